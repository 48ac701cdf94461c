"""`scaffold-cad convert`: a file with a skeleton becomes one of another format."""

from __future__ import annotations

import argparse
import logging

from scaffold_cad.cli import source, streams
from scaffold_cad.cli.flags import told_as
from scaffold_cad.io.write import check_writable, write

_log = logging.getLogger(__name__)


def add_parser(
    commands: argparse._SubParsersAction[argparse.ArgumentParser], common: argparse.ArgumentParser
) -> None:
    """Add this command to the command line."""
    parser = commands.add_parser(
        "convert", parents=[common], help="write a skeleton in another format"
    )
    source.add_arguments(parser, several=True)
    about = "file to write: .json .swc .graphml .csv .vtu .inp; .3mf with beams; .obj with lines"
    streams.add_output(parser, about)
    parser.add_argument(
        "--to-units", metavar="UNIT", help="unit of the lengths that are written (default: mm)"
    )
    parser.add_argument(
        "--jobs", type=int, metavar="N", help="processes that work on files (default: 1)"
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Read, change and write."""
    check_writable(options.output, skeleton=True)
    assembly = source.assembly_from(options) if options.output.suffix.lower() == ".3mf" else None
    found = source.skeleton_from(options, converted=True) if assembly is None else assembly
    with told_as(units="--to-units"):
        write(found, options.output, units=options.to_units)
    _log.info("%s written", options.output)
