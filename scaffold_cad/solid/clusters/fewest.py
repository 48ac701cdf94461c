"""How many sides the polygons of round struts need so that they keep apart as their circles do.

Polygons reach beyond their circles, for the volume of these: struts that are nearer to each other
than that would cross. A field in their place is filleted, and would fill the gap between them.
"""

from __future__ import annotations

import logging

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges
from scaffold_cad.solid.clusters.united import among, near_runs
from scaffold_cad.struts.apart import Slack
from scaffold_cad.struts.meshes.bands import polygon_slack
from scaffold_cad.struts.model import RoundStruts

MOST = 128
"""Sides up to which they are doubled: these reach beyond their circles by 0.0005 of the radius."""

MOST_CORNERS = 2_000_000
"""Polygons' corners up to which they are doubled, over two polygons a strut: some 1 GB of mesh."""

_log = logging.getLogger(__name__)


def fewest_sides(struts: RoundStruts, sides: int) -> int:
    """Return `sides`, or as many times 2 of them as keep struts apart that are proved to be so.

    Where some overlap, other pairs of one component do not count, such as a foam: all of it would
    get more triangles. Where even `MOST` are not enough, or the mesh would be too large, they are
    `sides`, and `tell_united` names what is united. Struts made like others have as many sides as
    the first of these.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, round_struts
    >>> ends = [[0, 0, 0], [20, 0, 0], [0, 2.05, 0], [20, 2.05, 0]]
    >>> fewest_sides(round_struts(Skeleton(ends, [[0, 1], [2, 3]], 1.0)), 16)
    32
    """
    overlap = len(struts.overlapping) > 0
    crossing = near_runs(struts) if overlap else np.zeros((0, 2), dtype=np.intp)
    given, most = sides, MOST
    if struts.like is not None:
        given = most = fewest_sides(struts.first, sides)
    enough, count = given, 2 * len(struts.runs.edges)
    while len(_near(struts, enough, crossing, overlap=overlap)):
        if 2 * enough > most or 2 * enough * count > MOST_CORNERS:
            return given
        enough *= 2
    if enough > given:
        _log.info("struts pass each other closely: circles have %d sides, not %d", enough, sides)
    return enough


def _near(struts: RoundStruts, sides: int, crossing: Edges, *, overlap: bool) -> Edges:
    """Return the pairs of runs that are apart and whose polygons may not be, (p, 2).

    Where some overlap, those of one component of the skeleton do not count: they are one body.

    Parameters
    ----------
    crossing : (q, 2) pairs of runs that overlap in any case
    overlap : whether any struts do, or their nodes
    """
    runs = struts.runs
    near = near_runs(struts, Slack(polygon_slack(sides)))
    pairs: Edges = near[~among(near, crossing, len(runs.edges))]
    if not overlap:
        return pairs
    part: Edges = struts.skeleton.component_of_node[runs.edges[pairs][:, :, 0]]  # (p, 2)
    apart: Bools = part[:, 0] != part[:, 1]
    return pairs[apart]
