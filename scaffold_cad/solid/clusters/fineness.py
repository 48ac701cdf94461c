"""How fine the triangles of fields are, place by place."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.base.vectors import length
from scaffold_cad.solid.field import FieldStruts
from scaffold_cad.solid.field.solid import SIDES

SMALLER = 4.0
"""By how much less room sides have where walls crossed: cells are half as large."""

MOST_PLACES = 100
"""Most places that are kept of a try."""


@dataclass(frozen=True, eq=False)
class Fineness:
    """How many vertices fields have around struts, and where they have more."""

    sides: int = SIDES
    """About so many vertices are around each strut."""
    sag: float = np.inf
    """How far the sides of triangles may be inside of round surfaces where nothing crossed, mm."""
    places: tuple[Points, ...] = ()
    """Where walls crossed, one array (p, 3) a try, mm."""

    def finer_at(self, places: Points) -> Fineness:
        """Return the same with finer triangles near `places` (p, 3)."""
        step = -(-len(places) // MOST_PLACES)
        return replace(self, places=(*self.places, places[::step]))

    def sags(self, struts: FieldStruts) -> Floats:
        """Return how far sides may be inside of the round surface of each strut, mm, (m,)."""
        found = np.full(len(struts.radii), self.sag)
        start, end = struts.ends[:, 0], struts.ends[:, 1]
        reach = struts.radii.max(axis=1) + 2.0 * struts.blend
        for places in self.places:
            near = np.zeros(len(found), dtype=np.bool_)
            for place in places:
                here = np.broadcast_to(place, start.shape)
                _, nearest = nearest_on_segments(here, here, start, end)
                near |= length(nearest - here) < reach
            found[near] /= SMALLER
        return found
