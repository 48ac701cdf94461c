"""Struts cut at the surface of a region."""

from __future__ import annotations

from typing import Literal, TypeAlias

import numpy as np

from scaffold_cad.base.arguments import as_number
from scaffold_cad.base.arrays import Bools, Floats, Ints
from scaffold_cad.lattice.regions import Region
from scaffold_cad.lattice.struts import Struts

Keep: TypeAlias = Literal["clip", "whole"]
"""What becomes of struts that the surface crosses: cut there, or kept if their middle is inside."""


def clipped(struts: Struts, region: Region, shortest: float) -> Struts:
    """Return the parts of struts in a region, cut at its surface.

    Parameters
    ----------
    struts : (m,) struts
    region : to keep
    shortest : length below which a piece of a cut strut is shrunk to a node, mm
    """
    strut, along = _ordered_cuts(struts, *region.crossings(struts), region.tolerance)
    pieces = struts.cut(strut, along)
    inside = region.contains(pieces.middles)
    # Only where the pieces on both sides differ is the strut cut: a strut along a face or
    # through an edge of the surface stays whole.
    before = strut + np.arange(len(strut))
    real = inside[before] != inside[before + 1]
    starts_piece = np.ones(len(inside), dtype=np.bool_)
    starts_piece[before + 1] = real
    pieces = struts.cut(strut[real], along[real]).kept(inside[starts_piece])

    on_surface = np.arange(len(pieces.nodes)) >= len(struts.nodes)
    short = on_surface[pieces.edges].any(axis=1) & (pieces.lengths < shortest)
    return pieces.collapsed(short, on_surface)


def _ordered_cuts(
    struts: Struts, strut: Ints, along: Floats, tolerance: float
) -> tuple[Ints, Floats]:
    """Return the crossings in order of strut and place, without repeats and those at ends."""
    lengths = struts.lengths
    apart: Bools = np.minimum(along, 1 - along) * lengths[strut] > tolerance
    strut, along = strut[apart], along[apart]
    order = np.lexsort([along, strut])
    strut, along = strut[order], along[order]
    repeat = np.zeros(len(strut), dtype=np.bool_)
    repeat[1:] = (strut[1:] == strut[:-1]) & (np.diff(along) * lengths[strut[1:]] <= tolerance)
    return strut[~repeat], along[~repeat]


def least_length(shortest: float | None, default: float) -> float:
    """Return the length below which pieces are given up, mm."""
    if shortest is None:
        return default
    return as_number(shortest, "shortest length", or_zero=True)
