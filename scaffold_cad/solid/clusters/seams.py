"""Seams: the field's mesh cut off across each strut, and joined to the ring of the strut beyond.

A field's strut goes on past its cut. Its mesh is cut by a plane between vertices, and a zip of
triangles leads from the loop there to the ring. Seen from the axis all triangles of the zip and
those that are cut face outward, in 32-bit coordinates: between the loop, which goes once around the
axis, and the ring they cover each place once, so that nothing crosses. A sliver of the mesh that a
plane cuts may face inward; then a seam at another plane holds, or one where slivers are drawn
together, which an exact test looks at.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Edges, Floats, Frozen, Ints, Points, Triangles
from scaffold_cad.base.positions import in_single_precision
from scaffold_cad.base.topology import sides_of
from scaffold_cad.base.vectors import dot, length
from scaffold_cad.mesh.collapse import without_short_edges
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.trianglemesh import TriangleMesh, compacted
from scaffold_cad.solid.clusters.remainder import Cuts
from scaffold_cad.solid.clusters.spans import WINDOW, free_length

TUBE = 1.2
"""Where the vertices of a strut's own tail are looked for, in its radii about its axis."""

BESIDE = 0.3
"""How far beside the window vertices are kept away from, in the strut's radii."""

PLANES = 16
"""Most planes of each cut, those farthest from vertices first, of which the first that holds is
taken; about one in 600 does not."""

SLIVER = 0.15
"""Edges that are drawn together where no plane holds: shorter than this part of the others."""

MARGIN = 1e-3
"""Least sine at which triangles of a seam are seen from the axis."""


@dataclass(frozen=True, eq=False)
class Seamed(Frozen):
    """A field's mesh, cut off and joined to rings."""

    vertices: Points
    """Vertices beside those of the rings: those of the field, then those at cuts, (v', 3), mm."""
    triangles: Triangles
    """Triangles; vertices are counted from those of the rings on, shape (t, 3)."""
    failed: Ints
    """Cuts that cannot be joined at any plane, ascending: then the triangles are of no use."""


@dataclass(frozen=True, eq=False)
class _Frames:
    """Coordinates about the axes of cuts, whose first points at the start of the ring."""

    cuts: Cuts
    x: Points
    y: Points

    def along(self, points: Points, cut: Ints) -> Floats:
        """Return how far points (p, 3) are past the end of the spans of their cuts, mm, (p,)."""
        return dot(points - self.cuts.base[cut], self.cuts.outward[cut])

    def angles(self, points: Points, cut: Ints) -> Floats:
        """Return the angles of points about the axes of their cuts, in [0, 2π), (p,)."""
        way = points - self.cuts.base[cut]
        return np.asarray(np.mod(np.arctan2(dot(way, self.y[cut]), dot(way, self.x[cut])), TURN))

    def seen(self, corners: Points, cut: Ints) -> Bools:
        """Return whether triangles (t, 3, 3) face away from the axes of their cuts, (t,)."""
        a, b, c = np.moveaxis(corners, 1, 0)
        normal = np.cross(b - a, c - a)
        axis = self.cuts.outward[cut]
        facing = np.ones(len(corners), dtype=np.bool_)
        for corner in (a, b, c):
            way = corner - self.cuts.base[cut]
            way = way - dot(way, axis)[:, None] * axis
            facing &= dot(normal, way) > MARGIN * length(normal) * length(way)
        return facing


TURN = 2.0 * np.pi


def seamed(
    field: TriangleMesh,
    cuts: Cuts,
    points: Points,
    rings: Ints,
    starts: Points,
    factor: float = 1.0,
    far: Floats | None = None,
) -> Seamed:
    """Return the mesh of a field, cut off and joined to rings.

    Parameters
    ----------
    field : whose vertices are 32-bit numbers, times `factor`
    points : (v, 3) vertices of the rings and of all that is not in the field, mm
    rings : (c, s) vertices of the ring beyond each cut, counter-clockwise about `cuts.outward`
    starts : (c, 3) unit vectors from the axis to the first point of each ring
    factor : what lengths are multiplied with in a file, in whose numbers triangles are looked at
    far : (c,) how far past their bases the struts of the field may reach, mm; by default as those
        of clusters do, which end in balls
    """
    if far is None:
        far = free_length(cuts.radius, cuts.slope)
    frames = _Frames(cuts, starts, np.cross(cuts.outward, starts))
    tails = _tails(field.vertices, len(points), cuts, far)
    made = _cut_off(field, tails, frames, points, rings, factor)
    if len(made.failed) == 0:
        return made
    drawn = _without_slivers(field, tails, len(points), cuts, made.failed)
    again = _cut_off(drawn, tails, frames, points, rings, factor)
    failed = np.union1d(again.failed, _crossed(again, points, cuts, far, made.failed, factor))
    return replace(again, failed=failed)


def _cut_off(
    field: TriangleMesh,
    tails: _Tails,
    frames: _Frames,
    points: Points,
    rings: Ints,
    factor: float,
) -> Seamed:
    """Return the mesh of a field joined to rings, see `seamed`."""
    vertices = np.concatenate([points, field.vertices])
    triangles = field.triangles + len(points)
    beyond = np.full(len(vertices), -1, dtype=np.intp)
    close, left, parts = triangles, np.ones(len(rings), dtype=np.bool_), []
    for plane in _planes(tails, frames):
        near = np.zeros(len(vertices), dtype=np.bool_)
        near[tails.vertex[left[tails.cut]]] = True
        close = close[near[close].any(axis=1)]
        bad = ~left | np.isnan(plane)
        _mark(beyond, tails, plane, bad)
        clipped = _clipped(TriangleMesh(vertices, close), beyond, plane, frames, bad, factor)
        order = _around(clipped, frames, bad)
        zips, cut = _zips(clipped, order, frames, rings, len(vertices))
        vertices = np.concatenate([vertices, clipped.vertices])
        made, of = np.concatenate([clipped.triangles, zips]), np.append(clipped.owner, cut)
        written = in_single_precision(vertices[made], factor) / factor
        bad[of[~frames.seen(written, of)]] = True
        parts.append(made[~bad[of]])
        left &= bad
        beyond[np.isin(beyond, np.flatnonzero(left))] = -1
        if not left.any():
            break
    kept = triangles[(beyond[triangles] < 0).all(axis=1)]
    made = np.concatenate([kept, *parts])
    return Seamed(vertices[len(points) :], made, np.flatnonzero(left))


@dataclass(frozen=True, eq=False)
class _Tails(Frozen):
    """The vertices of what fields have past the ends of spans, and just before."""

    vertex: Ints
    """Counted from those of the rings on, shape (p,)."""
    cut: Ints
    """Whose strut it is, shape (p,)."""
    along: Floats
    """How far past the end of the span, shape (p,), mm."""


def _tails(vertices: Points, count: int, cuts: Cuts, far: Floats) -> _Tails:
    """Return the vertices near the axes of cuts; `count` others come before them."""
    middle = cuts.base + 0.5 * far[:, None] * cuts.outward
    reach = np.hypot(0.5 * far + BESIDE * cuts.radius, 1.5 * TUBE * cuts.radius)
    found = cKDTree(vertices).query_ball_point(middle, reach)
    cut = np.repeat(np.arange(len(found)), [len(each) for each in found])
    vertex = np.concatenate([np.zeros(0), *found]).astype(np.intp)
    way = vertices[vertex] - cuts.base[cut]
    along = dot(way, cuts.outward[cut])
    away = length(way - along[:, None] * cuts.outward[cut])
    own = (along > -BESIDE * cuts.radius[cut]) & (along < far[cut])
    own &= away < TUBE * (cuts.radius + np.abs(cuts.slope) * far)[cut]
    return _Tails(vertex[own] + count, cut[own], along[own])


def _without_slivers(
    field: TriangleMesh, tails: _Tails, count: int, cuts: Cuts, failed: Ints
) -> TriangleMesh:
    """Return a field's mesh with short edges drawn together in the tails of some cuts (f,).

    Its vertices, which `count` others come before in the tails, stay.
    """
    some = cuts.chosen(failed)
    near = np.zeros(len(field.vertices), dtype=np.bool_)
    near[tails.vertex[np.isin(tails.cut, failed)] - count] = True
    bases = cKDTree(some.base)
    ends = sides_of(field.triangles[near[field.triangles].all(axis=1)])
    if len(ends) == 0:
        return field
    spans = length(field.vertices[ends[:, 1]] - field.vertices[ends[:, 0]])
    usual = np.median(spans / some.radius[bases.query(field.vertices[ends[:, 0]])[1]])

    def shortest(places: Points) -> Floats:
        return np.asarray(SLIVER * usual * some.radius[bases.query(places)[1]])

    return without_short_edges(
        field, shortest, near=near, order=lambda _, edges: edges, keep_vertices=True
    )


def _crossed(
    made: Seamed, points: Points, cuts: Cuts, far: Floats, drawn: Ints, factor: float
) -> Ints:
    """Return which of the cuts `drawn` (f,) have triangles near them that cross as written."""
    some = cuts.chosen(drawn)
    tails = _tails(made.vertices, len(points), some, far[drawn])
    vertices = in_single_precision(np.concatenate([points, made.vertices]), factor) / factor
    near = np.zeros(len(vertices), dtype=np.bool_)
    near[tails.vertex] = True
    mesh = compacted(vertices, made.triangles[near[made.triangles].any(axis=1)])
    crossing = np.unique(self_intersections(mesh))
    middles = mesh.vertices[mesh.triangles[crossing]].mean(axis=1)
    return np.unique(drawn[cKDTree(some.base).query(middles)[1]])


def _planes(tails: _Tails, frames: _Frames) -> Floats:
    """Return the places of planes, those farthest from vertices first, NaN for none, (k, c)."""
    order = np.lexsort((tails.along, tails.cut))
    cut, along = tails.cut[order], tails.along[order]
    middle, gap = (along[1:] + along[:-1]) / 2, along[1:] - along[:-1]
    window = WINDOW * frames.cuts.radius[cut[1:]]
    fits = (cut[1:] == cut[:-1]) & (middle > 0) & (middle < window)
    order = np.flatnonzero(fits)[np.lexsort((-gap[fits], cut[1:][fits]))]
    cut, middle = cut[1:][order], middle[order]
    rank = np.arange(len(cut)) - np.searchsorted(cut, cut)
    planes = np.full((PLANES, len(frames.cuts.node)), np.nan)
    few = rank < PLANES
    planes[rank[few], cut[few]] = middle[few]
    return planes


def _mark(beyond: Ints, tails: _Tails, plane: Floats, bad: Bools) -> None:
    """Set the cut that vertices are beyond; without those of cuts that are bad already."""
    past = ~bad[tails.cut] & (tails.along > np.where(bad, 0.0, plane)[tails.cut])
    vertex, cut = tails.vertex[past], tails.cut[past]
    free = beyond[vertex] < 0
    beyond[vertex[free]] = cut[free]
    bad[cut[beyond[vertex] != cut]] = True  # in the tails of two struts


@dataclass(frozen=True, eq=False)
class _Clipped:
    """What is left of the triangles that planes cut, and the loops of their new sides."""

    vertices: Points
    """Where planes cut edges, shape (w, 3), mm, 32-bit numbers in the file's unit."""
    cut: Ints
    """Cut of each of these, shape (w,)."""
    sides: Edges
    """Sides on planes, from one of these to another, shape (l, 2)."""
    triangles: Triangles
    """The triangles; vertices on planes come last, shape (t, 3)."""
    owner: Ints
    """Cut of each triangle, shape (t,)."""


def _clipped(
    field: TriangleMesh,
    beyond: Ints,
    plane: Floats,
    frames: _Frames,
    bad: Bools,
    factor: float,
) -> _Clipped:
    marks = beyond[field.triangles]  # (t, 3)
    out, most = marks >= 0, marks.max(axis=1)
    for corner in marks.T:  # a triangle with corners beyond two cuts
        other = (corner >= 0) & (corner != most)
        bad[most[other]] = bad[corner[other]] = True
    mixed = out.any(axis=1) & ~out.all(axis=1) & ~bad[most]
    triangles, out, cut = field.triangles[mixed], out[mixed], most[mixed]
    one = out.sum(axis=1) == 1
    # Turned so that the corner that is alone on its side comes first.
    alone = np.where(one, out.argmax(axis=1), (~out).argmax(axis=1))
    a, b, c = (
        np.take_along_axis(triangles, ((alone + k) % 3)[:, None], axis=1)[:, 0] for k in range(3)
    )
    low = np.where(one[:, None], np.stack([b, c], axis=1), np.stack([a, a], axis=1))
    high = np.where(one[:, None], np.stack([a, a], axis=1), np.stack([b, c], axis=1))
    keys = low * len(field.vertices) + high  # (l, 2)
    _, first, number = np.unique(keys, return_index=True, return_inverse=True)
    new = number.reshape(-1, 2)  # on the edges a b and a c
    start, end = low.reshape(-1)[first], high.reshape(-1)[first]
    own = np.repeat(cut, 2)[first]
    p, q = field.vertices[start], field.vertices[end]
    at_p, at_q = frames.along(p, own), frames.along(q, own)
    share = (plane[own] - at_p) / np.where(at_q == at_p, 1.0, at_q - at_p)
    bad[own[~((share > 0) & (share < 1))]] = True
    placed = in_single_precision(p + share[:, None] * (q - p), factor) / factor
    ab, ac = (new + len(field.vertices)).T
    tips = np.stack([a, ab, ac], axis=1)[~one]
    both = [np.stack([b, c, ac], axis=1)[one], np.stack([b, ac, ab], axis=1)[one]]
    sides = np.where(one[:, None], new[:, ::-1], new)
    return _Clipped(
        placed,
        own,
        sides,
        np.concatenate([tips, *both]),
        np.concatenate([cut[~one], cut[one], cut[one]]),
    )


def _around(clipped: _Clipped, frames: _Frames, bad: Bools) -> Ints:
    """Return the vertices on planes cut by cut and by angle; loops must follow the same order."""
    angle = frames.angles(clipped.vertices, clipped.cut)
    order = np.lexsort((angle, clipped.cut))
    cut = clipped.cut[order]
    count = np.bincount(cut, minlength=len(bad))
    first = np.cumsum(count) - count
    place = np.empty(len(order), dtype=np.intp)
    place[order] = np.arange(len(order))
    start, end = place[clipped.sides].T  # sides of what is cut run down around the axis
    of = cut[start]
    following = first[of] + (end - first[of] + 1) % np.maximum(count[of], 1)
    bad[of[following != start]] = True
    bad[np.bincount(of, minlength=len(bad)) != count] = True
    bad[count < 3] = True
    return order


def _zips(
    clipped: _Clipped, order: Ints, frames: _Frames, rings: Ints, first_new: int
) -> tuple[Triangles, Ints]:
    """Return the triangles between loops and rings, and their cuts.

    A side of the one is joined to that point of the other whose own two sides have their middles
    before and behind its middle.
    """
    number, sides = rings.shape
    loop, cut = order + first_new, clipped.cut[order]
    count = np.bincount(cut, minlength=number)
    first = np.cumsum(count) - count
    angle = frames.angles(clipped.vertices[order], cut)
    place = np.arange(len(order))
    following = first[cut] + (place - first[cut] + 1) % np.maximum(count[cut], 1)
    step = np.mod(angle[following] - angle, TURN)
    middle = angle + 0.5 * step  # may be past a whole turn for the last one
    ring_middle = TURN / sides * (np.arange(sides) + 0.5)
    # Points of rings for the sides of loops.
    wrapped = np.mod(middle, TURN)
    apex = np.searchsorted(ring_middle, wrapped, side="left") % sides
    lower = np.stack([loop, loop[following], rings[cut, apex]], axis=1)
    # Points of loops for the sides of rings: as many middles of loops are before.
    line = cut * (2 * TURN) + wrapped
    by_middle = np.argsort(line, kind="stable")
    asked = (np.arange(number)[:, None] * (2 * TURN) + ring_middle).reshape(-1)
    before = np.searchsorted(line[by_middle], asked, side="right")
    owner = np.repeat(np.arange(number), sides)
    # The point behind a loop's last middle before is the one where that side ends.
    last = first[owner] + (before - 1 - first[owner]) % np.maximum(count[owner], 1)
    last = np.minimum(last, max(len(order) - 1, 0))
    tip = loop[following[by_middle[last]]] if len(order) else np.zeros(len(owner), dtype=np.intp)
    k = np.tile(np.arange(sides), number)
    upper = np.stack([rings[owner, (k + 1) % sides], rings[owner, k], tip], axis=1)
    return np.concatenate([lower, upper]), np.concatenate([cut, owner])
