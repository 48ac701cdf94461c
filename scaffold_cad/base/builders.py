"""Builders of build123d, which stand for the shape that they have made so far."""

from __future__ import annotations

from typing import Any

from scaffold_cad.base.backends import is_instance
from scaffold_cad.errors import OptionError


def built(what: Any) -> Any:
    """Return the shape of a builder of build123d, or anything else as it is.

    Raises
    ------
    OptionError
        If the builder holds no shape yet.
    """
    if not is_instance(what, "build123d", "Builder"):
        return what
    for name in ("part", "sketch", "line"):
        shape = getattr(what, name, None)
        if shape is not None:
            return shape
    raise OptionError(f"the {type(what).__name__} holds no shape yet; need one")
