"""The control net of a patched surface: which control points the patches of a quad mesh share.

Control points are numbered through: one per vertex, then d − 1 per edge from its first vertex on,
then (d − 1)² a quad. Neighboring patches meet because they have these in common.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points
from scaffold_cad.base.vectors import sums_by_row
from scaffold_cad.brep.beziermesh import side_indices
from scaffold_cad.mesh.subdivision.connectivity import Connectivity


@dataclass(frozen=True, eq=False)
class ControlNet:
    """The shared control points of one patch of a degree on each quad."""

    connectivity: Connectivity
    """The quads."""
    degree: int
    """Degree d of the patches."""

    @property
    def count(self) -> int:
        """Number of control points."""
        inner = self.degree - 1
        quads, edges = len(self.connectivity.quads), len(self.connectivity.edges)
        return self.connectivity.count + inner * edges + inner**2 * quads

    @cached_property
    def of_patch(self) -> Ints:
        """Control points of each patch, row by row, shape (f, (d + 1)²)."""
        quads, edge_of_side = self.connectivity.quads, self.connectivity.edge_of_side
        inner = np.arange(self.degree - 1)
        first_edge = self.connectivity.count
        first_quad = first_edge + len(inner) * len(self.connectivity.edges)
        grid = np.arange((self.degree + 1) ** 2).reshape(self.degree + 1, -1)

        table = np.empty((len(quads), grid.size), dtype=np.intp)
        middle = grid[1:-1, 1:-1].reshape(-1)
        own = np.arange(len(quads) * middle.size).reshape(len(quads), -1)
        table[:, middle] = first_quad + own
        forward = self.connectivity.edges[:, 0][edge_of_side] == quads  # (f, 4)
        for side, along in enumerate(side_indices(self.degree)):
            rank = np.where(forward[:, side, None], inner, inner[::-1])
            table[:, along[1:-1]] = first_edge + len(inner) * edge_of_side[:, side, None] + rank
            table[:, along[0]] = quads[:, side]
        return table

    @cached_property
    def _turned(self) -> Ints:
        """Rows of control points parallel to each side of a patch, (4, d + 1, d + 1)."""
        grid = np.arange((self.degree + 1) ** 2).reshape(self.degree + 1, -1)
        # Row by row inwards, each in the direction of the side.
        return np.stack([grid.T, grid[::-1], grid.T[::-1, ::-1], grid[:, ::-1]])

    def beside(self, sides: Ints, row: int) -> Ints:
        """Return the control points of a `row` beside `sides` (k,) of quads, (k, d + 1).

        Row 0 lies on the side, row 1 next to it; in the direction of the side.
        """
        points: Ints = self.of_patch[(sides >> 2)[:, None], self._turned[sides & 3, row]]
        return points

    def seen_from(self, sides: Ints) -> Ints:
        """Return the control points of the patches with `sides` (...), (..., (d + 1)²).

        Row by row from the side, each in its direction.
        """
        places = self._turned.reshape(4, -1)[sides & 3]
        points: Ints = self.of_patch[(sides >> 2)[..., None], places]
        return points

    def gathered(self, patches: Floats) -> Points:
        """Return the mean of what `patches` (f, (d + 1)², 3) have at each control point."""
        uses = np.bincount(self.of_patch.reshape(-1), minlength=self.count)
        values = patches.reshape(*self.of_patch.shape, 3)
        means: Points = sums_by_row(values, self.of_patch, self.count)
        means /= np.maximum(uses, 1)[:, None]
        return means
