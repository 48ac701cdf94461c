"""Planes of flat ends in fields, and lines in them that cross creases.

A crease is looked for in the plane of an end, by the sign of F just beside it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.vectors import any_perpendicular, dot, normalize
from scaffold_cad.solid.field.grid import Grid
from scaffold_cad.solid.field.union import FilletedUnion, values

FLUSH = 0.004
"""How far a vertex may be off the plane of a flat end that it is on, in the end's radius."""

ASIDE = 2.0 * FLUSH
"""How far beside planes F is looked at, in that radius."""

STEPS = 8
"""Places of a line where a crease is looked for."""

HALVINGS = 10
"""Times that a step with a crease is halved."""


@dataclass(frozen=True, eq=False)
class Planes(Frozen):
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


def planes_of(union: FilletedUnion) -> Planes:
    """Return the planes of all flat ends."""
    end, strut = np.nonzero(np.isfinite(union.caps))
    start, axis, extent = union.rows[:3].T[strut], union.rows[3:6].T[strut], union.section[2, strut]
    radius = union.section[0, strut] + union.section[1, strut] * extent * end
    tip = start + (extent * end)[:, None] * axis
    reach = radius + union.blend[strut]
    return Planes(tip, np.where(end == 0, -1.0, 1.0)[:, None] * axis, radius, reach)


@dataclass(frozen=True, eq=False)
class Lines:
    """Lines in planes of flat ends, and where they cross creases."""

    union: FilletedUnion
    grid: Grid
    planes: Planes
    plane: Ints
    """Shape (s,)."""
    side: Floats
    """-1 where the crease is convex, 1 where it is concave, shape (s,)."""
    group: Ints
    """A group near each, shape (s,)."""

    def chosen(self, keep: Bools) -> Lines:
        """Return some of them."""
        parts = self.plane[keep], self.side[keep], self.group[keep]
        return Lines(self.union, self.grid, self.planes, *parts)

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
        """Return where lines (s, 3) first cross creases, and whether they do.

        They are looked at in `STEPS` places, as beyond a crease there may be another end's disc.
        """
        good = self.within(start) & ((self.values(start, -self.side) < 0) == (self.side > 0))
        low, high = np.zeros(len(start)), np.full(len(start), np.inf)
        for step in range(1, STEPS + 1):
            before = self.within(start + step / STEPS * way) & ~np.isfinite(high)
            low = np.where(before, step / STEPS, low)
            high = np.where(before | np.isfinite(high), high, step / STEPS)
        good &= np.isfinite(high)
        high = np.where(good, high, low)
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


def planes_near(vertices: Points, planes: Planes) -> tuple[Ints, Ints]:
    """Return the vertices that may be on each flat end or its fillets, and its plane, (k,)."""
    found = cKDTree(vertices).query_ball_point(planes.tip, planes.reach)
    plane = np.repeat(np.arange(len(found)), [len(each) for each in found])
    return np.concatenate([np.zeros(0), *found]).astype(np.intp), plane


def plane_of(vertices: Points, planes: Planes) -> Ints:
    """Return the plane of a flat end that each vertex is on, or -1, (v,)."""
    vertex, plane = planes_near(vertices, planes)
    off = np.abs(planes.beyond(vertices[vertex], plane)) / planes.radius[plane]
    near = off < FLUSH
    vertex, plane, off = vertex[near], plane[near], off[near]
    order = np.argsort(-off, kind="stable")
    result = np.full(len(vertices), -1)
    result[vertex[order]] = plane[order]  # the nearest one comes last
    return result
