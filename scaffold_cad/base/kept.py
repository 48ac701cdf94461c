"""Results of functions kept for the next call, as long as they take little memory."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from functools import wraps
from threading import Lock
from typing import Any, ParamSpec, TypeVar

import numpy as np

_Given = ParamSpec("_Given")
_Made = TypeVar("_Made")


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


def bytes_of(value: Any) -> int:
    """Return the bytes of an array, or of all arrays in a tuple or in the fields of a value."""
    if isinstance(value, np.ndarray):
        return value.nbytes
    parts = value if isinstance(value, tuple) else vars(value).values() if _has(value) else ()
    return sum(bytes_of(part) for part in parts)


def _has(value: Any) -> bool:
    """Return whether a value is made of fields."""
    return hasattr(value, "__dataclass_fields__")
