"""Sharp edges of flat ends: corners of the mesh on them, where cells had cut them off.

A side of a triangle from the plane of a flat end to what is beside that plane crosses a crease: the
end's rim, the rim of ends in one plane with the fillets between them, or the foot of a strut that
stands on the end. The crease is looked for in the plane, by the sign of F just beside it. Sides are
split there, or an end of theirs moves to the crease where it is near, so that no triangle is on
both sides of one. What would cross other triangles stays as it was.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Edges, Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.positions import in_single_precision
from scaffold_cad.base.topology import sides_of
from scaffold_cad.base.vectors import any_perpendicular, dot, length, normalize
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.intersections.faces import boxes_of
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.field.cells import packed, unpacked
from scaffold_cad.solid.field.grid import AROUND, Grid
from scaffold_cad.solid.field.union import FilletedUnion, values

FLUSH = 0.004
"""How far a vertex may be off the plane of a flat end that it is on, in the end's radius."""

ASIDE = 2.0 * FLUSH
"""How far beside planes F is looked at, in that radius."""

PAST = 1.5
"""How far creases are looked for, in the lengths of sides of triangles seen across the plane."""

HALVINGS = 12
"""Times that a stretch with a crease is halved."""

SNAP = 0.5
"""A vertex moves to a crease that is nearer than this, in the length of its side across it."""

NO_AREA = 1e-6
"""Least area of a triangle, as a part of its square size."""


@dataclass(frozen=True, eq=False)
class _Planes(Frozen):
    """Planes of flat ends."""

    tip: Points
    """Middles of the ends, shape (e, 3), mm from the union's origin."""
    outward: UnitVectors
    """Shape (e, 3)."""
    radius: Floats
    """At the end, shape (e,), mm."""
    reach: Floats
    """How far about the middle the end and its fillets are, shape (e,), mm."""

    def beyond(self, points: Points, plane: Ints) -> Floats:
        """Return how far points (k, 3) are beyond planes (k,), mm."""
        return dot(points - self.tip[plane], self.outward[plane])


@dataclass(frozen=True, eq=False)
class _Crossings(Frozen):
    """Sides of triangles that cross creases, and where."""

    sides: Edges
    """Vertices of each, shape (s, 2)."""
    places: Points
    """On the crease, shape (s, 3), mm, 32-bit numbers."""


def with_creases(
    union: FilletedUnion, grid: Grid, mesh: TriangleMesh, owners: Ints
) -> TriangleMesh:
    """Return the zero set of F with sharp edges at flat ends.

    Parameters
    ----------
    mesh : the zero set, free of crossings; all coordinates are 32-bit numbers, mm
    owners : (v,) group at each vertex
    """
    planes = _planes(union)
    if len(planes.tip) == 0:
        return mesh
    found = _crossings(union, grid, mesh, owners, planes)
    kept = np.arange(len(found.sides))
    made, side = _with(mesh, found.sides, found.places)
    moved = np.flatnonzero((made.vertices[: len(mesh.vertices)] != mesh.vertices).any(axis=1))
    around = np.append(moved, np.arange(len(mesh.vertices), len(made.vertices)))
    while len(kept):
        bad = _faulty(made, around)
        if not bad.any():
            return made
        # Vertices that moved belong to all sides that end there, new ones to those that they split.
        drop: Bools = np.asarray(bad[found.sides[kept]].any(axis=1))
        drop[side] |= bad[len(mesh.vertices) :]
        # That changes triangles around the ends of these sides only.
        around, kept = found.sides[kept[drop]], kept[~drop]
        made, side = _with(mesh, found.sides[kept], found.places[kept])
    return mesh


def _planes(union: FilletedUnion) -> _Planes:
    """Return the planes of all flat ends."""
    end, strut = np.nonzero(np.isfinite(union.caps))
    start, axis, extent = union.rows[:3].T[strut], union.rows[3:6].T[strut], union.section[2, strut]
    radius = union.section[0, strut] + union.section[1, strut] * extent * end
    tip = start + (extent * end)[:, None] * axis
    reach = radius + union.blend[strut]
    return _Planes(tip, np.where(end == 0, -1.0, 1.0)[:, None] * axis, radius, reach)


def _crossings(
    union: FilletedUnion, grid: Grid, mesh: TriangleMesh, owners: Ints, planes: _Planes
) -> _Crossings:
    """Return the sides from planes of ends to what is beside them, and the creases there."""
    vertices = mesh.vertices - union.origin
    of = _plane_of(vertices, planes)
    triangles = mesh.triangles[(of[mesh.triangles] >= 0).any(axis=1)]
    ends = sides_of(triangles)
    ends = np.concatenate([ends, ends[:, ::-1]])
    ends = ends[of[ends[:, 0]] >= 0]
    plane = of[ends[:, 0]]
    off = planes.beyond(vertices[ends[:, 1]], plane)
    beside = np.abs(off) > FLUSH * planes.radius[plane]
    ends, plane, off = ends[beside], plane[beside], off[beside]
    # One that goes from plane to plane is looked at once.
    keys = ends.min(axis=1) * len(vertices) + ends.max(axis=1)
    first = np.unique(keys, return_index=True)[1]
    ends, plane, off = ends[first], plane[first], off[first]
    lines = _Lines(union, grid, planes, plane, np.sign(off), owners[ends[:, 0]])
    start, end = (lines.flattened(vertices[column]) for column in ends.T)
    foot, good = lines.crease(start, PAST * (end - start))
    across = lines.normals(foot, normalize(end - start))
    inward = dot(foot - start, across)
    good &= inward > 0
    lines, ends, start, foot = lines.chosen(good), ends[good], start[good], foot[good]
    across, inward, off = across[good], inward[good], off[good]
    # Seen along the crease a side is cut where it is nearest to it: not all at the same place.
    share = inward / (inward + np.abs(off))
    middle = start + share[:, None] * (foot - start)
    places, good = lines.crease(middle, 2.0 * inward[:, None] * across)
    return _Crossings(ends[good], in_single_precision(places[good] + union.origin))


@dataclass(frozen=True, eq=False)
class _Lines:
    """Lines in planes of flat ends, and where they cross creases."""

    union: FilletedUnion
    grid: Grid
    planes: _Planes
    plane: Ints
    """Shape (s,)."""
    side: Floats
    """-1 where the crease is convex, 1 where it is concave, shape (s,)."""
    group: Ints
    """A group near each, shape (s,)."""

    def chosen(self, keep: Bools) -> _Lines:
        """Return some of them."""
        parts = self.plane[keep], self.side[keep], self.group[keep]
        return _Lines(self.union, self.grid, self.planes, *parts)

    def flattened(self, points: Points) -> Points:
        """Return points moved into the planes, (s, 3)."""
        off = self.planes.beyond(points, self.plane)
        return points - off[:, None] * self.planes.outward[self.plane]

    def values(self, points: Points, aside: Floats) -> Floats:
        """Return F at points that are so far beyond the planes, in `ASIDE`, (s,)."""
        step = (aside * ASIDE * self.planes.radius[self.plane])[:, None]
        points = points + step * self.planes.outward[self.plane]
        at = self.grid.groups_at(points)
        return values(self.union, points, np.where(at >= 0, at, self.group), self.grid.lists)

    def within(self, points: Points) -> Bools:
        """Return where the end's own plane is the surface, before the crease, (s,)."""
        return np.asarray((self.values(points, self.side) < 0) == (self.side < 0))

    def crease(self, start: Points, way: Floats) -> tuple[Points, Bools]:
        """Return where lines (s, 3) cross creases first seen by halving, and whether they do."""
        low, high = np.zeros(len(start)), np.ones(len(start))
        good = self.within(start) & ~self.within(start + way)
        good &= (self.values(start, -self.side) < 0) == (self.side > 0)
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            before = self.within(start + middle[:, None] * way)
            low, high = np.where(before, middle, low), np.where(before, high, middle)
        return start + ((low + high) / 2)[:, None] * way, good

    def normals(self, points: Points, way: UnitVectors) -> UnitVectors:
        """Return the directions across creases, away from the ends, (s, 3)."""
        size = ASIDE * self.planes.radius[self.plane]
        height = self.planes.outward[self.plane]
        aside = points + 2.0 * size[:, None] * way
        u = any_perpendicular(height)
        found = np.zeros_like(points)
        for axis in (u, np.cross(height, u)):
            step = size[:, None] * axis
            rise = self.values(aside + step, self.side) - self.values(aside - step, self.side)
            found += rise[:, None] * axis
        return normalize(
            np.where(found.any(axis=1, keepdims=True), -self.side[:, None] * found, way)
        )


def _plane_of(vertices: Points, planes: _Planes) -> Ints:
    """Return the plane of a flat end that each vertex is on, or -1, (v,)."""
    found = cKDTree(vertices).query_ball_point(planes.tip, planes.reach)
    plane = np.repeat(np.arange(len(found)), [len(each) for each in found])
    vertex = np.concatenate([np.zeros(0), *found]).astype(np.intp)
    off = np.abs(planes.beyond(vertices[vertex], plane)) / planes.radius[plane]
    near = off < FLUSH
    vertex, plane, off = vertex[near], plane[near], off[near]
    order = np.argsort(-off, kind="stable")
    result = np.full(len(vertices), -1)
    result[vertex[order]] = plane[order]  # the nearest one comes last
    return result


def _with(mesh: TriangleMesh, sides: Edges, places: Points) -> tuple[TriangleMesh, Ints]:
    """Return a mesh whose sides go by some places, and the side that each new vertex splits.

    New vertices come last.
    """
    vertices = mesh.vertices.copy()
    far = length(places[:, None] - vertices[sides]) / _shortest(mesh, sides)  # (s, 2)
    order = np.argsort(-far.reshape(-1), kind="stable")
    order = order[far.reshape(-1)[order] < SNAP]
    vertices[sides.reshape(-1)[order]] = places[order // 2]  # the nearest one comes last
    moved = np.zeros(len(vertices), dtype=np.bool_)
    moved[sides.reshape(-1)[order]] = True
    split = np.flatnonzero(~moved[sides].any(axis=1))
    new = len(vertices) + np.arange(len(split))
    vertices = np.concatenate([vertices, places[split]])
    return TriangleMesh(vertices, _split(vertices, mesh.triangles, sides[split], new)), split


def _shortest(mesh: TriangleMesh, sides: Edges) -> Floats:
    """Return the shortest side of triangles at each end of some sides, mm, (s, 2)."""
    found = np.full(len(mesh.vertices), -np.inf)
    found[sides] = np.inf
    triangles = mesh.triangles[(found[mesh.triangles] > 0).any(axis=1)]
    ends = sides_of(triangles).T
    size = length(mesh.vertices[ends[0]] - mesh.vertices[ends[1]])
    for end in ends:
        np.minimum.at(found, end, size)
    return np.asarray(found[sides])


def _split(vertices: Points, triangles: Ints, sides: Edges, new: Ints) -> Ints:
    """Return triangles with some of their sides split at new vertices, (t', 3)."""
    if len(sides) == 0:
        return triangles
    low, high = np.sort(sides, axis=1).T
    keys = low * len(vertices) + high
    order = np.argsort(keys)
    keys, new = keys[order], new[order]
    marks = np.zeros(len(vertices), dtype=np.bool_)
    marks[sides] = True
    touched = marks[triangles].sum(axis=1) > 1
    own = triangles[touched]
    pairs = np.sort(np.stack([own, np.roll(own, -1, axis=1)], axis=2), axis=2)  # (t, 3, 2)
    asked = pairs[..., 0] * len(vertices) + pairs[..., 1]
    at = np.minimum(np.searchsorted(keys, asked), len(keys) - 1)
    middle = np.where(keys[at] == asked, new[at], -1)  # on the side from each corner to the next
    count = (middle >= 0).sum(axis=1)
    parts = [triangles[~touched], own[count == 0]]
    # Turned so that sides that are split come first; two of them: so that the third is not.
    turn = np.where(count == 2, (middle < 0).argmax(axis=1) + 1, (middle >= 0).argmax(axis=1))
    turns = (turn[:, None] + np.arange(3)) % 3
    own, middle = (np.take_along_axis(each, turns, axis=1) for each in (own, middle))
    (a, b, c), (p, _, _) = own[count == 1].T, middle[count == 1].T
    parts += [np.stack(each, axis=1) for each in ((a, p, c), (p, b, c))]
    (a, b, c), (p, q, _) = own[count == 2].T, middle[count == 2].T
    first = length(vertices[a] - vertices[q]) < length(vertices[p] - vertices[c])
    parts.append(np.stack([p, b, q], axis=1))
    parts += [np.stack(each, axis=1)[first] for each in ((a, p, q), (a, q, c))]
    parts += [np.stack(each, axis=1)[~first] for each in ((a, p, c), (p, q, c))]
    (a, b, c), (p, q, r) = own[count == 3].T, middle[count == 3].T
    parts += [np.stack(each, axis=1) for each in ((a, p, r), (p, b, q), (r, q, c), (p, q, r))]
    return np.concatenate(parts)


def _faulty(mesh: TriangleMesh, around: Ints) -> Bools:
    """Return the vertices of triangles with no area or that meet others, (v,).

    Parameters
    ----------
    around : vertices whose triangles are looked at, with what is near these
    """
    marks = np.zeros(len(mesh.vertices), dtype=np.bool_)
    marks[around] = True
    own = np.flatnonzero(marks[mesh.triangles].any(axis=1))
    near = _near(mesh, own)
    some = TriangleMesh(mesh.vertices, mesh.triangles[near])
    meet = near[np.unique(self_intersections(some, weld=False))]
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles[own]], 1, 0)
    size = np.maximum(length(b - a), length(c - a))
    flat = own[length(np.cross(b - a, c - a)) < NO_AREA * size * size]
    found = np.zeros(len(mesh.vertices), dtype=np.bool_)
    found[mesh.triangles[np.append(meet, flat)]] = True
    return found


def _near(mesh: TriangleMesh, own: Ints) -> Ints:
    """Return the triangles that may meet some of them, with these, ascending.

    They are sorted into boxes of about their size.
    """
    low, high = boxes_of(mesh.vertices[mesh.triangles])
    origin, size = mesh.vertices.min(axis=0), (high - low).max(axis=1)
    least = size[own].max()
    octave = np.ceil(np.log2(np.maximum(size / least, 1.0))).astype(np.intp)
    found = []
    for number in np.unique(octave).tolist():
        rows = np.flatnonzero(octave == number)
        box = least * 2.0**number
        at = np.unique(packed(np.floor((low[own] - origin) / box).astype(np.intp)))
        # A triangle begins in the box where another one does, or in one beside it.
        keys = np.unique(packed(unpacked(at)[:, None] + AROUND - 1))
        place = packed(np.floor((low[rows] - origin) / box).astype(np.intp))
        found.append(rows[np.isin(place, keys)])
    return np.unique(np.concatenate(found))
