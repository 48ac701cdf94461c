"""The filleted union of struts as a function of space, at many points at once.

For struts at distances d_j (negative inside) with fillet radii ρ_j let h_j = 1 - d_j / ρ_j. Then
F = 1 - h, where h is the largest of all h_j and, for each two struts with h_j > 0 whose distances
grow in directions with the cosine c, taken as 0 if it is negative, of

    sqrt((h_i² + h_j² - 2 c h_i h_j) / (1 - c²))    where h_i > c h_j and h_j > c h_i

which is the distance to the line where a ball of radius ρ touches both surfaces, taken as planes:
a rolling-ball fillet, that of ρ - |max(ρ - d_j, 0)|₂ for two struts at right angles. Surfaces that
go the same way, such as those of struts that run on straight, of balls at the end of several
struts, or of struts in the same place, have no fillet and no bulge. Where a strut ends flat, its
fillets end in the plane of that end. F is continuous, independent of the struts' order, at most
d_i / ρ_i, and d_i / ρ_i where no other strut is within its ρ. Where ρ differ the fillet is a
quarter of an ellipse, and a strut swells by its own ρ at most.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.blocks import CACHE, blocks
from scaffold_cad.base.threads import in_order
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.solid.field.chains import EndPlanes, end_planes
from scaffold_cad.solid.field.struts import FieldStruts

NO_LENGTH = 1e-12
"""A strut shorter than this part of its radius is a ball."""

NO_PLANE = 1e100
"""How far the plane of a round end is away, mm: a number to reckon with."""

ALONG = 1.0 - 1e-9
"""Largest cosine between directions that are not the same."""

POINT_BYTES = 128
"""What a point takes where it is looked at."""


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
    rims: Floats
    """How small cells are at the rims of both ends, see `FieldStruts.fineness`, shape (2, m)."""
    planes: EndPlanes
    """Those that other links of chains end at, relative to the origin."""
    tapered: bool
    capped: bool

    def distances(self, x: Points, struts: Ints) -> tuple[Floats, Floats]:
        """Return the distance of each point (k, 3) to its strut, and the place on its axis.

        The distance is that to the balls along the strut's axis that touch its side: exact for
        round ends, and for flat ends too, where the rim is nearest to what is beyond both. It
        grows by 1 mm per mm at most.
        """
        side, place, along = self._parts(x, struts)
        if self.capped:
            some = np.flatnonzero(np.isfinite(self.caps[:, struts]).any(axis=0))
            ends = self._ends(struts[some], along[some])
            within = [_corner(side[some], beyond, lean)[0] for beyond, lean in ends]
            side[some] = np.maximum(*within)
        return self.planes.cut(side, x, struts), place

    def _parts(self, x: Points, struts: Ints) -> tuple[Floats, Floats, Floats]:
        """Return distances from struts' sides, the places, and how far along axes x is, (k,)."""
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
        return distance, place, along

    def _ends(self, struts: Ints, along: Floats) -> list[tuple[Floats, Floats]]:
        """Return distances from the planes of both ends, and their cosines with the side, (k,)."""
        before, behind = (np.maximum(row[struts], -NO_PLANE) for row in self.caps)
        sine = self.rows[9, struts]
        return [(before - along, sine), (behind + along, -sine)]

    def beyond(self, x: Points, struts: Ints) -> Floats:
        """Return how far points (k, 3) are beyond the plane of a flat end of their struts, (k,).

        It is -inf for struts without such ends.
        """
        found = np.full(len(x), -np.inf)
        if self.capped:
            along = dot(x - self.rows[:3, struts].T, self.rows[3:6, struts].T)
            found = np.maximum(self.caps[0, struts] - along, self.caps[1, struts] + along)
        return self.planes.cut(found, x, struts)

    def gradients(self, x: Points, struts: Ints) -> UnitVectors:
        """Return the direction in which each distance grows, shape (k, 3).

        Beyond the end of its chain a strut's is that of the last one: they have no fillet there.
        """
        return self._gradients(x, self.planes.last_at(x, struts))

    def _gradients(self, x: Points, struts: Ints) -> UnitVectors:
        side, place, along = self._parts(x, struts)
        axis = self.rows[3:6, struts].T
        gradient = normalize(x - self.rows[:3, struts].T - place[:, None] * axis)
        if not self.capped:
            return gradient
        ends = self._ends(struts, along)
        first, last = (_corner(side, beyond, lean) for beyond, lean in ends)
        is_last = last[0] > first[0]
        _, by_side, by_end = (np.where(is_last, b, a) for a, b in zip(first, last, strict=True))
        outward = np.where(is_last[:, None], axis, -axis)
        return normalize(by_side[:, None] * gradient + by_end[:, None] * outward)

    def local_radii(self, place: Floats, struts: Ints, within: float) -> Floats:
        """Return the least section radius of a strut within a distance of a place on its axis."""
        start, slope, extent, least = (row[struts] for row in self.section)
        radii = start + slope * np.clip(place, 0.0, extent) - np.abs(slope) * within
        return np.asarray(np.maximum(radii, least))

    def rim_sizes(self, x: Points, struts: Ints, within: float) -> Floats:
        """Return how small cells at each point (k, 3) are for rims of its strut near it, (k,)."""
        way = x - self.rows[:3, struts].T
        along = dot(way, self.rows[3:6, struts].T)
        away = np.sqrt(np.maximum(dot(way, way) - along * along, 0.0))
        start, slope, extent, _ = (row[struts] for row in self.section)
        first = np.hypot(along, away - start) < within
        last = np.hypot(along - extent, away - start - slope * extent) < within
        before, behind = self.rims[:, struts]
        return np.minimum(np.where(first, before, 1.0), np.where(last, behind, 1.0))


def _corner(side: Floats, beyond: Floats, lean: Floats) -> tuple[Floats, Floats, Floats]:
    """Return distances from what is behind two planes, and the parts of both normals in them, (k,).

    Parameters
    ----------
    side, beyond : (k,) distances from both, mm
    lean : (k,) cosine between their normals
    """
    least = 1.0 - lean * lean
    by_side, by_end = (side - lean * beyond) / least, (beyond - lean * side) / least
    off_rim = (by_side > 0) & (by_end > 0) & ((side > 0) | (beyond > 0))
    first = side >= beyond
    far = np.sqrt(np.where(off_rim, side * by_side + beyond * by_end, 0.0))
    return (
        np.where(off_rim, far, np.maximum(side, beyond)),
        np.where(off_rim, by_side, first),
        np.where(off_rim, by_end, ~first),
    )


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
        planes=end_planes(struts, origin),
        rims=np.where(ball[:, None], 1.0, struts.fineness).T,
        tapered=bool((slope != 0).any()),
        capped=bool(flat.any()),
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


def values(union: FilletedUnion, points: Points, owners: Ints, lists: Lists) -> Floats:
    """Return F at `points` (k, 3), each seen by the struts on its owner's list, shape (k,)."""
    result = np.empty(len(points))

    def some(block: slice) -> None:
        which, struts, _ = entries = lists.of(owners[block])
        x = points[block][which]
        distance, _ = union.distances(x, struts)
        result[block] = combined(union, x, entries, distance / union.blend[struts])

    for _ in in_order(some, blocks(len(points), POINT_BYTES, CACHE)):
        pass
    return result


def combined(
    union: FilletedUnion, x: Points, entries: tuple[Ints, Ints, Ints], ratio: Floats
) -> Floats:
    """Return F at points from their distances to struts, shape (k,).

    Parameters
    ----------
    x : (p, 3) the point of each entry
    entries : the point that each is of (p,), its strut (p,), first entry of each point (k,)
    ratio : (p,) d / ρ
    """
    which, struts, starts = entries
    least = np.minimum.reduceat(ratio, starts)
    # The fillet matters outside of all struts, where two of them are near.
    near = (ratio < 1.0) & (least > 0.0)[which]
    near &= (np.add.reduceat(near.astype(np.intp), starts) > 1)[which]
    rows = np.flatnonzero(near)
    if len(rows):
        at, of = x[rows], struts[rows]
        most = 1.0 - union.beyond(at, of) / union.blend[of]
        ways = union.gradients(at, of)
        filleted, height = _heights(which[rows], 1.0 - ratio[rows], ways, most)
        least[filleted] = np.minimum(least[filleted], 1.0 - height)
    return least


def _heights(which: Ints, heights: Floats, ways: UnitVectors, most: Floats) -> tuple[Ints, Floats]:
    """Return the points that have several entries, and the largest h of two of their entries.

    Parameters
    ----------
    which : (p,) point of each entry, ascending, each at least twice
    most : (p,) largest h of a fillet of each entry
    """
    first = np.flatnonzero(np.append(True, which[1:] != which[:-1]))
    counts = np.diff(np.append(first, len(which)))
    rest = np.repeat(first + counts, counts) - np.arange(len(which)) - 1  # entries that follow
    one = np.repeat(np.arange(len(which)), rest)
    begin = np.cumsum(rest) - rest
    other = one + 1 + np.arange(len(one)) - begin[one]
    a, b = heights[one], heights[other]
    cosine = np.clip(dot(ways[one], ways[other]), 0.0, ALONG)
    meet = np.minimum(a, b) > cosine * np.maximum(a, b)
    square = (a * a + b * b - 2.0 * cosine * a * b) / (1.0 - cosine * cosine)
    fillet = np.minimum(np.sqrt(np.maximum(square, 0.0)), np.minimum(most[one], most[other]))
    height = np.where(meet, np.maximum(fillet, np.maximum(a, b)), np.maximum(a, b))
    return which[first], np.maximum.reduceat(height, begin[first])


def least_values(ratio: Floats, starts: Ints) -> Floats:
    """Return what F of each list (k,) is not less than, from d / ρ of its struts (p,)."""
    inside = np.maximum(1.0 - ratio, 0.0)
    size = np.sqrt(np.add.reduceat(inside * inside, starts))
    return np.where(size > 0, 1.0 - size, np.minimum.reduceat(ratio, starts))


def any_of(marks: Bools, starts: Ints) -> Bools:
    """Return whether any mark (p,) of each list is set."""
    return np.logical_or.reduceat(marks, starts)
