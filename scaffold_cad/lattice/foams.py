"""Random foams: struts along the edges of Voronoi cells, or of Delaunay tetrahedra."""

from __future__ import annotations

import logging
from itertools import combinations
from typing import get_args

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import Delaunay, cKDTree

from scaffold_cad.base.arguments import as_count, as_real
from scaffold_cad.base.arrays import Floats, Ints, Points
from scaffold_cad.base.radii import Radius
from scaffold_cad.base.topology import component_labels
from scaffold_cad.base.vectors import dot
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.lattice.clipping import Keep, clipped, least_length
from scaffold_cad.lattice.regions import BoxRegion, as_box
from scaffold_cad.lattice.struts import Struts
from scaffold_cad.skeleton import Skeleton

SHORTEST_FRACTION = 1e-3
"""Length below which struts are shrunk to a node, as a fraction of the points' mean spacing."""

LARGEST_REGULARITY = 0.7
"""Beyond it, random points find no room any more."""

MOST_POINTS = 10_000_000
"""Most random points: a foam of so many has some 1e8 struts, see `MOST_STRUTS`."""

_log = logging.getLogger(__name__)

KELVIN_SPACING = np.sqrt(3) / 2 * np.cbrt(2)
"""Distance of neighbours in a body-centred cubic lattice of one point a unit of volume."""


def voronoi_foam(
    count: int,
    box: ArrayLike,
    radius: Radius,
    seed: int = 0,
    *,
    regularity: float = 0.0,
    keep: Keep = "clip",
    dangling: bool = True,
    shortest: float | None = None,
) -> Skeleton:
    """Return the edges of the Voronoi cells of random points: an open-cell foam.

    Nodes inside have valency 4, but for those that short struts were shrunk to. The foam is in one
    piece: others, which the box cuts loose, are left out.

    Parameters
    ----------
    count : random points, one a cell
    box : lowest and highest corner of the box to fill, mm
    radius : mm; one number, or a function of positions (n, 3) that returns radii (n,)
    seed : of the random points; the same seed gives the same foam
    regularity : least distance of two points, as a fraction of that in a lattice of as many
        Kelvin cells, in 0..0.7: 0 is fully random, 0.7 gives cells of similar size
    keep : "clip" cuts struts at the faces of the box, "whole" drops those that leave it
    dangling : whether struts that end free stay
    shortest : struts shorter than this are shrunk to a node, mm; by default 1/1000 of the mean
        spacing of the points

    Raises
    ------
    OptionError
        If an argument is out of its range.
    SkeletonError
        If no strut is in the box.

    References
    ----------
    Zhu, Hobdell, Windle, Effects of cell irregularity on the elastic properties of open-cell
    foams, 2000: the regularity.
    """
    if keep not in get_args(Keep):
        raise OptionError(f"keep is {keep!r}; need one of {', '.join(get_args(Keep))}")
    region = BoxRegion(box)
    points = random_points(count, region.bounds, seed, regularity)
    struts = _voronoi_edges(points, region.bounds)
    if keep == "clip":
        struts = clipped(struts, region, 0.0)
    else:
        inside = region.contains(struts.nodes)[struts.edges]  # (m, 2)
        struts = struts.kept(inside[:, 0] & inside[:, 1])
    if not dangling:
        struts = struts.without_dangling()
    return _foam(struts, region, radius, _mean_spacing(region.bounds, count), shortest)


def delaunay_foam(
    count: int,
    box: ArrayLike,
    radius: Radius,
    seed: int = 0,
    *,
    regularity: float = 0.0,
    shortest: float | None = None,
) -> Skeleton:
    """Return the edges of the Delaunay tetrahedra of random points: a random truss.

    Tetrahedra count that have their circumcentre in the box: the others are flat ones at its
    faces. The truss is in one piece: others are left out.

    Parameters
    ----------
    count : random points
    box : lowest and highest corner of the box to fill, mm
    radius : mm; one number, or a function of positions (n, 3) that returns radii (n,)
    seed : of the random points; the same seed gives the same foam
    regularity, shortest : as for `voronoi_foam`

    Raises
    ------
    OptionError
        If an argument is out of its range.
    SkeletonError
        If no tetrahedron is in the box.
    """
    region = BoxRegion(box)
    points = random_points(count, region.bounds, seed, regularity)
    tetrahedra = np.zeros((0, 4), dtype=np.intp)
    if count >= 5:  # Qhull needs one more than a tetrahedron has
        tetrahedra = Delaunay(points).simplices.astype(np.intp)
    tetrahedra = tetrahedra[region.contains(_circumcenters(points[tetrahedra]))]
    sides = np.concatenate([tetrahedra[:, pair] for pair in combinations(range(4), 2)])
    edges = np.unique(np.sort(sides, axis=1), axis=0)
    spacing = _mean_spacing(region.bounds, count)
    return _foam(Struts(points, edges), region, radius, spacing, shortest)


def random_points(count: int, box: ArrayLike, seed: int, regularity: float = 0.0) -> Points:
    """Return random points in a box, none closer to another than their regularity asks.

    Parameters
    ----------
    count : points, ≥ 1
    box : lowest and highest corner, mm
    seed : of numpy's default generator
    regularity : as for `voronoi_foam`

    Returns
    -------
    (count, 3) float64, mm
    """
    bounds = as_box(box)
    count = as_count(count, "count", least=1)
    if count > MOST_POINTS:
        raise OptionError(f"count is {count}; need at most {MOST_POINTS}")
    if not 0 <= as_real(regularity, "regularity") <= LARGEST_REGULARITY:
        raise OptionError(f"regularity is {regularity:g}; need 0 to {LARGEST_REGULARITY:g}")
    random = np.random.default_rng(as_count(seed, "seed"))
    least = regularity * KELVIN_SPACING * _mean_spacing(bounds, count)
    points = np.zeros((0, 3))
    while len(points) < count:
        more = random.uniform(bounds[0], bounds[1], (count, 3))
        if len(points):
            more = more[cKDTree(points).query(more)[0] >= least]
        clashes = cKDTree(more).query_pairs(least, output_type="ndarray")
        points = np.concatenate([points, np.delete(more, clashes[:, 1], axis=0)])[:count]
    return points


def _foam(
    struts: Struts, region: BoxRegion, radius: Radius, spacing: float, shortest: float | None
) -> Skeleton:
    """Return the struts as a skeleton, short ones shrunk to a node; nodes on the box stay on it."""
    if len(struts.edges):
        short = struts.lengths < least_length(shortest, SHORTEST_FRACTION * spacing)
        struts = struts.collapsed(short, region.on_face(struts.nodes))
    if len(struts.edges) == 0:
        low, high = region.bounds.tolist()
        raise SkeletonError(
            f"the foam has no strut in the box from {low} to {high} mm; need more points"
        )
    return _largest_piece(struts).cleaned_skeleton(radius)


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


def _voronoi_edges(points: Points, box: Floats) -> Struts:
    """Return the edges of the Voronoi cells of `points`, all those that meet the box among them.

    An edge joins the circumcentres of two tetrahedra with a common face. Four more points, too
    far away to be the nearest one of any place in the box, close the cells that would be open.
    """
    corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    far = box.mean(axis=0) + 10 * np.linalg.norm(box[1] - box[0]) * corners
    everything = np.concatenate([points, far])
    triangulation = Delaunay(everything)
    neighbors: Ints = triangulation.neighbors.astype(np.intp)
    one, side = np.nonzero(neighbors > np.arange(len(neighbors))[:, None])
    edges = np.stack([one, neighbors[one, side]], axis=1)
    return Struts(_circumcenters(everything[triangulation.simplices]), edges)


def _circumcenters(corners: Floats) -> Points:
    """Return the centres of the spheres through the corners of tetrahedra (t, 4, 3), (t, 3)."""
    u, v, w = (corners[:, k] - corners[:, 0] for k in range(1, 4))
    toward = (
        dot(u, u)[:, None] * np.cross(v, w)
        + dot(v, v)[:, None] * np.cross(w, u)
        + dot(w, w)[:, None] * np.cross(u, v)
    )
    centers: Points = corners[:, 0] + toward / (2 * dot(u, np.cross(v, w)))[:, None]
    return centers


def _mean_spacing(box: Floats, count: int) -> float:
    """Return the side of a cube as large as the part of the box that a point has, mm."""
    return float(np.cbrt((box[1] - box[0]).prod() / count))
