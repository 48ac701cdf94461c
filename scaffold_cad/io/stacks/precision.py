"""How fine the numbers of files of layers are, and whether that is enough for the layers."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scaffold_cad.errors import FormatError
from scaffold_cad.layers import Layers

DECIMALS = 6
"""Of lengths in text, mm."""

LEAST_STEPS = 100.0
"""Least thickness of layers, in steps between the numbers of a file: polygons may cross beyond."""


def check_precision(layers: Layers, path: Path, *, binary: bool) -> None:
    """Raise unless the numbers of a file can hold layers so thin, so far from the origin.

    Parameters
    ----------
    binary : whether they are binary numbers of 32 bits, not text

    Raises
    ------
    FormatError
        If they cannot.
    """
    apart = layers.thickness or float(np.diff(layers.heights).min(initial=np.inf))
    largest = float(np.abs(layers.box[:, :2]).max())  # heights are no corners of polygons
    step = float(np.spacing(np.float32(largest))) if binary else 10.0**-DECIMALS
    if apart >= LEAST_STEPS * step:
        return
    what, way = "numbers of text", "a part scaled up"
    if binary:
        what, way = f"32-bit numbers up to {largest:g} mm", "a place nearer to the origin, or text"
    raise FormatError(
        f"cannot write {path}: {what} are {step:.3g} mm apart, too coarse for layers of "
        f"{apart:g} mm; need {LEAST_STEPS * step:.3g} mm or more, or {way}"
    )
