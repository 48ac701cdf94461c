"""Grid edges that the surface cuts, and the places on them that 32 bits hold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points
from scaffold_cad.solid.field.grid import Grid
from scaffold_cad.solid.field.lattice import FINEST_FRACTION, steps_on_edges
from scaffold_cad.solid.field.slots import Slots


@dataclass(frozen=True, eq=False)
class GridEdges(Frozen):
    """Grid edges that the surface cuts."""

    points: Ints
    """Grid points at both ends, shape (2, e); of one that was put in, see `Slots.ends`, 0."""
    put_in: Bools
    """Whether the second end is none of the grid's points, shape (e,)."""
    owner: Ints
    """A group at each, shape (e,)."""
    start: Points
    """First end, shape (e, 3), mm from the union's origin."""
    way: Floats
    """From there to the second end, shape (e, 3), mm."""
    steps: NDArray[np.int32]
    """A vertex stands at a multiple of 2^-steps of the way, shape (e,)."""

    def at(self, part: Floats) -> Points:
        """Return the places that are nearest to parts of the way (e,), (e, 3) mm.

        They are on the edge, not at its ends, and exact in 32 bits.
        """
        scale = np.ldexp(1.0, self.steps)
        margin = np.ldexp(1.0, -np.minimum(self.steps, FINEST_FRACTION))
        part = np.round(np.clip(part, margin, 1.0 - margin) * scale) / scale
        return self.start + part[:, None] * self.way


def grid_edges(grid: Grid, slots: Slots, edges: Ints) -> GridEdges:
    """Return the grid edges with some numbers (e,)."""
    start, end, owner, put_in = slots.ends(edges)
    place_a = grid.places[start].astype(np.intp)
    place_b = grid.places[np.where(put_in, 0, end)].astype(np.intp)
    size = 2 << (np.searchsorted(grid.first, owner[put_in], side="right") - 1)
    way = end[put_in]
    step = np.where(way & 1, size, -size)[:, None] * np.eye(3, dtype=np.intp)[way >> 1]
    place_b[put_in] = place_a[put_in] + step
    a, b = grid.lattice.places(place_a), grid.lattice.places(place_b)
    return GridEdges(
        points=np.stack([start, np.where(put_in, 0, end)]),
        put_in=put_in,
        owner=owner,
        start=a,
        way=b - a,
        steps=steps_on_edges(grid.lattice, place_a, place_b),
    )
