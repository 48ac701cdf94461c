"""Sections of overlapping parts united to polygons that neither touch nor cross, by manifold3d."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Protocol

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints
from scaffold_cad.base.boxes import overlapping_boxes
from scaffold_cad.layers.layer import Layer
from scaffold_cad.layers.loops import Loops, joined

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
        if self._hollow is not None:
            for height, section in zip(planes.tolist(), self.sections(planes), strict=True):
                yield layer_of(section, height, thickness)
            return
        for some in _blocks(self._parts, planes):
            loops = joined(self._parts.loops(some))
            alone = _alone(loops)
            apart = loops.taken(np.flatnonzero(alone))
            rest = loops.taken(np.flatnonzero(~alone)).by_level(len(some))
            pairs = zip(some.tolist(), apart.by_level(len(some)), rest, strict=True)
            for height, single, others in pairs:
                yield _layer([*single, *united(others).to_polygons()], height, thickness)


def _blocks(parts: Sections, planes: Floats) -> Iterator[Floats]:
    """Yield heights that follow each other, with about `PARTS_AT_ONCE` sections of parts."""
    block = np.cumsum(parts.count(planes) + 1) // PARTS_AT_ONCE
    yield from np.split(planes, np.flatnonzero(np.diff(block)) + 1) if len(planes) else []


def _united(parts: Sections, planes: Floats) -> Iterator[CrossSection]:
    """Yield the union of parts at each of some heights."""
    for some in _blocks(parts, planes):
        for found in joined(parts.loops(some)).by_level(len(some)):
            yield united(found)


def _alone(loops: Loops) -> Bools:
    """Return whether the box of each polygon meets no other at its height, shape (l,)."""
    alone = np.ones(len(loops.levels), dtype=np.bool_)
    if len(alone) == 0:
        return alone
    low = np.minimum.reduceat(loops.points, loops.offsets[:-1])  # (l, 2)
    high = np.maximum.reduceat(loops.points, loops.offsets[:-1])
    level = loops.levels[:, None].astype(np.float64)
    boxes = np.concatenate([low, level], axis=1), np.concatenate([high, level], axis=1)
    for i, j in overlapping_boxes(*boxes):
        # Those of a block of heights that nearly meet may be no pair in another block.
        meet = (loops.levels[i] == loops.levels[j]) & (low[i] <= high[j]).all(axis=1)
        meet &= (low[j] <= high[i]).all(axis=1)
        alone[i[meet]] = False
        alone[j[meet]] = False
    alone &= (low < high).all(axis=1)
    return alone


def united(loops: list[Floats]) -> CrossSection:
    """Return what is inside some polygons (k, 2), counter-clockwise around it, holes clockwise."""
    from manifold3d import CrossSection, FillRule

    return CrossSection(loops, FillRule.Positive) if loops else CrossSection()


def layer_of(section: CrossSection, height: float, thickness: float) -> Layer:
    """Return the polygons of a section as a layer."""
    return _layer(section.to_polygons(), height, thickness)


def _layer(loops: list[Floats], height: float, thickness: float) -> Layer:
    offsets = np.cumsum([0, *map(len, loops)])
    points = np.concatenate(loops) if loops else np.zeros((0, 2))
    return Layer(height, thickness, points, offsets)
