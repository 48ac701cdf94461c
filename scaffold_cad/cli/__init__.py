"""The command `scaffold-cad`: one module per subcommand, no geometry.

Exit codes: 0 done, 1 not printable (`check`), 2 bad input (one line on standard error says what),
130 interrupted. What was repaired or must be known is logged on standard error; results go to
standard output.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from itertools import takewhile
from pathlib import Path

from scaffold_cad import __version__
from scaffold_cad.cli import (
    build,
    cells,
    check,
    convert,
    formats,
    info,
    lattice,
    running,
    slicing,
    streams,
    strength,
    view,
)
from scaffold_cad.cli.completion import add_completion
from scaffold_cad.cli.config import with_config
from scaffold_cad.cli.parsing import Parser
from scaffold_cad.errors import ScaffoldCadError

COMMANDS = (build, lattice, slicing, convert, cells, check, strength, view, formats, info)

LOGGING = ("-q", "--quiet", "-v", "--verbose")
"""Flags of all commands that may stand before the command, too."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code."""
    streams.open_closed()
    parser, commands = parsers()
    words = list(sys.argv[1:] if arguments is None else arguments)
    if not words:
        parser.print_help(sys.stderr)
        return running.BAD_INPUT
    ahead = list(takewhile(LOGGING.__contains__, words))  # such as -q build: as build -q
    words = [*words[len(ahead) :][:1], *ahead, *words[len(ahead) + 1 :]]
    if words[0] == "help":
        words = [*(word for word in words[1:] if word != "help"), "--help"]
    try:
        words = with_config(words, commands)
    except ScaffoldCadError as error:
        parser.error(str(error))
    try:
        try:
            options = parser.parse_args(words)
        finally:
            sys.stdout.flush()  # help, versions and scripts for shells are printed by now
    except OSError as error:
        return running.unprinted(error)
    options.words = words
    return running.run(options)


def parsers() -> tuple[argparse.ArgumentParser, dict[str, argparse.ArgumentParser]]:
    """Return the parser of the command line, and those of its commands by name."""
    parser = Parser(
        prog="scaffold-cad",
        description="Solid lattice frames from skeletons: round struts, lattices, scaffolds.",
        epilog="`scaffold-cad help COMMAND` tells the options of a command.",
    )
    parser.add_argument("--version", action="version", version=f"%(prog)s {__version__}")
    add_completion(parser)
    common = argparse.ArgumentParser(add_help=False)
    common.add_argument("-q", "--quiet", action="store_true", help="log only errors")
    common.add_argument("-v", "--verbose", action="store_true", help="log also what is tried")
    common.add_argument(
        "--config", type=Path, metavar="FILE", help="TOML file with options, in tables by command"
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for command in COMMANDS:
        command.add_parser(commands, common)
    return parser, dict(commands.choices)
