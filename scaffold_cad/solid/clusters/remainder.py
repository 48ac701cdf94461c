"""What is left of round struts beside clusters: struts of their own between nodes and cuts."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.vectors import any_perpendicular
from scaffold_cad.solid.clusters.spans import BAND, CUT, Spans, radii_at
from scaffold_cad.struts.curves.cuts import CutCurves, cut_curves
from scaffold_cad.struts.model import BlendedNodes, RoundStruts
from scaffold_cad.struts.runs import Runs
from scaffold_cad.struts.sharp.nodes import SharpNodes


@dataclass(frozen=True, eq=False)
class Cuts(Frozen):
    """Where fields are cut off, and struts of their own begin."""

    span: Ints
    """Span that each is an end of, shape (c,)."""
    base: Points
    """Where the span ends on the strut's axis, shape (c, 3), mm."""
    outward: UnitVectors
    """Direction of the axis, away from the field, shape (c, 3)."""
    radius: Floats
    """Radius of the strut there, shape (c,), mm."""
    slope: Floats
    """Growth of the radius outward, mm per mm, shape (c,)."""
    node: Ints
    """Node of the remainder at the ring, `CUT` radii further, shape (c,)."""

    def chosen(self, rows: Ints) -> Cuts:
        """Return some of them."""
        return Cuts(
            self.span[rows],
            self.base[rows],
            self.outward[rows],
            self.radius[rows],
            self.slope[rows],
            self.node[rows],
        )


@dataclass(frozen=True, eq=False)
class Remainder(Frozen):
    """Struts without what is in clusters."""

    struts: RoundStruts
    """The struts left, which end at nodes of their own where they are cut."""
    run: Ints
    """Run of the whole that each run left is a part of, shape (b,)."""
    cuts: Cuts
    """Two for each span but where it ends at nodes; then those of curves."""
    cut_curves: CutCurves
    """The curves left, and where they are cut."""

    @property
    def open_at(self) -> Bools:
        """Nodes at cuts, shape (n',)."""
        found = np.zeros(len(self.struts.runs.nodes), dtype=np.bool_)
        found[self.cuts.node] = True
        return found


def remainder(struts: RoundStruts, nodes: Bools, spans: Spans, pieces: Bools) -> Remainder:
    """Return the struts without `nodes` (n,) and `spans`, which leave room between them.

    Parameters
    ----------
    pieces : (p,) of curves that are left out too
    """
    runs = struts.runs
    straight, at_low, at_high = _cuts(runs, spans)
    run, edges, half_run = _bands(runs, spans, at_low, at_high)
    cut = cut_curves(struts.curves, pieces, len(runs.tails), 2)
    cuts = _with_curves(straight, struts, spans, cut)
    own = half_run >= 0
    collar = np.where(own, struts.collar[half_run], 0.0)
    x = np.where(own[:, None], struts.x[half_run], 0.0)
    number = np.full(len(runs.tails), -1, dtype=np.intp)
    number[half_run[own]] = np.flatnonzero(own)
    blended = [_without(group, nodes, number) for group in struts.blended]
    sharp = [_without(group, nodes, number) for group in struts.sharp]
    # Beside the circles of cut curves stand short straight struts.
    short = np.stack([cut.nodes, cuts.node[len(straight.node) :]], axis=1)
    radii = [_radii(runs, half_run, edges, straight), np.repeat(cut.radii[:, None], 2, axis=1)]
    places = [runs.nodes, cuts.base + (CUT * cuts.radius)[:, None] * cuts.outward]
    left = Runs.of(
        np.concatenate(places),
        np.concatenate([edges, short]),
        np.concatenate(radii),
        np.full_like(runs.run_of_edge, -1),  # an edge may be cut in several
    )
    number = np.append(number, len(half_run) + np.arange(2 * len(cut.nodes)))
    own = np.append(own, np.zeros(2 * len(cut.nodes), dtype=np.bool_))
    x = np.concatenate([x, np.repeat(cut.x, 2, axis=0)])
    own[len(half_run) :: 2] = True
    _turn_cuts(left, x, own)
    collar = np.append(collar, np.zeros(2 * len(cut.nodes)))
    curves, curved = cut.curves, struts.curves.curved[run]
    ends = np.where(curves.half_runs < 0, -1, number[curves.half_runs])
    run = np.append(run, spans.run[cuts.span[len(straight.node) :]])
    curved = np.append(curved, np.zeros(len(cut.nodes), dtype=np.bool_))
    rest = replace(
        struts,
        curves=replace(curves, half_runs=ends, curved=curved),
        crowded_runs=np.zeros(len(run), dtype=np.bool_),
        runs=left,
        blended=tuple(group for group in blended if len(group.nodes)),
        sharp=tuple(group for group in sharp if len(group.nodes)),
        collar=collar,
        x=x,
        like=None,
        inner=None,
    )
    return Remainder(rest, run, cuts, cut)


def _cuts(runs: Runs, spans: Spans) -> tuple[Cuts, Ints, Ints]:
    """Return the cuts, and the node at the low and at the high end of each span or -1, (q,)."""
    low = np.flatnonzero(spans.low > 0)
    high = np.flatnonzero(spans.high < runs.lengths[spans.run])
    span = np.concatenate([low, high])
    run = spans.run[span]
    place = np.concatenate([spans.low[low], spans.high[high]])
    sign = np.concatenate([-np.ones(len(low)), np.ones(len(high))])
    ahead = runs.directions[2 * run]
    number = len(runs.nodes) + np.arange(len(span))
    at_low, at_high = np.full(len(spans), -1), np.full(len(spans), -1)
    at_low[low], at_high[high] = number[: len(low)], number[len(low) :]
    base = runs.nodes[runs.edges[run, 0]] + place[:, None] * ahead
    cuts = Cuts(
        span,
        base,
        sign[:, None] * ahead,
        radii_at(runs, run, place),
        sign * runs.slopes[2 * run],
        number,
    )
    return cuts, at_low, at_high


def _with_curves(straight: Cuts, struts: RoundStruts, spans: Spans, cut: CutCurves) -> Cuts:
    """Return cuts, and those of curves after them."""
    curves, runs = struts.curves, struts.runs
    # The axes in a wall's two fields are one, so that it keeps its thickness.
    room = (CUT + BAND) * (cut.radii + struts.within)
    return Cuts(
        np.append(straight.span, np.searchsorted(spans.run, curves.run[curves.pieces[cut.beyond]])),
        np.concatenate([straight.base, runs.nodes[cut.nodes] + room[:, None] * cut.outward]),
        np.concatenate([straight.outward, -cut.outward]),
        np.append(straight.radius, cut.radii),
        np.append(straight.slope, np.zeros(len(room))),
        np.append(straight.node, len(runs.nodes) + len(straight.node) + np.arange(len(room))),
    )


def _bands(runs: Runs, spans: Spans, at_low: Ints, at_high: Ints) -> tuple[Ints, Edges, Ints]:
    """Return the runs (b,), the nodes (b, 2) and the half-runs (2 b,) of what is left.

    Half-runs that leave a cut are -1.
    """
    every = np.arange(len(runs.edges))
    none = np.full(len(every), -1)
    # What is left of a run begins at its first node or at the end of a span, by turns with where
    # it ends.
    begin = np.lexsort((np.append(none, spans.high), np.append(every, spans.run)))
    end = np.lexsort((np.append(none + np.inf, spans.low), np.append(every, spans.run)))
    run = np.append(every, spans.run)[begin]
    first = np.append(runs.edges[:, 0], at_high)[begin]
    last = np.append(runs.edges[:, 1], at_low)[end]
    own_first = np.append(2 * every, np.full(len(spans), -1))[begin]
    own_last = np.append(2 * every + 1, np.full(len(spans), -1))[end]
    there = (first >= 0) & (last >= 0)
    edges = np.stack([first, last], axis=1)[there]
    return run[there], edges, np.stack([own_first, own_last], axis=1)[there].reshape(-1)


def _radii(runs: Runs, half_run: Ints, edges: Edges, cuts: Cuts) -> Floats:
    """Return the radii at both nodes of what is left, shape (b, 2), mm."""
    count = len(runs.nodes)
    own = runs.radii.reshape(-1)[half_run]
    if len(cuts.node) == 0:
        return own.reshape(-1, 2)
    at_cut = np.clip(edges.reshape(-1) - count, 0, len(cuts.node) - 1)
    cut = (cuts.radius * (1.0 + CUT * cuts.slope))[at_cut]
    return np.where(half_run >= 0, own, cut).reshape(-1, 2)


def _turn_cuts(runs: Runs, x: UnitVectors, own: Bools) -> None:
    """Let the ring at each cut begin where that at the other end of its strut does."""
    cut = np.flatnonzero(~own)
    x[cut] = x[cut ^ 1]
    lone = np.flatnonzero((x == 0).all(axis=1))
    first = lone[lone % 2 == 0]
    x[first] = any_perpendicular(runs.directions[first])
    x[first + 1] = x[first]


_Nodes = TypeVar("_Nodes", BlendedNodes, SharpNodes)


def _without(group: _Nodes, nodes: Bools, number: Ints) -> _Nodes:
    """Return nodes that are in no cluster, with the numbers of half-runs that are left."""
    kept = ~nodes[group.nodes]
    changed: dict[str, Ints | Floats] = {
        "nodes": group.nodes[kept],
        "half_runs": number[group.half_runs[kept]],
        "shape_of": group.shape_of[kept],
    }
    if isinstance(group, SharpNodes):
        changed["size"] = group.size[kept]
    return replace(group, **changed)  # type: ignore[arg-type]
