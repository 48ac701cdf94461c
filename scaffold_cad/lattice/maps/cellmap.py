"""CellMap: what every map of cells is, and what is measured on one."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points
from scaffold_cad.base.vectors import length

SAMPLES, ACROSS = 65, 5
"""Places along the axis that is measured, and along the others."""

MOST_PATCHES = 64
"""Most patches that are measured."""


class CellMap(ABC):
    """Where cells go: a function from places in unit cubes (u, v, w) to positions, mm.

    A map has one unit cube, or several patches that meet side by side. Derive a class from this
    one and write `positions` to have a map of your own.
    """

    wraps: tuple[bool, bool, bool] = (False, False, False)
    """Whether the end of the cube along u, v and w is its beginning again, as around a pipe."""
    patches: int = 1
    """Number of unit cubes."""
    loops: tuple[Floats, ...] = ()
    """Closed polygons (k, 2) in the unit square of u and v, an even-odd rule between them, that
    the cells are trimmed to; none if the whole square is used."""

    def __str__(self) -> str:
        size = " x ".join(f"{side:.4g}" for side in extents(self))
        patches = "" if self.patches == 1 else f"{self.patches} patches, each "
        return f"{type(self).__name__}: {patches}about {size} mm along u, v and w"

    @abstractmethod
    def positions(self, places: Points, patch: Ints) -> Points:
        """Return where places are in space.

        Parameters
        ----------
        places : (n, 3) float64, u, v and w in 0..1
        patch : (n,) intp, which unit cube each is in

        Returns
        -------
        (n, 3) float64, mm
        """


def sampled(mapping: CellMap, samples: tuple[int, int, int], patch: int) -> Floats:
    """Return positions on a regular grid in a patch, shape (*samples, 3), mm."""
    axes = [np.linspace(0.0, 1.0, count) for count in samples]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    positions = mapping.positions(places, np.full(len(places), patch, dtype=np.intp))
    return positions.reshape(*samples, 3)


def extents(mapping: CellMap) -> Floats:
    """Return how long a patch is along u, v and w in the mean, shape (3,), mm."""
    chosen = np.unique(np.linspace(0, mapping.patches - 1, MOST_PATCHES).astype(np.intp))
    along = SAMPLES if mapping.patches == 1 else ACROSS
    means = []
    for axis in range(3):
        shape = [ACROSS] * 3
        shape[axis] = along
        grids = [sampled(mapping, (shape[0], shape[1], shape[2]), int(one)) for one in chosen]
        means.append(np.mean([length(np.diff(g, axis=axis)).sum(axis=axis) for g in grids]))
    return np.asarray(means)
