"""How small cells are at the rims of flat ends, which a field cuts off by some tenths of a cell."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.base.boxes import overlapping_boxes
from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.base.vectors import length
from scaffold_cad.solid.field.struts import FieldStruts

ALONE, COVERED = 0.5, 0.25
"""Size of cells at the rim of a flat end, as a part of that elsewhere: where nothing else is near,
and rims may have polygons in their place later, and where other struts are."""

REACH = 1.5
"""How far from an end other struts are near it, in its radius."""


def rim_fractions(struts: FieldStruts) -> Floats:
    """Return how small cells are at each rim, as a part of that elsewhere, (m, 2); 1 without."""
    found = np.where(struts.flat, ALONE, 1.0)
    strut, end = np.nonzero(struts.flat)
    if len(strut) == 0:
        return found
    tip, reach = struts.ends[strut, end], REACH * struts.radii[strut, end]
    thick = struts.radii.max(axis=1)
    low = np.concatenate([tip - reach[:, None], struts.ends.min(axis=1) - thick[:, None]])
    high = np.concatenate([tip + reach[:, None], struts.ends.max(axis=1) + thick[:, None]])
    for i, j in overlapping_boxes(low, high):
        # Pairs of an end and a strut: ends come first.
        pair = (i < len(tip)) & (j >= len(tip))
        i, j = i[pair], j[pair] - len(tip)
        i, j = i[strut[i] != j], j[strut[i] != j]
        at, on = nearest_on_segments(tip[i], tip[i], struts.ends[j, 0], struts.ends[j, 1])
        near = i[length(at - on) < reach[i] + thick[j]]
        found[strut[near], end[near]] = COVERED
    return found
