"""`scaffold-cad formats`: what can be read and written."""

from __future__ import annotations

import argparse

from scaffold_cad.io import known_formats, mesh_formats, written_formats


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
    skeletons = [(suffix, known.name) for known in known_formats() for suffix in known.suffixes]
    meshes = [(suffix, known.name) for known in mesh_formats() for suffix in known.suffixes]
    written = [(suffix, known.name) for known in written_formats() for suffix in known.suffixes]
    names: dict[str, list[str]] = {}
    for suffix, name in skeletons + meshes + written:
        names.setdefault(suffix, []).append(name)
    is_read, is_written = dict(skeletons + meshes), dict(written)
    width = max(map(len, names))
    for suffix in sorted(names):
        verbs = ("read" if suffix in is_read else "", "write" if suffix in is_written else "")
        kinds = ", ".join(dict.fromkeys(names[suffix]))
        print(f"{suffix:<{width}}  {verbs[0]:<4}  {verbs[1]:<5}  {kinds}")
