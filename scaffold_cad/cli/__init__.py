"""The command `scaffold-cad`: one module a subcommand, no geometry.

Exit codes: 0 done, 1 not printable (`check`), 2 bad input (one line on standard error says what),
130 interrupted. What was repaired or must be known is logged on standard error; results go to
standard output.
"""

from __future__ import annotations

import argparse
import logging
import os
import re
import sys
from collections.abc import Sequence

from scaffold_cad import __version__
from scaffold_cad.cli import build, cells, check, formats, info, lattice, slicing, strength, view
from scaffold_cad.cli.parsing import Parser
from scaffold_cad.errors import ScaffoldCadError

COMMANDS = (build, lattice, slicing, cells, check, strength, view, formats, info)

PARAMETER = re.compile(
    r"\b(overlaps|radius|blend|ends|joints|wall|sides|collars|section|fit|max_nodes)=('?)([\w.]*)\2"
)
"""Parameters of the library that are flags here, as messages give them."""

BAD_INPUT = 2
INTERRUPTED = 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code."""
    options = _parser().parse_args(arguments)
    _log_to_stderr(logging.ERROR if options.quiet else logging.INFO)
    try:
        code: int | None = options.run(options)
        sys.stdout.flush()
    except ScaffoldCadError as error:
        print(f"scaffold-cad: {with_flags(str(error))}", file=sys.stderr)
        return BAD_INPUT
    except MemoryError:
        print("scaffold-cad: out of memory; need a smaller skeleton", file=sys.stderr)
        return BAD_INPUT
    except OSError as error:  # of standard output: files raise a FormatError
        # What is left in its buffer has nowhere to go.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(error, BrokenPipeError):
            print(f"scaffold-cad: cannot print: {error.strerror or error}", file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt:
        print("scaffold-cad: interrupted", file=sys.stderr)
        return INTERRUPTED
    return code or 0  # most commands give none: they are done


def with_flags(message: str) -> str:
    """Return a message of the library with its parameters as the command's flags.

    Examples
    --------
    >>> with_flags("need overlaps='unite', or radius= for all")
    'need --overlaps unite, or --radius for all'
    """
    return PARAMETER.sub(
        lambda found: f"--{found[1].replace('_', '-')} {found[3]}".strip(), message
    )


def _parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="scaffold-cad",
        description="Solid lattice frames and organic solids from skeletons.",
    )
    parser.add_argument("--version", action="version", version=f"%(prog)s {__version__}")
    common = argparse.ArgumentParser(add_help=False)
    common.add_argument("--quiet", action="store_true", help="log nothing but errors")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for command in COMMANDS:
        command.add_parser(commands, common)
    return parser


def _log_to_stderr(level: int) -> None:
    """Send the package's log records of `level` and above to standard error, and them only."""
    logger = logging.getLogger("scaffold_cad")
    for handler in list(logger.handlers):
        logger.removeHandler(handler)
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(logging.Formatter("scaffold-cad: %(message)s"))
    logger.addHandler(handler)
    logger.setLevel(level)
    logger.propagate = False
