"""Layer: what is solid at one height, as polygons with holes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.arrays import Floats, Frozen, Ints
from scaffold_cad.base.counts import tracked
from scaffold_cad.base.summaries import size_text


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Layer(Frozen):
    """The section of a solid at one height: closed polygons that neither touch nor cross.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, slices
    >>> strut = Skeleton([[0, 0, 0], [0, 0, 9]], [[0, 1]], 1.0)
    >>> (layer,) = slices(strut, [4.5])
    >>> layer.height, len(layer.loops), round(layer.area, 4)
    (4.5, 1, 3.1416)
    """

    height: float
    """Height of the plane of the section, mm."""
    thickness: float
    """Thickness of the layer whose middle the section is, mm; 0 for a section alone."""
    points: Floats
    """Corners of all polygons one after another, shape (p, 2), mm."""
    offsets: Ints
    """Where each polygon begins in `points`, and their number at the end, shape (l + 1,)."""

    def __str__(self) -> str:
        loops = f"{self.offsets.size - 1} polygons, {self.area:.6g} mm²"
        return f"Layer: at {self.height:.6g} mm, {self.thickness:.6g} mm thick, {loops}"

    @property
    def top(self) -> float:
        """Upper side of the layer, mm."""
        return self.height + self.thickness / 2

    @property
    def loops(self) -> list[Floats]:
        """The polygons, each (k, 2), mm: counter-clockwise around what is solid, holes clockwise.

        The last corner is joined to the first.
        """
        return np.split(self.points, self.offsets[1:-1]) if len(self.offsets) > 1 else []

    @property
    def areas(self) -> Floats:
        """Area in each polygon, < 0 for holes, shape (l,), mm²."""
        if len(self.offsets) == 1:
            return np.zeros(0)
        following = np.arange(1, len(self.points) + 1)
        following[self.offsets[1:] - 1] = self.offsets[:-1]
        x, y = self.points.T
        crosses = x * y[following] - y * x[following]
        return np.asarray(np.add.reduceat(crosses, self.offsets[:-1]) / 2)

    @property
    def area(self) -> float:
        """What is solid, mm²."""
        return float(self.areas.sum())

    @property
    def bounds(self) -> Floats:
        """Lowest and highest corner, shape (2, 2), mm; of an empty layer inf and -inf."""
        low = self.points.min(axis=0, initial=np.inf)
        return np.stack([low, self.points.max(axis=0, initial=-np.inf)])


@checks_keywords()
class Layers(Iterator[Layer]):
    """Layers from the lowest up, each made when it is asked for, and how large all of them are."""

    def __init__(self, layers: Iterable[Layer], heights: Floats, thickness: float, box: Floats):
        """Take layers.

        Parameters
        ----------
        layers : in order of their heights
        heights : of all of them, shape (n,), mm
        thickness : of each, mm; 0 for sections alone
        box : lowest and highest corner of a box that holds all polygons, shape (2, 2), mm
        """
        self._layers = tracked("layers", layers, [1] * len(heights))
        self.taken = 0
        """How many of them were asked for: they are gone."""
        self.heights = heights
        self.thickness = thickness
        self.box = box

    def __next__(self) -> Layer:
        layer = next(self._layers)
        self.taken += 1
        return layer

    def __len__(self) -> int:
        return len(self.heights)

    def __str__(self) -> str:
        """Return one line: how many, how thick, how large."""
        thick = f"{self.thickness:.6g} mm thick" if self.thickness else "sections"
        return f"Layers: {len(self)}, {thick}, {size_text(self.box)}"
