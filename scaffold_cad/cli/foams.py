"""`scaffold-cad lattice --foam`: struts along the cells of random points, in a box or a part."""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np

from scaffold_cad.base.arguments import as_count
from scaffold_cad.base.arrays import Points
from scaffold_cad.cli import borders, sizes, source
from scaffold_cad.errors import OptionError
from scaffold_cad.filling import delaunay_foam, voronoi_foam
from scaffold_cad.lattice.maps import BoxMap
from scaffold_cad.lattice.maps.grading import mean_size
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.skeleton import Skeleton

FOAMS = {"voronoi": voronoi_foam, "delaunay": delaunay_foam}
"""What makes each foam."""

PER_CELL = {"voronoi": (6.8, 13.6), "delaunay": (1.0, 7.8)}
"""Nodes and struts of each point of a foam, about: those of Poisson's points in all of space."""

ONLY_FOAMS = ("count", "seed", "regularity", "stretch", "periodic")
"""Options that unit cells have no use for."""

ONLY_CELLS = ("cylinder", "sphere", "face", "face_number", "thickness", "tiles")
"""Options that foams have no use for."""

MARGIN = 2.0
"""How far a foam goes on around a body that cuts it, in cells: its own border is ragged."""


def add_arguments(what: argparse._MutuallyExclusiveGroup, parser: argparse.ArgumentParser) -> None:
    """Add the arguments that `foam` reads."""
    what.add_argument(
        "--foam",
        choices=tuple(FOAMS),
        help="random foam in place of a cell: struts along the edges of the cells of random "
        "points, or of their tetrahedra",
    )
    group = parser.add_argument_group("foams")
    group.add_argument(
        "--count", type=int, metavar="N", help="random points, one per cell, in place of --size"
    )
    group.add_argument(
        "--seed", type=int, metavar="S", help="seed of the random points (default: 0)"
    )
    group.add_argument(
        "--regularity",
        type=float,
        metavar="Q",
        help="0 for fully random points (default) to 0.7 for cells of similar size",
    )
    group.add_argument(
        "--stretch",
        type=sizes.direction,
        metavar="X,Y,Z",
        help="how much longer cells are along x, y and z",
    )
    group.add_argument(
        "--periodic",
        action="store_true",
        help="make the foam of a box periodic: it meets itself on opposite faces (--foam voronoi)",
    )


def check(options: argparse.Namespace) -> None:
    """Raise where an option of foams is given for cells, or the other way around."""
    if options.foam is None:
        source.refuse(options, ONLY_FOAMS, "is for --foam")
        if options.size is None:
            raise OptionError("--cell needs the --size of a cell, mm")
        return
    source.refuse(options, ONLY_CELLS, "is for --cell")
    if (options.count is None) == (options.size is None):
        raise OptionError("--foam needs either the --count of its cells or their --size, mm")
    if np.ndim(options.size):
        raise OptionError("--size of --foam is one number; --stretch makes cells longer one way")
    if options.periodic and (options.foam != "voronoi" or options.box is None):
        raise OptionError("--periodic is for --foam voronoi in a --box")


def foam(region: TriangleMesh | Points, options: argparse.Namespace) -> Skeleton:
    """Return the foam in a part, or in a box (2, 3).

    Raises
    ------
    OptionError
        If an option is out of its range, or memory may not hold that many cells.
    """
    corners = region.vertices if isinstance(region, TriangleMesh) else region
    count = _cell_count(corners, options.size) if options.count is None else options.count
    return _made(region, options, count, {"count": options.count, "size": options.size})


def foam_around(region: TriangleMesh | Points, options: argparse.Namespace) -> Skeleton:
    """Return a foam that goes on beyond a part, or a box (2, 3), which is to cut it.

    Raises
    ------
    OptionError
        As `foam` does.
    """
    if isinstance(region, TriangleMesh):
        corners, volume = region.vertices, region.signed_volume
    else:
        corners, volume = region, float((region[1] - region[0]).prod())
    low, high = corners.min(axis=0), corners.max(axis=0)
    size = options.size
    if size is None:
        size = float(np.cbrt(volume / as_count(options.count, "--count", 1)))
    mean = mean_size(BoxMap(high - low, low), size)[0] if callable(size) else size
    margin = MARGIN * mean * (1.0 if options.stretch is None else np.asarray(options.stretch))
    box = np.stack([low - margin, high + margin])
    count = _cell_count(box, size)
    return _made(box, options, count, {"count": None, "size": size})


def _made(
    region: TriangleMesh | Points,
    options: argparse.Namespace,
    count: int,
    cells: dict[str, Any],
) -> Skeleton:
    """Return a foam in a part or a box.

    Parameters
    ----------
    count : cells that it has, about
    cells : how many are asked for, or their size
    """
    nodes, struts = PER_CELL[options.foam]
    source.check_memory(options, count, int(nodes * count), int(struts * count))
    given: dict[str, Any] = {name: getattr(options, name) for name in ONLY_FOAMS[1:]}
    chosen = {name: value for name, value in given.items() if value not in (None, False)}
    make: Any = FOAMS[options.foam]
    chosen |= borders.borders(options)
    made: Skeleton = make(region=region, radius=options.radius, **cells, **chosen)
    return made


def _cell_count(corners: Points, size: Any) -> int:
    """Return how many cells of a size, mm, the box around points (n, 3) has, about."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    if callable(size):
        size = mean_size(BoxMap(high - low, low), size)[0]
    return round(np.clip((high - low).prod() / size**3, 1, 1e15)) if size > 0 else 1
