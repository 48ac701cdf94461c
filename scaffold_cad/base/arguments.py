"""Checks of what callers pass: what kind of object it is, and that a number is one."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from difflib import get_close_matches
from functools import wraps
from inspect import Parameter, signature
from numbers import Integral, Real
from os import PathLike
from pathlib import Path
from types import FunctionType
from typing import Any, ParamSpec, TypeVar

import numpy as np

from scaffold_cad.base.arrays import (
    LARGEST_COORDINATE,
    LARGEST_WHOLE,
    Floats,
    UnitVectors,
    as_floats,
)
from scaffold_cad.base.placements import DirectionLike, PositionLike, direction_of
from scaffold_cad.errors import KeywordError, OptionError

LIKE = 0.65
"""Ratio of `difflib` from which words are like each other: quiet is not like units."""

LONGEST_TEXT = 80
"""Letters of a text that a message repeats at most."""

FEW = 6
"""Values of a list that a message repeats at most."""

MM = " mm"
"""Unit of lengths, after a number in a message."""

_Given = ParamSpec("_Given")
_Result = TypeVar("_Result")

WAYS = {
    ("Skeleton", "Scaffold"): "build_scaffold(skeleton) makes one",
    ("Skeleton", "QuadMesh"): "build_scaffold(skeleton).mesh is one",
    ("Skeleton", "RoundStruts"): "round_struts(skeleton) makes one",
    ("RoundStruts", "Skeleton"): "struts.skeleton is one",
    ("Skeleton", "ConvolutionField"): "ConvolutionField(skeleton) is one",
    ("Scaffold", "Skeleton"): "scaffold.skeleton is one",
    ("Scaffold", "QuadMesh"): "scaffold.mesh is one",
    ("Subdivision", "QuadMesh"): "subdivision.mesh is one",
    ("Cleaning", "Skeleton"): "cleaning.skeleton is one",
    ("Solidified", "Manifold"): "solidified.manifold is one",
    ("RoundStruts", "Manifold"): "to_solid(struts) is one",
}
"""How to get what is needed from what is often given in its place, by the names of both."""


def check_kind(what: object, *kinds: type | str, name: str = "") -> None:
    """Check that `what`, the argument `name`, is an instance of one of `kinds`.

    Parameters
    ----------
    kinds : classes; a name stands for a class of a package that need not be loaded, and is used
        in the message only
    name : of the argument; left out where it is the first one, what the function is for

    Raises
    ------
    OptionError
        If it is not; the message says how to get one of them from it, where that is known.
    """
    if isinstance(what, tuple(kind for kind in kinds if not isinstance(kind, str))):
        return
    found = type(what).__name__
    names = [kind if isinstance(kind, str) else kind.__name__ for kind in kinds]
    ways = [WAYS[found, kind] for kind in names if (found, kind) in WAYS]
    hint = f": {' or '.join(ways[:2])}" if ways else ""
    given = f"{name} is" if name else "got"
    raise OptionError(f"{given} {described(what)}; need a {' or a '.join(names)}{hint}")


def check_choice(value: object, name: str, known: Iterable[str], *, or_else: str = "") -> None:
    """Check that the argument `name` has one of its `known` values.

    Parameters
    ----------
    or_else : what else is accepted in place of them, for the message

    Raises
    ------
    OptionError
        If it does not; the message has the value that is spelled most like it.
    """
    known = list(known)
    if not isinstance(value, str) or value not in known:
        end = (f", or {or_else}" if or_else else "") + did_you_mean(value, known)
        raise OptionError(f"{name} is {described(value)}; need one of {', '.join(known)}{end}")


def did_you_mean(value: object, known: Iterable[str]) -> str:
    """Return the end of a message with the known word nearest to `value`, or an empty text.

    >>> did_you_mean("colars", ["fit", "section", "collars"])
    "; did you mean 'collars'?"
    """
    if not isinstance(value, str):
        return ""
    by_word = {word.lstrip("-"): word for word in known}  # dashes make no flag like another
    near = get_close_matches(value.lower().lstrip("-"), by_word, n=1, cutoff=LIKE)
    return f"; did you mean {by_word[near[0]]!r}?" if near else ""


def checks_keywords(
    *further: Callable[..., Any],
) -> Callable[[Callable[_Given, _Result]], Callable[_Given, _Result]]:
    """Return a decorator: a wrong keyword raises a `KeywordError` with the nearest known one.

    It takes functions and classes. Of a class `__init__` and the public methods are replaced: the
    class stays the object that it was, so that pickles, subclasses and annotations know it.

    Parameters
    ----------
    further : functions that get the `**options` of the decorated one: their keyword-only
        parameters are known too

    Examples
    --------
    >>> @checks_keywords()
    ... def box(length: float = 1.0) -> float:
    ...     return length
    >>> box(lenght=2.0)
    Traceback (most recent call last):
    ...
    scaffold_cad.errors.KeywordError: box() has no parameter 'lenght'; did you mean 'length'?
    """

    def decorated(called: Callable[_Given, _Result]) -> Callable[_Given, _Result]:
        if not isinstance(called, type):
            # A class is called by its own name, not by that of its `__init__`.
            name = called.__qualname__.removesuffix(".__init__").rpartition(".")[2]
            return _checked(called, name, further)
        whole: Any = called
        whole.__init__ = _checked(whole.__init__, called.__name__, further)
        for name, member in list(vars(called).items()):
            if not name.startswith("_") and isinstance(member, FunctionType):
                setattr(whole, name, _checked(member, name, ()))
            elif not name.startswith("_") and isinstance(member, classmethod | staticmethod):
                setattr(whole, name, type(member)(_checked(member.__func__, name, ())))
        return called

    return decorated


def _checked(
    function: Callable[..., Any], called: str, further: tuple[Callable[..., Any], ...]
) -> Callable[..., Any]:
    """Return `function`, which users know as `called`, with a check of its keywords."""
    own = [
        one.name
        for one in signature(function).parameters.values()
        if one.kind in (Parameter.POSITIONAL_OR_KEYWORD, Parameter.KEYWORD_ONLY)
    ]
    passed_on = [
        one.name
        for other in further
        for one in signature(other).parameters.values()
        if one.kind is Parameter.KEYWORD_ONLY
    ]
    known = dict.fromkeys(name for name in own + passed_on if name not in ("self", "cls"))
    listed = f"one of {', '.join(known)}" if known else "no arguments"

    @wraps(function)
    def checked(*args: Any, **kwargs: Any) -> Any:
        for name in kwargs:
            if name not in known:
                hint = did_you_mean(name, known) or f"; need {listed}"
                raise KeywordError(f"{called}() has no parameter {name!r}{hint}")
        return function(*args, **kwargs)

    return checked


def as_path(value: Any, name: str = "path") -> Path:
    """Return `value`, of that name, as a path.

    Raises
    ------
    OptionError
        If it is neither a str nor a Path.
    """
    if not isinstance(value, str | PathLike):
        raise OptionError(f"{name} is {described(value)}; need a str or a Path")
    return Path(value)


def as_flag(value: Any, name: str) -> bool:
    """Return `value` as a bool.

    Raises
    ------
    OptionError
        If it is not True or False.
    """
    if not isinstance(value, bool | np.bool_):
        raise OptionError(f"{name} is {described(value)}; need True or False")
    return bool(value)


def as_number(
    value: Any, name: str, *, unit: str = MM, or_zero: bool = False, hint: str = ""
) -> float:
    """Return `value` as a finite float > 0, or ≥ 0 with `or_zero`.

    Parameters
    ----------
    name, unit : of the value, for the message; in mm, or without one, it is at most
        `LARGEST_COORDINATE`
    hint : what else is accepted in place of a number, such as ", or a function of positions"

    Raises
    ------
    OptionError
        If it is not such a number.
    """
    number = as_real(value, name, hint=hint)
    if unit in (MM, "") and LARGEST_COORDINATE < number < np.inf:
        raise OptionError(f"{name} is {number:g}{unit}; need at most {LARGEST_COORDINATE:g}")
    if 0 < number < np.inf or (or_zero and number == 0):
        return number
    finite = " and finite" if number == np.inf else ""
    raise OptionError(f"{name} is {number:g}{unit}; need {'>=' if or_zero else '>'} 0{finite}")


def as_real(value: Any, name: str, *, hint: str = "") -> float:
    """Return `value` as a float, finite or not, see `as_number`."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, bool) or not isinstance(value, Real):
        raise OptionError(f"{name} is {described(value)}; need a number{hint}")
    try:
        return float(value)
    except OverflowError:
        raise OptionError(f"{name} is beyond 1e308; need a smaller number") from None


def as_vector(values: PositionLike, name: str, *, unit: str = MM, most: float = np.inf) -> Floats:
    """Return `values`, or those of a Vector, as three finite numbers (3,).

    Parameters
    ----------
    name, unit : of the values, for the message
    most : size that none of them may exceed

    Raises
    ------
    OptionError
        If they are not such numbers.
    """
    vector = as_floats(values, name, OptionError)
    if vector.shape != (3,) or not np.isfinite(vector).all() or np.abs(vector).max() > most:
        limit = "" if most == np.inf else f" of at most {most:g}{unit}"
        raise OptionError(f"{name} is {vector.tolist()}{unit}; need three finite numbers{limit}")
    return vector


def as_direction(values: DirectionLike, name: str, *, hint: str = "") -> UnitVectors:
    """Return `values`, of any length > 0, or an Axis or a Plane, as a unit vector (3,).

    Parameters
    ----------
    name : of the direction, for the message
    hint : what else is accepted in place of it, for the message

    Raises
    ------
    OptionError
        If they are not three finite numbers, or all are 0.
    """
    needed = f"need a direction, three finite numbers that are not all 0{hint}"
    if isinstance(values, str):
        raise OptionError(f"{name} is {described(values)}; {needed}")
    vector = as_floats(direction_of(values), name, OptionError)
    if vector.shape != (3,) or not np.isfinite(vector).all() or not vector.any():
        raise OptionError(f"{name} is {vector.tolist()}; {needed}")
    near = vector / np.abs(vector).max()  # squares of large ones would overflow
    direction: UnitVectors = near / np.linalg.norm(near)
    return direction


def as_count(value: Any, name: str, least: int = 0) -> int:
    """Return `value` as an int that is at least `least`.

    Raises
    ------
    OptionError
        If it is not a whole number, or less than `least`.
    """
    if isinstance(value, bool) or not isinstance(value, Integral):
        raise OptionError(f"{name} is {described(value)}; need a whole number")
    if value < least:
        raise OptionError(f"{name} is {described(value)}; need {least} or more")
    return int(value)


def described(value: object) -> str:
    """Return a number, a text, None or a few of them as they are written, else the value's type.

    >>> described("flat"), described((2, 3.5)), described({1, 2})
    ("'flat'", '(2, 3.5)', 'a set')
    """
    if isinstance(value, str | bytes):
        short = value[:LONGEST_TEXT]
        return repr(short) + ("" if len(short) == len(value) else " ...")
    if isinstance(value, int) and abs(value) >= LARGEST_WHOLE:
        return f"a whole number of {value.bit_length()} bits"
    if value is None or isinstance(value, bool | Real):
        return str(value)
    if (
        isinstance(value, list | tuple)
        and 0 < len(value) <= FEW
        and all(isinstance(each, str | Real | None) for each in value)
    ):
        within = ", ".join(map(described, value))
        return f"[{within}]" if isinstance(value, list) else f"({within})"
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape}"
    article = "an" if type(value).__name__[0] in "AEIOUaeiou" else "a"
    return f"{article} {type(value).__name__}"
