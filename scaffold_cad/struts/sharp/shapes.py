"""The faces of a star: vertices where its curves' pieces meet, edges, and the loops around faces.

Each strut's face and each part of the ball is on one side of the pieces around it. A vertex joins,
of each face there, one edge that ends to one that begins: following these gives loops. One loop of
each strut runs around its axis, the end of its face at the node; all others are holes through
which thinner struts leave. Where this does not hold, or an edge is too short, the star is not
proved: something touches, or a piece was too short to be found.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points
from scaffold_cad.base.blocks import blocks
from scaffold_cad.base.topology import component_labels
from scaffold_cad.base.vectors import normalize, sums_by_row
from scaffold_cad.struts.sharp.ballfaces import apart
from scaffold_cad.struts.sharp.curves import Kind, StarCurves, curves_of
from scaffold_cad.struts.sharp.loops import Loop, clearance, loops_of, ordered
from scaffold_cad.struts.sharp.outlines import SAMPLES, Outlines, outlines_of
from scaffold_cad.struts.sharp.stars import SharpStars

ONE_PLACE = 1e-7
"""Distance below which ends of pieces are one vertex, in radii of the ball."""

TINY = 5e-6
"""Length of edges that are left out, their ends taken for one vertex, in radii of the ball: what
rounded coordinates make of corners in which more than three faces meet."""

CLEAR, BESIDE = 1.06, 0.04
"""How far collars stand from their node: a multiple of the distance of the edges, plus radii.
Polygons of 8 sides are 5 % larger than their circles."""

ALONG = 33
"""Points of each edge at which loops are followed; an odd number."""

LEAST_CLEAR = 1e-3
"""Least angle between a seam and a vertex, rad."""


@dataclass(frozen=True, eq=False)
class SharpShape(Frozen):
    """The union at one star, relative to its node, in radii of the ball."""

    curves: StarCurves
    """Of this star alone."""
    outlines: Outlines
    """The edges."""
    vertices: Points
    """Shape (v, 3)."""
    slack: Floats
    """How far from each vertex edges end there, shape (v,)."""
    ends: Ints
    """First and last vertex of each edge, shape (e, 2)."""
    sides: Ints
    """Face to the left and to the right of each edge, seen from outside, shape (e, 2): strut i as
    i, piece k of the ball as N + k."""
    loops: tuple[Loop, ...]
    """Each loop's face and its edges with whether it runs along them, counter-clockwise; the loop
    around each strut's axis comes first, in the order of the struts."""
    islands: tuple[Loop, ...]
    """Loops around pieces of struts that are apart from the rest of their strut."""
    heights: Floats
    """How far up each strut its edges reach at most, shape (N,)."""

    clear: Floats
    """How far from all vertices on each strut's edges the generators in the middles of equal parts
    of a turn are, shape (N, SEAMS), rad; 0 for those that meet these edges more than once."""

    @property
    def valency(self) -> int:
        """How many struts there are."""
        return int(self.curves.stars.radii.shape[1])

    @property
    def collars(self) -> Floats:
        """How far up each strut is alone, and has its ring, (N,)."""
        beside: Floats = BESIDE * self.curves.stars.radii[0]
        return CLEAR * np.maximum(self.heights, 0.0) + beside


def shapes_of(stars: SharpStars) -> list[SharpShape | None]:
    """Return the union at each star, None where it is not proved."""
    valency = stars.radii.shape[1]
    row = 8 * SAMPLES * valency**2 * (valency + 8)
    return [shape for part in blocks(len(stars), row) for shape in _shapes(stars[part])]


def _shapes(stars: SharpStars) -> Iterator[SharpShape | None]:
    curves = curves_of(stars)
    outlines = outlines_of(curves)
    angles = outlines.angles(ALONG)
    number = np.repeat(outlines.curve, ALONG)
    points = curves.points(number, angles.reshape(-1))[0].reshape(-1, ALONG, 3)
    sides = _sides(curves, outlines, points)
    node = curves.node[outlines.curve]
    for star in range(len(stars)):
        rows = np.flatnonzero(node == star)
        yield _shape(_alone(curves, star), outlines.chosen(rows), points[rows], sides[rows], curves)


def _vertices(points: Points, tiny: Bools) -> Ints:
    """Return the vertex at both ends of edges, (e, 2), where those of tiny ones are one."""
    places = points[:, [0, -1]].reshape(-1, 3)
    near = np.argwhere(np.linalg.norm(places[:, None] - places, axis=2) < ONE_PLACE)
    rows = np.flatnonzero(tiny)
    pairs = np.concatenate([near, np.stack([2 * rows, 2 * rows + 1], axis=1)])
    return component_labels(pairs, len(places)).reshape(-1, 2)


def _alone(curves: StarCurves, star: int) -> tuple[StarCurves, Ints]:
    """Return the curves of a star, and the new number of each curve or -1."""
    keep = np.flatnonzero(curves.node == star)
    number = np.full(len(curves.node), -1)
    number[keep] = np.arange(len(keep))
    rows = np.array([star])
    alone = StarCurves(
        curves.stars[rows],
        np.zeros(len(keep), dtype=np.intp),
        curves.kind[keep],
        curves.one[keep],
        curves.other[keep],
        curves.center[keep],
        curves.radius[keep],
        curves.x[keep],
        curves.y[keep],
        curves.frames[rows],
    )
    return alone, number


def _sides(curves: StarCurves, outlines: Outlines, points: Points) -> Ints:
    """Return the faces to the left and to the right of pieces, (e, 2).

    Parameters
    ----------
    points : (e, ALONG, 3) of the pieces
    """
    stars, curve = curves.stars, outlines.curve
    node, kind, one, other = (
        each[curve] for each in (curves.node, curves.kind, curves.one, curves.other)
    )
    half = ALONG // 2
    middle, ahead = points[:, half], points[:, half + 1] - points[:, half - 1]
    normal = stars.normals(node, one, middle)
    on_seam = kind == Kind.SEAM
    normal[on_seam] = middle[on_seam]
    left = normalize(np.cross(normal, ahead))
    facing = stars.directions[node, one]
    # Beyond the edge on its generators is the face of `one`: whether it is to the left.
    own = np.einsum("ex,ex->e", left, facing) > 0
    valency = stars.radii.shape[1]
    far = np.where(other >= 0, other, valency)
    found = np.where(own[:, None], np.stack([one, far], 1), np.stack([far, one], 1))
    found[on_seam] = valency
    return np.asarray(found, dtype=np.intp)


def _shape(
    alone: tuple[StarCurves, Ints],
    outlines: Outlines,
    points: Points,
    sides: Ints,
    curves: StarCurves,
) -> SharpShape | None:
    """Return the union at one star; `points` (e, ALONG, 3) are on its edges."""
    own, number = alone
    outlines = replace(outlines, curve=number[outlines.curve])
    valency = curves.stars.radii.shape[1]
    sizes = np.linalg.norm(np.diff(points, axis=1), axis=2).sum(axis=1)
    number_of = _vertices(points, sizes < TINY)
    kept = np.flatnonzero(sizes >= TINY)
    if len(kept) == 0:
        return None
    outlines, points, sides = outlines.chosen(kept), points[kept], sides[kept]
    _, vertex = np.unique(number_of[kept], return_inverse=True)
    ends = vertex.reshape(-1, 2)
    places = sums_by_row(points[:, [0, -1]], ends, int(ends.max()) + 1)
    places /= np.bincount(ends.reshape(-1))[:, None]
    slack = np.zeros(len(places))
    np.maximum.at(slack, ends, np.linalg.norm(points[:, [0, -1]] - places[ends], axis=2))
    found = loops_of(ends, sides)
    if found is None:
        return None
    known_loops = ordered(own, found, points, valency)
    if known_loops is None:
        return None
    seam = own.kind[outlines.curve] == Kind.SEAM
    loops, sides = apart(known_loops.loops, sides, own.frames[0], points, seam, valency)
    along = np.einsum("nx,epx->epn", own.stars.directions[0], points)
    touches = (sides[:, :, None] == np.arange(valency)).any(axis=1)  # (e, N)
    heights = np.where(touches[:, None], along, -np.inf).max(axis=(0, 1))
    clear = np.stack([clearance(own, points, sides, strut) for strut in range(valency)])
    if (clear.max(axis=1) < LEAST_CLEAR).any():
        return None
    return SharpShape(
        own,
        outlines,
        places,
        slack,
        ends,
        sides,
        loops,
        known_loops.islands,
        heights,
        clear,
    )
