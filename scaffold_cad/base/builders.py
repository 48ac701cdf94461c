"""What stands for one shape of build123d: a builder, for what it has made so far, or a list."""

from __future__ import annotations

from typing import Any

from scaffold_cad.base.backends import is_instance
from scaffold_cad.errors import OptionError


def built(what: Any) -> Any:
    """Return the shape of a builder of build123d, or the only one of a list; else what is given.

    Raises
    ------
    OptionError
        If there is no shape yet, or several.
    """
    if is_instance(what, "build123d", "Builder"):
        made = (getattr(what, name, None) for name in ("part", "sketch", "line"))
        shape = next((shape for shape in made if shape is not None), None)
        if shape is None:
            raise OptionError(f"the {type(what).__name__} holds no shape yet; need one")
    elif isinstance(what, list | tuple) and any(_is_shape(one) for one in what):
        if len(what) > 1:
            raise OptionError(
                f"the {type(what).__name__} holds {len(what)} shapes; need one, such as their sum "
                "or a Compound of them"
            )
        shape = built(what[0])
    else:
        shape = what
    if _is_shape(shape) and _is_empty(shape):
        raise OptionError(f"the {type(shape).__name__} is empty; need a shape")
    return shape


def _is_empty(shape: Any) -> bool:
    """Return whether nothing is in a shape, as where all of a solid was cut away."""
    is_compound = is_instance(shape, "build123d", "Compound")
    return bool(shape.is_null) or (is_compound and next(iter(shape), None) is None)


def _is_shape(what: Any) -> bool:
    return is_instance(what, "build123d", "Shape") or is_instance(what, "build123d", "Builder")
