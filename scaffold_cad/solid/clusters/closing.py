"""Open ends of hollow struts that come to lie in fields, and are closed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scaffold_cad.base.arrays import Bools, place_text
from scaffold_cad.errors import MeshError, OptionError
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts.hollow.longends import with_long_ends
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.runs import Runs


def shortened(struts: RoundStruts, closed: Bools, wall: float) -> RoundStruts:
    """Return struts that end a wall before `closed` (n,) ends, where they are to be open.

    Raises
    ------
    MeshError
        If a chain of links is not longer than a wall.
    """
    runs, skeleton = struts.runs, struts.skeleton
    half = np.flatnonzero(closed[runs.tails])
    if struts.options.ends != "open" or len(half) == 0:
        return struts
    # Links that are shorter than a wall go on beyond it.
    links = Skeleton(runs.nodes, runs.edges, skeleton.radii, runs.radii)
    at_ends = np.zeros(len(runs.nodes))
    at_ends[runs.tails[half]] = wall
    try:
        links, at_ends = with_long_ends(links, at_ends)
    except OptionError:
        place = place_text(runs.nodes[runs.tails[half[0]]])
        raise MeshError(
            f"the open end near {place} lies among other struts and is closed there; need more "
            f"than {wall:g} mm of wall in its strut or in links that follow it"
        ) from None
    nodes, radii = links.nodes.copy(), links.edge_radii.reshape(-1).copy()
    cut = at_ends[runs.tails[half]]
    shrink = np.diff(links.edge_radii, axis=1)[:, 0] / links.lengths
    nodes[runs.tails[half]] += cut[:, None] * links.directions[half]
    radii[half] += cut * np.stack([shrink, -shrink], axis=1).reshape(-1)[half]
    moved = Runs.of(nodes, runs.edges, radii.reshape(-1, 2), runs.run_of_edge)
    sizes = links.radii.copy()
    sizes[runs.tails[half]] = radii[half]  # a node thicker than its tapered strut would be a ball
    own = Skeleton(skeleton.nodes, skeleton.edges, sizes, skeleton.edge_radii)
    return replace(struts, runs=moved, skeleton=own)
