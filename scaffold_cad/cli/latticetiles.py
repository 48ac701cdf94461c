"""`scaffold-cad lattice --tiles`: a box of any size, tile by tile, in several processes."""

from __future__ import annotations

import argparse
import logging
from pathlib import Path
from typing import TYPE_CHECKING

from scaffold_cad.base.arguments import as_count
from scaffold_cad.base.backends import need
from scaffold_cad.base.files import check_target
from scaffold_cad.cli import build, latticelayers, source
from scaffold_cad.cli.progress import Progress
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.filling.fill import lattice_around
from scaffold_cad.lattice.registry import unit_cell
from scaffold_cad.lattice.tiling import cell_size
from scaffold_cad.layers import slices
from scaffold_cad.solid.rounds import SIDES

if TYPE_CHECKING:
    from scaffold_cad.lattice import PeriodicLattice
    from scaffold_cad.tiles import Build, Slice
    from scaffold_cad.tiles.surfaces import TileOverlaps

BLOCK = 10
"""Cells along the sides of a tile where none are given."""

_log = logging.getLogger(__name__)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of tiles."""
    parser.add_argument(
        "--tiles",
        type=Path,
        metavar="FOLDER",
        help="make a box of whole cells tile by tile, as .stl or layers; the tiles' files stay in "
        "FOLDER, and the same command goes on where it was ended",
    )
    parser.add_argument(
        "--block", type=int, metavar="N", help=f"cells along each side of a tile (default: {BLOCK})"
    )
    parser.add_argument(
        "--jobs", type=int, metavar="N", help="processes that work on tiles (default: 1)"
    )


def run(options: argparse.Namespace, sides: int) -> None:
    """Make all tiles that are not there yet, and join them.

    Parameters
    ----------
    sides : of round struts where none are given
    """
    _check(options)
    need("joblib", "work on tiles")
    from joblib import parallel_config

    from scaffold_cad.tiles import run_tiles, tiles

    cell = unit_cell(options.cell)
    size = cell_size(cell, options.size)
    given = build.round_options(options)
    lattice = lattice_around(options.box, cell, size, options.radius, **given)
    work = _layers(options, lattice) if options.layer is not None else _solid(options, sides)
    jobs = as_count(1 if options.jobs is None else options.jobs, "--jobs", 1)
    block = as_count(BLOCK if options.block is None else options.block, "--block", 1)
    parts = tiles(lattice, block=block)
    _log.info("%d struts, %d tiles", lattice.strut_count, len(parts))
    folder: Path = options.tiles
    done = Progress().counted(
        "tiles", len(parts), lambda: sum(1 for _ in folder.glob("tile-*.done"))
    )
    with done, parallel_config(backend="loky", n_jobs=jobs):
        manifest = run_tiles(parts, work, folder)
    manifest.joined(work, options.output)
    _log.info("%s written", options.output)


def _solid(options: argparse.Namespace, sides: int) -> Build:
    from scaffold_cad.tiles import Build

    allowed: TileOverlaps = "allow" if options.overlaps == "allow" else "refuse"
    if options.round:
        return Build(round=True, sides=options.sides or sides, overlaps=allowed)
    return Build(options={"collars": True}, overlaps=allowed)


def _layers(options: argparse.Namespace, lattice: PeriodicLattice) -> Slice:
    from scaffold_cad.tiles import Slice

    sides = options.sides or SIDES
    first = float(slices(lattice, thickness=options.layer, sides=sides).heights[0])
    return Slice(
        options.layer,
        bottom=first - options.layer / 2,
        sides=sides,
        text=options.text,
        pixel=options.pixel,
    )


def _check(options: argparse.Namespace) -> None:
    """Raise where an option is out of its range, or would do nothing."""
    if options.box is None or not latticelayers.fills(options.box, options):
        raise OptionError("--tiles is for a --box that whole cells fill; need one")
    source.refuse(
        options, ["trim", "skin", "beams", "joints", "max_nodes"], "is not for lattices by --tiles"
    )
    if options.layer is not None:
        latticelayers.check(options)
        return
    build.check_round_options(options)
    source.refuse(options, ["pixel", "text"], "is for layers; need --layer")
    check_target(options.output)
    if options.output.suffix.lower() != ".stl":
        raise FormatError(
            f"cannot write {options.output}: tiles are joined as .stl, or with --layer as layers"
        )
    if options.overlaps == "unite":
        raise OptionError("--overlaps unite is not for --tiles, which unite nothing; need allow")


def refuse(options: argparse.Namespace) -> None:
    """Raise if an argument of tiles is given without `--tiles`."""
    source.refuse(options, ["block", "jobs"], "is for --tiles")
