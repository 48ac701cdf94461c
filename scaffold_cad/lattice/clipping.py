"""Struts cut at the surface of a region."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arguments import as_number
from scaffold_cad.base.regions import Region
from scaffold_cad.lattice.struts import Struts
from scaffold_cad.skeleton.cutting import inside


def clipped(struts: Struts, region: Region, shortest: float) -> Struts:
    """Return the parts of struts in a region, cut at its surface.

    A strut that is the chord of a curve stays where the curve is in the region.

    Parameters
    ----------
    struts : (m,) struts
    region : to keep
    shortest : length below which a piece of a cut strut is shrunk to a node, mm
    """
    pieces = inside(struts.nodes, struts.edges, region, struts.at)
    on_surface = np.arange(len(pieces.nodes)) >= len(struts.nodes)
    short = on_surface[pieces.edges].any(axis=1) & (pieces.lengths < shortest)
    return Struts(pieces.nodes, pieces.edges).collapsed(short, on_surface)


def least_length(shortest: float | None, default: float) -> float:
    """Return the length below which pieces are given up, mm."""
    if shortest is None:
        return default
    return as_number(shortest, "shortest length", or_zero=True)
