"""Joints of curves: where two edges meet as samples of one curve, and their strut runs on smoothly.

A chain of edges says nothing about whether it is meant as straight members or as a curve. Joints
are taken for samples of a curve if they turn little, the shorter edge of each is short, the arc
over it rises little, and there are several in a row; or if their edges are too short for a bend.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints
from scaffold_cad.base.vectors import angle_between
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts.options import Joints
from scaffold_cad.struts.runs import Runs

SAME_RADIUS = 1e-9
"""Radii of two edges at their joint that differ by less are equal, in radii."""

SAMPLED_TURN = np.pi / 4
"""Greatest turn of a joint that is taken for a sample of a curve, rad."""

SAMPLED_LENGTH = 6.0
"""Greatest length of the shorter edge of such a joint, in radii."""

SAMPLED_RISE = 0.25
"""Greatest rise of the arc over the shorter edge of such a joint, in radii."""

MOST_TURN = np.pi / 2
"""Greatest turn at which a strut can run on through a joint, rad."""

MOST_BEND = 0.95
"""Greatest curvature at a joint, times the radius: at 1 the inside of the strut is a crease."""

TURNING = 4.0
"""How far from its joint a straight strut begins, in radii times the turn (rad), if it can."""

LEAST_TURNING = 2.5
"""The same where there is no more room: below that the inside of wide bends folds. On a link to an
extremity, which leaves room to no other node, it is what there is."""

LEAST_REACH = 0.05
"""Least distance from a joint at which a straight strut begins, in radii."""

LEAST_STRAIGHT = 0.2
"""Least part of a run that stays straight, if any does."""


@dataclass(frozen=True, eq=False)
class CurvedJoints(Frozen):
    """The joints of curves among the nodes of runs."""

    at: Bools
    """Whether each node is a joint of a curve, shape (n,)."""
    wanted: Floats
    """Distance from its node at which the straight part of each half-run at such a joint begins, if
    there is room, shape (2 k,), mm; 0 at other nodes."""
    least: Floats
    """The same, where there is no more room, shape (2 k,), mm."""
    curved: Bools
    """Runs between two such joints that have no straight part, shape (k,)."""


def possible(skeleton: Skeleton, runs: Runs) -> Bools:
    """Return the joints through which a strut can run on smoothly, shape (n,).

    Both edges have one radius there, the node has no ball, and the bend is wider than the strut.
    """
    found = np.zeros(len(runs.nodes), dtype=np.bool_)
    nodes, pairs, turns = _joints(runs)
    radii = runs.radii.reshape(-1)[pairs]  # (j, 2)
    lengths = runs.lengths[pairs >> 1]
    thick = radii.max(axis=1)
    bend = 4 * np.sin(turns / 2) / lengths.sum(axis=1)
    found[nodes] = (
        (np.abs(radii[:, 0] - radii[:, 1]) <= SAME_RADIUS * thick)
        & (skeleton.radii[nodes] <= thick * (1 + SAME_RADIUS))
        & (turns <= MOST_TURN)
        & (bend * thick <= MOST_BEND)
    )
    return found


def sampled(runs: Runs, among: Bools, joints: Joints) -> Bools:
    """Return the joints that are taken for samples of curves, shape (n,).

    Parameters
    ----------
    among : (n,) those that are possible
    joints : all of them for "curve", none for "blend", and for "auto" those that the module names
    """
    if joints != "auto":
        return among & (joints == "curve")
    found = np.zeros_like(among)
    nodes, pairs, turns = _joints(runs)
    radius = runs.radii.reshape(-1)[pairs].min(axis=1)
    short = runs.lengths[pairs >> 1].min(axis=1)
    found[nodes] = (
        (turns <= SAMPLED_TURN)
        & (short <= SAMPLED_LENGTH * radius)
        & (short * turns / 8 <= SAMPLED_RISE * radius)
    )
    found &= among
    in_a_row = np.zeros_like(found)
    in_a_row[runs.edges[found[runs.edges].all(axis=1)]] = True
    return in_a_row


def curved_joints(
    runs: Runs, at: Bools, collars: Floats, closed: float, curved: Bools | None = None
) -> CurvedJoints:
    """Return how far the curves through some joints reach along their runs.

    Parameters
    ----------
    at : (n,) the joints
    collars : (2 k,) distances from other nodes that their blends and balls ask for, mm
    closed : thickness of the plane ends of hollow struts, mm
    curved : (k,) runs without a straight part, if that is known
    """
    nodes, pairs, turns = _joints(runs)
    chosen = at[nodes]
    pairs, turns = pairs[chosen], turns[chosen, None]
    radius = runs.radii.reshape(-1)[pairs]  # (j, 2)
    lengths = runs.lengths
    wanted, least = np.zeros(len(runs.tails)), np.zeros(len(runs.tails))
    # As long as what follows on the other side: curves sampled evenly have no straight parts.
    wanted[pairs] = np.maximum(lengths[pairs[:, ::-1] >> 1], TURNING * turns * radius)
    least[pairs] = np.maximum(LEAST_TURNING * turns, LEAST_REACH) * radius
    is_joint = at[runs.edges]  # (k, 2)
    both = is_joint.all(axis=1)
    usable = (1 - LEAST_STRAIGHT) * lengths
    if curved is None:
        curved = both & (wanted.reshape(-1, 2).sum(axis=1) > usable)
    total = wanted.reshape(-1, 2).sum(axis=1)
    shrunk = np.divide(usable, total, out=np.ones_like(total), where=total > usable)
    wanted[np.repeat(both, 2)] *= np.repeat(shrunk, 2)[np.repeat(both, 2)]
    single = np.flatnonzero(is_joint.reshape(-1) & ~np.repeat(both, 2))
    at_end = runs.valency[runs.tails[single ^ 1]] == 1
    least[single] = np.minimum(least[single], np.where(at_end, usable[single >> 1], np.inf))
    room = usable[single >> 1] - np.maximum(np.where(at_end, closed, 0.0), collars[single ^ 1])
    wanted[single] = np.clip(wanted[single], least[single], np.maximum(room, least[single]))
    none = np.repeat(curved, 2)
    wanted[none], least[none] = 0.0, 0.0
    return CurvedJoints(at, wanted, least, curved)


def joints_inside(runs: Runs, joints: CurvedJoints, collars: Floats) -> CurvedJoints:
    """Return joints whose curves reach as far as those outside, where runs inside are as long.

    Parameters
    ----------
    runs, joints : those inside
    collars : (2 k,) of the outside, mm
    """
    at_end = runs.valency[runs.tails.reshape(-1, 2)[:, ::-1].reshape(-1)] == 1
    most = np.where(at_end, (1 - LEAST_STRAIGHT / 2) * np.repeat(runs.lengths, 2), np.inf)
    along = np.where(joints.wanted > 0, np.minimum(collars, most), 0.0)
    return replace(joints, wanted=along, least=along)


def _joints(runs: Runs) -> tuple[Ints, Ints, Floats]:
    """Return the nodes of two runs, their half-runs (j, 2), and by how much they turn, rad."""
    nodes = np.flatnonzero(runs.valency == 2)
    pairs = runs.incidence.at_nodes(nodes, 2)
    directions = runs.directions[pairs]
    return nodes, pairs, angle_between(directions[:, 0], -directions[:, 1])
