"""Array types by role, and the checks that give them.

Every array kept by a public object went through one of the `as_…` functions: it is a
C-contiguous, read-only copy of a known dtype and shape, and its values are finite.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scaffold_cad.errors import MeshError, OptionError, SkeletonError

Floats: TypeAlias = NDArray[np.float64]
"""Real numbers of any shape."""
Ints: TypeAlias = NDArray[np.intp]
"""Indices of any shape."""
Bools: TypeAlias = NDArray[np.bool_]
"""Truth values of any shape."""
Points: TypeAlias = NDArray[np.float64]
"""Positions, shape (n, 3), mm."""
UnitVectors: TypeAlias = NDArray[np.float64]
"""Directions of length 1, shape (..., 3)."""
Frames: TypeAlias = NDArray[np.float64]
"""Orthonormal frames, shape (k, 3, 3), rows x, y, z."""
Edges: TypeAlias = NDArray[np.intp]
"""Node pairs, shape (m, 2)."""
Quads: TypeAlias = NDArray[np.intp]
"""Vertex indices, shape (f, 4), counter-clockwise seen from outside."""
Triangles: TypeAlias = NDArray[np.intp]
"""Vertex indices, shape (t, 3), counter-clockwise seen from outside."""
Radii: TypeAlias = NDArray[np.float64]
"""Sphere radii, shape (n,), mm, all > 0."""


def read_only(array: NDArray[np.generic]) -> None:
    """Forbid any further change of `array`."""
    array.setflags(write=False)


def as_points(
    values: ArrayLike, name: str, error: type[SkeletonError] | type[OptionError] = SkeletonError
) -> Points:
    """Return a read-only copy of `values` as (n, 3) float64, all finite.

    Raises
    ------
    SkeletonError, or another `error`
        If the shape is wrong or a coordinate is not finite; the row is named.
    """
    points = as_floats(values, name, error)
    if points.size == 0:
        points = points.reshape(0, 3)
    if points.ndim != 2 or points.shape[1] != 3:
        raise error(f"{name} has shape {points.shape}; need (n, 3)")
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        raise error(f"{name}[{bad[0]}] is {points[bad[0]].tolist()}; need finite numbers")
    read_only(points)
    return points


def as_radii(values: ArrayLike, name: str, count: int) -> Radii:
    """Return a read-only copy of `values` as (count,) float64, all finite and > 0.

    One number stands for all of them.

    Raises
    ------
    SkeletonError
        If the shape is wrong or a radius is not a finite number > 0; the node is named.
    """
    radii = as_floats(values, name)
    if radii.ndim == 0:
        radii = np.full(count, float(radii))
    if radii.shape != (count,):
        raise SkeletonError(f"{name} has shape {radii.shape}; need ({count},), one a node")
    bad = np.flatnonzero(~(np.isfinite(radii) & (radii > 0)))
    if len(bad):
        raise SkeletonError(f"node {bad[0]} has radius {radii[bad[0]]:g} mm; need > 0")
    read_only(radii)
    return radii


def as_edges(values: ArrayLike, name: str, count: int) -> Edges:
    """Return a read-only copy of `values` as (m, 2) intp, all in 0..count-1.

    Raises
    ------
    SkeletonError
        If the shape or the type is wrong or an index is out of range; the edge is named.
    """
    edges = _as_index(values, name, width=2, error=SkeletonError)
    bad = np.flatnonzero(((edges < 0) | (edges >= count)).any(axis=1))
    if len(bad):
        pair = edges[bad[0]].tolist()
        raise SkeletonError(f"{name}[{bad[0]}] joins nodes {pair}; need 0 to {count - 1}")
    read_only(edges)
    return edges


def as_quads(values: ArrayLike, name: str, count: int) -> Quads:
    """Return a read-only copy of `values` as (f, 4) intp, all in 0..count-1.

    Raises
    ------
    MeshError
        If the shape or the type is wrong or an index is out of range; the quad is named.
    """
    quads = _as_index(values, name, width=4, error=MeshError)
    bad = np.flatnonzero(((quads < 0) | (quads >= count)).any(axis=1))
    if len(bad):
        row = quads[bad[0]].tolist()
        raise MeshError(f"{name}[{bad[0]}] has vertices {row}; need 0 to {count - 1}")
    read_only(quads)
    return quads


def as_floats(
    values: ArrayLike, name: str, error: type[SkeletonError] | type[OptionError] = SkeletonError
) -> Floats:
    """Return a copy of `values` as float64 of any shape, finite or not.

    Raises
    ------
    SkeletonError, or another `error`
        If they are not numbers.
    """
    try:
        raw = np.asarray(values)
        if raw.dtype.kind in "SU":
            raise TypeError(f"it holds text, {raw.reshape(-1)[0]!s:.40}")
        if values is None:  # numpy makes it nan
            raise TypeError("it is None")
        return np.array(raw, dtype=np.float64, order="C")
    except (TypeError, ValueError, OverflowError) as reason:
        raise error(f"{name} is not an array of numbers: {reason}") from None


def _as_index(
    values: ArrayLike, name: str, width: int, error: type[SkeletonError] | type[MeshError]
) -> Ints:
    try:
        raw = np.asarray(values)
    except ValueError as reason:
        raise error(f"{name} is not an array of indices: {reason}") from None
    if raw.size == 0:
        raw = np.zeros((0, width), dtype=np.intp)
    if raw.dtype.kind not in "iu":
        raise error(f"{name} has dtype {raw.dtype}; need whole numbers")
    if raw.ndim != 2 or raw.shape[1] != width:
        raise error(f"{name} has shape {raw.shape}; need (n, {width})")
    return np.array(raw, dtype=np.intp, order="C")
