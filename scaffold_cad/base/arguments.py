"""Checks of what callers pass: what kind of object it is, and that a number is one."""

from __future__ import annotations

from collections.abc import Iterable
from numbers import Integral, Real
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from scaffold_cad.errors import OptionError

WAYS = {
    ("Skeleton", "Scaffold"): "build_scaffold(skeleton) makes one",
    ("Skeleton", "QuadMesh"): "build_scaffold(skeleton).mesh is one",
    ("Skeleton", "ConvolutionField"): "ConvolutionField(skeleton) is one",
    ("Scaffold", "Patches"): "smooth_patches(scaffold) makes them",
    ("Scaffold", "Skeleton"): "scaffold.skeleton is one",
    ("Scaffold", "QuadMesh"): "scaffold.mesh is one",
    ("Subdivision", "QuadMesh"): "subdivision.mesh is one",
    ("Cleaning", "Skeleton"): "cleaning.skeleton is one",
    ("Solidified", "Manifold"): "solidified.manifold is one",
}
"""How to get what is needed from what is often given in its place, by the names of both."""


def check_kind(what: object, *kinds: type | str) -> None:
    """Raise unless `what` is of one of `kinds`.

    Parameters
    ----------
    kinds : classes; names of classes of packages that need not be loaded are only told of

    Raises
    ------
    OptionError
        If it is of none; the message tells how to make one of them of it, where that is known.
    """
    if isinstance(what, tuple(kind for kind in kinds if not isinstance(kind, str))):
        return
    found = type(what).__name__
    names = [kind if isinstance(kind, str) else kind.__name__ for kind in kinds]
    ways = [WAYS[found, name] for name in names if (found, name) in WAYS]
    hint = f": {ways[0]}" if ways else ""
    raise OptionError(f"got {_described(what)}; need a {' or a '.join(names)}{hint}")


def check_choice(value: object, name: str, known: Iterable[str]) -> None:
    """Raise unless `value`, of that name, is one of the `known` ones.

    Raises
    ------
    OptionError
        If it is none.
    """
    if not isinstance(value, str) or value not in known:
        raise OptionError(f"{name} is {value!r}; need one of {', '.join(known)}")


def as_path(value: Any, name: str = "path") -> Path:
    """Return `value`, of that name, as a path.

    Raises
    ------
    OptionError
        If it is neither a str nor a Path.
    """
    if not isinstance(value, str | PathLike):
        raise OptionError(f"{name} is {_described(value)}; need a str or a Path")
    return Path(value)


def as_flag(value: Any, name: str) -> bool:
    """Return `value` as a bool.

    Raises
    ------
    OptionError
        If it is none.
    """
    if not isinstance(value, bool | np.bool_):
        raise OptionError(f"{name} is {_described(value)}; need True or False")
    return bool(value)


def as_number(
    value: Any, name: str, *, unit: str = " mm", or_zero: bool = False, hint: str = ""
) -> float:
    """Return `value` as a finite float > 0, or ≥ 0 with `or_zero`.

    Parameters
    ----------
    name, unit : of the value, for the message
    hint : what else is taken in place of a number, such as ", or a function of positions"

    Raises
    ------
    OptionError
        If it is no such number.
    """
    number = as_real(value, name, hint=hint)
    if 0 < number < np.inf or (or_zero and number == 0):
        return number
    raise OptionError(f"{name} is {number:g}{unit}; need {'>=' if or_zero else '>'} 0")


def as_real(value: Any, name: str, *, hint: str = "") -> float:
    """Return `value` as a float, finite or not, see `as_number`."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, bool) or not isinstance(value, Real):
        raise OptionError(f"{name} is {_described(value)}; need a number{hint}")
    try:
        return float(value)
    except OverflowError:
        raise OptionError(f"{name} is beyond 1e308; need a smaller number") from None


def as_count(value: Any, name: str, least: int = 0) -> int:
    """Return `value` as an int that is at least `least`.

    Raises
    ------
    OptionError
        If it is no whole number, or a lower one.
    """
    if isinstance(value, bool) or not isinstance(value, Integral):
        raise OptionError(f"{name} is {_described(value)}; need a whole number")
    if value < least:
        raise OptionError(f"{name} is {value}; need {least} or more")
    return int(value)


def _described(value: object) -> str:
    """Return a number, a text or None as it is written, and what kind of thing any other is."""
    if value is None or isinstance(value, bool | Real | str):
        return repr(value) if isinstance(value, str) else str(value)
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape}"
    article = "an" if type(value).__name__[0] in "AEIOUaeiou" else "a"
    return f"{article} {type(value).__name__}"
