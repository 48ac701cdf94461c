"""`scaffold-cad cells`: the unit cells that lattices are made of."""

from __future__ import annotations

import argparse

from scaffold_cad.lattice import cells


def add_parser(
    commands: argparse._SubParsersAction[argparse.ArgumentParser], common: argparse.ArgumentParser
) -> None:
    """Add this command to the command line."""
    parser = commands.add_parser(
        "cells",
        parents=[common],
        help="list the unit cells of lattices",
        description="A line a cell: its name, the valency of its nodes, its relative density "
        "for thin struts of radius r in a cell of size a, and what it is.",
    )
    parser.set_defaults(run=run)


def run(_: argparse.Namespace) -> None:
    """Print a line a cell."""
    known = cells()
    width = max(len(name) for name in known)
    for name, cell in known.items():
        valency = "+".join(str(n) for n in cell.valencies)
        density = f"{cell.density_coefficient:.4g} (r/a)²"
        print(f"{name:<{width}}  valency {valency:<6}  {density:<14}  {cell.description}")
