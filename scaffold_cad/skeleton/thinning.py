"""Thinning of over-sampled chains: which nodes of a polyline may go."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Points
from scaffold_cad.base.vectors import length

LEAST_SPACING = 1.0
"""Least distance of two neighboring joints, as a multiple of the larger of their radii."""


def kept_samples(
    points: Points, radii: Floats, tolerance: float, spacing: float = LEAST_SPACING
) -> Bools:
    """Return which samples of a polyline to keep, its two ends always, shape (k,).

    Between kept samples neither the positions nor the radii stray more than `tolerance` (mm)
    from their linear interpolation (Douglas and Peucker's rule in x, y, z, r); of what is kept,
    a joint closer to its neighbor than `spacing` times its radius goes as well.
    """
    samples = np.column_stack([points, radii])  # (k, 4)
    keep = np.zeros(len(samples), dtype=np.bool_)
    keep[[0, -1]] = True
    spans = [(0, len(samples) - 1)]
    while spans:
        first, last = spans.pop()
        if last - first < 2:
            continue
        distance = _distance_to_chord(samples[first : last + 1])
        worst = int(np.argmax(distance))
        if distance[worst] > tolerance:
            keep[first + worst] = True
            spans += [(first, first + worst), (first + worst, last)]
    _drop_crowded(points, spacing * radii, keep)
    return keep


def farthest_sample(points: Points) -> int:
    """Return which inner sample of a polyline (k ≥ 3) is farthest from the chord of its ends."""
    return 1 + int(np.argmax(_distance_to_chord(points)[1:-1]))


def _distance_to_chord(samples: Floats) -> Floats:
    """Return the distance of each sample (k, d) to the segment from the first to the last."""
    chord = samples[-1] - samples[0]
    offset = samples - samples[0]
    squared = float(chord @ chord)
    along = np.clip(offset @ chord / squared, 0.0, 1.0) if squared > 0 else np.zeros(len(samples))
    rest = offset - along[:, None] * chord
    distance: Floats = np.linalg.norm(rest, axis=1)
    return distance


def _drop_crowded(points: Points, room: Floats, keep: Bools) -> None:
    """Clear in `keep` the joints that stand closer to their neighbor than their `room`."""

    def crowded(a: int, b: int) -> bool:
        return bool(length(points[a] - points[b]) < max(room[a], room[b]))

    kept = np.flatnonzero(keep)
    last, end = int(kept[0]), int(kept[-1])
    for sample in kept[1:-1].tolist():
        if crowded(last, sample):
            keep[sample] = False
        else:
            last = sample
    # Those that are left before the end give way to it.
    for sample in np.flatnonzero(keep)[-2:0:-1].tolist():
        if not crowded(sample, end):
            break
        keep[sample] = False
