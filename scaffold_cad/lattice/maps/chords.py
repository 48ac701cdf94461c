"""Struts of a lattice on a map: straight chords of the curves that the map bends them to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points
from scaffold_cad.lattice.maps.cellmap import CellMap
from scaffold_cad.lattice.maps.grading import Grading
from scaffold_cad.lattice.struts import Struts


@dataclass(frozen=True, eq=False)
class Chords(Struts):
    """Struts between nodes on a map, each the chord of a curve."""

    mapping: CellMap
    grading: Grading | None
    """How places are moved within the unit cubes, if they are."""
    first: Points
    """u, v and w where each strut starts, shape (m, 3)."""
    spans: Points
    """How far it goes along them, shape (m, 3)."""
    patch: Ints
    """The unit cube that each is in, shape (m,)."""
    stretch: Floats
    """Length of each strut over that in a cell of the mean size, shape (m,)."""
    counts: tuple[int, int, int]
    """Cells along u, v and w, in each patch."""
    cell: Floats
    """Size of a mean cell along u, v and w, shape (3,), mm."""

    def at(self, strut: Ints, along: Floats) -> Points:
        """Return places on the curves (k, 3), mm, see `Struts.at`."""
        places = self.first[strut] + along[:, None] * self.spans[strut]
        places = np.where(self.mapping.wraps, places % 1.0, places)
        patch = self.patch[strut]
        if self.grading is not None:
            places = self.grading.moved(places, patch)
        return self.mapping.positions(places, patch)
