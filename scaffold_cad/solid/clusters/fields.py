"""The field of clusters: the struts of spans, which go on past the places where they are cut."""

from __future__ import annotations

import numpy as np

from scaffold_cad.solid.clusters.growth import Clusters, balls_at
from scaffold_cad.solid.clusters.spans import radii_at, tail_length
from scaffold_cad.solid.field import FieldStruts, field_struts
from scaffold_cad.struts.model import RoundStruts


def cluster_struts(struts: RoundStruts, clusters: Clusters) -> FieldStruts:
    """Return what the field of clusters is made of."""
    runs, spans, cuts = struts.runs, clusters.spans, clusters.rest.cuts
    tail, ahead = runs.nodes[runs.edges[spans.run, 0]], runs.directions[2 * spans.run]
    bounds = np.stack([spans.low, spans.high], axis=1)  # (q, 2)
    at_end = np.stack([spans.low == 0, spans.high == runs.lengths[spans.run]], axis=1)
    side = (cuts.outward * ahead[cuts.span]).sum(axis=1) > 0
    further = np.where(side, 1.0, -1.0) * tail_length(cuts.radius, cuts.slope)
    bounds[cuts.span, side.astype(np.intp)] += further
    ends = tail[:, None] + bounds[..., None] * ahead[:, None]
    ends[at_end] = runs.nodes[runs.edges[spans.run]][at_end]
    radii = np.stack([radii_at(runs, spans.run, bound) for bound in bounds.T], axis=1)
    closed = at_end & (runs.valency[runs.edges[spans.run]] == 1)
    rows, sizes = balls_at(struts, clusters.nodes)
    return field_struts(
        ends,
        radii,
        flat=closed & (struts.options.ends != "round"),
        balls=runs.nodes[rows],
        ball_radii=sizes,
        blend=clusters.blend,
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
