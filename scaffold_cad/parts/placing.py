"""How parts are placed: what build123d takes without a look is checked here."""

from __future__ import annotations

from typing import Any

import numpy as np
from build123d import Align, Location

from scaffold_cad.base.arguments import described
from scaffold_cad.base.arrays import as_floats
from scaffold_cad.errors import OptionError

_ALIGN = "need Align.MIN, CENTER, MAX or NONE, or three of these"
_ROTATION = "need three angles in degrees, or a Rotation"


def as_rotation(rotation: Any) -> Any:
    """Return a rotation as build123d takes it: a Rotation, or a tuple of three angles, degrees.

    Raises
    ------
    OptionError
        If it is neither such an object nor three finite numbers.

    Examples
    --------
    >>> as_rotation([0, 90, 0])
    (0.0, 90.0, 0.0)
    """
    if isinstance(rotation, Location):  # a Rotation is one
        return rotation
    if not isinstance(rotation, tuple | list | np.ndarray):
        raise OptionError(f"rotation is {described(rotation)}; {_ROTATION}")
    angles = as_floats(rotation, "rotation", OptionError)
    if angles.shape != (3,) or not np.isfinite(angles).all():
        raise OptionError(f"rotation is {angles.tolist()}; {_ROTATION}")
    return tuple(angles.tolist())


def as_align(align: Any) -> Any:
    """Return an alignment as build123d takes it: None, an Align, or one along each axis.

    Raises
    ------
    OptionError
        If it is something else.
    """
    if align is None or isinstance(align, Align):
        return align
    if not isinstance(align, tuple | list):
        raise OptionError(f"align is {described(align)}; {_ALIGN}")
    odd = [one for one in align if not isinstance(one, Align)]
    if odd or len(align) != 3:
        found = f"holds {described(odd[0])}" if odd else f"has {len(align)}"
        raise OptionError(f"align {found}; {_ALIGN}")
    return tuple(align)
