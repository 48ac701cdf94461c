"""Clusters: what of round struts has no room for a surface of its own, and what comes near it.

A cluster begins with a node that is not proved, with a strut that has no room between its collars,
or where two struts cross. It grows along its struts to where each is alone, and takes in what
comes within reach of its fillets, until all that is outside keeps apart from all that is inside.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Frozen, Ints
from scaffold_cad.base.vectors import length, normalize
from scaffold_cad.solid.clusters.core import Core
from scaffold_cad.solid.clusters.nearness import near_spans
from scaffold_cad.solid.clusters.remainder import Remainder, remainder
from scaffold_cad.solid.clusters.spans import (
    Spans,
    merged,
    no_spans,
    radii_at,
    tail_length,
    whole_runs,
)
from scaffold_cad.solid.clusters.stumps import GAP, Reaches, stumps
from scaffold_cad.solid.clusters.zones import Lines, Zones, core_of, lines_to, zones_of
from scaffold_cad.struts.apart import Slack, meeting
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.pieces import (
    Pieces,
    ball_pieces,
    capsules,
    curve_pieces,
    joined,
    node_pieces,
    sharp_pieces,
    strut_pieces,
    with_domes,
)
from scaffold_cad.struts.runs import Runs, balls_of

MOST_FIELD = 0.8
"""Where the struts of clusters have a larger part of the area than this, all becomes one field:
then cuts save nothing."""

SETTLED = 0.01
"""By how much spans may still grow where clusters have settled, in radii."""

ALONG_CURVES = 6.0
"""Length of curve, in radii, along which spans of it that come near each other are neighbors."""

TAPERS = 4
"""Pieces that a span of a cone is cut into, so that its larger radius bounds little."""

STRUT, NODE, SPAN, DUMMY = range(4)
"""What a piece is: of a strut left, of a node left, of a span, or of what is cut off a field."""

FIELD = (SPAN, SPAN, DUMMY, SPAN)
"""What spans, what leads to cuts of curves, what is cut off, and balls are."""


@dataclass(frozen=True, eq=False)
class Clusters(Frozen):
    """Nodes and spans that are made as a field, and the struts that are left."""

    core: Core
    """What they began with, and what came near."""
    nodes: Bools
    """Shape (n,)."""
    pieces: Bools
    """Pieces of curves, shape (p,)."""
    spans: Spans
    """By run and place, with room for struts of their own between them."""
    reached: Floats
    """Fillet radius at each node, as wanted or what has room, shape (n,), mm."""
    blend: Floats
    """Fillet radius of each span, shape (q,), mm."""
    rest: Remainder
    """What is left."""
    lines: Lines
    """How the axes of the field lead to the cuts of curves."""
    seeds: Spans
    """Spans that they began with, and what came near: with these they are soon found again."""


def most_field(struts: RoundStruts) -> float:
    """Return the part of the area in clusters from which on all becomes one field.

    Ends that come to lie in a field are closed: open ones stay out of it as long as they can.
    """
    return 1.0 if struts.options.ends == "open" else MOST_FIELD


def bodies_of(struts: RoundStruts) -> Pieces:
    """Return the pieces around nodes and curves, and balls at extremities."""
    runs = struts.runs
    return joined(
        [
            node_pieces(runs, struts.blended),
            curve_pieces(struts.curves),
            sharp_pieces(runs, struts.sharp, struts.collar),
            ball_pieces(runs, struts.collar),
        ]
    )


def clusters_of(
    struts: RoundStruts,
    bodies: Callable[[], Pieces],
    fillets: Floats,
    slack: Slack,
    core: Core,
    seeds: Spans,
    most: float = 1.0,
) -> Clusters | None:
    """Return the least clusters that hold some nodes, pieces of curves and spans.

    None are returned once they have more than a part of the struts' area.

    Parameters
    ----------
    bodies : gives those of the struts, see `bodies_of`
    fillets : (n,) fillet radius wanted at each node, mm
    slack : how much thicker all are taken to be
    most : that part
    """
    runs, curves = struts.runs, struts.curves
    most_area = most * whole_runs(runs).areas(runs).sum()
    reaches = Reaches(struts, fillets)
    while True:
        inside, zones, spans, reached = _settled(reaches, core, seeds)
        if spans.areas(runs).sum() > most_area:
            return None
        blend = _span_fillets(struts, spans, reached, fillets)
        rest = remainder(struts, inside, spans, zones.pieces)
        found = _Found(struts, bodies(), rest, spans, reached, blend, inside, zones.pieces)
        joining, near = found.meeting(slack)
        bent = curves.curved[near.run]
        more = joining.pieces | np.isin(curves.run[curves.pieces], near.run[bent])
        more &= curves.curved[curves.run[curves.pieces]] | joining.pieces
        near = near.chosen(~bent)
        settled = spans.covers(near, SETTLED * runs.radii.min(axis=1)[near.run]).all()
        if settled and not (joining.nodes & ~inside).any() and not (more & ~core.pieces).any():
            lines = found.lines
            return Clusters(core, inside, zones.pieces, spans, reached, blend, rest, lines, seeds)
        core = replace(core.with_nodes(joining.nodes), pieces=core.pieces | more)
        seeds = Spans.joined([seeds, near])


def _settled(reaches: Reaches, core: Core, seeds: Spans) -> tuple[Bools, Zones, Spans, Floats]:
    """Return nodes, zones, spans and the fillets of nodes, once all have room beside them."""
    struts, nodes = reaches.struts, core.nodes
    runs, curves = struts.runs, struts.curves
    while True:
        pieces = core.pieces | core_of(curves, nodes)
        zones = zones_of(curves, pieces, len(nodes), core.zone)
        inside = nodes | zones.nodes
        made = stumps(reaches, inside)
        collar = struts.collar.reshape(-1, 2)
        free = np.stack([collar[:, 0], runs.lengths - collar[:, 1]], axis=1)
        free = np.where(made.nodes[runs.edges], [-np.inf, np.inf], free)
        half = np.flatnonzero(made.nodes[runs.tails] & ~np.repeat(curves.curved, 2))
        run, reach = half >> 1, made.length[half]
        all_of = runs.lengths[run]
        first = half % 2 == 0
        low = np.where(first, 0.0, all_of - reach)
        high = np.where(first, reach, all_of)
        whole = np.flatnonzero(made.whole | zones.runs(curves))
        every = Spans(whole, np.zeros(len(whole)), runs.lengths[whole])
        spans = merged(Spans.joined([Spans(run, low, high), every, seeds]), runs, free)
        more = made.nodes | spans.chosen(~curves.curved[spans.run]).nodes(runs)
        if not (more & ~inside).any():
            return inside, zones, spans, made.blend
        nodes = nodes | (more & ~inside)


def _span_fillets(struts: RoundStruts, spans: Spans, reached: Floats, wanted: Floats) -> Floats:
    """Return the fillet radius of each span, (q,): those of its nodes, or of its run's ends."""
    runs = struts.runs
    ends = runs.edges[spans.run]  # (q, 2)
    at_end = np.stack([spans.low == 0, spans.high == runs.lengths[spans.run]], axis=1)
    least = np.where(at_end, reached[ends], np.inf).min(axis=1)
    return np.asarray(np.where(at_end.any(axis=1), least, wanted[ends].min(axis=1)))


@dataclass(frozen=True, eq=False)
class _Found:
    """Looks for what comes near to what."""

    struts: RoundStruts
    bodies: Pieces
    rest: Remainder
    spans: Spans
    reached: Floats
    blend: Floats
    nodes: Bools
    zone: Bools

    @cached_property
    def lines(self) -> Lines:
        """How axes lead to the cuts of curves."""
        cut = self.rest.cut_curves
        first = len(self.rest.cuts.node) - len(cut.nodes)
        base, sizes = self.rest.cuts.base[first:], cut.radii + self.struts.within
        return lines_to(self.struts.runs, self.struts.curves, cut, base, sizes)

    def meeting(self, slack: Slack) -> tuple[Core, Spans]:
        """Return what has to join the clusters, and the stretches of runs that do."""
        pieces, kind, radius, blend = self._pieces(slack.ratio)
        pairs = meeting(pieces, slack.of(pieces))
        kinds = kind[pairs]
        idle = (kinds == DUMMY).any(axis=1) & (kinds < SPAN).any(axis=1)
        idle |= (kinds >= SPAN).all(axis=1) & self._along_one_curve(*pieces.run[pairs].T)
        pairs, kinds = pairs[~idle], kinds[~idle]
        found = pairs[kinds == NODE]
        at, folded = np.zeros_like(self.nodes), np.zeros_like(self.zone)
        at[pieces.nodes[found[pieces.curve[found] < 0], 0]] = True
        folded[pieces.curve[found[pieces.curve[found] >= 0]]] = True
        both = pairs[(kinds != NODE).all(axis=1)]
        near = [no_spans()]
        for own, other in (both.T, both[:, ::-1].T):
            gap = np.maximum(blend[own], blend[other])
            gap = np.maximum(gap, GAP * radius[own])
            inner = (kind[own] >= SPAN) & (kind[other] >= SPAN)
            near.append(
                near_spans(self.struts.runs, pieces, own, other, radius[other] + gap, inner)
            )
        return Core(at, folded, np.zeros_like(folded), no_spans()), Spans.joined(near)

    def _pieces(self, slack: float) -> tuple[Pieces, Ints, Floats, Floats]:
        """Return all pieces, what they are, their radii without fillets, and their fillets."""
        rest, runs, cuts = self.rest, self.struts.runs, self.rest.cuts
        balls, sizes = balls_at(self.struts, self.nodes)
        parts = [self._spans(), self._leads(), self._dummies(), _balls(runs, balls, sizes)]
        kept = self._taper_of()
        kept = kept[~self.lines.passed[self.spans.run[kept]]]
        lead = cuts.span[len(cuts.span) - len(self.lines.joints) :]
        blends = [self.blend[row] for row in (kept, lead, cuts.span)] + [self.reached[balls]]
        kinds = [np.full(len(part.radius), kind) for part, kind in zip(parts, FIELD, strict=True)]
        radii = [part.radius for part in parts]
        pieces = [_padded(joined(parts), 0.5 * np.concatenate(blends))]
        if len(rest.run):
            curved = rest.struts.curves.curved
            bands, ends = rest.struts.runs, self.struts.options.ends
            collar = with_domes(bands, rest.struts.collar, ends, len(runs.nodes), slack)
            left = strut_pieces(bands, curved, collar)
            of_run = rest.run[left.run]
            left = replace(left, nodes=runs.edges[of_run], run=of_run)
            in_cluster = np.asarray(self.nodes[self.bodies.nodes].any(axis=1))
            curve = np.flatnonzero(self.bodies.curve >= 0)
            in_cluster[curve] = self.zone[self.bodies.curve[curve]]
            bodies = self.bodies.chosen(~in_cluster)
            pieces += [left, bodies]
            kinds += [np.full(len(left.run), STRUT), np.full(len(bodies.run), NODE)]
            radii += [left.radius, bodies.radius]
            blends.append(np.zeros(len(left.run) + len(bodies.run)))
        kind = np.concatenate(kinds)
        return joined(pieces), kind, np.concatenate(radii), np.concatenate(blends)

    def _along_one_curve(self, one: Ints, other: Ints) -> Bools:
        """Return whether pairs of runs (p,) follow each other nearly along a curve."""
        curves = self.struts.curves
        first = curves.pieces
        way = length(curves.centers[first + 1] - curves.centers[first])
        size = way / np.maximum(curves.radii[first], curves.radii[first + 1])
        # A run that is curved from end to end is one piece, and balls have none.
        of, place = (np.full(len(curves.curved) + 1, value) for value in (-1, 0.0))
        bent = np.flatnonzero(curves.curved[curves.run[first]])
        run = curves.run[first[bent]]
        of[run], place[run] = curves.curve_of_piece[bent], (np.cumsum(size) - size / 2)[bent]
        whole = np.bincount(curves.curve_of_piece, size, len(curves.closed))
        apart = np.abs(place[one] - place[other])
        closed = np.append(np.where(curves.closed, whole, np.inf), np.inf)[of[one]]
        apart = np.minimum(apart, closed - apart)
        return np.asarray((of[one] >= 0) & (of[one] == of[other]) & (apart < ALONG_CURVES))

    def _taper_of(self) -> Ints:
        """Return the span of each piece of a span."""
        cone = self.struts.runs.slopes[2 * self.spans.run] != 0
        return np.repeat(np.arange(len(cone)), np.where(cone, TAPERS, 1))

    def _spans(self) -> Pieces:
        """Return the pieces of spans; at nodes they end in balls."""
        runs, spans = self.struts.runs, self.spans
        which = self._taper_of()
        which = which[~self.lines.passed[spans.run[which]]]
        count = np.bincount(which, minlength=len(spans))[which]
        piece = np.arange(len(which)) - np.searchsorted(which, which)
        run, low, high = spans.run[which], spans.low[which], spans.high[which]
        bounds = [low + (high - low) * (piece + side) / count for side in (0, 1)]
        radius = np.maximum(*(radii_at(runs, run, bound) for bound in bounds))
        start = np.where(bounds[0] == 0, -radius, bounds[0])
        end = np.where(bounds[1] == runs.lengths[run], bounds[1] + radius, bounds[1])
        return _capsules(runs, run, start, end, radius, self._ends()[which])

    def _leads(self) -> Pieces:
        """Return what leads from joints to the cuts of curves."""
        runs, cuts, joints = self.struts.runs, self.rest.cuts, self.lines.joints
        first = len(cuts.node) - len(joints)
        start, end = runs.nodes[joints], cuts.base[first:]
        radius = np.maximum(cuts.radius[first:], radii_of(runs)[joints])
        start = start - radius[:, None] * normalize(end - start)
        nodes = np.stack([joints, self.rest.cut_curves.nodes], axis=1)
        return capsules(start, end, radius, nodes, self.spans.run[cuts.span[first:]])

    def _dummies(self) -> Pieces:
        """Return what the struts of the field have past their cuts."""
        cuts = self.rest.cuts
        far = cuts.base + tail_length(cuts.radius, cuts.slope)[:, None] * cuts.outward
        far = far + cuts.radius[:, None] * cuts.outward
        radius = cuts.radius * (1.0 + np.maximum(cuts.slope, 0.0))
        return capsules(cuts.base, far, radius, self._ends()[cuts.span], self.spans.run[cuts.span])

    def _ends(self) -> Edges:
        """Return the nodes that spans touch, (q, 2), numbers of their own where they do not."""
        runs, spans = self.struts.runs, self.spans
        number = len(runs.nodes) + np.arange(2 * len(spans)).reshape(-1, 2)
        at_end = np.stack([spans.low == 0, spans.high == runs.lengths[spans.run]], axis=1)
        return np.where(at_end, runs.edges[spans.run], number)


def radii_of(runs: Runs) -> Floats:
    """Return the greatest radius of the runs at each node, mm, (n,)."""
    found = np.zeros(len(runs.nodes))
    np.maximum.at(found, runs.tails, runs.radii.reshape(-1))
    return found


def balls_at(struts: RoundStruts, nodes: Bools) -> tuple[Ints, Floats]:
    """Return those of `nodes` (n,) that are thicker than their struts, and their radii, mm."""
    radii = balls_of(struts.skeleton, struts.runs)
    rows = np.flatnonzero(nodes & (radii > 0))
    return rows, radii[rows]


def _balls(runs: Runs, rows: Ints, radius: Floats) -> Pieces:
    """Return balls at nodes, as cylinders around them."""
    step = radius[:, None] * np.array([1.0, 0.0, 0.0])
    center, same = runs.nodes[rows], np.repeat(rows[:, None], 2, axis=1)
    return capsules(center - step, center + step, radius, same, np.full(len(rows), -1))


def _padded(pieces: Pieces, more: Floats) -> Pieces:
    """Return pieces that reach so much further all around."""
    way = pieces.end - pieces.start
    step = more[:, None] * way / np.maximum(length(way), 1e-300)[:, None]
    return replace(
        pieces, start=pieces.start - step, end=pieces.end + step, radius=pieces.radius + more
    )


def _capsules(
    runs: Runs, run: Ints, low: Floats, high: Floats, radius: Floats, nodes: Edges
) -> Pieces:
    tail, ahead = runs.nodes[runs.edges[run, 0]], runs.directions[2 * run]
    return capsules(tail + low[:, None] * ahead, tail + high[:, None] * ahead, radius, nodes, run)
