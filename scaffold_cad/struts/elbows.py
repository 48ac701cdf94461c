"""Elbows: bends of two equal cylinders that are a part of an exact torus, tangent to both.

An elbow with centerline radius R and turn θ begins and ends R tan(θ / 2) from its node. It lies
between two half-planes that end in the torus' axis, θ apart, and each strut lies within a quarter
turn beyond its half-plane: as R is more than the strut's radius, for θ < π all three are apart.

For meshes and for distances to neighbors the elbow is a curve of `PIECES` pieces, off the torus by
1e-7 of R at a turn of 90° and 1e-5 at 170°; its face is the torus itself.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, fields, replace

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, UnitVectors, place_text
from scaffold_cad.base.vectors import angle_between, normalize
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts.curves.curve import Curves
from scaffold_cad.struts.curves.joints import SAME_RADIUS, CurvedJoints
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.options import Bend
from scaffold_cad.struts.runs import Runs

USUAL = 3.0
"""Centerline radius of elbows without one given, in radii of the strut: 1.5 diameters, as of pipe
fittings."""
LEAST = 1.25
"""Least centerline radius, in radii of the strut."""
LEAST_TURN, MOST_TURN = 1e-3, np.radians(170)
"""Turns that elbows can have, rad."""
PIECES = 4
"""Pieces of the curve that stands for an elbow."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Elbows(Frozen):
    """The bends that are to be parts of tori."""

    nodes: Ints
    """Shape (q,)."""
    half_runs: Ints
    """The two that leave each, shape (q, 2)."""
    turns: Floats
    """By how much each turns, shape (q,), rad."""
    wanted: Floats
    """Centerline radius if there is room, shape (q,), mm."""
    least: Floats
    """The same where there is no more room, shape (q,), mm."""

    def chosen(self, keep: Bools) -> Elbows:
        """Return some of them."""
        return Elbows(*(getattr(self, each.name)[keep] for each in fields(self)))

    def with_room(self, runs: Runs, short: Bools, least: Floats) -> Elbows:
        """Return those that have room; the log says what the others lack.

        Parameters
        ----------
        short : (n,) nodes whose runs have no room
        least : (2 k,) what nodes need of each half-run at least, mm
        """
        lost = short[self.nodes]
        for node, half_runs, radius, turn in zip(
            self.nodes[lost].tolist(),
            self.half_runs[lost],
            self.least[lost].tolist(),
            self.turns[lost].tolist(),
            strict=True,
        ):
            run = half_runs >> 1
            needed = least.reshape(-1, 2).sum(axis=1)[run]
            worst = int((needed - runs.lengths[run]).argmax())
            _log.warning(
                "the bend at node %d (%s) is a blend: a torus with a centerline radius of %.4g "
                "mm takes %.4g mm of its strut to node %d, whose nodes need %.4g mm of its %.4g mm",
                *(node, place_text(runs.nodes[node]), radius, radius * np.tan(turn / 2)),
                *(runs.edges[run[worst]].sum() - node, needed[worst], runs.lengths[run[worst]]),
            )
        return self.chosen(~lost)

    def crossing(self, nodes: Points, crowded: Bools) -> Bools:
        """Return the nodes, among `crowded` (n,), whose elbow meets others, (n,), and log them.

        Parameters
        ----------
        nodes : (n, 3) their positions, mm
        """
        found = np.zeros_like(crowded)
        found[self.nodes] = crowded[self.nodes]
        for node in np.flatnonzero(found).tolist():
            _log.warning(
                "the bend at node %d (%s) is a blend: its torus would meet other struts",
                *(node, place_text(nodes[node])),
            )
        return found

    def beside(self, joints: CurvedJoints) -> CurvedJoints:
        """Return what curves want of their runs, and elbows too."""
        wanted, least = joints.wanted.copy(), joints.least.copy()
        ratio = np.tan(self.turns / 2)
        wanted[self.half_runs] = (self.wanted * ratio)[:, None]
        least[self.half_runs] = (self.least * ratio)[:, None]
        return replace(joints, wanted=wanted, least=least)

    def cut(self, runs: Runs, closed: float) -> Floats:
        """Return what the ends of struts beside elbows take of them inside, (2 k,), mm.

        Parameters
        ----------
        closed : by how much the inside of struts is shorter at extremities, mm
        """
        found = np.zeros(len(runs.tails))
        beyond = self.half_runs ^ 1
        found[beyond] = np.where(runs.valency[runs.tails[beyond]] == 1, closed, 0.0)
        return found

    def radii(self, collar: Floats) -> Floats:
        """Return the centerline radii (q,) that there is room for within `collar` (2 k,), mm."""
        found: Floats = collar[self.half_runs].min(axis=1) / np.tan(self.turns / 2)
        return found


def elbows_of(
    skeleton: Skeleton,
    runs: Runs,
    among: Bools,
    bend: Bend,
    like: RoundStruts | None,
    outer: RoundStruts | None,
) -> Elbows:
    """Return the bends that can be elbows, whether there is room or not.

    Both struts are cylinders of one radius, and the node has no ball.

    Parameters
    ----------
    among : (n,) nodes that are looked at
    bend : of `StrutOptions`
    like : struts that had the nodes elsewhere
    outer : what they are the inside of
    """
    model = like if outer is None else outer
    among = among & (bend != "blend")
    if model is not None:
        among = among & np.isfinite(model.bends)
    found, thick = _even_bends(skeleton, runs, among)
    if outer is not None:
        return replace(found, wanted=outer.bends[found.nodes], least=outer.bends[found.nodes])
    if isinstance(bend, str):
        return replace(found, wanted=USUAL * thick, least=LEAST * thick)
    tight = bend < LEAST * thick
    for node, radius in zip(found.nodes[tight].tolist(), thick[tight].tolist(), strict=True):
        _log.warning(
            "the bend at node %d (%s) is a blend: its centerline radius of %g mm is too tight for "
            "struts of radius %g mm; need %g mm or more",
            *(node, place_text(runs.nodes[node]), bend, radius, LEAST * radius),
        )
    given = np.full(len(thick), float(bend))
    return replace(found, wanted=given, least=given).chosen(~tight)


def _even_bends(skeleton: Skeleton, runs: Runs, among: Bools) -> tuple[Elbows, Floats]:
    """Return the bends between two equal cylinders, of no radius yet, and their struts', (q,)."""
    nodes = np.flatnonzero((runs.valency == 2) & among)
    pairs = runs.incidence.at_nodes(nodes, 2)  # (q, 2)
    radii = runs.radii.reshape(-1)[pairs]
    directions = runs.directions[pairs]
    turns = angle_between(directions[:, 0], -directions[:, 1])
    thick = radii.max(axis=1)
    even = (
        (np.abs(radii[:, 0] - radii[:, 1]) <= SAME_RADIUS * thick)
        & (runs.slopes[pairs] == 0).all(axis=1)
        & (skeleton.radii[nodes] <= thick * (1 + SAME_RADIUS))
        & (turns > LEAST_TURN)
        & (turns < MOST_TURN)
    )
    none = np.zeros(len(nodes))
    return Elbows(nodes, pairs, turns, none, none).chosen(even), thick[even]


@dataclass(frozen=True, eq=False)
class Tori(Frozen):
    """Parts of tori: from angle 0, at the first of two half-runs, on to `turns`."""

    half_runs: Ints
    """Shape (q, 2)."""
    centers: Points
    """Shape (q, 3), mm."""
    x: UnitVectors
    """From the center to that of the first circle, shape (q, 3)."""
    y: UnitVectors
    """The way the elbow runs there, shape (q, 3)."""
    radii: Floats
    """Of the centerline, shape (q,), mm."""
    turns: Floats
    """Shape (q,), rad."""

    @property
    def z(self) -> UnitVectors:
        """Axes of the tori, shape (q, 3)."""
        return np.cross(self.x, self.y)


def tori_of(runs: Runs, half_runs: Ints, radii: Floats) -> Tori:
    """Return the tori of elbows.

    Parameters
    ----------
    half_runs : (q, 2) that leave their nodes
    radii : (q,) of the centerlines, mm
    """
    ahead = runs.directions[half_runs]  # (q, 2, 3)
    turns = angle_between(ahead[:, 0], -ahead[:, 1])
    node = runs.nodes[runs.tails[half_runs[:, 0]]]
    inward = normalize(ahead.sum(axis=1))
    centers = node + (radii / np.cos(turns / 2))[:, None] * inward
    start = node + (radii * np.tan(turns / 2))[:, None] * ahead[:, 0]
    return Tori(half_runs, centers, normalize(start - centers), -ahead[:, 0], radii, turns)


def elbow_curves(runs: Runs, elbows: Elbows, radii: Floats) -> Curves:
    """Return the curves that stand for elbows.

    Parameters
    ----------
    radii : (q,) of the centerlines, mm
    """
    tori, count = tori_of(runs, elbows.half_runs, radii), len(radii)
    angle = tori.turns[:, None] * np.arange(PIECES + 1) / PIECES  # (q, 5)
    cosine, sine = np.cos(angle)[..., None], np.sin(angle)[..., None]
    x = cosine * tori.x[:, None] + sine * tori.y[:, None]
    tangents = cosine * tori.y[:, None] - sine * tori.x[:, None]
    centers = tori.centers[:, None] + radii[:, None, None] * x
    bends = -x / radii[:, None, None]
    nodes = np.repeat(elbows.nodes[:, None], PIECES + 1, axis=1)
    nodes[:, [0, -1]] = -1
    run = np.repeat(elbows.half_runs >> 1, PIECES // 2, axis=1)
    run = np.concatenate([run, np.full((count, 1), -1)], axis=1)
    size = np.repeat(runs.radii.reshape(-1)[elbows.half_runs[:, 0]], PIECES + 1)
    still = np.zeros(count * (PIECES + 1))
    return Curves(
        (PIECES + 1) * np.arange(count + 1),
        elbows.half_runs,
        nodes.reshape(-1),
        run.reshape(-1),
        centers.reshape(-1, 3),
        tangents.reshape(-1, 3),
        x.reshape(-1, 3),
        size,
        size,
        still,
        bends.reshape(-1, 3),
        still,
        np.zeros(len(runs.edges), dtype=np.bool_),
        radii,
    )
