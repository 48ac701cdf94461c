"""`scaffold-cad lattice --tiles`: a box of any size, tile by tile, no strut made before."""

from __future__ import annotations

import argparse
import logging

from scaffold_cad.base.arguments import as_count
from scaffold_cad.base.backends import need
from scaffold_cad.base.summaries import counted
from scaffold_cad.cli import borders, latticelayers, processes, shapes, source, tiled
from scaffold_cad.errors import OptionError
from scaffold_cad.filling.fill import lattice_around
from scaffold_cad.lattice.registry import as_cell
from scaffold_cad.lattice.tiling import cell_size
from scaffold_cad.layers import slices
from scaffold_cad.solid.rounds import SIDES

BLOCK = 10
"""Cells along the sides of a tile where none are given."""

NOT_TILED = (
    "trim",
    "skin",
    "beams",
    "max_nodes",
    *borders.OF_BORDERS,
    *latticelayers.NOT_PERIODIC,
)
"""Options that are not for tiles of lattices."""

_log = logging.getLogger(__name__)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of tiles."""
    tiled.add_arguments(
        parser,
        of="a box of whole cells, as .stl or layers",
        block=f"of a tile, in cells (default: {BLOCK})",
    )


def run(options: argparse.Namespace, sides: int) -> None:
    """Make all tiles that are not there yet, and join them; `check` has looked at the options.

    Parameters
    ----------
    sides : of round struts where none are given
    """
    need("joblib", "work on tiles")
    from scaffold_cad.tiles import tiles

    cell = as_cell(options.cell)
    size = cell_size(cell, options.size)
    given = shapes.round_options(options)
    lattice = lattice_around(options.box, cell, size, options.radius, **given)
    processes.check_lattice(options, lattice)
    if options.layer is None:
        work = tiled.surface_work(options, {}, {"collars": True}, options.sides or sides)
    else:
        sides = options.sides or SIDES
        first = float(slices(lattice, thickness=options.layer, sides=sides).heights[0])
        work = tiled.layer_work(options, first - options.layer / 2, {}, sides)
    parts = tiles(lattice, block=_block(options))
    _log.info("%s, %s", counted(lattice.strut_count, "strut"), counted(len(parts), "tile"))
    tiled.make(parts, work, options)


def _block(options: argparse.Namespace) -> int:
    """Return the cells along the sides of a tile."""
    if options.block is None:
        return BLOCK
    if not options.block.is_integer():
        raise OptionError(f"--block is {options.block:g} cells; need a whole number")
    return as_count(int(options.block), "--block", 1)


def check(options: argparse.Namespace) -> None:
    """Raise where an option is out of its range, or would do nothing."""
    if callable(options.size):
        raise OptionError("--tiles is for cells of one size; need --size as a number")
    if options.box is None or not latticelayers.fills(options.box, options):
        raise OptionError("--tiles is for a --box that whole cells fill; need one")
    source.refuse(options, NOT_TILED, "is not for lattices by --tiles")
    if options.layer is not None:
        latticelayers.check(options)
        return
    shapes.check_round_options(options)
    source.refuse(options, ["pixel", "text"], "is for layers; need --layer")
    tiled.check_stl(options)
