"""Struts that can be printed without supports: none lies too flat, each hangs on lower ones."""

from __future__ import annotations

import logging

import numpy as np

from scaffold_cad.base.arguments import (
    as_direction,
    as_number,
    as_real,
    check_kind,
    checks_keywords,
)
from scaffold_cad.base.arrays import Bools, Floats
from scaffold_cad.base.placements import DirectionLike
from scaffold_cad.base.summaries import counted
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.skeleton.skeleton import Skeleton

PLATE = 1e-6
"""Height above the lowest node up to which nodes stand on the plate, in heights of the whole."""

_log = logging.getLogger(__name__)


@checks_keywords()
def self_supporting(
    skeleton: Skeleton,
    angle: float = np.pi / 4,
    direction: DirectionLike = (0.0, 0.0, 1.0),
    *,
    bridge: float = 0.0,
) -> Skeleton:
    """Return the struts that can be printed without supports.

    A node is held if it stands on the plate, at the height of the lowest one, or if a strut that
    is steep enough leads up to it from a node that is held. Steep struts between held nodes stay,
    and flat ones between two held nodes that are short enough to be bridged. The log reports how
    many are dropped.

    Parameters
    ----------
    skeleton : of any kind
    angle : least angle of struts to the plate, rad
    direction : of building, upwards
    bridge : length up to which flatter struts between two held nodes stay, mm

    Raises
    ------
    OptionError
        If an argument is out of its range.
    SkeletonError
        If no strut is left.

    Examples
    --------
    >>> from scaffold_cad import tile
    >>> octet = tile("octet", 10.0, 2, radius=0.5)
    >>> len(self_supporting(octet).edges) < len(octet.edges)
    True
    """
    check_kind(skeleton, Skeleton)
    up = as_direction(direction, "direction")
    if not 0 <= as_real(angle, "angle") <= np.pi / 2:
        raise OptionError(f"angle is {angle:g} rad; need 0 to pi/2")
    longest = as_number(bridge, "bridge", or_zero=True)
    heights = skeleton.nodes @ up  # (n,)
    rises = np.diff(heights[skeleton.edges], axis=1)[:, 0]  # (m,)
    steep = np.abs(rises) >= np.sin(angle) * skeleton.lengths * (1 - 1e-9)
    held = _held(skeleton, heights, rises, steep & (rises != 0))
    both = held[skeleton.edges].all(axis=1)
    kept = both & (steep | (skeleton.lengths <= longest))
    if not kept.any():
        raise SkeletonError(
            f"no strut rises at {np.degrees(angle):g} degrees or more from the lowest nodes; "
            "need one"
        )
    _log.info(
        "%d of %s left out: nothing below holds them", np.sum(~kept), counted(len(kept), "strut")
    )
    return skeleton.with_edges(kept)


def _held(skeleton: Skeleton, heights: Floats, rises: Floats, carries: Bools) -> Bools:
    """Return which nodes are held by struts that carry, (n,)."""
    low = float(heights.min())
    held = heights <= low + PLATE * max(float(np.ptp(heights)), 1e-9)
    edges = skeleton.edges[carries]
    upward = np.where((rises[carries] > 0)[:, None], edges, edges[:, ::-1])  # lower node first
    while True:
        reached = upward[held[upward[:, 0]], 1]
        new = reached[~held[reached]]
        if len(new) == 0:
            return held
        held[new] = True
