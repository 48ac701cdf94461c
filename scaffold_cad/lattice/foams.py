"""Random foams: struts along the edges of Voronoi cells, or of Delaunay tetrahedra."""

from __future__ import annotations

import logging
from itertools import combinations

import numpy as np
from scipy.spatial import Delaunay

from scaffold_cad.base.arrays import Bools, Floats
from scaffold_cad.base.radii import Radius
from scaffold_cad.base.regions import BoxRegion, Keep, Region
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.topology import component_labels
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.lattice.clipping import clipped, least_length
from scaffold_cad.lattice.foampoints import Seeds
from scaffold_cad.lattice.powercells import cell_edges, centers, repeated_around
from scaffold_cad.lattice.struts import Struts
from scaffold_cad.skeleton import Skeleton

SHORTEST_FRACTION = 1e-3
"""Length below which struts are shrunk to a node, as a fraction of the points' mean spacing."""

_log = logging.getLogger(__name__)


def voronoi_struts(
    seeds: Seeds, region: Region, stretch: Floats, *, periodic: bool, keep: Keep, dangling: bool
) -> tuple[Struts, Bools]:
    """Return the edges of the cells of points in a region, and which nodes are on its surface.

    Parameters
    ----------
    stretch : (3,) how much longer cells are along x, y and z
    periodic, keep, dangling : see `scaffold_cad.filling.voronoi_foam`
    """
    struts = _cells(seeds, region, stretch, periodic)
    on_surface = np.zeros(len(struts.nodes), dtype=np.bool_)
    if keep == "clip":
        struts = clipped(struts, region, 0.0)
        on_surface = np.arange(len(struts.nodes)) >= len(on_surface)
    else:
        inside = region.contains(struts.nodes)[struts.edges]  # (m, 2)
        struts = struts.kept(inside[:, 0] & inside[:, 1])
    return (struts if dangling else struts.without_dangling()), on_surface


def delaunay_struts(seeds: Seeds, region: Region, stretch: Floats) -> Struts:
    """Return the edges of the tetrahedra of points whose circumcenters are in a region.

    Parameters
    ----------
    stretch : (3,) how much longer tetrahedra are along x, y and z
    """
    points = seeds.points[region.contains(seeds.points)]
    tetrahedra = np.zeros((0, 4), dtype=np.intp)
    if len(points) >= 5:  # Qhull needs one more than a tetrahedron has
        tetrahedra = Delaunay(points / stretch).simplices.astype(np.intp)
    middles = centers((points / stretch)[tetrahedra]) * stretch
    there = np.isfinite(middles).all(axis=1)  # not so of flat ones
    tetrahedra = tetrahedra[there][region.contains(middles[there])]
    sides = np.concatenate([tetrahedra[:, pair] for pair in combinations(range(4), 2)])
    struts = Struts(points, np.unique(np.sort(sides, axis=1), axis=0))
    if isinstance(region, BoxRegion):
        return struts
    leaves = np.zeros(len(struts.edges), dtype=np.bool_)
    leaves[region.crossings(struts.nodes, struts.edges)[0]] = True
    return struts.kept(~leaves)


def _cells(seeds: Seeds, space: Region, stretch: Floats, periodic: bool) -> Struts:
    """Return the edges of the cells of points, before they are cut."""
    points, sizes, box = seeds.points, seeds.sizes, space.bounds
    if periodic:
        if not isinstance(space, BoxRegion):
            raise OptionError("a periodic foam in a region that is not a box; need a box")
        points = repeated_around(points, box)
        sizes = None if sizes is None else np.tile(sizes, 27)
        box = np.stack([2 * box[0] - box[1], 2 * box[1] - box[0]])
    weights = None if sizes is None else (sizes / 2) ** 2
    struts = cell_edges(points / stretch, box / stretch, weights)
    return Struts(struts.nodes * stretch, struts.edges)


def foam_of(
    struts: Struts,
    seeds: Seeds,
    region: Region,
    radius: Radius,
    *,
    shortest: float | None,
    on_surface: Bools | None = None,
    whole: bool = False,
) -> Skeleton:
    """Return the struts as a skeleton, short ones shrunk to a node.

    Parameters
    ----------
    shortest : mm; by default a fraction of the mean spacing of the points
    on_surface : (n,) which nodes stay where they are
    whole : whether pieces that the surface cuts loose stay
    """
    least = least_length(shortest, SHORTEST_FRACTION * seeds.spacing)
    if on_surface is None:
        on_surface = np.zeros(len(struts.nodes), dtype=np.bool_)
    if len(struts.edges):
        struts = struts.collapsed(struts.lengths < least, on_surface)
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
            "%d of %s of the foam left out: they hang loose from the largest piece",
            len(keep) - int(keep.sum()),
            counted(len(keep), "strut"),
        )
    return struts.kept(keep)
