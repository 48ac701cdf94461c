"""Where a triangle mesh meets itself: exact, and without any knowledge of how it was made.

Three sieves on pairs of triangles: boxes that overlap; certificates in rounded numbers that two
triangles are apart or that they cross; and, for the few pairs that rounding leaves open, their
intersection in whole numbers.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Protocol, TypeAlias

import numpy as np

from scaffold_cad.arrays import Bools, Edges, Floats, Ints, Points, Triangles
from scaffold_cad.boxes import order_in_space, overlapping_neighbors
from scaffold_cad.errors import MeshError, OptionError
from scaffold_cad.threads import in_order
from scaffold_cad.trianglemesh import TriangleMesh
from scaffold_cad.vectors import dot, normalize, triple

LARGEST_COORDINATE = 1e70
"""Products of four greater lengths would overflow, mm."""

ONE_THREAD = 1 << 15
"""Triangles that are not worth a second thread."""

EXACT_PAIRS_AT_ONCE = 1 << 10
"""Pairs tested in whole numbers before a limit is looked at."""


class Triangulated(Protocol):
    """What has vertices and triangles: a TriangleMesh, a QuadMesh, or the like."""

    @property
    def vertices(self) -> Points:
        """Vertex positions, shape (v, 3), mm."""

    @property
    def triangles(self) -> Triangles:
        """Vertex indices of each triangle, shape (t, 3)."""


def self_intersections(
    mesh: Triangulated,
    *,
    tolerance: float | None = None,
    weld: bool = True,
    limit: int | None = None,
    parts: Ints | None = None,
) -> Edges:
    """Return the pairs of triangles that meet outside the vertices or the edge that they share.

    A triangle is the closed convex hull of its corners: a segment or a point if it has no area.
    Two triangles are a pair if some point of both lies outside the hull of the corners that they
    share. So triangles without a common corner may not even touch; with one, they may share
    nothing else; with two, nothing but the edge between them; and two triangles with the same
    three corners are a pair. Without a tolerance the answer is that of exact arithmetic on the
    float64 coordinates, however close or degenerate the triangles are.

    Parameters
    ----------
    mesh : closed or open, manifold or not
    tolerance : mm, ≥ 0; leave out the pairs that only touch, and those of which one triangle need
        be moved no farther than this for them only to touch. Sheets that a boolean operation
        left on top of each other may cross by rounding errors: 1e-9 leaves these out. Two
        triangles in one plane only touch, so that any tolerance leaves them out
    weld : whether vertices at the very same position are the same corner, so that parts of a
        mesh may touch along equal vertices and edges. If not, corners are the same only where
        their vertex index is, and parts that touch are pairs
    limit : stop after so many pairs, ≥ 1; 1 tells whether there are any
    parts : (t,) intp; the part that each triangle is of, where only pairs within a part matter

    Returns
    -------
    (k, 2) intp, the lower triangle first, in ascending order

    Raises
    ------
    MeshError
        If the triangles are not a proper array of indices, or a coordinate is too large.
    OptionError
        If `tolerance` or `limit` is out of its range.

    Notes
    -----
    The cost is O(t log t) and the pairs of triangles with overlapping boxes, of which a vertex of
    valence d brings d²/2.
    """
    if tolerance is not None and not 0 <= tolerance < np.inf:
        raise OptionError(f"tolerance is {tolerance:g} mm; need >= 0")
    if limit is not None and limit < 1:
        raise OptionError(f"limit is {limit} pairs; need at least 1")
    checked = TriangleMesh(mesh.vertices, mesh.triangles)
    _check_size(checked)
    # What is looked up together is then together in the cache.
    order = order_in_space(*_boxes(checked.vertices[checked.triangles]))
    faces = _faces(checked, order, weld)
    found = [np.zeros((0, 2), dtype=np.intp)]
    count = 0
    part = np.zeros(len(order), dtype=np.intp) if parts is None else parts[order]
    for block in _meeting_pairs(faces, part, tolerance):
        found.append(block)
        count += len(block)
        if limit is not None and count >= limit:
            break
    pairs = np.sort(order[np.concatenate(found)[:limit]], axis=1)
    return pairs[np.lexsort(pairs.T[::-1])]


@dataclass(frozen=True, eq=False)
class _Faces:
    """The triangles in their order in space, with what the sieves need of each."""

    corners: Floats
    """Positions, shape (t, 3, 3), mm."""
    labels: Ints
    """What tells corners apart: the number of the position or of the vertex, shape (3, t).

    A corner that repeats an earlier one of its triangle has a label < 0 that no other has.
    """
    corner_count: Ints
    """Number of corners that repeat no other, shape (t,)."""
    normals: Floats
    """Cross product of two edges, shape (t, 3), mm²."""
    reach: Floats
    """Largest coordinate difference of two corners, shape (t,), mm."""
    centers: Floats
    """Mean of the corners, shape (t, 3), mm."""
    bisectors: Floats
    """Sum of the unit vectors from each corner to the two others, shape (t, 3, 3)."""

    def corner(self, rows: Ints, number: Ints | int) -> Points:
        """Return one corner of each triangle in `rows` (k,), shape (k, 3), mm."""
        return _picked(self.corners, rows, number)

    def edge(self, rows: Ints, number: int) -> Floats:
        """Return the edge that ends at a corner of each triangle in `rows` (k,), (k, 3), mm."""
        return self.corner(rows, number) - self.corner(rows, (number + 2) % 3)


def _check_size(mesh: TriangleMesh) -> None:
    far = np.flatnonzero((np.abs(mesh.vertices) > LARGEST_COORDINATE).any(axis=1))
    if len(far):
        place = mesh.vertices[far[0]].tolist()
        raise MeshError(f"vertex {far[0]} is at {place} mm; need at most {LARGEST_COORDINATE:g}")


def _faces(mesh: TriangleMesh, order: Ints, weld: bool) -> _Faces:
    triangles = mesh.triangles[order]
    corners = mesh.vertices[triangles]
    numbers = _position_numbers(mesh.vertices) if weld else np.arange(len(mesh.vertices))
    labels = np.ascontiguousarray(numbers[triangles].T)  # or each look-up would copy it all
    repeats = np.zeros(labels.shape, dtype=np.bool_)
    repeats[1] = labels[1] == labels[0]
    repeats[2] = (labels[2] == labels[0]) | (labels[2] == labels[1])
    labels[repeats] = -1 - np.flatnonzero(repeats)
    edges = np.roll(corners, -1, axis=1) - corners  # (t, 3, 3)
    along = normalize(edges)
    return _Faces(
        corners=corners,
        labels=labels,
        corner_count=3 - repeats.sum(axis=0),
        normals=np.cross(edges[:, 0], edges[:, 1]),
        reach=np.abs(edges).max(axis=(1, 2)),
        centers=(corners[:, 0] + corners[:, 1] + corners[:, 2]) / 3.0,
        bisectors=along - np.roll(along, 1, axis=1),
    )


def _position_numbers(vertices: Points) -> Ints:
    """Return the number of each vertex's position, the same for equal positions, shape (v,)."""
    order = np.lexsort(vertices.T)
    ordered = vertices[order]
    numbers = np.zeros(len(vertices), dtype=np.intp)
    numbers[order[1:]] = np.cumsum((ordered[1:] != ordered[:-1]).any(axis=1))
    return numbers


def _picked(rows_of_three: Floats, rows: Ints, number: Ints | int) -> Floats:
    """Return `rows_of_three[rows, number]`, shape (k, 3); three times as fast as that."""
    return np.take(rows_of_three.reshape(-1, 3), 3 * rows + number, axis=0)


def _meeting_pairs(faces: _Faces, part: Ints, tolerance: float | None) -> Iterator[Edges]:
    """Yield blocks of the pairs of triangles that meet where they may not, shape (k, 2)."""

    def left_open(block: tuple[Ints, Ints]) -> tuple[Edges, Bools]:
        return _neither_apart_nor_crossing(faces, part, tolerance, *block)

    blocks = overlapping_neighbors(*_boxes(faces.corners))
    several = len(part) > ONE_THREAD
    for pairs, sure in (in_order if several else map)(left_open, blocks):
        yield pairs[sure]
        unsure = pairs[~sure]
        for start in range(0, len(unsure), EXACT_PAIRS_AT_ONCE):
            some = unsure[start : start + EXACT_PAIRS_AT_ONCE]
            meets = [_meets_exactly(faces, i, j) for i, j in some.tolist()]
            yield some[np.array(meets)]


def _neither_apart_nor_crossing(
    faces: _Faces, part: Ints, tolerance: float | None, i: Ints, j: Ints
) -> tuple[Edges, Bools]:
    """Return the pairs not surely apart, shape (k, 2), and which of them surely meet, (k,)."""
    together = part[i] == part[j]
    i, j, same = _left_open(faces, i[together], j[together])
    if tolerance is not None:
        deep = _depth(faces, i, j) > tolerance
        i, j, same = i[deep], j[deep], same[deep]
    sure = same | _pierces(faces, i, j) | _pierces(faces, j, i)
    return np.stack([i, j], axis=1), sure


def _boxes(corners: Floats) -> tuple[Points, Points]:
    """Return the lowest and highest coordinates of triangles (t, 3, 3), shapes (t, 3)."""
    a, b, c = (corners[:, k] for k in range(3))
    return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)


# ---------------------------------------------------------------------------------------------
# Second sieve: certificates in rounded numbers
# ---------------------------------------------------------------------------------------------

_ROUNDING = 2.0**-45
"""Bound on the rounding error of any expression below, relative to its largest term.

With u = 2**-53, differences of coordinates are off by u, so the cross product of two edges no
longer than E by 8 u E², its product with an offset C by 48 u E² C, and the product of two such
cross products by 132 u E⁴; projections of a span S on an axis A, taken as it is, by 12 u A S.
"""
_UNDERFLOW = 1e-180
"""Bound on what underflow adds to that error, given `LARGEST_COORDINATE`."""

_OTHER_CORNERS = np.array([[1, 2], [2, 0], [0, 1]])
_AXIS_COUNT = 1 + 2 + 6 + 9  # see `_axis`


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


def _left_open(faces: _Faces, i: Ints, j: Ints) -> tuple[Ints, Ints, Bools]:
    """Return the pairs not surely apart, shapes (k,), and whether all their corners are shared."""
    shared, pairs = _by_shared_corners(faces, i, j)
    same = shared == 3
    left_open = same.copy()
    for count, is_apart in enumerate((_is_apart, _is_apart_at_corner, _is_apart_at_edge)):
        rows = np.flatnonzero(shared == count)
        left_open[rows] = ~is_apart(faces, pairs[rows])
    return i[left_open], j[left_open], same[left_open]


def _by_shared_corners(faces: _Faces, i: Ints, j: Ints) -> tuple[Ints, _Pairs]:
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


def _is_apart_at_edge(faces: _Faces, pairs: _Pairs) -> Bools:
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


def _is_apart_at_corner(faces: _Faces, pairs: _Pairs) -> Bools:
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
    axis = _picked(faces.bisectors, i, at_i) - _picked(faces.bisectors, j, at_j)
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


def _is_apart(faces: _Faces, pairs: _Pairs) -> Bools:
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


def _axis(faces: _Faces, i: Ints, j: Ints, number: int) -> Floats:
    """Return one of the axes on which two triangles must be disjoint if they do not meet, (k, 3).

    These are their normals, the normals of their edges in their planes, and the common normals
    of their edges; but first the line between their centres, which most often is one.
    """
    if number == 0:
        return faces.centers[j] - faces.centers[i]
    if number <= 2:
        return faces.normals[(i, j)[number - 1]]
    if number <= 8:
        side, which = divmod(number - 3, 2)
        one = (i, j)[which]
        return np.cross(faces.edge(one, side), faces.normals[one])
    side_i, side_j = divmod(number - 9, 3)
    return np.cross(faces.edge(i, side_i), faces.edge(j, side_j))


def _overlap(faces: _Faces, i: Ints, j: Ints, axis: Floats) -> Floats:
    """Return how far two triangles overlap along `axis` (k, 3), in units of its length, (k,).

    It is below 0 if there is a gap between them.
    """
    base = faces.corner(i, 0)[:, None]
    first = _along(np.take(faces.corners, i, axis=0) - base, axis)  # (3, k)
    second = _along(np.take(faces.corners, j, axis=0) - base, axis)
    overlap: Floats = np.minimum(
        first.max(axis=0) - second.min(axis=0), second.max(axis=0) - first.min(axis=0)
    )
    return overlap


def _depth(faces: _Faces, i: Ints, j: Ints) -> Floats:
    """Return how far one of two triangles must be moved for them only to touch, shape (k,), mm."""
    depth = np.full(len(i), np.inf)
    for number in range(_AXIS_COUNT):
        axis = normalize(_axis(faces, i, j, number))
        overlap = _overlap(faces, i, j, axis)
        depth = np.minimum(depth, np.where(axis.any(axis=1), overlap, np.inf))
    return depth


def _pierces(faces: _Faces, one: Ints, other: Ints) -> Bools:
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


# ---------------------------------------------------------------------------------------------
# Third sieve: the intersection in whole numbers
# ---------------------------------------------------------------------------------------------

_Vector: TypeAlias = tuple[int, int, int]
_Point: TypeAlias = tuple[int, int, int, int]
"""Homogeneous coordinates x, y, z, w: the point (x, y, z) / w, with w > 0."""
_HalfSpace: TypeAlias = tuple[int, int, int, int]
"""The points with a x + b y + c z + d w ≥ 0."""

_UNITS: tuple[_Vector, ...] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


def _meets_exactly(faces: _Faces, i: int, j: int) -> bool:
    """Return whether two triangles meet outside the hull of the corners that they share."""
    corners = _whole_numbers(faces.corners[[i, j]])
    polygon: list[_Point] = [(*corner, 1) for corner in corners[:3]]
    for half_space in _half_spaces(*corners[3:]):
        polygon = _clipped(polygon, half_space)
    shared = [corners[k] for k in range(3) if faces.labels[k, i] in faces.labels[:, j]]
    if not shared:
        return bool(polygon)
    hull = _half_spaces(shared[0], shared[-1], shared[-1])  # at most two differ here
    return any(_height(half_space, point) < 0 for half_space in hull for point in polygon)


def _whole_numbers(positions: Floats) -> list[_Vector]:
    """Return rows of three of `positions`, times the power of two that makes them all whole."""
    ratios = [value.as_integer_ratio() for value in positions.reshape(-1).tolist()]
    scale = max(denominator for _, denominator in ratios)
    whole = iter([numerator * (scale // denominator) for numerator, denominator in ratios])
    return list(zip(whole, whole, whole, strict=True))


def _half_spaces(a: _Vector, b: _Vector, c: _Vector) -> list[_HalfSpace]:
    """Return half-spaces that have just the triangle, segment or point abc in common."""
    normal = _cross(_minus(b, a), _minus(c, a))
    if any(normal):
        sides = ((a, b), (b, c), (c, a))
        inward = [_half_space(_cross(normal, _minus(q, p)), p) for p, q in sides]
        return [*_plane(normal, a), *inward]
    start, end = max(combinations((a, b, c), 2), key=_squared_distance)
    along = _minus(end, start)
    if not any(along):
        return [half_space for unit in _UNITS for half_space in _plane(unit, start)]
    line = [half_space for unit in _UNITS for half_space in _plane(_cross(along, unit), start)]
    return [*line, _half_space(along, start), _half_space(_minus(start, end), end)]


def _plane(normal: _Vector, place: _Vector) -> list[_HalfSpace]:
    """Return the two half-spaces that have just the plane through `place` in common."""
    a, b, c, d = _half_space(normal, place)
    return [(a, b, c, d), (-a, -b, -c, -d)]


def _half_space(inward: _Vector, place: _Vector) -> _HalfSpace:
    """Return the half-space bounded by a plane through `place` on the side of `inward`."""
    return (*inward, -_dot(inward, place))


def _clipped(polygon: list[_Point], half_space: _HalfSpace) -> list[_Point]:
    """Return the corners of the part of a convex polygon that lies in a half-space."""
    heights = [_height(half_space, point) for point in polygon]
    inside: list[_Point] = []
    for k, (point, height) in enumerate(zip(polygon, heights, strict=True)):
        before, start = polygon[k - 1], heights[k - 1]
        if start < 0 < height or height < 0 < start:
            s, t = abs(height), abs(start)
            x, y, z, w = (s * p + t * q for p, q in zip(before, point, strict=True))
            inside.append((x, y, z, w))
        if height >= 0:
            inside.append(point)
    return inside


def _height(half_space: _HalfSpace, point: _Point) -> int:
    """Return a positive multiple of the height of `point` above the plane of `half_space`."""
    a, b, c, d = half_space
    x, y, z, w = point
    return a * x + b * y + c * z + d * w


def _squared_distance(ends: tuple[_Vector, _Vector]) -> int:
    span = _minus(*ends)
    return _dot(span, span)


def _minus(a: _Vector, b: _Vector) -> _Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _dot(a: _Vector, b: _Vector) -> int:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: _Vector, b: _Vector) -> _Vector:
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )
