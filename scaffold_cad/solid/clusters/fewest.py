"""How many sides the polygons of round struts need so that they keep apart as their circles do.

Polygons reach beyond their circles, for the volume of these: struts that are nearer to each other
than that would cross. A field in their place is filleted, and would fill the gap between them.
"""

from __future__ import annotations

import logging

from scaffold_cad.base.arrays import Edges, place_text
from scaffold_cad.base.summaries import counted
from scaffold_cad.struts.apart import Slack, crossings
from scaffold_cad.struts.meshes.bands import polygon_slack
from scaffold_cad.struts.model import RoundStruts

MOST = 256
"""Sides up to which they are doubled: these reach beyond their circles by 0.0002 of the radius."""

_log = logging.getLogger(__name__)


def fewest_sides(struts: RoundStruts, sides: int) -> int:
    """Return `sides`, or as many times 2 of them as keep struts apart that are proved to be so.

    Where some overlap in any case, or even `MOST` are not enough, they are `sides`; the latter is
    logged, as these struts come to be united.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, round_struts
    >>> ends = [[0, 0, 0], [20, 0, 0], [0, 2.05, 0], [20, 2.05, 0]]
    >>> fewest_sides(round_struts(Skeleton(ends, [[0, 1], [2, 3]], 1.0)), 16)
    32
    """
    if len(struts.overlapping):
        return sides
    enough = sides
    while len(near := _near(struts, enough)):
        if 2 * enough > MOST:
            _report(struts, near)
            return sides
        enough *= 2
    if enough > sides:
        _log.info("struts pass each other closely: circles have %d sides, not %d", enough, sides)
    return enough


def _near(struts: RoundStruts, sides: int) -> Edges:
    """Return the pairs of runs whose polygons are not known to keep apart, (p, 2)."""
    return crossings(
        struts.runs,
        struts.blended,
        struts.curves,
        struts.collar,
        struts.options.ends,
        struts.crowded,
        Slack(polygon_slack(sides)),
        sharp=struts.sharp,
    ).runs


def _report(struts: RoundStruts, near: Edges) -> None:
    edges = [int((struts.runs.run_of_edge == run).argmax()) for run in near[0]]
    _log.warning(
        "%s each other by less than %.2g radii, and are united: edges %d and %d, near %s, first; "
        "need more room between them, or a STEP file",
        counted(len(near), "pair of struts passes", "pairs of struts pass"),
        2 * polygon_slack(MOST),
        *edges,
        place_text(struts.skeleton.nodes[struts.skeleton.edges[edges[0]]].mean(axis=0)),
    )
