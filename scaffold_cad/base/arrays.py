"""Array types by role, the checks that give them, and the base of what keeps them.

Every array that a caller gives to a public object goes through one of the `as_…` functions: what
is kept is a C-contiguous, read-only copy of a known dtype and shape, and its values are finite.
Points and faces that are such an array already, as those of other meshes, are kept as they are.
`Frozen` makes all other arrays of such objects read-only too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sized
from functools import cached_property, wraps
from typing import Any, TypeAlias, TypeGuard, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scaffold_cad.base.placements import numbers_of
from scaffold_cad.errors import MeshError, OptionError, ScaffoldCadError, SkeletonError

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

LARGEST_COORDINATE = 1e12
"""Largest coordinate or radius of a node that is believed, mm: a million km."""

WRITTEN = str | bytes | bool | int | float | complex | None
"""What messages repeat as it is written; of all else they name the type."""

LARGEST_WHOLE = 2.0**53
"""Whole numbers below it are all float64."""

_Array = TypeVar("_Array", bound=np.ndarray[Any, Any])
_Value = TypeVar("_Value")
_Kind = TypeVar("_Kind", bound=np.generic)


def read_only(array: _Array) -> _Array:
    """Return `array` itself, which nobody may write to from now on."""
    array.setflags(write=False)
    return array


def is_locked(values: ArrayLike, kind: type[_Kind]) -> TypeGuard[NDArray[_Kind]]:
    """Return whether `values` are an array of a kind that nobody may write to: it needs no copy.

    It has its numbers to itself, in their usual order.
    """
    if type(values) is not np.ndarray or values.dtype != kind:
        return False
    return values.base is None and not values.flags.writeable and values.flags.c_contiguous


class Frozen:
    """Base of the dataclasses that keep arrays: none of these may be written to.

    That holds for fields and cached properties, for copies, and for what is read with pickle.
    They are printed by their shapes.
    """

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        cls.__repr__ = Frozen.__repr__  # type: ignore[method-assign]  # or dataclass makes its own
        for attribute in vars(cls).values():
            if isinstance(attribute, cached_property):
                attribute.func = _with_locked_result(attribute.func)

    def __post_init__(self) -> None:
        self._keep(**vars(self))

    def __repr__(self) -> str:
        fields = getattr(self, "__dataclass_fields__", {})
        values = ", ".join(f"{name}={_shown(getattr(self, name))}" for name in fields)
        return f"{type(self).__name__}({values})"

    def __setstate__(self, state: dict[str, Any]) -> None:
        # Arrays that were copied or pickled may be written to again.
        self._keep(**state)

    def _keep(self, **values: Any) -> None:
        """Set attributes, whose arrays are read-only from now on."""
        vars(self).update({name: _locked(value) for name, value in values.items()})


def _shown(value: object) -> str:
    """Return how a field is printed: an array by its shape and kind."""
    if isinstance(value, np.ndarray):
        return f"<{' × '.join(map(str, value.shape))} {value.dtype.name}>"
    return repr(value)


def _locked(value: _Value) -> _Value:
    """Return `value` itself; if it is an array, or arrays are in a tuple, they are read-only."""
    for item in value if isinstance(value, tuple) else (value,):
        if isinstance(item, np.ndarray):
            read_only(item)
    return value


def _with_locked_result(compute: Callable[[Any], _Value]) -> Callable[[Any], _Value]:
    @wraps(compute)
    def computed(owner: Any) -> _Value:
        return _locked(compute(owner))

    return computed


def as_points(
    values: ArrayLike, name: str, error: type[ScaffoldCadError] = SkeletonError
) -> Points:
    """Return a read-only copy of `values` as (n, 3) float64, all finite; see `is_locked`.

    Raises
    ------
    SkeletonError, or another `error`
        If the shape is wrong or a coordinate is not finite; the row is named.
    """
    points = values if is_locked(values, np.float64) else as_floats(values, name, error)
    if points.size == 0:
        points = points.reshape(0, 3)
    if points.ndim != 2 or points.shape[1] != 3:
        raise error(f"{name} has shape {points.shape}; need (n, 3)")
    finite = np.isfinite(points)
    if not finite.all():
        bad = np.flatnonzero(~finite.all(axis=1))
        raise error(f"{name}[{bad[0]}] is {points[bad[0]].tolist()}; need finite numbers")
    return read_only(points)


def place_text(point: Floats) -> str:
    """Return a place, (3,), as messages have it.

    >>> place_text(np.array([-1e-17, 1 / 3, 20000.0]))
    '[0, 0.333333, 20000] mm'
    """
    rounded = np.round(point, 9) + 0.0  # no -0
    return "[" + ", ".join(f"{value:.6g}" for value in rounded.tolist()) + "] mm"


def as_radii(values: ArrayLike, name: str, count: int, places: Points | None = None) -> Radii:
    """Return a read-only copy of `values` as (count,) float64, all finite and > 0.

    One number stands for all of them.

    Raises
    ------
    SkeletonError
        If the shape is wrong or a radius is not a finite number > 0; the node is named, and its
        place, where `places` (count, 3), mm, are given.
    """
    radii = as_floats(values, name)
    if radii.ndim == 0:
        radii = np.full(count, float(radii))
    if radii.shape != (count,):
        raise SkeletonError(f"{name} has shape {radii.shape}; need ({count},), one per node")
    bad = np.flatnonzero(~(np.isfinite(radii) & (radii > 0)))
    if len(bad):
        at = "" if places is None else f" at {place_text(places[bad[0]])}"
        finite = " and finite" if radii[bad[0]] == np.inf else ""
        raise SkeletonError(f"node {bad[0]}{at} has radius {radii[bad[0]]:g} mm; need > 0{finite}")
    return read_only(radii)


def as_edge_radii(values: ArrayLike, name: str, count: int, places: Points | None = None) -> Floats:
    """Return a read-only copy of `values` as (count, 2) float64, all finite and > 0.

    One number stands for all of them, and one per row, (count,), for both ends of an edge.

    Raises
    ------
    SkeletonError
        If the shape is wrong or a radius is not a finite number > 0; the edge is named, and its
        middle, where `places` (count, 3), mm, are given.
    """
    radii = as_floats(values, name)
    if radii.ndim == 0:
        radii = np.full((count, 2), float(radii))
    elif radii.shape == (count,):
        radii = np.stack([radii, radii], axis=1)
    if radii.shape != (count, 2):
        raise SkeletonError(f"{name} has shape {radii.shape}; need ({count}, 2), two per edge")
    bad = np.flatnonzero(~(np.isfinite(radii) & (radii > 0)).all(axis=1))
    if len(bad):
        at = "" if places is None else f" near {place_text(places[bad[0]])}"
        finite = " and finite" if np.inf in radii[bad[0]] else ""
        raise SkeletonError(
            f"edge {bad[0]}{at} has radii {radii[bad[0]].tolist()} mm; need > 0{finite}"
        )
    return read_only(radii)


def check_believable(values: Floats, what: str) -> None:
    """Raise if a coordinate or a radius of a node is beyond `LARGEST_COORDINATE`.

    Parameters
    ----------
    values : (n,) or (n, 3) float64, mm, of n nodes; nan passes
    what : they are, such as "is at", for the message

    Raises
    ------
    SkeletonError
        If one is; the node is named.
    """
    far = np.argwhere(np.abs(values) > LARGEST_COORDINATE)
    if len(far):
        node = far[0, 0]
        found = values[node].tolist()
        raise SkeletonError(f"node {node} {what} {found} mm; need at most {LARGEST_COORDINATE:g}")


def as_edges(values: ArrayLike, name: str, count: int) -> Edges:
    """Return a read-only copy of `values` as (m, 2) intp, all in 0..count-1.

    Raises
    ------
    SkeletonError
        If the shape or the type is wrong or an index is out of range; the edge is named.
    """
    return _as_rows(values, name, 2, count, "joins nodes", SkeletonError)


def as_quads(values: ArrayLike, name: str, count: int) -> Quads:
    """Return a read-only copy of `values` as (f, 4) intp, all in 0..count-1.

    Raises
    ------
    MeshError
        If the shape or the type is wrong or an index is out of range; the quad is named.
    """
    return _as_rows(values, name, 4, count, "has vertices", MeshError)


def as_triangles(values: ArrayLike, name: str, count: int) -> Triangles:
    """Return a read-only copy of `values` as (t, 3) intp, all in 0..count-1, see `as_quads`."""
    return _as_rows(values, name, 3, count, "has vertices", MeshError)


def as_chosen(values: ArrayLike, name: str, count: int) -> Ints:
    """Return the items, of `count`, that are chosen by number or by mark, shape (k,).

    Raises
    ------
    OptionError
        If `values` are neither whole numbers in 0..count-1 nor as many truth values as items.
    """
    given = _as_array(values, name, OptionError)
    if given.dtype == np.bool_:
        if given.shape != (count,):
            raise OptionError(f"{name} has shape {given.shape}; need ({count},), a mark each")
        return np.flatnonzero(given)
    numbers = as_indices(given, name, OptionError)
    if numbers.ndim != 1:
        raise OptionError(f"{name} has shape {numbers.shape}; need (k,)")
    bad = np.flatnonzero((numbers < 0) | (numbers >= count))
    if len(bad):
        raise OptionError(f"{name}[{bad[0]}] is {numbers[bad[0]]}; need 0 to {count - 1}")
    return numbers


def as_floats(
    values: ArrayLike, name: str, error: type[ScaffoldCadError] = SkeletonError
) -> Floats:
    """Return a copy of `values` as float64 of any shape, finite or not.

    Raises
    ------
    SkeletonError, or another `error`
        If they are not real numbers.
    """
    values = _listed(values)
    _check_unmasked(values, name, error)
    try:
        raw = _as_one_array(values)
        if raw.dtype.kind in "SU":
            raise TypeError(f"it holds text, {raw.reshape(-1)[0]!s:.40}")
        if raw.dtype.kind == "c":  # numpy would drop the imaginary parts
            raise TypeError("it holds complex numbers")
        if values is None:  # numpy makes it nan
            raise TypeError("it is None")
        _check_real(raw)
        return np.array(raw, dtype=np.float64, order="C")
    except (TypeError, ValueError, OverflowError) as reason:
        why = _uneven(values) or reason
        raise error(f"{name} is not an array of numbers: {why}") from None


def _listed(values: ArrayLike) -> ArrayLike:
    """Return `values`, or the list of what an iterator gives, if it is one."""
    return list(values) if isinstance(values, Iterator) else values


def _check_unmasked(values: ArrayLike, name: str, error: type[ScaffoldCadError]) -> None:
    """Raise if numpy's mask hides an item, which a plain array would show; the first is named."""
    rows: list[Any] = list(values) if isinstance(values, list | tuple) else [values]
    if not any(issubclass(kind, np.ma.MaskedArray) for kind in set(map(type, rows))):
        return
    hidden = [np.ma.getmaskarray(row) for row in rows]
    first = next((k for k, mask in enumerate(hidden) if mask.any()), None)
    if first is None:
        return
    item = np.argwhere(hidden[first])[0].tolist()
    at = [first, *item] if isinstance(values, list | tuple) else item
    raise error(f"{name}{at} is masked; need a number, or an array without that item")


def _as_one_array(values: ArrayLike) -> NDArray[Any]:
    """Return `values` as an array: build123d's Vector and the like, or rows of these."""
    values = numbers_of(values)
    if isinstance(values, list | tuple):
        rows: list[Any] = list(values)
        vectors = {kind for kind in set(map(type, rows)) if _are_vectors(kind)}
        if vectors:
            return np.array(
                [tuple(numbers_of(row)) if type(row) in vectors else row for row in rows]
            )
    return np.asarray(values)


def _check_real(raw: NDArray[Any]) -> None:
    """Raise a TypeError if one of an array of objects is no number; numpy makes None nan."""
    objects: Iterable[Any] = raw.flat if raw.dtype == np.object_ else ()
    odd = next((one for one in objects if not (hasattr(one, "__float__") or one is None)), None)
    if odd is not None:
        what = "holds items" if raw.ndim else "is"
        raise TypeError(f"it {what} of type {type(odd).__name__}; need numbers")


def _are_vectors(kind: type) -> bool:
    return issubclass(kind, Iterable) and not issubclass(kind, Sized)


def as_indices(values: ArrayLike, name: str, error: type[ScaffoldCadError]) -> Ints:
    """Return a copy of `values` as intp of any shape, in any range; no values are (0,).

    Raises
    ------
    `error`
        If they are not whole numbers.
    """
    raw = _as_array(values, name, error)
    if raw.size and raw.dtype.kind == "f":  # as text files are read
        bad = raw[~(raw == np.floor(raw)) | ~(np.abs(raw) < LARGEST_WHOLE)]
        if bad.size:
            raise error(f"{name} holds {bad[0]}; need whole numbers")
    elif raw.size and raw.dtype.kind == "u":
        if raw.max() >= LARGEST_WHOLE:
            raise error(f"{name} holds {raw.max()}; need whole numbers below {LARGEST_WHOLE:.2g}")
    elif raw.size and raw.dtype.kind != "i":
        items = raw.reshape(-1).tolist()
        odd = next((item for item in items if not _is_index(item)), items[0])
        below = f" below {LARGEST_WHOLE:.2g}" if type(odd) is int else ""
        shown = (
            repr(odd)[:40] if isinstance(odd, WRITTEN) else f"items of type {type(odd).__name__}"
        )
        raise error(f"{name} holds {shown}; need whole numbers{below}")
    return np.array(raw, dtype=np.intp, order="C")


def _is_index(item: object) -> bool:
    return isinstance(item, int) and not isinstance(item, bool) and abs(item) < LARGEST_WHOLE


def _uneven(values: ArrayLike) -> str:
    """Return which row has another length than the first, "" where none has."""
    rows: list[Any] = list(values) if isinstance(values, list | tuple) else []
    sizes = [len(row) if isinstance(row, Sized) else 0 for row in rows]
    odd = next((k for k, size in enumerate(sizes) if size != sizes[0]), None)
    if odd is None or isinstance(rows[odd], str):
        return ""
    return f"row {odd} is {rows[odd]!r:.40}, and row 0 is {rows[0]!r:.40}"


def _as_array(values: ArrayLike, name: str, error: type[ScaffoldCadError]) -> NDArray[Any]:
    values = _listed(values)
    _check_unmasked(values, name, error)
    try:
        return np.asarray(values)
    except ValueError as reason:
        raise error(f"{name} is not an array of indices: {_uneven(values) or reason}") from None


def _as_rows(
    values: ArrayLike, name: str, width: int, count: int, verb: str, error: type[ScaffoldCadError]
) -> Ints:
    """Return a read-only copy of `values` as (n, width) intp, all in 0..count-1."""
    rows = values if is_locked(values, np.intp) else as_indices(values, name, error)
    if rows.size == 0:
        rows = rows.reshape(0, width)
    if rows.ndim != 2 or rows.shape[1] != width:
        raise error(f"{name} has shape {rows.shape}; need (n, {width})")
    if rows.size and (rows.min() < 0 or rows.max() >= count):
        bad = np.flatnonzero(((rows < 0) | (rows >= count)).any(axis=1))
        found = rows[bad[0]].tolist()
        raise error(f"{name}[{bad[0]}] {verb} {found}; need 0 to {count - 1}")
    return read_only(rows)
