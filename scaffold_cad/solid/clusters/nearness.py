"""Nearness: the stretches of runs that come within reach of other pieces."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints
from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.base.vectors import dot, length
from scaffold_cad.solid.clusters.spans import Spans, radii_at
from scaffold_cad.struts.pieces import Pieces
from scaffold_cad.struts.runs import Runs

STEPS = 8
"""Newton's steps toward the end of what is near."""


def near_spans(
    runs: Runs, pieces: Pieces, own: Ints, other: Ints, reach: Floats, inner: Bools
) -> Spans:
    """Return the stretches of the runs of pieces within `reach` (p,) of the axes of others.

    Where an axis only nearly comes so near, a radius to each side of the nearest place is taken,
    but for pieces that are `inner` (p,): those are in clusters already.
    """
    run = pieces.run[own]
    keep = run >= 0  # balls are not stretches
    own, other, run = own[keep], other[keep], run[keep]
    reach, inner = reach[keep], inner[keep]
    tail, ahead = runs.nodes[runs.edges[run, 0]], runs.directions[2 * run]
    start, end = pieces.start[other], pieces.end[other]
    nearest, _ = nearest_on_segments(pieces.start[own], pieces.end[own], start, end)
    whole = runs.lengths[run]
    middle = np.clip(((nearest - tail) * ahead).sum(axis=1), 0.0, whole)

    slope, along = runs.slopes[2 * run], end - start
    size = np.maximum(dot(along, along), 1e-300)

    def beyond(place: Floats) -> tuple[Floats, Floats]:
        """Return how far others are beyond the reach at places, mm, and how fast that grows."""
        way = tail + place[:, None] * ahead - start
        way -= np.clip(dot(way, along) / size, 0.0, 1.0)[:, None] * along
        far = length(way)
        growth = dot(way, ahead) / np.maximum(far, 1e-300) - slope
        return far - reach - radii_at(runs, run, place), growth

    apart = beyond(middle)[0] >= 0
    radius = radii_at(runs, run, middle)
    low = np.where(apart, middle - radius, _edge(beyond, middle, np.zeros(len(run)), apart))
    high = np.where(apart, middle + radius, _edge(beyond, middle, whole, apart))
    kept = ~(apart & inner)
    return Spans(run[kept], np.maximum(low[kept], 0.0), np.minimum(high[kept], whole[kept]))


def _edge(
    beyond: Callable[[Floats], tuple[Floats, Floats]], near: Floats, far: Floats, idle: Bools
) -> Floats:
    """Return where what is near ends between places that are near and places far off.

    What lies beyond a reach is convex along a line: Newton's steps from far off never come nearer
    than the end. `idle` places (p,) stay far off.
    """
    place = far
    low, high = np.minimum(near, far), np.maximum(near, far)
    for _ in range(STEPS):
        gap, growth = beyond(place)
        moving = (gap > 0) & (growth != 0) & ~idle
        if not moving.any():
            break
        step = np.divide(gap, growth, out=np.zeros_like(gap), where=moving)
        place = np.clip(place - step, low, high)
    return place
