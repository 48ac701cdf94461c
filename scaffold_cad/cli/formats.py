"""`scaffold-cad formats`: what can be read and written."""

from __future__ import annotations

import argparse

from scaffold_cad.io import export, known_formats

NAMES = {
    ".brep": "OCCT B-rep",
    ".step": "STEP",
    ".stp": "STEP",
}
"""Names of formats that are written only."""


def add_parser(
    commands: argparse._SubParsersAction[argparse.ArgumentParser], common: argparse.ArgumentParser
) -> None:
    """Add this command to the command line."""
    parser = commands.add_parser(
        "formats", parents=[common], help="list the formats that are read and written"
    )
    parser.set_defaults(run=run)


def run(_: argparse.Namespace) -> None:
    """Print a line a suffix: whether it is read, whether it is written, and its formats."""
    names: dict[str, list[str]] = {}
    for known in known_formats():
        for suffix in known.suffixes:
            names.setdefault(suffix, []).append(known.name)
    written = export.known_suffixes()
    width = max(len(suffix) for suffix in [*names, *written])
    for suffix in sorted({*names, *written}):
        read = "read" if suffix in names else ""
        write = "write" if suffix in written else ""
        kinds = ", ".join(names.get(suffix) or [NAMES.get(suffix, suffix[1:].upper())])
        print(f"{suffix:<{width}}  {read:<4}  {write:<5}  {kinds}")
