"""Nodes that are turned copies of each other, as in rings of cells: seen alike, solved once.

Each node is looked at from its own struts: one of them is along the first axis of its frame, and
another in the plane of the first two. Struts are numbered by where they are seen. Which two they
are follows from the angles between struts, and from what else tells struts apart.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, UnitVectors
from scaffold_cad.base.vectors import any_perpendicular, length, normalize

Values = TypeVar("Values", Floats, Ints)

SLANTED = 0.3
"""Least sine between the two struts of a frame; less only where there are no such struts."""

STRAIGHT = 1e-6
"""Sine up to which all struts of a node are on one line: any plane through it will do."""

SAME = 1e-9
"""Marks and places that differ by less are the same: then the first strut comes first."""

ALONG = np.array([1.0, 0.6180339887, 0.4142135624])
"""Direction along which struts are numbered, as seen in their frame: in no plane of symmetry."""


@dataclass(frozen=True, eq=False)
class Views(Frozen):
    """How M nodes with N struts are looked at."""

    frames: Floats
    """Axes of each frame in rows, shape (M, 3, 3)."""
    order: Ints
    """Strut that has each number, shape (M, N)."""

    @staticmethod
    def of(directions: UnitVectors, weights: Floats) -> Views:
        """Return the views of nodes.

        Parameters
        ----------
        directions : (M, N, 3) of struts
        weights : (M, N) float64, what tells struts apart, of about 1
        """
        cosines = directions @ directions.swapaxes(1, 2)
        marks = np.rint((weights + np.einsum("mj,mij->mi", weights, (2 + cosines) ** 1.7)) / SAME)
        row = np.arange(len(marks))
        first = directions[row, marks.argmin(axis=1)]
        across = np.cross(first[:, None], directions)  # (M, N, 3)
        sines = length(across)
        sines[sines > SLANTED] = 1.0
        slanted = sines == sines.max(axis=1, keepdims=True)
        third = across[row, np.where(slanted, marks, np.inf).argmin(axis=1)]
        straight = sines.max(axis=1, keepdims=True) < STRAIGHT
        third = normalize(np.where(straight, any_perpendicular(first), third))
        frames = np.stack([first, np.cross(third, first), third], axis=1)
        places = np.rint(directions @ frames.swapaxes(1, 2) @ ALONG / SAME)
        return Views(frames, np.argsort(places, axis=1, kind="stable"))

    @property
    def number(self) -> Ints:
        """Number that each strut has, shape (M, N)."""
        return np.argsort(self.order, axis=1)

    def __getitem__(self, item: Ints) -> Views:
        return Views(self.frames[item], self.order[item])

    def rounded(self, to: float) -> Views:
        """Return the views with frames that are alike where their numbers are, rounded."""
        first = normalize(np.rint(self.frames[:, 0] / to))
        third = normalize(np.cross(first, np.rint(self.frames[:, 1] / to)))
        return Views(np.stack([first, np.cross(third, first), third], axis=1), self.order)

    def distinct(self, kind: Ints) -> tuple[Ints, Ints]:
        """Return one node of each kind (M,) and view, (U,), and which of them each is, (M,)."""
        rows = np.concatenate(
            [kind[:, None], self.order, self.frames.reshape(len(kind), 9)], axis=1
        )
        _, first, same = np.unique(rows + 0.0, axis=0, return_index=True, return_inverse=True)
        return first, same.reshape(-1)

    def seen(self, vectors: Floats) -> Floats:
        """Return vectors (M, k, 3) as they are seen."""
        return np.asarray(vectors @ self.frames.swapaxes(1, 2))

    def meant(self, vectors: Floats) -> Floats:
        """Return vectors (M, ..., 3) of which these are as they are seen."""
        alone = (1,) * (vectors.ndim - 3)
        return np.asarray(vectors @ self.frames.reshape(-1, *alone, 3, 3))

    def by_number(self, values: Values) -> Values:
        """Return values (M, N, ...) of struts by their numbers."""
        found: Values = values[np.arange(len(values))[:, None], self.order]
        return found

    def by_strut(self, values: Values) -> Values:
        """Return values (M, N, ...) by numbers as those of struts."""
        found: Values = values[np.arange(len(values))[:, None], self.number]
        return found
