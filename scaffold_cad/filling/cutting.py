"""Any skeleton cut to any region, and its free ends put on a surface or another skeleton."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arguments import as_number, check_kind, checks_keywords, described
from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.base.placements import BoxLike, side_of
from scaffold_cad.base.regions import BoxRegion, ImplicitRegion, Keep
from scaffold_cad.errors import OptionError
from scaffold_cad.filling.fill import FillRegion, as_region
from scaffold_cad.mesh.nearest import NearestPlace
from scaffold_cad.mesh.remeshing import evened
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.surfaces import surface_of
from scaffold_cad.skeleton import Skeleton

if TYPE_CHECKING:
    from build123d import Plane

NEWTON_STEPS = 8
"""Steps toward the surface where a function is 0."""


@checks_keywords()
def cut(
    skeleton: Skeleton,
    region: FillRegion | Plane,
    *,
    keep: Keep = "clip",
    bounds: BoxLike | None = None,
    shortest: float | None = None,
) -> Skeleton:
    """Return the part of a skeleton in a region, its surface included; struts keep their radii.

    Parameters
    ----------
    skeleton : of any kind: a lattice, a foam, a drawing
    region : a box, a build123d solid, a closed triangle mesh or a function, see `fill`; or a Plane,
        of which the side counts that its z axis points to
    keep : "clip" cuts struts at the surface, "whole" keeps those whole that have their middle in
        the region
    bounds : lowest and highest corner of a box around the region; for a function only, by default
        that of the skeleton
    shortest : pieces of cut struts shorter than this are shrunk to a node on the surface, mm; by
        default 1/1000 of the mean length

    Raises
    ------
    OptionError
        If an argument is out of its range, or the region is not one of these.
    MeshError
        If the mesh is not closed.
    SkeletonError
        If nothing is left.

    Examples
    --------
    >>> from scaffold_cad import tile
    >>> lattice = tile("octet", 10.0, 3, radius=0.5)
    >>> cut(lattice, [[2, 2, 2], [28, 28, 12]]).nodes.max(axis=0).tolist()
    [28.0, 28.0, 12.0]
    """
    check_kind(skeleton, Skeleton)
    region = side_of(region)
    if callable(region) and bounds is None and surface_of(region) is None:
        return skeleton.cut(region, keep=keep, shortest=shortest)
    return skeleton.cut(as_region(region, bounds), keep=keep, shortest=shortest)


@checks_keywords()
def snapped(
    skeleton: Skeleton, target: FillRegion | Skeleton, reach: float, *, ends: bool = True
) -> Skeleton:
    """Return the skeleton with its free ends moved onto a surface, or onto another's nodes.

    Parameters
    ----------
    skeleton : whose ends move
    target : a box, a build123d solid, a mesh, or a function that is 0 on the surface; or a
        skeleton, of which the nearest nodes are taken: `snapped(a, b, reach) + b` then hang
        together
    reach : ends farther off than this stay where they are, mm
    ends : whether only extremities move; if not, all nodes within reach

    Raises
    ------
    OptionError
        If an argument is out of its range.

    Examples
    --------
    >>> from scaffold_cad import Skeleton
    >>> strut = Skeleton([[5, 5, 2], [5, 5, 9.5]], [[0, 1]], 1.0)
    >>> snapped(strut, [[0, 0, 0], [10, 10, 10]], 1.0).nodes[:, 2].tolist()
    [2.0, 10.0]
    """
    check_kind(skeleton, Skeleton)
    distance = as_number(reach, "reach")
    which = skeleton.extremities if ends else np.arange(len(skeleton.nodes))
    points = skeleton.nodes[which]
    if isinstance(target, Skeleton):
        places = target.nodes[cKDTree(target.nodes).query(points)[1]]
    else:
        places = _nearest(target, points, distance)
    near = np.linalg.norm(places - points, axis=1) <= distance
    nodes = skeleton.nodes.copy()
    nodes[which[near]] = places[near]
    return skeleton.moved(nodes).cleaned(weld_distance=0.0).skeleton


def _nearest(target: FillRegion, points: Points, reach: float) -> Points:
    """Return the place of a surface nearest to each of `points` (n, 3), (n, 3)."""
    surface = surface_of(target)
    if surface is not None:
        triangles = TriangleMesh(surface.vertices, surface.triangles)
        return NearestPlace(evened(triangles)).nearest(points)
    if callable(target):
        low, high = points.min(axis=0) - reach, points.max(axis=0) + reach
        return _on_zero(ImplicitRegion(target, [low, high]), points, reach)
    region = as_region(target)
    if not isinstance(region, BoxRegion):
        raise OptionError(f"the target is {described(target)}; need a surface or a skeleton")
    return _on_box(region.bounds, points)


def _on_box(bounds: Floats, points: Points) -> Points:
    """Return the place on a box nearest to each point (n, 3)."""
    low, high = bounds
    places = np.clip(points, low, high)
    gaps = np.concatenate([places - low, high - places], axis=1)  # (n, 6)
    side = gaps.argmin(axis=1)
    inside = np.flatnonzero((gaps > 0).all(axis=1))
    axis = side[inside] % 3
    places[inside, axis] = np.where(side[inside] < 3, low[axis], high[axis])
    return places


def _on_zero(region: ImplicitRegion, points: Points, reach: float) -> Points:
    """Return points moved along the gradient of a region's function to where it is 0."""
    step = 1e-5 * reach
    places = points.copy()
    for _ in range(NEWTON_STEPS):
        value = region.values(places)
        gradient = np.stack(
            [
                (region.values(places + step * axis) - region.values(places - step * axis))
                / (2 * step)
                for axis in np.eye(3)
            ],
            axis=1,
        )
        square = np.maximum((gradient**2).sum(axis=1), 1e-30)
        moves = -(value / square)[:, None] * gradient
        size = np.linalg.norm(moves, axis=1, keepdims=True)
        places += moves * np.minimum(1.0, reach / np.maximum(size, 1e-30))
    return places
