"""How far the sides of triangles of fields may be inside of round surfaces, place by place."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.base.vectors import length
from scaffold_cad.solid.field import FieldStruts

SMALLER = 4.0
"""By how much less room sides have where walls crossed: cells are half as large."""

MOST_PLACES = 100
"""Most places that are kept of a try."""


@dataclass(frozen=True, eq=False)
class Sags:
    """How much room the sides of triangles have, and where they have less."""

    usual: float
    """Where nothing crossed, mm."""
    places: tuple[Points, ...] = ()
    """Where walls crossed, one array (p, 3) a try, mm."""

    def smaller_at(self, places: Points) -> Sags:
        """Return the same with less room near `places` (p, 3)."""
        step = -(-len(places) // MOST_PLACES)
        return replace(self, places=(*self.places, places[::step]))

    def of(self, struts: FieldStruts) -> Floats:
        """Return the room of each strut of a field, mm, (m,)."""
        found = np.full(len(struts.radii), self.usual)
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
