"""Radii of nodes: one number for all, or a function of their positions."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_number
from scaffold_cad.base.arrays import Floats, Points, as_floats
from scaffold_cad.errors import OptionError

Radius: TypeAlias = float | Callable[[Points], ArrayLike]
"""One radius for all nodes, mm, or a function of positions (n, 3) that returns radii (n,)."""


def check_radius(radius: Radius) -> Radius:
    """Return `radius` as a float, or as it is where it is a function.

    Raises
    ------
    OptionError
        If it is neither a number > 0 nor a function.
    """
    hint = (
        ", or a function of positions (n, 3) that returns radii (n,); with_radii and "
        "with_edge_radii of a skeleton give nodes or struts each their own"
    )
    return radius if callable(radius) else as_number(radius, "radius", hint=hint)


def radii_at(nodes: Points, radius: Radius) -> Floats:
    """Return the radius of each node, shape (n,), or () for one of all, mm.

    Raises
    ------
    OptionError
        If it is neither a number > 0 nor a function that returns an array of shape (n,).
    """
    if not callable(radius):
        return np.asarray(check_radius(radius))
    radii = as_floats(radius(nodes), "what the function radius returned", OptionError)
    if radii.shape not in {(), (len(nodes),)}:
        raise OptionError(
            f"radius returned shape {radii.shape} for points ({len(nodes)}, 3); "
            f"need ({len(nodes)},)"
        )
    return radii
