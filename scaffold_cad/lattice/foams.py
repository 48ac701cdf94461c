"""Random foams: struts along the edges of Voronoi cells, or of Delaunay tetrahedra."""

from __future__ import annotations

import logging
from itertools import combinations
from typing import get_args

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import Delaunay

from scaffold_cad.base.arrays import Bools, Floats
from scaffold_cad.base.radii import Radius
from scaffold_cad.base.regions import BoxRegion, Keep, Region
from scaffold_cad.base.topology import component_labels
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.lattice.clipping import clipped, least_length
from scaffold_cad.lattice.foampoints import (
    MOST_POINTS,
    CellSizes,
    Seeds,
    as_stretch,
    random_points,
    seeds_in,
)
from scaffold_cad.lattice.powercells import cell_edges, centers, repeated_around
from scaffold_cad.lattice.struts import Struts
from scaffold_cad.skeleton import Skeleton

__all__ = ["MOST_POINTS", "delaunay_foam", "random_points", "voronoi_foam"]

SHORTEST_FRACTION = 1e-3
"""Length below which struts are shrunk to a node, as a fraction of the points' mean spacing."""

_log = logging.getLogger(__name__)


def voronoi_foam(
    count: int | ArrayLike | None,
    region: ArrayLike | Region,
    radius: Radius,
    seed: int = 0,
    *,
    size: CellSizes | None = None,
    regularity: float = 0.0,
    stretch: ArrayLike = (1.0, 1.0, 1.0),
    periodic: bool = False,
    keep: Keep = "clip",
    dangling: bool = True,
    shortest: float | None = None,
) -> Skeleton:
    """Return the edges of the Voronoi cells of random points: an open-cell foam.

    Nodes inside have valency 4, but for those that short struts were shrunk to. The foam is in one
    piece: others, which the surface cuts loose, are left out.

    Parameters
    ----------
    count : random points in the region, one a cell; or points of one's own (n, 3), mm
    region : lowest and highest corner of the box to fill, mm; or a region
    radius : mm; one number, or a function of positions (n, 3) that returns radii (n,)
    seed : of the random points; the same seed gives the same foam
    size : in place of a count: side of a cube as large as a cell, mm; or a function of positions
        (n, 3) that returns sizes (n,), such as a `Field`: points are then as dense as it asks, and
        the cells are Laguerre cells, larger where they are to be
    regularity : least distance of two points, as a fraction of that in a lattice of as many
        Kelvin cells, in 0..0.7: 0 is fully random, 0.7 gives cells of similar size
    stretch : how much longer cells are along x, y and z
    periodic : whether the foam of a box meets itself on opposite faces, to be repeated; what the
        box cuts loose then stays, as it hangs on the next one
    keep : "clip" cuts struts at the surface, "whole" drops those that leave it
    dangling : whether struts that end free stay
    shortest : struts shorter than this are shrunk to a node, mm; by default 1/1000 of the mean
        spacing of the points

    Raises
    ------
    OptionError
        If an argument is out of its range.
    SkeletonError
        If no strut is in the region.

    References
    ----------
    Zhu, Hobdell, Windle, Effects of cell irregularity on the elastic properties of open-cell
    foams, 2000: the regularity. Redenbach, Microstructure models for cellular materials, 2009:
    Laguerre cells.
    """
    if keep not in get_args(Keep):
        raise OptionError(f"keep is {keep!r}; need one of {', '.join(get_args(Keep))}")
    space = _as_region(region)
    factors = as_stretch(stretch)
    seeds = seeds_in(count, space, seed, regularity, size, factors)
    struts = _cells(seeds, space, factors, periodic)
    on_surface = np.zeros(len(struts.nodes), dtype=np.bool_)
    if keep == "clip":
        struts = clipped(struts, space, 0.0)
        on_surface = np.arange(len(struts.nodes)) >= len(on_surface)
    else:
        inside = space.contains(struts.nodes)[struts.edges]  # (m, 2)
        struts = struts.kept(inside[:, 0] & inside[:, 1])
    if not dangling:
        struts = struts.without_dangling()
    shortest = least_length(shortest, _shortest(seeds))
    return _foam(struts, space, radius, on_surface, shortest, whole=periodic)


def delaunay_foam(
    count: int | ArrayLike | None,
    region: ArrayLike | Region,
    radius: Radius,
    seed: int = 0,
    *,
    size: CellSizes | None = None,
    regularity: float = 0.0,
    stretch: ArrayLike = (1.0, 1.0, 1.0),
    shortest: float | None = None,
) -> Skeleton:
    """Return the edges of the Delaunay tetrahedra of random points: a random truss.

    Tetrahedra count that have their circumcenter in the region: the others are flat ones at its
    surface. Struts that leave the region go. The truss is in one piece: others are left out.

    Parameters
    ----------
    count : random points in the region, or points of one's own (n, 3), mm
    region : lowest and highest corner of the box to fill, mm; or a region
    radius : mm; one number, or a function of positions (n, 3) that returns radii (n,)
    seed : of the random points; the same seed gives the same foam
    size, regularity, stretch, shortest : as for `voronoi_foam`

    Raises
    ------
    OptionError
        If an argument is out of its range.
    SkeletonError
        If no tetrahedron is in the region.
    """
    space = _as_region(region)
    factors = as_stretch(stretch)
    seeds = seeds_in(count, space, seed, regularity, size, factors)
    points = seeds.points[space.contains(seeds.points)]
    tetrahedra = np.zeros((0, 4), dtype=np.intp)
    if len(points) >= 5:  # Qhull needs one more than a tetrahedron has
        tetrahedra = Delaunay(points / factors).simplices.astype(np.intp)
    middles = centers((points / factors)[tetrahedra]) * factors
    there = np.isfinite(middles).all(axis=1)  # not so of flat ones
    tetrahedra = tetrahedra[there][space.contains(middles[there])]
    sides = np.concatenate([tetrahedra[:, pair] for pair in combinations(range(4), 2)])
    struts = Struts(points, np.unique(np.sort(sides, axis=1), axis=0))
    if not isinstance(space, BoxRegion):
        leaves = np.zeros(len(struts.edges), dtype=np.bool_)
        leaves[space.crossings(struts.nodes, struts.edges)[0]] = True
        struts = struts.kept(~leaves)
    held = np.zeros(len(points), dtype=np.bool_)
    return _foam(struts, space, radius, held, least_length(shortest, _shortest(seeds)))


def _as_region(region: ArrayLike | Region) -> Region:
    """Return a region, or the box between two corners."""
    return region if isinstance(region, Region) else BoxRegion(region)


def _cells(seeds: Seeds, space: Region, stretch: Floats, periodic: bool) -> Struts:
    """Return the edges of the cells of points, before they are cut."""
    points, sizes, box = seeds.points, seeds.sizes, space.bounds
    if periodic:
        if not isinstance(space, BoxRegion):
            raise OptionError("a periodic foam in a region that is no box; need a box")
        points = repeated_around(points, box)
        sizes = None if sizes is None else np.tile(sizes, 27)
        box = np.stack([2 * box[0] - box[1], 2 * box[1] - box[0]])
    weights = None if sizes is None else (sizes / 2) ** 2
    struts = cell_edges(points / stretch, box / stretch, weights)
    return Struts(struts.nodes * stretch, struts.edges)


def _shortest(seeds: Seeds) -> float:
    return SHORTEST_FRACTION * seeds.spacing


def _foam(
    struts: Struts,
    region: Region,
    radius: Radius,
    on_surface: Bools,
    shortest: float,
    *,
    whole: bool = False,
) -> Skeleton:
    """Return the struts as a skeleton, short ones shrunk to a node; nodes on the surface stay.

    Parameters
    ----------
    whole : whether pieces that the surface cuts loose stay
    """
    if len(struts.edges):
        struts = struts.collapsed(struts.lengths < shortest, on_surface)
    if len(struts.edges) == 0:
        low, high = region.bounds.tolist()
        raise SkeletonError(
            f"the foam has no strut in the box from {low} to {high} mm; need more points"
        )
    return (struts if whole else _largest_piece(struts)).cleaned_skeleton(radius)


def _largest_piece(struts: Struts) -> Struts:
    """Return the struts that hang together in the longest piece; log how many others there are."""
    piece = component_labels(struts.edges, len(struts.nodes))[struts.edges[:, 0]]
    keep = piece == np.argmax(np.bincount(piece, weights=struts.lengths))
    if not keep.all():
        _log.info(
            "%d of %d struts of the foam left out: they hang loose from the largest piece",
            len(keep) - int(keep.sum()),
            len(keep),
        )
    return struts.kept(keep)
