"""`scaffold-cad cells`: the unit cells that lattices are made of."""

from __future__ import annotations

import argparse
import logging
from html import escape

from scaffold_cad.base.files import check_page, replacing
from scaffold_cad.cli import sizes
from scaffold_cad.cli.flags import told_as
from scaffold_cad.lattice import UnitCell, cell_picture, cells

PAGE = """\
<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Unit cells</title><style>
body {{ font: 15px sans-serif; margin: 2em; color: #222; }}
div {{ display: grid; grid-template-columns: repeat(auto-fill, minmax(240px, 1fr)); gap: 1em; }}
figure {{ margin: 0; }}
</style></head><body><h1>Unit cells</h1>
<p>Maxwell's count is below 0 where struts must bend. Relative density of thin round struts of
radius r in a cell of size a.</p>
<div>
{figures}
</div></body></html>
"""

_log = logging.getLogger(__name__)


def add_parser(
    commands: argparse._SubParsersAction[argparse.ArgumentParser], common: argparse.ArgumentParser
) -> None:
    """Add this command to the command line."""
    parser = commands.add_parser(
        "cells",
        parents=[common],
        help="list the unit cells of lattices",
        description="A line per cell: its name, the valency of its nodes, Maxwell's count "
        "(below 0 struts carry by bending), its relative density for thin struts of radius r in a "
        "cell of size a, and what it is.",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=sizes.path,
        metavar="PAGE",
        help="write them as a page with pictures, .html",
    )
    parser.add_argument(
        "--stiffness",
        type=float,
        metavar="DENSITY",
        help="print their moduli at this relative density instead, over that density and the "
        "Young's modulus of the material: Young's along x y z, shear yz xz xy, and bulk",
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Print a line per cell, or write the page."""
    known = cells()
    if options.stiffness is not None:
        with told_as(**{"relative density": "--stiffness"}):
            _print_stiffness(options.stiffness)
        return
    if options.output is not None:
        check_page(options.output)
        with replacing(options.output) as fresh:
            figures = "\n".join(_figure(name, cell) for name, cell in known.items())
            fresh.write_text(PAGE.format(figures=figures), encoding="utf-8")
        _log.info("%s written", options.output)
        return
    width = max(len(name) for name in known)
    for name, cell in known.items():
        valency, maxwell, density = _valency(cell), cell.maxwell_number, _density(cell)
        counts = f"valency {valency:<6}  Maxwell {maxwell:<3}"
        print(f"{name:<{width}}  {counts}  {density:<14}  {cell.description}")


def _print_stiffness(density: float) -> None:
    """Print how stiff each cell is, over relative density times the material's Young's modulus."""
    from scaffold_cad.mechanics import cell_table

    rows = cell_table(density)
    print(f"{'':<22}{'E x':>8}{'E y':>8}{'E z':>8}{'G yz':>8}{'G xz':>8}{'G xy':>8}", end="")
    print(f"{'K':>8}{'Zener':>9}{'Maxwell':>9}")
    for row in rows:
        moduli = "".join(f"{value:>8.4f}" for value in (*row.young, *row.shear, row.bulk))
        print(f"{row.name:<22}{moduli}{row.zener:>9.3g}{row.maxwell:>9}")


def _figure(name: str, cell: UnitCell) -> str:
    return (
        f"<figure>{cell_picture(cell)}<figcaption><b>{escape(name)}</b>, valency {_valency(cell)}, "
        f"Maxwell's count {cell.maxwell_number}, {_density(cell)}<br>"
        f"{escape(cell.description)}</figcaption></figure>"
    )


def _valency(cell: UnitCell) -> str:
    return "+".join(str(n) for n in cell.valencies)


def _density(cell: UnitCell) -> str:
    return f"{cell.density_coefficient:.4g} (r/a)²"
