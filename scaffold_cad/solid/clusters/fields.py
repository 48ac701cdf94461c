"""The field of clusters: the struts of spans, which go on past the places where they are cut."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.solid.clusters.growth import Clusters, balls_at, radii_of
from scaffold_cad.solid.clusters.spans import radii_at, tail_length
from scaffold_cad.solid.field import FieldStruts, field_struts
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.runs import Runs


def cluster_struts(struts: RoundStruts, clusters: Clusters) -> FieldStruts:
    """Return what the field of clusters is made of."""
    runs, spans, cuts = struts.runs, clusters.spans, clusters.rest.cuts
    tail, ahead = runs.nodes[runs.edges[spans.run, 0]], runs.directions[2 * spans.run]
    bounds = np.stack([spans.low, spans.high], axis=1)  # (q, 2)
    at_end = np.stack([spans.low == 0, spans.high == runs.lengths[spans.run]], axis=1)
    first = len(cuts.node) - len(clusters.lines.joints)  # of the cuts of curves
    tails = tail_length(cuts.radius, cuts.slope)
    side = (cuts.outward * ahead[cuts.span]).sum(axis=1)[:first] > 0
    bounds[cuts.span[:first], side.astype(np.intp)] += np.where(side, 1.0, -1.0) * tails[:first]
    ends = tail[:, None] + bounds[..., None] * ahead[:, None]
    ends[at_end] = runs.nodes[runs.edges[spans.run]][at_end]
    radii = np.stack([radii_at(runs, spans.run, bound) for bound in bounds.T], axis=1)
    closed = at_end & (runs.valency[runs.edges[spans.run]] == 1)
    kept = ~clusters.lines.passed[spans.run]
    lead, lead_radii = _leads(runs, clusters, tails)
    rows, sizes = balls_at(struts, clusters.nodes)
    return field_struts(
        np.concatenate([ends[kept], lead]),
        np.concatenate([radii[kept], lead_radii]),
        flat=np.append(
            closed[kept] & (struts.options.ends != "round"),
            np.zeros((len(lead), 2), dtype=np.bool_),
            axis=0,
        ),
        balls=runs.nodes[rows],
        ball_radii=sizes,
        blend=np.concatenate([clusters.blend[kept], np.tile(clusters.blend[cuts.span[first:]], 2)]),
    )


def _leads(runs: Runs, clusters: Clusters, tails: Floats) -> tuple[Floats, Floats]:
    """Return the ends (2 v, 2, 3) and radii (2 v, 2) of what leads to the cuts of curves, mm.

    First from a joint to the base of each cut, then on along its axis.
    """
    cuts, joints = clusters.rest.cuts, clusters.lines.joints
    first = len(cuts.node) - len(joints)
    base, radius = cuts.base[first:], cuts.radius[first:]
    tip = base + tails[first:, None] * cuts.outward[first:]
    ends = [[runs.nodes[joints], base], [base, tip]]
    radii = [[radii_of(runs)[joints], radius], [radius, radius]]
    return (
        np.concatenate([np.stack(each, axis=1) for each in ends]),
        np.concatenate([np.stack(each, axis=1) for each in radii]),
    )


def whole_struts(struts: RoundStruts) -> FieldStruts:
    """Return all of the struts as those of a field."""
    runs, skeleton = struts.runs, struts.skeleton
    at_end = runs.valency[runs.edges] == 1  # (k, 2)
    rows, sizes = balls_at(struts, np.ones(len(skeleton.nodes), dtype=np.bool_))
    thin = np.repeat(runs.radii.min(axis=1)[:, None], 2, axis=1)
    blend = struts.options.blends(runs.edges, thin).min(axis=1)
    return field_struts(
        runs.nodes[runs.edges],
        runs.radii,
        flat=at_end & (struts.options.ends != "round"),
        balls=runs.nodes[rows],
        ball_radii=sizes,
        blend=blend,
    )
