"""Round struts whose nodes have edges: what `round_struts` makes of nodes="sharp" and "ball"."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import UnitVectors, place_text
from scaffold_cad.base.vectors import (
    STILL,
    best_turns,
    dot,
    normalize,
    rotated,
    shortest_turns,
)
from scaffold_cad.errors import PartitionError
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts.apart import crossings
from scaffold_cad.struts.curves.curve import Curves
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.options import StrutOptions
from scaffold_cad.struts.runs import Runs, at_balls, ball_collars
from scaffold_cad.struts.sharp.nodes import SharpNodes, ring_starts, seams_of, sharp_nodes


def sharp_struts(
    skeleton: Skeleton, options: StrutOptions, runs: Runs, like: RoundStruts | None
) -> RoundStruts:
    """Return solid struts whose nodes are sharp; nodes that are not proved are crowded.

    Parameters
    ----------
    like : struts that had their nodes elsewhere

    Raises
    ------
    PartitionError
        If a node is proved, and is not in `like`, or the other way around.
    """
    x = ring_starts(runs) if like is None else _turned(like, runs)
    made = sharp_nodes(skeleton, runs, x)
    if like is not None:
        _check_same_nodes(made, like, runs)
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
        like=like,
    )


def _turned(like: RoundStruts, runs: Runs) -> UnitVectors:
    """Return where the rings of half-runs begin, (2 k, 3): as in `like`, turned with their nodes.

    Both rings of a run are turned alike, by the mean of what its nodes that have other struts do.
    """
    before, after = like.runs.directions, runs.directions
    sums = np.zeros((len(runs.nodes), 3, 3))
    np.add.at(sums, runs.tails, after[:, :, None] * before[:, None])
    turns = best_turns(sums)[runs.tails]  # (2 k, 3, 3)
    x, ahead = (np.einsum("hij,hj->hi", turns, own) for own in (like.x, before))
    weight = np.maximum(runs.valency[runs.tails] - 1, STILL)[:, None]
    x = (weight * rotated(x, shortest_turns(ahead, after))).reshape(-1, 2, 3).sum(axis=1)
    after = after[0::2]
    return np.repeat(normalize(x - dot(x, after)[:, None] * after), 2, axis=0)


def _check_same_nodes(made: tuple[SharpNodes, ...], like: RoundStruts, runs: Runs) -> None:
    """Raise unless the nodes that are proved are those of `like`."""
    proved = np.zeros((2, len(runs.nodes)), dtype=np.bool_)
    for row, groups in enumerate((made, like.sharp)):
        for group in groups:
            proved[row, group.nodes] = True
    other = np.flatnonzero(proved[0] != proved[1])
    if len(other):
        node = int(other[0])
        which = "is not proved, and is in like" if proved[1, node] else "is not proved in like"
        raise PartitionError(
            f"node {node} at {place_text(runs.nodes[node])} {which}; need wider angles or longer "
            "struts there"
        )
