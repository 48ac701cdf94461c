"""Lattices without the cut struts that overlap others: what is left has a B-rep.

Where the surface of a part cuts a strut close to its node, what is left of it is shorter than the
node is wide and runs into its neighbours.
"""

from __future__ import annotations

import logging

import numpy as np

from scaffold_cad.arrays import Bools
from scaffold_cad.parts.bodies import overlapping_struts
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.skeleton import Skeleton

_log = logging.getLogger(__name__)


def without_overlapping_stubs(skeleton: Skeleton, *, smooth: bool) -> Scaffold:
    """Return the scaffold, with collars, without the struts that end free and overlap others.

    Struts that overlap and do not end free stay.
    """
    count = len(skeleton.edges)
    while True:
        scaffold = build_scaffold(skeleton, collars=True)
        is_stub = (skeleton.valency[skeleton.edges] == 1).any(axis=1)
        keep = np.ones(len(skeleton.edges), dtype=np.bool_)
        keep[overlapping_struts(scaffold, smooth)] = False
        keep |= ~is_stub
        if keep.all() or not keep.any():
            break
        skeleton = _with_struts(skeleton, keep)
    dropped = count - len(scaffold.skeleton.edges)
    if dropped:
        _log.info("%d of %d struts left out: they end free and overlap others", dropped, count)
    return scaffold


def _with_struts(skeleton: Skeleton, keep: Bools) -> Skeleton:
    """Return the struts marked in `keep` (m,) and their nodes."""
    nodes, ends = np.unique(skeleton.edges[keep], return_inverse=True)
    return Skeleton(skeleton.nodes[nodes], ends.reshape(-1, 2), skeleton.radii[nodes])
