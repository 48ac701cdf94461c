"""Sections of overlapping parts united to polygons that neither touch nor cross, by manifold3d."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Protocol

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints
from scaffold_cad.layers.layer import Layer
from scaffold_cad.layers.loops import Loops

if TYPE_CHECKING:
    from manifold3d import CrossSection

PARTS_AT_ONCE = 2**14
"""Sections of struts and nodes that are made together, about: some layers of a small part, or
one layer of a large one."""


class Sections(Protocol):
    """Closed parts that can be cut from the lowest up."""

    @property
    def bounds(self) -> tuple[float, float]:
        """Lowest and highest point, mm."""

    @property
    def box(self) -> Floats:
        """Lowest and highest corner of a box that holds all polygons, shape (2, 2), mm."""

    def count(self, heights: Floats) -> Ints:
        """Return how many parts there are at each height, about, shape (h,)."""

    def loops(self, heights: Floats) -> list[Loops]:
        """Return the sections of all parts at ascending heights (h,), above those before."""


class Solid:
    """Parts united, and others taken out of them."""

    def __init__(self, parts: Sections, hollow: Sections | None = None) -> None:
        self._parts, self._hollow = parts, hollow
        self.box = parts.box
        """Lowest and highest corner of a box that holds all polygons, shape (2, 2), mm."""

    @property
    def bounds(self) -> tuple[float, float]:
        """Lowest and highest point, mm."""
        return self._parts.bounds

    def sections(self, planes: Floats) -> Iterator[CrossSection]:
        """Yield what is solid at each of ascending heights; all are asked for only once."""
        if self._hollow is None:
            yield from _united(self._parts, planes)
            return
        pairs = zip(_united(self._parts, planes), _united(self._hollow, planes), strict=True)
        for whole, hollow in pairs:
            yield whole - hollow

    def layers(self, planes: Floats, thickness: float) -> Iterator[Layer]:
        """Yield what is solid at each of ascending heights as layers."""
        for height, section in zip(planes.tolist(), self.sections(planes), strict=True):
            yield layer_of(section, height, thickness)


def _united(parts: Sections, planes: Floats) -> Iterator[CrossSection]:
    """Yield the union of parts at each of some heights, made some heights at once."""
    block = np.cumsum(parts.count(planes) + 1) // PARTS_AT_ONCE
    for some in np.split(planes, np.flatnonzero(np.diff(block)) + 1):
        lists = [loops.by_level(len(some)) for loops in parts.loops(some)] if len(some) else []
        for found in zip(*lists, strict=True):
            yield united([loop for loops in found for loop in loops])


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
