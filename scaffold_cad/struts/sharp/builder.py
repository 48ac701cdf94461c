"""Round struts with sharp nodes: what `round_struts` makes of nodes="sharp"."""

from __future__ import annotations

import numpy as np

from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts.apart import crossings
from scaffold_cad.struts.curves.curve import Curves
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.options import StrutOptions
from scaffold_cad.struts.runs import Runs, at_balls, ball_collars
from scaffold_cad.struts.sharp.nodes import ring_starts, seams_of, sharp_nodes


def sharp_struts(skeleton: Skeleton, options: StrutOptions, runs: Runs) -> RoundStruts:
    """Return solid struts whose nodes are sharp; nodes that are not proved are crowded."""
    x = ring_starts(runs)
    made = sharp_nodes(skeleton, runs, x)
    collar = ball_collars(skeleton, runs)
    crowded = runs.valency > 1
    for group in made:
        collar[group.half_runs] = group.collars
        crowded[group.nodes] = False
    no_room = seams_of(runs, made, x) < 0
    no_room |= collar.reshape(-1, 2).sum(axis=1) > runs.lengths
    crowded[runs.edges[no_room]] = True
    is_ball = np.zeros_like(crowded)
    is_ball[runs.tails[at_balls(runs, collar)]] = True
    crowded[(runs.valency <= 1) & ~is_ball] = False
    curves = Curves.none(len(runs.edges))
    crossing = crossings(runs, (), curves, collar, options.ends, crowded, sharp=made)
    crowded |= crossing.nodes
    nothing = np.full(len(skeleton.nodes), np.nan)
    return RoundStruts(
        skeleton,
        options,
        runs,
        (),
        collar,
        curves,
        x,
        nothing,
        nothing.copy(),
        crowded,
        no_room | crossing.struts | crowded[runs.edges].all(axis=1),
        sharp=made,
    )
