"""The filleted union of struts as a function of space, at many points at once.

For struts at distances d_j (negative inside) with fillet radii ρ_j it is
``F = 1 - |max(1 - d_j / ρ_j, 0)|₂`` where some d_j < ρ_j, and otherwise the least d_j / ρ_j:
continuous with its derivative where d_j are, independent of the struts' order, and d_i / ρ_i where
no other strut is within its ρ. With one ρ for all, the zero set is that of
``ρ - |max(ρ - d_j, 0)|₂``: a rolling-ball fillet of radius ρ where surfaces meet at right angles.
Where ρ differ the fillet is a quarter of an ellipse, and a strut swells by its own ρ at most.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points
from scaffold_cad.base.threads import in_order
from scaffold_cad.base.vectors import dot, length
from scaffold_cad.solid.field.struts import FieldStruts

NO_LENGTH = 1e-12
"""A strut shorter than this part of its radius is a ball."""

POINTS_AT_ONCE = 1 << 14
"""Points looked at together: their arrays stay in the processor's cache."""


@dataclass(frozen=True, eq=False)
class FilletedUnion(Frozen):
    """Struts ready for evaluation; positions are relative to `origin`."""

    origin: Floats
    """Place of the local origin, shape (3,), mm."""
    rows: Floats
    """A column a strut: start x, y, z, unit axis x, y, z, lowest and highest place on the axis
    that a nearest ball stands at, radius of the ball at the start, its decrease, slope; shape
    (11, m)."""
    caps: Floats
    """Places of flat ends before and behind, or -inf, shape (2, m)."""
    blend: Floats
    """Fillet radii, shape (m,), mm."""
    section: Floats
    """Section radius at the start, its slope, length, least radius; shape (4, m)."""
    groups: Ints
    """Struts of one number have no fillet between them, shape (m,)."""
    tapered: bool
    capped: bool
    grouped: bool

    def distances(self, x: Points, struts: Ints) -> tuple[Floats, Floats]:
        """Return the distance of each point (k, 3) to its strut, and the place on its axis.

        The distance is that to the balls along the strut's axis that touch its side: exact for
        round ends, and for flat ends the larger of that and the distance to the end's plane.
        """
        px, py, pz, ax, ay, az, low, high, radius, sine, slope = (row[struts] for row in self.rows)
        px, py, pz = x[:, 0] - px, x[:, 1] - py, x[:, 2] - pz
        along = px * ax + py * ay + pz * az
        square = px * px + py * py + pz * pz
        place = along
        if self.tapered:
            place = along + slope * np.sqrt(np.maximum(square - along * along, 0.0))
        place = np.minimum(np.maximum(place, low), high)
        square -= place * (2.0 * along - place)
        distance = np.sqrt(np.maximum(square, 0.0)) - radius
        if self.tapered:
            distance -= place * sine
        if self.capped:
            before, behind = (row[struts] for row in self.caps)
            distance = np.maximum(distance, np.maximum(before - along, along + behind))
        return distance, place

    def local_radii(self, place: Floats, struts: Ints, within: float) -> Floats:
        """Return the least section radius of a strut within a distance of a place on its axis."""
        start, slope, extent, least = (row[struts] for row in self.section)
        radii = start + slope * np.clip(place, 0.0, extent) - np.abs(slope) * within
        return np.asarray(np.maximum(radii, least))

    def rim_distances(self, x: Points, struts: Ints) -> Floats:
        """Return the distance of each point (k, 3) to the nearest rim of its strut's flat ends."""
        way = x - self.rows[:3, struts].T
        along = dot(way, self.rows[3:6, struts].T)
        away = np.sqrt(np.maximum(dot(way, way) - along * along, 0.0))
        start, slope, extent, _ = (row[struts] for row in self.section)
        before, behind = np.isfinite(self.caps[:, struts])
        first = np.hypot(along, away - start)
        last = np.hypot(along - extent, away - start - slope * extent)
        return np.minimum(np.where(before, first, np.inf), np.where(behind, last, np.inf))


def filleted_union(struts: FieldStruts, origin: Floats, swell: Floats) -> FilletedUnion:
    """Return the function of `struts` with their radii times 1 + `swell` (m,)."""
    start, end = struts.ends[:, 0] - origin, struts.ends[:, 1] - origin
    extent = length(end - start)
    ball = extent <= NO_LENGTH * struts.radii.max(axis=1)
    reach = np.where(ball, 1.0, extent)
    axis = np.where(ball[:, None], [1.0, 0.0, 0.0], (end - start) / reach[:, None])
    extent = np.where(ball, 0.0, extent)
    radii = np.where(ball[:, None], struts.radii.max(axis=1)[:, None], struts.radii)
    slope = (radii[:, 1] - radii[:, 0]) / reach * (1.0 + swell)
    cosine = 1.0 / np.sqrt(1.0 + slope * slope)
    flat = struts.flat & ~ball[:, None]
    low, high = np.where(flat[:, 0], -np.inf, 0.0), np.where(flat[:, 1], np.inf, extent)
    first = radii[:, 0] * (1.0 + swell) * cosine
    return FilletedUnion(
        origin=origin,
        rows=np.array([*start.T, *axis.T, low, high, first, slope * cosine, slope]),
        caps=np.array([np.where(flat[:, 0], 0.0, -np.inf), np.where(flat[:, 1], -extent, -np.inf)]),
        blend=struts.blend,
        section=np.array([radii[:, 0], slope, extent, radii.min(axis=1)]),
        groups=struts.groups,
        tapered=bool((slope != 0).any()),
        capped=bool(flat.any()),
        grouped=len(np.unique(struts.groups)) < len(struts.groups),
    )


@dataclass(frozen=True, eq=False)
class Lists(Frozen):
    """A list of struts for each of some places."""

    starts: Ints
    """Where each list starts in `struts`, and their end, shape (n + 1,)."""
    struts: Ints
    """Lists one after the other, shape (p,)."""

    def __len__(self) -> int:
        return len(self.starts) - 1

    def of(self, owners: Ints) -> tuple[Ints, Ints, Ints]:
        """Return the lists of `owners` (k,): which of them (p,), its struts (p,), starts (k,)."""
        first, counts = self.starts[owners], self.starts[owners + 1] - self.starts[owners]
        starts = np.cumsum(counts) - counts
        which = np.repeat(np.arange(len(owners)), counts)
        return which, self.struts[np.arange(len(which)) + np.repeat(first - starts, counts)], starts


def filleted(ratio: Floats, starts: Ints) -> Floats:
    """Return F of each list from d / ρ of its struts (p,).

    F is scaled so that it falls as fast as d / ρ of the nearest strut where several are as near;
    else a line through two values would not lead to its root.
    """
    inside = np.maximum(1.0 - ratio, 0.0)
    size = np.sqrt(np.add.reduceat(inside * inside, starts))
    least = np.minimum.reduceat(ratio, starts)
    near = size > 0
    return np.where(near, (1.0 - size) * (1.0 - least) / np.where(near, size, 1.0), least)


def merged_groups(
    union: FilletedUnion, which: Ints, struts: Ints, ratio: Floats, starts: Ints
) -> tuple[Floats, Ints]:
    """Return the least ratio of each group of struts of each list, and where lists start."""
    if not union.grouped:
        return ratio, starts
    group = union.groups[struts]
    order = np.lexsort((group, which))
    which, group, ratio = which[order], group[order], ratio[order]
    new = np.ones(len(which), dtype=np.bool_)
    new[1:] = (which[1:] != which[:-1]) | (group[1:] != group[:-1])
    first = np.flatnonzero(new)
    rank = np.cumsum(new) - 1
    return np.minimum.reduceat(ratio, first), rank[starts]


def values(union: FilletedUnion, points: Points, owners: Ints, lists: Lists) -> Floats:
    """Return F at `points` (k, 3), each seen by the struts on its owner's list, shape (k,)."""
    result = np.empty(len(points))

    def some(begin: int) -> None:
        block = slice(begin, begin + POINTS_AT_ONCE)
        which, struts, starts = lists.of(owners[block])
        distance, _ = union.distances(points[block][which], struts)
        ratio = distance / union.blend[struts]
        ratio, starts = merged_groups(union, which, struts, ratio, starts)
        result[block] = filleted(ratio, starts)

    for _ in in_order(some, range(0, len(points), POINTS_AT_ONCE)):
        pass
    return result


def any_of(marks: Bools, starts: Ints) -> Bools:
    """Return whether any mark (p,) of each list is set."""
    return np.logical_or.reduceat(marks, starts)
