"""The rule for struts that overlap: unite them, refuse them, or allow faces that cross.

It is one rule for all that a skeleton's struts become: `write`, `to_brep`, the part objects, `show`
and the command line. Meshes are united by default, for that always works; B-reps are refused, for a
CAD program fails later on faces that cross. What is done is logged once.
"""

from __future__ import annotations

import logging
from typing import Literal, TypeAlias, get_args

import numpy as np

from scaffold_cad.base.arguments import check_choice
from scaffold_cad.base.arrays import Ints, place_text
from scaffold_cad.base.summaries import counted
from scaffold_cad.errors import BrepError
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts import RoundStruts

Overlaps: TypeAlias = Literal["unite", "refuse", "allow"]
"""What becomes of struts that overlap."""

NAMED = 5
"""Struts that a message names."""

FARTHER = (
    "joints farther apart make it longer: coarser samples of curves, or "
    "skeleton.simplified(tolerance)"
)
"""What helps where a strut is a sample of a curve."""

_log = logging.getLogger(__name__)


def to_unite(overlaps: Overlaps, edges: Ints, skeleton: Skeleton, room: str = "") -> bool:
    """Return whether `edges` are to be united; log what is done with them, or refuse them.

    Parameters
    ----------
    overlaps : the rule chosen
    edges : of `skeleton` whose struts overlap others or their nodes, ascending
    room : what of it is known to be too short, see `room_needed`

    Raises
    ------
    BrepError
        If there are any and the rule is to refuse them; edges and a place are named.
    OptionError
        If there is no such rule.
    """
    check_choice(overlaps, "overlaps", get_args(Overlaps))
    if len(edges) == 0:
        return False
    found = described(edges, skeleton)
    if overlaps == "refuse":
        raise BrepError(
            f"{found}{room}: faces would cross; need struts apart (smaller radii, larger cells, "
            "fewer joints) or joined where they cross (skeleton.joined(tolerance)), or "
            "overlaps='unite' for their union (round struts get plane facets where they overlap, "
            "square ones throughout), overlaps='allow' for faces that cross, or a mesh format, "
            "which unites them"
        )
    if overlaps == "allow":
        _log.warning("%s: faces cross there", found)
        return False
    _log.info("%s; they are united", found)
    return True


def room_needed(struts: RoundStruts) -> str:
    """Return how long the strut is that lacks most for its collars, and what they need."""
    runs = struts.runs
    needed = struts.collar.reshape(-1, 2).sum(axis=1)  # (k,)
    lacking = np.where(struts.crowded_runs, needed - runs.lengths, 0.0)
    run = int(np.argmax(lacking))
    if lacking[run] <= 0:
        return ""
    edge = int(np.flatnonzero(runs.run_of_edge == run)[0])
    between = (runs.valency[runs.edges[run]] == 2).any()
    return (
        f"; edge {edge} is {runs.lengths[run]:.4g} mm long, and its collars need {needed[run]:.4g}"
        + (f" ({FARTHER})" if between else "")
    )


def described(edges: Ints, skeleton: Skeleton) -> str:
    """Return how many struts overlap, which ones, and where the first of them is."""
    place = skeleton.nodes[skeleton.edges[edges[0]]].mean(axis=0)
    named = ", ".join(str(edge) for edge in edges[:NAMED].tolist())
    more = "" if len(edges) <= NAMED else ", ..."
    one = len(edges) == 1
    return (
        f"{len(edges)} of {counted(len(skeleton.edges), 'strut')} "
        f"{'overlaps' if one else 'overlap'} others or their nodes "
        f"({'edge' if one else 'edges'} {named}{more}; {'' if one else 'the first '}near "
        f"{place_text(place)})"
    )
