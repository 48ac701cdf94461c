"""The intersection of two triangles in whole numbers: slow, and never wrong."""

from __future__ import annotations

from itertools import combinations
from typing import TypeAlias

from scaffold_cad.base.arrays import Floats
from scaffold_cad.mesh.intersections.faces import Faces

_Vector: TypeAlias = tuple[int, int, int]
_Point: TypeAlias = tuple[int, int, int, int]
"""Homogeneous coordinates x, y, z, w: the point (x, y, z) / w, with w > 0."""
_HalfSpace: TypeAlias = tuple[int, int, int, int]
"""The points with a x + b y + c z + d w ≥ 0."""

_UNITS: tuple[_Vector, ...] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


def meet_exactly(faces: Faces, i: int, j: int) -> bool:
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
