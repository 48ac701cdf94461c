"""Chains of links that end flat: links before the last one reach beyond its end, and are cut there.

A link ends in balls, which stand out past the flat end of the chain where links are shorter than
they are thick.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.vectors import dot
from scaffold_cad.solid.field.struts import FieldStruts

MOST_TURN = 0.5
"""Least cosine between the end and links that are cut there: what turns away further is another
part of the chain."""

MOST_GROWTH = 1.5
"""Largest radius of links that are cut, over that of the end: what is thicker is more than a link,
such as the body of a cell."""


@dataclass(frozen=True, eq=False)
class EndPlanes(Frozen):
    """Planes of flat ends, and the struts that they cut."""

    tips: Points
    """A point of each plane, shape (p, 3), mm."""
    outward: UnitVectors
    """Shape (p, 3)."""
    last: Ints
    """Strut that ends at each plane, shape (p,)."""
    of: Ints
    """Planes that cut each strut, -1 for none, shape (2, m): of the chain's ends that its own first
    and second end lead to."""

    def cut(self, side: Floats, x: Points, struts: Ints) -> Floats:
        """Return distances (k,) of points (k, 3) from struts that end at these planes."""
        found = side.copy()
        for row, _, beyond in self._beyond(x, struts):
            found[row] = np.maximum(found[row], beyond)
        return found

    def last_at(self, x: Points, struts: Ints) -> Ints:
        """Return the last strut of the chain where points (k, 3) are beyond its end, (k,)."""
        found = struts.copy()
        for row, plane, beyond in self._beyond(x, struts):
            found[row] = np.where(beyond > 0, self.last[plane], found[row])
        return found

    def _beyond(self, x: Points, struts: Ints) -> list[tuple[Ints, Ints, Floats]]:
        """Return which points are of struts that planes cut, these, and how far beyond they are."""
        parts = []
        for plane in self.of[:, struts] if len(self.tips) else ():
            row = np.flatnonzero(plane >= 0)
            of = plane[row]
            parts.append((row, of, dot(x[row] - self.tips[of], self.outward[of])))
        return parts


def end_planes(struts: FieldStruts, origin: Floats) -> EndPlanes:
    """Return the planes of flat ends that the balls of other links of their chains reach beyond."""
    lengths = struts.lengths
    none = np.full((2, len(lengths)), -1, dtype=np.intp)
    strut, end = np.nonzero(struts.flat & (lengths > 0)[:, None])
    tips = struts.ends[strut, end]
    outward = (tips - struts.ends[strut, 1 - end]) / lengths[strut, None]
    near = lengths[strut] < struts.radii.max(axis=1)[strut]
    strut, end, tips, outward = strut[near], end[near], tips[near], outward[near]
    sizes = struts.radii[strut, end]
    planes = EndPlanes(tips - origin, outward, strut, none)
    if len(strut) == 0:
        return planes
    _, joint = np.unique(struts.ends.reshape(-1, 3) + 0.0, axis=0, return_inverse=True)
    joint = np.where((lengths > 0)[:, None], joint.reshape(-1, 2), -1)  # (m, 2), no balls
    flat = joint.reshape(-1)
    order = np.argsort(flat, kind="stable")
    start = np.searchsorted(flat[order], np.arange(flat.max() + 2))
    of, plane = none.copy(), np.arange(len(strut))
    while len(plane):
        tail = joint[strut, 1 - end]
        first = start[tail]
        passing = start[tail + 1] - first == 2
        plane, strut, end, first = (each[passing] for each in (plane, strut, end, first))
        pair = np.stack([order[first], order[first + 1]], axis=1)
        other = np.where(pair[:, 0] // 2 == strut, pair[:, 1], pair[:, 0])
        strut, end = other // 2, other % 2
        place = struts.ends[strut, end]
        way = (place - struts.ends[strut, 1 - end]) / lengths[strut, None]
        reach = dot(place - tips[plane], outward[plane]) + struts.radii[strut, end]
        reach += struts.blend[strut]
        alike = struts.radii[strut].max(axis=1) < MOST_GROWTH * sizes[plane]
        ahead = dot(way, outward[plane]) > MOST_TURN
        on = (reach > 0) & alike & ahead
        plane, strut, end = plane[on], strut[on], end[on]
        of[end, strut] = plane
    return replace(planes, of=of)
