"""Results of functions kept for the next call, as long as they take little memory."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from functools import wraps
from threading import Lock
from typing import Any, Concatenate, ParamSpec, TypeVar
from weakref import ref

import numpy as np

_Given = ParamSpec("_Given")
_Made = TypeVar("_Made")
_Kind = TypeVar("_Kind")


def kept(most: int) -> Callable[[Callable[_Given, _Made]], Callable[_Given, _Made]]:
    """Keep what a function returns while all of it takes at most `most` bytes.

    What was not used for longest goes first; the last result stays however large it is.

    Parameters
    ----------
    most : bytes of arrays

    Examples
    --------
    >>> @kept(1000)
    ... def zeros(count):
    ...     return np.zeros(count)
    >>> zeros(50) is zeros(50)
    True
    """

    def decorate(make: Callable[_Given, _Made]) -> Callable[_Given, _Made]:
        found: OrderedDict[Hashable, tuple[_Made, int]] = OrderedDict()
        lock = Lock()

        @wraps(make)
        def get(*args: _Given.args, **keywords: _Given.kwargs) -> _Made:
            key = (args, tuple(sorted(keywords.items())))
            with lock:
                if key in found:
                    found.move_to_end(key)
                    return found[key][0]
            made = make(*args, **keywords)
            with lock:
                found[key] = made, bytes_of(made)
                while len(found) > 1 and sum(size for _, size in found.values()) > most:
                    found.popitem(last=False)
            return made

        return get

    return decorate


def kept_last(
    make: Callable[Concatenate[_Kind, _Given], _Made],
) -> Callable[Concatenate[_Kind, _Given], _Made]:
    """Keep what a function returned last, as long as its first argument lives.

    It is let go before anything else is made: both may not fit into memory.

    Examples
    --------
    >>> class Part:
    ...     pass
    >>> @kept_last
    ... def points(part, count):
    ...     return np.zeros((count, 3))
    >>> part = Part()
    >>> points(part, 4) is points(part, 4), points(part, 5) is points(Part(), 5)
    (True, False)
    """
    slot: list[tuple[ref[_Kind], Hashable, _Made]] = []
    lock = Lock()

    def gone(whose: ref[_Kind]) -> None:
        slot[:] = [row for row in slot if row[0] is not whose]

    @wraps(make)
    def get(what: _Kind, /, *args: _Given.args, **keywords: _Given.kwargs) -> _Made:
        key = (args, tuple(sorted(keywords.items())))
        with lock:
            for whose, own, made in slot:
                if whose() is what and own == key:
                    return made
            slot.clear()
        made = make(what, *args, **keywords)
        with lock:
            slot[:] = [(ref(what, gone), key, made)]
        return made

    return get


def bytes_of(value: Any) -> int:
    """Return the bytes of an array, or of all arrays in a tuple or in the fields of a value."""
    if isinstance(value, np.ndarray):
        return value.nbytes
    parts = value if isinstance(value, tuple) else vars(value).values() if _has(value) else ()
    return sum(bytes_of(part) for part in parts)


def _has(value: Any) -> bool:
    """Return whether a value is made of fields."""
    return hasattr(value, "__dataclass_fields__")
