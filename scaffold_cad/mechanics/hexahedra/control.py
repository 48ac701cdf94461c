"""The few points that all others of hexahedra depend on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy import sparse

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points, UnitVectors

Onto: TypeAlias = Callable[[Ints, Points], tuple[Points, UnitVectors]]
"""What puts control points (q,), moved to places (q, 3), back on their surface, with its normals
there, (q, 3)."""


@dataclass(frozen=True, eq=False)
class Control:
    """Points of a mesh as fixed combinations of fewer control points, some of which may move."""

    weights: sparse.csr_array
    """Shape (p, c): each point is a combination of control points."""
    hexahedra: Ints
    """Points of each hexahedron, shape (k, 8)."""
    movable: Bools
    """Which control points may move, shape (c,)."""
    scale: Floats
    """What counts as a large move of each, shape (c,), mm."""
    sliding: Bools
    """Which of those that may move stay on a surface, shape (c,)."""
    onto: Onto
    """Puts them back there."""
    hub: Ints
    """Hub that each control point is, or is around, shape (c,)."""
    narrow: Callable[[], Points] | None
    """Returns where they stand in nodes that can be narrowed toward their hubs, shape (c, 3), mm;
    none for points that must stay on a surface."""

    def touched(self, cells: Ints) -> Bools:
        """Return which control points the points of `cells` depend on, (c,)."""
        rows = self.weights[np.unique(cells)]
        touched = np.zeros(self.weights.shape[1], dtype=np.bool_)
        touched[rows.indices] = True
        return touched
