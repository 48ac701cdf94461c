"""`--tiles`: a work done tile by tile, in several processes, resumed by the same command."""

from __future__ import annotations

import argparse
import logging
from pathlib import Path
from typing import TYPE_CHECKING, Any

from scaffold_cad.base.arguments import as_count, as_number
from scaffold_cad.base.backends import need
from scaffold_cad.base.files import check_target
from scaffold_cad.cli import source
from scaffold_cad.cli.progress import Progress
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.skeleton import Skeleton

if TYPE_CHECKING:
    from scaffold_cad.tiles import LatticeTiles, SkeletonTiles, Work
    from scaffold_cad.tiles.surfaces import TileOverlaps

ENOUGH = 20_000
"""Struts of a tile, about, where no block is given for a skeleton."""

_log = logging.getLogger(__name__)


def add_arguments(
    parser: argparse.ArgumentParser, *, of: str, block: str = "of a tile, mm", jobs: str = "tiles"
) -> None:
    """Add the arguments of tiles.

    Parameters
    ----------
    of : what is made tile by tile
    block : what `--block` is the size of, and its unit
    jobs : what processes work on
    """
    tiles = parser.add_argument_group("tiles")
    tiles.add_argument(
        "--tiles",
        type=Path,
        metavar="FOLDER",
        help=f"make {of} tile by tile; the tiles' files stay in FOLDER, and the same command "
        "resumes where it stopped",
    )
    tiles.add_argument("--block", type=float, metavar="N", help=f"size {block}")
    tiles.add_argument(
        "--jobs",
        type=int,
        metavar="N",
        help=f"processes that work on {jobs} (default: 1)",
    )


def refuse(options: argparse.Namespace) -> None:
    """Raise if an argument of tiles is given without `--tiles`."""
    source.refuse(options, ["block", "jobs"], "is for --tiles")


def cut(skeleton: Skeleton, options: argparse.Namespace) -> SkeletonTiles:
    """Return the tiles of a skeleton, in blocks of the size asked for."""
    need("joblib", "work on tiles")
    from scaffold_cad.tiles import tiles
    from scaffold_cad.tiles.tiling import block_size

    given = options.block is not None
    block = as_number(options.block, "--block") if given else block_size(skeleton, ENOUGH)
    return tiles(skeleton, block=block)


def make(
    parts: SkeletonTiles | LatticeTiles,
    work: Work,
    options: argparse.Namespace,
    name: str | None = None,
    part: str = "",
) -> Path:
    """Make all tiles that are not there yet, join them, and return the file.

    Parameters
    ----------
    name : of the file beside the tiles'; by default it is the output
    part : of the tiles' folder, for works of several parts
    """
    from joblib import parallel_config

    from scaffold_cad.tiles import run_tiles

    jobs = as_count(1 if options.jobs is None else options.jobs, "--jobs", 1)
    folder: Path = options.tiles / part
    done = Progress().counted(
        "tiles", len(parts), lambda: sum(1 for _ in folder.glob("tile-*.done"))
    )
    with done, parallel_config(backend="loky", n_jobs=jobs):
        manifest = run_tiles(parts, work, folder)
    output: Path = options.output if name is None else folder / name
    manifest.joined(work, output)
    _log.info("%s written", output)
    return output


def check_stl(options: argparse.Namespace) -> TileOverlaps:
    """Return what becomes of struts that overlap; raise where tiles cannot be joined as asked."""
    check_target(options.output)
    if options.output.suffix.lower() != ".stl":
        raise FormatError(
            f"cannot write {options.output}: tiles are joined as .stl, or with --layer as layers"
        )
    if options.overlaps == "unite":
        raise OptionError("--overlaps unite is not for --tiles, which unite nothing; need allow")
    return "allow" if options.overlaps == "allow" else "refuse"


def surface_work(
    options: argparse.Namespace, struts: dict[str, Any], scaffold: dict[str, Any], sides: int
) -> Work:
    """Return the work that makes the surface which is asked for.

    Parameters
    ----------
    struts, scaffold : options of round struts and of square ones
    sides : of round struts
    """
    from scaffold_cad.tiles import Build

    allowed = check_stl(options)
    if options.round:
        return Build(round=True, options=struts, sides=sides, overlaps=allowed)
    return Build(options=scaffold, overlaps=allowed)


def layer_work(
    options: argparse.Namespace,
    bottom: float,
    struts: dict[str, Any],
    sides: int,
    region: TriangleMesh | None = None,
) -> Work:
    """Return the work that cuts the layers which are asked for.

    Parameters
    ----------
    bottom : height where a layer begins, mm
    struts : options of round struts
    sides : of the polygons that stand for circles
    region : what the layers are cut to
    """
    from scaffold_cad.tiles import Slice

    return Slice(
        options.layer,
        bottom=bottom,
        options=struts,
        sides=sides,
        text=options.text,
        pixel=options.pixel,
        region=region,
        skin=options.skin,
    )
