"""Runs of round struts as hexahedra need them: whether they have any, edges along them, turns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, place_text
from scaffold_cad.base.vectors import dot
from scaffold_cad.errors import OptionError
from scaffold_cad.struts import RoundStruts
from scaffold_cad.struts.meshes.bands import matching
from scaffold_cad.struts.runs import Runs


def check_has_hexahedra(struts: RoundStruts) -> None:
    """Raise unless all struts are solid, with a proved surface of patches."""
    if struts.inner is not None:
        raise OptionError(
            f"round struts with a wall of {struts.options.wall:g} mm have no hexahedra; need solid "
            "ones, wall=None"
        )
    if struts.options.nodes != "blend":
        raise OptionError(
            f"round struts with nodes={struts.options.nodes!r} have no hexahedra; need "
            "nodes='blend'"
        )
    nodes = struts.runs.nodes
    crowded = np.flatnonzero(struts.crowded)
    if len(crowded):
        raise OptionError(
            f"node {crowded[0]} at {place_text(nodes[crowded[0]])} is crowded: its struts have no "
            f"surface of their own there ({len(crowded)} in all), so no hexahedra; need thinner "
            "struts, a smaller blend, or wider angles"
        )
    over = struts.overlapping
    if len(over):
        middle = nodes[struts.skeleton.edges[over[0]]].mean(axis=0)
        raise OptionError(
            f"strut {over[0]} overlaps others near {place_text(middle)} ({len(over)} in all), so "
            "it has no hexahedra; need thinner struts"
        )
    balls = struts.runs.tails[struts.at_balls]
    if len(balls):
        raise OptionError(
            f"node {balls[0]} at {place_text(nodes[balls[0]])} is a ball at an extremity "
            f"({len(balls)} in all), which has no hexahedra; need it as thin as its strut"
        )


@dataclass(frozen=True, eq=False)
class RunEdges(Frozen):
    """The edges of the skeleton along each run."""

    runs: Runs
    """All runs."""
    edge: Ints
    """Edges run by run, from the first node on, shape (m',)."""
    run: Ints
    """Run of each, shape (m',)."""
    start: Floats
    """Distance from the run's first node at which each begins, shape (m',), mm."""
    number: Ints
    """Run that each of the straight ones is, shape (k',)."""

    @staticmethod
    def of(struts: RoundStruts) -> RunEdges:
        """Return the edges of round struts."""
        runs, skeleton = struts.runs, struts.skeleton
        edge = np.flatnonzero(runs.run_of_edge >= 0)
        run = runs.run_of_edge[edge]
        offsets = skeleton.nodes[skeleton.edges[edge]] - runs.nodes[runs.edges[run, :1]]
        axis = np.broadcast_to(runs.directions[2 * run, None], offsets.shape)
        start = dot(offsets, axis).min(axis=1)
        order = np.lexsort((start, run))
        number = np.flatnonzero(~struts.curves.curved)
        return RunEdges(runs, edge[order], run[order], start[order], number)

    def at(self, run: Ints, places: Points) -> Ints:
        """Return the edge of each run (q,) that is nearest to places (q, 3)."""
        offset = places - self.runs.nodes[self.runs.edges[run, 0]]
        share = dot(offset, self.runs.directions[2 * run]) / self.runs.lengths[run]
        key = run + np.clip(share, 0.0, 1.0 - 1e-9)
        place = np.searchsorted(self._key, key, side="right")
        found: Ints = self.edge[np.maximum(place - 1, 0)]
        return found

    @property
    def _key(self) -> Floats:
        share = np.clip(self.start / self.runs.lengths[self.run], 0.0, 1.0)
        return np.asarray(self.run + np.where(share < 1e-12, 0.0, share), dtype=np.float64)


@dataclass(frozen=True, eq=False)
class RunTurns(Frozen):
    """How the rings at both ends of runs are joined."""

    shift: Ints
    """Quarters by which they are, as in `Matching`, shape (k,)."""
    turn: Floats
    """How far the patches at each half-run turn its ring, shape (2 k,), rad."""
    rest: Floats
    """What is left for the straight part, shape (k,), rad."""
    radius: Floats
    """Radius of each half-run's ring, shape (2 k,), mm."""

    @staticmethod
    def of(struts: RoundStruts) -> RunTurns:
        """Return the turns of straight struts: shared out by length."""
        runs, x = struts.runs, struts.x
        matched = matching(x[::2], np.cross(runs.directions[::2], x[::2]), x[1::2], 4)
        share = np.zeros(len(struts.collar))
        for group in struts.blended:
            share[group.half_runs] = (struts.collar / np.repeat(runs.lengths, 2))[group.half_runs]
        turn = np.repeat(matched.twist, 2) * share
        radius = runs.radii_at(np.arange(len(struts.collar)), struts.collar)
        return RunTurns(matched.shift, turn, matched.twist - turn[::2] - turn[1::2], radius)

    def seen_along(self, half_runs: Ints, rings: Ints) -> Ints:
        """Return rings (..., sides) of half-runs (...) as seen along the run, corner to corner."""
        sides = rings.shape[-1]
        place = np.arange(sides)
        back = (self.shift[half_runs >> 1, None] * (sides // 4) - place) % sides
        order = np.where((half_runs % 2 == 0)[..., None], place, back)
        return np.take_along_axis(rings, order, axis=-1)
