"""Shapes for CadQuery, and so for CQ-editor, which does not accept those of build123d."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.backends import need
from scaffold_cad.products.overlaps import Overlaps
from scaffold_cad.viewers.shapes import to_shape


@checks_keywords()
def to_cadquery(what: Any, overlaps: Overlaps = "unite") -> Any:
    """Return `what` as a `cadquery.Shape`: the same OCCT shape, not a copy.

    `cadquery.Workplane(to_cadquery(part))` goes on from it.

    Parameters
    ----------
    what : a build123d shape, or anything else that `to_shape` knows
    overlaps : what becomes of struts that overlap, see `to_shape`

    Raises
    ------
    OptionError
        If it is nothing that has a shape.
    MissingBackendError
        If CadQuery or build123d is not installed.
    """
    need("cadquery", "a CadQuery shape")
    return import_module("cadquery").Shape.cast(to_shape(what, overlaps).wrapped)
