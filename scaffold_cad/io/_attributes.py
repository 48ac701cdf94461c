"""Positions and radii among the attributes that nodes and edges of graphs have."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

from scaffold_cad.io._nodes import radius_of_area

AXES = (("x", "y", "z"), ("X", "Y", "Z"), ("x_plane", "y_plane", "z_plane"))
POSITIONS = ("pos", "position", "coordinates", "coords", "coord", "xyz", "point", "location", "o")
RADII = ("radius", "r", "radii", "mean_radius", "meanradius", "avgradius", "avgradiusavg")
DIAMETERS = ("diameter", "d", "diam", "dia", "thickness")
AREAS = ("area", "a", "cross_section")

_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


def position_in(values: Mapping[str, Any]) -> list[float] | None:
    """Return the position among attributes, 2 or 3 numbers, or None without one.

    It may be three attributes, one with a list, or one with a text such as ``(0, 1.5, 2)``.
    """
    for axes in AXES:
        if axes[0] in values and axes[1] in values:
            found = [as_number(values[axis]) for axis in axes if axis in values]
            return None if None in found else [x for x in found if x is not None]
    plain = {name.strip().lower(): value for name, value in values.items()}
    for name in POSITIONS:
        point = numbers_of(plain.get(name))
        if point is not None and len(point) in (2, 3):
            return point
    return None


def radius_in(values: Mapping[str, Any]) -> float:
    """Return the radius among attributes, from a diameter or an area too; NaN without one."""
    plain = {name.strip().lower(): value for name, value in values.items()}
    for names, power, factor in ((RADII, 1, 1.0), (DIAMETERS, 1, 0.5), (AREAS, 2, 1.0)):
        for name in names:
            number = as_number(plain.get(name))
            if number is not None:
                return radius_of_area(number) if power == 2 else number * factor
    return math.nan


def numbers_of(value: Any) -> list[float] | None:
    """Return the numbers of a list or of a text, or None if it is something else."""
    if isinstance(value, str):
        rest = _NUMBER.sub("", value)
        if rest.strip(" \t\r\n,;()[]{}"):
            return None
        return [float(word) for word in _NUMBER.findall(value)]
    if isinstance(value, Sequence):
        found = [as_number(x) for x in value]
        return None if None in found else [x for x in found if x is not None]
    return None


def as_number(value: Any) -> float | None:
    """Return a number, or a text that is one, as a float; None if it is something else."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        return float(value)
    except (ValueError, OverflowError):
        return None
