"""Completion of the command line in a shell, by shtab."""

from __future__ import annotations

import argparse
from typing import Any

SHELLS = ("bash", "zsh", "tcsh")


def add_completion(parser: argparse.ArgumentParser) -> None:
    """Add the argument that prints a script for a shell."""
    parser.add_argument(
        "--print-completion",
        action=_Print,
        choices=SHELLS,
        help="print a script that completes commands and flags in a shell (extra `completion`)",
    )


class _Print(argparse.Action):
    """Print the script and end."""

    def __call__(self, parser: argparse.ArgumentParser, *given: Any) -> None:
        """Do so for the shell that is given."""
        try:
            import shtab
        except ModuleNotFoundError:
            parser.error("--print-completion needs shtab: pip install 'scaffold-cad[completion]'")
        print(shtab.complete(parser, given[1]))
        parser.exit()
