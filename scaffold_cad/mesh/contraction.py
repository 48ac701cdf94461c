"""Edges of a triangle mesh drawn together in rounds, many at once.

Each vertex has the mean of the squared distances to the planes of the triangles that it stands for,
by their areas. An edge is drawn together to the point of least mean, where its root is within a
tolerance, no triangle turns over or becomes a sliver, and the surface is not pinched. Edges that
share no triangle are drawn together at once.

References
----------
Garland, Heckbert, Surface simplification using quadric error metrics, SIGGRAPH 1997.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points

TURN = 0.5
"""Least cosine of the angle by which a triangle's normal may turn at once."""

THIN = 0.25
"""Least height of a triangle, in tolerances, but for those that are thinner from the start."""

PULL = 1e-3
"""Weight of the middle of an edge beside the planes: it decides where these leave it open."""

SIEVES = 5
"""Times that edges are looked for that share no triangle with those found."""

FEW = 0.01
"""Part of the triangles that a round leaves out at least, or it is the last one of its share."""

HALF = 32
"""Bits of a vertex in the key of an edge."""

ROWS, COLUMNS = [0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]
"""What is kept of symmetric matrices."""


@dataclass(frozen=True, eq=False)
class Contractible:
    """A mesh whose edges may be drawn together."""

    points: Points
    """Vertices, about the middle of all, shape (v, 3), mm."""
    corners: Ints
    """Triangles, shape (3, t)."""
    stays: Bools
    """Vertices that stay where they are, shape (v,)."""
    tolerance: Floats
    """How far the surface may move at each vertex, shape (v,), mm."""
    planes: Floats
    """Sums over the triangles that each vertex stands for, see `planes_of`, shape (v, 11)."""


class Contraction:
    """A mesh whose edges are being drawn together."""

    def __init__(self, start: Contractible, stays: Bools) -> None:
        self.points = start.points.copy()
        self.corners = start.corners
        self.target = np.arange(len(self.points))
        """Vertex that each vertex became a part of, shape (v,)."""
        self.stays = stays
        self.tolerance = start.tolerance.copy()
        self.planes = start.planes.copy()
        self._known = (np.zeros(0, dtype=np.intp), np.zeros(0), np.zeros((0, 3)))
        self._blocked = np.zeros(0, dtype=np.intp)

    def compacted(self, stays: Bools) -> Contractible:
        """Return the mesh as it is, with the vertices that it uses."""
        used = np.zeros(len(self.points), dtype=np.bool_)
        used[self.corners] = True
        corners = (np.cumsum(used) - 1)[self.corners]
        points, tolerance, planes = self.points[used], self.tolerance[used], self.planes[used]
        return Contractible(points, corners, stays[used], tolerance, planes)

    def run(self, shares: tuple[float, ...]) -> None:
        """Draw edges together until little comes of it.

        Parameters
        ----------
        shares : of the tolerance, squared, that may be used up, one after the other
        """
        for share in shares:
            before = np.inf
            while before - self.corners.shape[1] > FEW * self.corners.shape[1]:
                before = self.corners.shape[1]
                if not self._round(share):
                    break

    def _round(self, share: float) -> bool:
        """Draw edges together that share no triangle; return whether there were any."""
        keys = self._edges()
        cost, places = self._costs(keys)
        start, end = _ends(keys)
        cost = cost / np.minimum(self.tolerance[start], self.tolerance[end]) ** 2
        able = np.flatnonzero(cost <= share)
        if len(self._blocked):
            able = able[~_among(keys[able], self._blocked)[0]]
        chosen = able[self._independent(keys[able], cost[able])]
        if len(chosen) == 0:
            return False
        good = self._good(start[chosen], end[chosen], places[chosen])
        self._blocked = np.union1d(self._blocked, keys[chosen[~good]])
        chosen = chosen[good]
        self._draw(start[chosen], end[chosen], places[chosen])
        return True

    def _edges(self) -> Ints:
        """Return the keys of the edges with an end that may move, ascending, (e,)."""
        keys = []
        for side in range(3):
            start, end = self.corners[side], self.corners[side - 2]
            inner = (start < end) & ~(self.stays[start] & self.stays[end])
            keys.append(start[inner] << HALF | end[inner])
        return np.sort(np.concatenate(keys))

    def _costs(self, keys: Ints) -> tuple[Floats, Points]:
        """Return the mean squared distance where each edge is drawn together to, and that place."""
        old_keys, old_costs, old_places = self._known
        known, place = _among(keys, old_keys)
        costs, places = np.empty(len(keys)), np.empty((len(keys), 3))
        old = np.flatnonzero(known)
        costs[old], places[old] = old_costs[place[old]], old_places[place[old]]
        new = np.flatnonzero(~known)
        costs[new], places[new] = self._placed(*_ends(keys[new]))
        self._known = keys, costs, places
        return costs, places

    def _placed(self, start: Ints, end: Ints) -> tuple[Floats, Points]:
        """Return the least mean squared distance of points for edges, (e,), and the points."""
        sums = np.ascontiguousarray((self.planes[start] + self.planes[end]).T)  # (11, e)
        sums = sums[1:] / np.maximum(sums[0], 1e-300)
        square, linear, rest = sums[:6], sums[6:9], sums[9]
        tail, tip = self.points[start].T, self.points[end].T  # (3, e)
        places = _solved(square, PULL / 2 * (tail + tip) - linear)
        for ends, points in ((start, tail), (end, tip)):
            stay = self.stays[ends]
            places[:, stay] = points[:, stay]
        a, b, c, d, e, f = square
        x, y, z = places
        costs = x * (a * x + 2 * (b * y + c * z + linear[0])) + y * (d * y + 2 * linear[1])
        costs += z * (2 * e * y + f * z + 2 * linear[2]) + rest
        return np.maximum(costs, 0.0), places.T

    def _independent(self, keys: Ints, cost: Floats) -> Ints:
        """Return edges of low cost, no two of which touch the same triangle."""
        none = len(keys)
        # An even order: a slope of costs would leave one edge a round.
        level = (np.log2(cost + 1e-9) + 64.0).astype(np.uint64)
        rank = np.empty(none, dtype=np.intp)
        order = level << np.uint64(56) | _scattered(keys) >> np.uint64(8)
        rank[np.argsort(order)] = np.arange(none)
        (start, end), left, chosen = _ends(keys), np.arange(none), []
        corners = self.corners
        for _ in range(SIEVES):
            own = rank[left]
            least = np.full(len(self.points), none)
            np.minimum.at(least, start, own)
            np.minimum.at(least, end, own)
            lowest = _least(least, corners)
            corners, lowest = corners[:, lowest < none], lowest[lowest < none]
            around = least
            for corner in corners:
                np.minimum.at(around, corner, lowest)
            found = (around[start] == own) & (around[end] == own)
            chosen.append(left[found])
            ends = np.zeros(len(self.points), dtype=np.bool_)
            ends[start[found]] = ends[end[found]] = True
            near = _beside(ends, corners)
            kept = ~(near[start] | near[end])
            start, end, left = start[kept], end[kept], left[kept]
        return np.concatenate(chosen)

    def _good(self, start: Ints, end: Ints, places: Points) -> Bools:
        """Return which edges may be drawn together to their places, (e,)."""
        bad = np.zeros(len(start), dtype=np.bool_)
        triangles = np.ascontiguousarray(self.corners.T).reshape(-1)
        first, order = _by_corner(triangles, len(self.points))
        count = np.diff(first)
        least = THIN * np.minimum(self.tolerance[start], self.tolerance[end])
        shared = []
        for own, other in ((start, end), (end, start)):
            which = np.repeat(np.arange(len(own)), count[own])
            before = np.cumsum(count[own]) - count[own]
            place = order[np.arange(len(which)) + (first[own] - before)[which]]
            turn = place % 3
            after = triangles[place + np.array([1, 1, -2])[turn]]
            last = triangles[place + np.array([2, -1, -1])[turn]]
            shared.append(_neighbors(which, after, last, self.stays[own][which]))
            kept = np.flatnonzero((after != other[which]) & (last != other[which]))
            which = which[kept]
            up = _stay_up(
                self.points[own[which]].T,
                places[which].T,
                self.points[after[kept]].T,
                self.points[last[kept]].T,
                least[which],
            )
            bad[which[~up]] = True
        both = np.sort(np.concatenate(shared))
        twice = both[1:][both[1:] == both[:-1]] >> HALF
        bad[np.bincount(twice, minlength=len(bad)) != 2] = True
        return ~bad

    def _draw(self, start: Ints, end: Ints, places: Points) -> None:
        """Draw edges together, each to its first end or to that which stays."""
        turned = self.stays[end]
        kept, gone = np.where(turned, end, start), np.where(turned, start, end)
        self.points[kept] = places
        self.planes[kept] += self.planes[gone]
        self.tolerance[kept] = np.minimum(self.tolerance[kept], self.tolerance[gone])
        target = np.arange(len(self.points))
        target[gone] = kept
        a, b, c = corners = target[self.corners]
        self.corners = np.ascontiguousarray(corners[:, (a != b) & (b != c) & (c != a)])
        self.target = target[self.target]
        moved = np.zeros(len(self.points), dtype=np.bool_)
        moved[kept] = moved[gone] = True
        keys, costs, points = self._known
        tail, tip = _ends(keys)
        same = np.flatnonzero(~(moved[tail] | moved[tip]))
        self._known = keys[same], costs[same], points[same]
        near = moved | _beside(moved, self.corners)
        tail, tip = _ends(self._blocked)
        self._blocked = self._blocked[~(near[tail] | near[tip])]


def _ends(keys: Ints) -> tuple[Ints, Ints]:
    """Return the vertices of edges, (e,) each."""
    return keys >> HALF, keys & ((1 << HALF) - 1)


def _among(keys: Ints, those: Ints) -> tuple[Bools, Ints]:
    """Return whether keys are among those, which ascend, and where, (e,)."""
    if len(those) == 0:
        return np.zeros(len(keys), dtype=np.bool_), np.zeros(len(keys), dtype=np.intp)
    place = np.minimum(np.searchsorted(those, keys), len(those) - 1)
    return those[place] == keys, place


def _least(values: Ints, corners: Ints) -> Ints:
    """Return the least value of the corners of triangles (3, t), (t,)."""
    a, b, c = corners
    return np.asarray(np.minimum(np.minimum(values[a], values[b]), values[c]))


def _beside(marks: Bools, corners: Ints) -> Bools:
    """Return the vertices of triangles (3, t) with a corner that is marked, (v,)."""
    a, b, c = corners
    found = np.zeros_like(marks)
    found[corners[:, marks[a] | marks[b] | marks[c]]] = True
    return found


def _by_corner(triangles: Ints, count: int) -> tuple[Ints, Ints]:
    """Return where the corners (3 t,) of each vertex begin in a list, and the list."""
    rows = np.arange(len(triangles) + 1)
    table = csr_array((rows[:-1], triangles, rows), shape=(len(triangles), count)).tocsc()
    return table.indptr.astype(np.intp), table.data


def _neighbors(which: Ints, after: Ints, last: Ints, stays: Bools) -> Ints:
    """Return each of the vertices beside an end of edges once, with the number of the edge.

    Parameters
    ----------
    which : (k,) edges
    after, last : (k,) the other corners of the triangles at their end
    stays : (k,) whether that may be on a border, where a corner is the last one only
    """
    once = (which << HALF | after)[~stays]
    fixed = which[stays] << HALF
    return np.concatenate([once, np.unique(np.append(fixed | after[stays], fixed | last[stays]))])


def _scattered(keys: Ints) -> NDArray[np.uint64]:
    """Return a number for each edge that is as good as random, and always the same, (e,)."""
    bits = keys.astype(np.uint64)
    for factor in (0xBF58476D1CE4E5B9, 0x94D049BB133111EB):  # as in splitmix64
        bits = (bits ^ bits >> np.uint64(30)) * np.uint64(factor)
    return np.asarray(bits ^ bits >> np.uint64(31))


def _solved(square: Floats, right: Floats) -> Floats:
    """Return the solutions (3, e) for symmetric matrices (6, e), with `PULL` on the diagonal."""
    a, b, c, d, e, f = square
    a, d, f = a + PULL, d + PULL, f + PULL
    aa, ab, ac = d * f - e * e, c * e - b * f, b * e - c * d
    bb, bc, cc = a * f - c * c, b * c - a * e, a * d - b * b
    x, y, z = right / (a * aa + b * ab + c * ac)
    return np.stack([aa * x + ab * y + ac * z, ab * x + bb * y + bc * z, ac * x + bc * y + cc * z])


def _stay_up(before: Floats, place: Floats, b: Floats, c: Floats, least: Floats) -> Bools:
    """Return which triangles neither turn over nor become slivers, (k,).

    Parameters
    ----------
    before, place : (3, k) the corner that moves, and where to
    b, c : (3, k) the other corners
    """
    normals, heights, sizes = [], [], []
    side = _length(c - b)
    for corner in (before, place):
        to_b, to_c = b - corner, c - corner
        normals.append(_cross(to_b, to_c))
        sizes.append(_length(normals[-1]))
        longest = np.maximum(np.maximum(_length(to_b), _length(to_c)), side)
        heights.append(sizes[-1] / np.maximum(longest, 1e-300))
    up = (normals[0] * normals[1]).sum(axis=0) > TURN * sizes[0] * sizes[1]
    found: Bools = up & (heights[1] >= np.minimum(least, heights[0]))
    return found


def _cross(a: Floats, b: Floats) -> Floats:
    """Return the cross products of vectors (3, k)."""
    return np.stack(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


def _length(a: Floats) -> Floats:
    """Return the lengths of vectors (3, k), (k,)."""
    return np.asarray(np.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]))


def planes_of(points: Points, corners: Ints) -> Floats:
    """Return sums over the triangles of each vertex, by area, of 1, nn, -(np) n and (np)².

    n is the normal of a triangle, p a point of it; of nn the upper half; shape (v, 1 + 6 + 3 + 1).
    """
    a, b, c = (points[corner].T for corner in corners)
    normal = _cross(b - a, c - a)
    area = _length(normal)
    normal /= np.maximum(area, 1e-300)
    place = (normal * a).sum(axis=0)
    columns = [np.ones(len(area)), *(normal[ROWS] * normal[COLUMNS])]
    columns += [*(-place * normal), place**2]
    sums = [
        sum(np.bincount(corner, area * column, len(points)) for corner in corners)
        for column in columns
    ]
    return np.stack(sums, axis=1)
