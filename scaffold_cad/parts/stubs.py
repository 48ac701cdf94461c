"""Lattices without the cut struts that overlap others: what is left has a B-rep.

Where the surface of a part cuts a strut close to its node, what is left of it is shorter than the
node is wide and runs into its neighbors.
"""

from __future__ import annotations

import logging

import numpy as np

from scaffold_cad.base.arrays import Bools
from scaffold_cad.base.summaries import counted
from scaffold_cad.errors import BrepError
from scaffold_cad.products.models import Make, Model, overlapping
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts import RoundStruts

MOST_DROPPED = 0.2
"""Part of the struts that may be left out: with fewer left it is another lattice."""

_log = logging.getLogger(__name__)


def without_overlapping_stubs(skeleton: Skeleton, make: Make) -> Model:
    """Return the struts of `skeleton` without those that end free and overlap others.

    Struts that overlap and do not end free stay. A warning tells how many are left out.

    Raises
    ------
    BrepError
        If more than a fifth of the struts would be left out.
    """
    count = len(skeleton.edges)
    while True:
        model = make(skeleton)
        is_stub = (skeleton.valency[skeleton.edges] == 1).any(axis=1)
        keep = ~(is_stub & _in_the_way(model, is_stub))
        dropped = count - int(keep.sum())
        if dropped > MOST_DROPPED * count:
            raise BrepError(
                f"{dropped} of {count} struts end free and overlap others; need a fifth at most "
                'to leave them out (keep="whole" for struts that are not cut, dangling=False for '
                "no loose ends, smaller radii or larger cells, or overlaps='unite' if the union "
                "has few triangles; lattice_part makes a mesh of any)"
            )
        if keep.all():
            break
        skeleton = skeleton.with_edges(keep)
    if dropped:
        _log.warning(
            "%d of %s left out, with free ends that overlap others",
            dropped,
            counted(count, "strut"),
        )
    return model


def _in_the_way(model: Model, is_stub: Bools) -> Bools:
    """Return which struts overlap others, shape (m,).

    Of round struts only those without room for a surface of their own, while there are stubs among
    them: their neighbors overlap because of them, and may have room once they are gone.
    """
    if isinstance(model, RoundStruts) and (is_stub & ~model.exact).any():
        return ~model.exact
    found = np.zeros(len(is_stub), dtype=np.bool_)
    found[overlapping(model)] = True
    return found
