"""How many sides the polygons of round struts need so that they keep apart as their circles do.

Polygons reach beyond their circles, for the volume of these: struts that are nearer to each other
than that would cross. A field in their place is filleted, and would fill the gap between them.
"""

from __future__ import annotations

import logging

from scaffold_cad.base.arrays import Bools, Edges, place_text
from scaffold_cad.base.summaries import counted
from scaffold_cad.struts.apart import Slack, crossings
from scaffold_cad.struts.meshes.bands import polygon_slack
from scaffold_cad.struts.model import RoundStruts

MOST = 128
"""Sides up to which they are doubled: these reach beyond their circles by 0.0005 of the radius."""

MOST_CORNERS = 2_000_000
"""Polygons' corners up to which they are doubled, over two polygons a strut: some 1 GB of mesh."""

_log = logging.getLogger(__name__)


def fewest_sides(struts: RoundStruts, sides: int) -> int:
    """Return `sides`, or as many times 2 of them as keep struts apart that are proved to be so.

    Struts that overlap others in any case do not count, and where there are some, neither do other
    pairs of one component, such as a foam: all of it would get more triangles. Where even `MOST`
    are not enough, or the mesh would be too large, they are `sides`, and a warning tells that these
    struts come to be united. Struts made like others have as many sides as the first of these.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, round_struts
    >>> ends = [[0, 0, 0], [20, 0, 0], [0, 2.05, 0], [20, 2.05, 0]]
    >>> fewest_sides(round_struts(Skeleton(ends, [[0, 1], [2, 3]], 1.0)), 16)
    32
    """
    crossing = struts.crowded_runs | struts.crowded[struts.runs.edges].any(axis=1)
    given, most = sides, MOST
    if struts.like is not None:
        given = most = fewest_sides(struts.like, sides)
    enough, count = given, 2 * len(crossing)
    while len(near := _near(struts, enough, crossing)):
        if 2 * enough > most or 2 * enough * count > MOST_CORNERS:
            _report(struts, near, enough)
            return given
        enough *= 2
    if enough > given:
        _log.info("struts pass each other closely: circles have %d sides, not %d", enough, sides)
    return enough


def _near(struts: RoundStruts, sides: int, crossing: Bools) -> Edges:
    """Return the pairs of runs that are apart and whose polygons may not be, (p, 2).

    Where some overlap, those of one component of the skeleton do not count: they are one body.

    Parameters
    ----------
    crossing : (k,) runs that overlap others in any case
    """
    runs = crossings(
        struts.runs,
        struts.blended,
        struts.curves,
        struts.collar,
        struts.options.ends,
        struts.crowded,
        Slack(polygon_slack(sides)),
        sharp=struts.sharp,
    ).runs
    pairs: Edges = runs[~crossing[runs].any(axis=1)]
    if not crossing.any():
        return pairs
    part: Edges = struts.skeleton.component_of_node[struts.runs.edges[pairs][:, :, 0]]  # (p, 2)
    apart: Bools = part[:, 0] != part[:, 1]
    return pairs[apart]


def _report(struts: RoundStruts, near: Edges, sides: int) -> None:
    edges = [int((struts.runs.run_of_edge == run).argmax()) for run in near[0]]
    _log.warning(
        "%s each other by less than %.2g radii, and are united: edges %d and %d, near %s, first; "
        "need more room between them, or a STEP file",
        counted(len(near), "pair of struts passes", "pairs of struts pass"),
        2 * polygon_slack(sides),
        *edges,
        place_text(struts.skeleton.nodes[struts.skeleton.edges[edges[0]]].mean(axis=0)),
    )
