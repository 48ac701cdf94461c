"""Open ends of hollow struts that come to lie in fields, and are closed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scaffold_cad.base.arrays import Bools
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.runs import Runs


def shortened(struts: RoundStruts, closed: Bools, wall: float) -> RoundStruts:
    """Return struts that end a wall before `closed` (n,) ends, where they are to be open."""
    runs, skeleton = struts.runs, struts.skeleton
    half = np.flatnonzero(closed[runs.tails])
    if struts.options.ends != "open" or len(half) == 0:
        return struts
    nodes, radii = runs.nodes.copy(), runs.radii.reshape(-1).copy()
    nodes[runs.tails[half]] += wall * runs.directions[half]
    radii[half] += wall * runs.slopes[half]
    moved = Runs.of(nodes, runs.edges, radii.reshape(-1, 2), runs.run_of_edge)
    sizes = skeleton.radii.copy()
    sizes[runs.tails[half]] = radii[half]  # a node thicker than its tapered strut would be a ball
    own = Skeleton(skeleton.nodes, skeleton.edges, sizes, skeleton.edge_radii)
    return replace(struts, runs=moved, skeleton=own)
