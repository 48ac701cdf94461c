"""Sections of overlapping parts united to polygons that neither touch nor cross, by manifold3d."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.layers.layer import Layer

if TYPE_CHECKING:
    from manifold3d import CrossSection


def united(loops: list[Floats]) -> CrossSection:
    """Return what is inside some polygons (k, 2), counter-clockwise around it, holes clockwise."""
    from manifold3d import CrossSection, FillRule

    return CrossSection(loops, FillRule.Positive) if loops else CrossSection()


def layer_of(section: CrossSection, height: float, thickness: float) -> Layer:
    """Return the polygons of a section as a layer."""
    loops = section.to_polygons()
    offsets = np.cumsum([0, *map(len, loops)])
    points = np.concatenate(loops) if loops else np.zeros((0, 2))
    return Layer(height, thickness, points, offsets)
