"""Certificates in rounded numbers that two triangles are apart, or that they cross."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points
from scaffold_cad.base.vectors import dot, normalize, triple
from scaffold_cad.mesh.intersections.faces import Faces, picked

_ROUNDING = 2.0**-45
"""Bound on the rounding error of any expression below, relative to its largest term.

With u = 2**-53, differences of coordinates are off by u, so the cross product of two edges no
longer than E by 8 u E², its product with an offset C by 48 u E² C, and the product of two such
cross products by 132 u E⁴; projections of a span S on an axis A, taken as it is, by 12 u A S.
"""
_UNDERFLOW = 1e-180
"""Bound on what underflow adds to that error, given `LARGEST_COORDINATE`."""

_OTHER_CORNERS = np.array([[1, 2], [2, 0], [0, 1]])
_AXIS_COUNT = 2 + 2 + 6 + 9  # see `_axis`


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Pairs of triangles, with the corners that tell how they are joined."""

    i: Ints
    j: Ints
    """The two triangles of each pair, shape (k,)."""
    at_i: Ints
    at_j: Ints
    """The only shared corner of each, or the only one that is not shared, shape (k,)."""

    def __getitem__(self, rows: Ints) -> _Pairs:
        return _Pairs(self.i[rows], self.j[rows], self.at_i[rows], self.at_j[rows])


def left_open(faces: Faces, i: Ints, j: Ints) -> tuple[Ints, Ints, Bools]:
    """Return the pairs not surely apart, shapes (k,), and whether all their corners are shared."""
    shared, pairs = _by_shared_corners(faces, i, j)
    same = shared == 3
    left_open = same.copy()
    for count, is_apart in enumerate((_is_apart, _is_apart_at_corner, _is_apart_at_edge)):
        rows = np.flatnonzero(shared == count)
        left_open[rows] = ~is_apart(faces, pairs[rows])
    return i[left_open], j[left_open], same[left_open]


def _by_shared_corners(faces: Faces, i: Ints, j: Ints) -> tuple[Ints, _Pairs]:
    """Return how many corners the triangles of each pair share, shape (k,), and the pairs.

    It is -1 where one of them has no area and no corner of its own, and so may lie where it does.
    """
    labels_i, labels_j = (np.take(faces.labels, rows, axis=1) for rows in (i, j))
    equal = labels_i[:, None] == labels_j  # (3, 3, k)
    in_j, in_i = equal.any(axis=1), equal.any(axis=0)  # (3, k)
    shared = in_j.sum(axis=0)
    odd_i, odd_j = in_j ^ (shared == 2), in_i ^ (shared == 2)
    pairs = _Pairs(i, j, odd_i[1] + 2 * odd_i[2], odd_j[1] + 2 * odd_j[2])
    fewest = np.minimum(faces.corner_count[i], faces.corner_count[j])
    return np.where((shared == fewest) & (fewest < 3), -1, shared), pairs


def _is_apart_at_edge(faces: Faces, pairs: _Pairs) -> Bools:
    """Return where two triangles with a common edge surely do not lie folded on each other.

    They do not if there is more than a right angle between them, or if their planes differ.
    """
    i, j, tip_i, tip_j = pairs.i, pairs.j, pairs.at_i, pairs.at_j
    start_i = faces.labels[(tip_i + 1) % 3, i]
    start_j = faces.labels[(tip_j + 1) % 3, j]
    opposed = np.where(start_i == start_j, -1.0, 1.0)  # 1 if they run along it opposite ways
    cosine = opposed * dot(faces.normals[i], faces.normals[j])
    apart = np.greater(cosine, _ROUNDING * (faces.reach[i] * faces.reach[j]) ** 2 + _UNDERFLOW)
    rest = np.flatnonzero(~apart)
    a, b, c = (faces.corner(i[rest], k) for k in range(3))
    apart[rest] = _turn(a, b, c, faces.corner(j[rest], tip_j[rest])) != 0
    return apart


def _is_apart_at_corner(faces: Faces, pairs: _Pairs) -> Bools:
    """Return where two triangles with one common corner surely meet nowhere else.

    They do not if a plane through that corner has one triangle strictly on each side: if some
    axis makes acute angles with the two edges from the corner in one triangle and with the two
    reversed ones in the other. If there is one, then so is the middle of the smallest cap of the
    unit sphere that holds the four directions, and two or three of them give that.
    """
    i, j, at_i, at_j = pairs.i, pairs.j, pairs.at_i, pairs.at_j
    others_i = 3 * i[:, None] + np.take(_OTHER_CORNERS, at_i, axis=0)
    others_j = 3 * j[:, None] + np.take(_OTHER_CORNERS, at_j, axis=0)
    ends = np.take(faces.corners.reshape(-1, 3), np.hstack([others_i, others_j]), axis=0)
    rays = ends - faces.corner(i, at_i)[:, None]  # (k, 4, 3)
    np.negative(rays[:, 2:], out=rays[:, 2:])
    span = np.maximum(faces.reach[i], faces.reach[j])
    axis = picked(faces.bisectors, i, at_i) - picked(faces.bisectors, j, at_j)
    apart = _is_acute(axis, rays, span)
    rest = np.flatnonzero(~apart)
    rays, span = rays[rest], span[rest]
    for axis in _cap_middles(normalize(rays)):
        apart[rest] |= _is_acute(axis, rays, span)
        if apart.all():
            break
    return apart


def _cap_middles(directions: Floats) -> Iterator[Floats]:
    """Yield the middle of each two and each three of the `directions` (k, 4, 3), shape (k, 3)."""
    for a, b in combinations(range(4), 2):
        yield directions[:, a] + directions[:, b]
    for a, b, c in combinations(range(4), 3):
        first = directions[:, a]
        middle = np.cross(directions[:, b] - first, directions[:, c] - first)
        yield middle * np.sign(dot(middle, first))[:, None]


def _is_acute(axis: Floats, rays: Floats, span: Floats) -> Bools:
    """Return where `axis` (k, 3) surely makes an acute angle with each of `rays` (k, n, 3).

    No ray is longer than `span` (k,) in any coordinate.
    """
    error = _ROUNDING * _largest(axis) * span + _UNDERFLOW
    acute: Bools = np.all(_along(rays, axis) > error, axis=0)
    return acute


def _is_apart(faces: Faces, pairs: _Pairs) -> Bools:
    """Return where two triangles without common corners surely do not meet.

    They do not if some axis has disjoint projections of them.
    """
    apart = np.zeros(len(pairs.i), dtype=np.bool_)
    for number in range(_AXIS_COUNT):
        rest = np.flatnonzero(~apart)
        if len(rest) == 0:
            break
        i, j = pairs.i[rest], pairs.j[rest]
        axis = _axis(faces, i, j, number)
        span = _largest(faces.corner(j, 0) - faces.corner(i, 0)) + faces.reach[i] + faces.reach[j]
        error = _ROUNDING * _largest(axis) * span + _UNDERFLOW
        apart[rest] = _overlap(faces, i, j, axis) < -error
    return apart


def _axis(faces: Faces, i: Ints, j: Ints, number: int) -> Floats:
    """Return one of the axes on which two triangles must be disjoint if they do not meet, (k, 3).

    These are their normals, the normals of their edges in their planes, and the common normals
    of their edges; but first those two that most often are one: the common normal of their longest
    edges, which parts long thin triangles, and the line between their centers.
    """
    if number == 0:
        return np.cross(faces.longest[i], faces.longest[j])
    if number == 1:
        return faces.centers[j] - faces.centers[i]
    if number <= 3:
        return faces.normals[(i, j)[number - 2]]
    if number <= 9:
        side, which = divmod(number - 4, 2)
        one = (i, j)[which]
        return np.cross(faces.edge(one, side), faces.normals[one])
    side_i, side_j = divmod(number - 10, 3)
    return np.cross(faces.edge(i, side_i), faces.edge(j, side_j))


def _overlap(faces: Faces, i: Ints, j: Ints, axis: Floats) -> Floats:
    """Return how far two triangles overlap along `axis` (k, 3), in units of its length, (k,).

    It is below 0 if there is a gap between them.
    """
    base = faces.corner(i, 0)[:, None]
    first = _along(np.take(faces.corners, i, axis=0) - base, axis)  # (3, k)
    second = _along(np.take(faces.corners, j, axis=0) - base, axis)
    (low, high), (lower, higher) = _span(first), _span(second)
    overlap: Floats = np.minimum(high - lower, higher - low)
    return overlap


def _span(heights: Floats) -> tuple[Floats, Floats]:
    """Return the least and the greatest of three `heights` (3, k); faster than over an axis."""
    a, b, c = heights
    return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)


def depth_of(faces: Faces, i: Ints, j: Ints) -> Floats:
    """Return how far one of two triangles must be moved for them only to touch, shape (k,), mm."""
    depth = np.full(len(i), np.inf)
    for number in range(_AXIS_COUNT):
        axis = normalize(_axis(faces, i, j, number))
        overlap = _overlap(faces, i, j, axis)
        depth = np.minimum(depth, np.where(axis.any(axis=1), overlap, np.inf))
    return depth


def pierces(faces: Faces, one: Ints, other: Ints) -> Bools:
    """Return where an edge of triangle `one` surely passes through the inside of `other`."""
    p, q, r = (faces.corner(other, k) for k in range(3))
    ends = [faces.corner(one, k) for k in range(3)]
    side = [_turn(p, q, r, end) for end in ends]
    pierced = np.zeros(len(one), dtype=np.bool_)
    for k in range(3):
        a, b = ends[k - 1], ends[k]
        around = _turn(a, b, p, q) + _turn(a, b, q, r) + _turn(a, b, r, p)
        pierced |= (side[k - 1] * side[k] < 0) & (np.abs(around) == 3)
    return pierced


def _turn(a: Points, b: Points, c: Points, d: Points) -> Ints:
    """Return the sign of det(b - a, c - a, d - a), 0 where rounding leaves it open, shape (k,)."""
    edges = (b - a, c - a, d - a)
    error = _ROUNDING * _largest(edges[0]) * _largest(edges[1]) * _largest(edges[2]) + _UNDERFLOW
    volume = triple(*edges)
    return (volume > error).astype(np.intp) - (volume < -error)


def _along(offsets: Floats, axis: Floats) -> Floats:
    """Return the products of `offsets` (k, n, 3) with `axis` (k, 3), shape (n, k)."""
    products: Floats = np.einsum("kni,ki->nk", offsets, axis)
    return products


def _largest(vectors: Floats) -> Floats:
    """Return the largest coordinate of `vectors` (k, 3) regardless of sign, shape (k,)."""
    x, y, z = np.abs(vectors).T
    largest: Floats = np.maximum(np.maximum(x, y), z)
    return largest
