"""Thinning of over-sampled chains: which nodes of a polyline may go within a tolerance."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points
from scaffold_cad.base.topology import Chains
from scaffold_cad.base.vectors import length

LEAST_SPACING = 1.0
"""Least distance of two neighboring joints, as a multiple of the larger of their radii."""

MOST_STRAY = 0.1
"""How far the radius may stray where a joint beside its neighbor goes, in radii of its own."""


def thinned_edges(
    nodes: Points, edges: Edges, edge_radii: Floats, branches: Chains, tolerance: float
) -> tuple[Edges, Floats]:
    """Return the edges of a skeleton without the joints that its shape does not need, (k, 2).

    With the radii of each at both ends, (k, 2); see `Skeleton.simplified`.
    """
    lone, walks = _walks(edges, edge_radii, branches)
    kept = [_kept(nodes, walk, tolerance) for walk in walks]
    both = [(walk.stops[0], walk.stops[-1]) for walk in walks]
    ends = np.asarray(both, dtype=np.intp).reshape(-1, 2)
    _, pair, uses = np.unique(
        np.sort(np.concatenate([ends, edges[lone]]), axis=1),
        axis=0,
        return_inverse=True,
        return_counts=True,
    )
    # Branches between the same two nodes must not become the same edge.
    for branch in np.flatnonzero(uses[pair.reshape(-1)[: len(kept)]] > 1).tolist():
        if len(kept[branch]) == 2:
            stops = walks[branch].stops
            kept[branch] = np.array([0, farthest_sample(nodes[stops]), len(stops) - 1])
    links, sizes = [edges[lone]], [edge_radii[lone]]
    for walk, row in zip(walks, kept, strict=True):
        links.append(np.stack([walk.stops[row[:-1]], walk.stops[row[1:]]], axis=1))
        sizes.append(np.stack([walk.radii[row[:-1], 0], walk.radii[row[1:] - 1, 1]], axis=1))
    return np.concatenate(links), np.concatenate(sizes)


@dataclass(frozen=True, eq=False)
class _Walk:
    """The nodes that a branch passes, and the radii of its edges."""

    stops: Ints
    """Shape (k + 1,)."""
    radii: Floats
    """Of each edge where it is entered and where it is left, shape (k, 2), mm."""


def _walks(edges: Edges, edge_radii: Floats, branches: Chains) -> tuple[Ints, list[_Walk]]:
    """Return the edges that are a branch of their own, and all other branches.

    A ring has its first node at both ends.
    """
    half_edges, offsets = branches.half_edges, branches.offsets
    tails = edges.reshape(-1)
    counts = np.diff(offsets)
    lone = half_edges[offsets[:-1][counts == 1]] >> 1
    radii = edge_radii.reshape(-1)
    walks = []
    for branch in np.flatnonzero(counts > 1).tolist():
        row = half_edges[offsets[branch] : offsets[branch + 1]]
        stops = np.append(tails[row], tails[row[-1] ^ 1])
        walks.append(_Walk(stops, np.stack([radii[row], radii[row ^ 1]], axis=1)))
    return lone, walks


def _kept(nodes: Points, walk: _Walk, tolerance: float) -> Ints:
    """Return the stops of a walk to keep; a walk that ends where it began keeps two inside."""
    stops, last = walk.stops, len(walk.stops) - 1
    third = (last + 1) // 3
    cuts = [0, last] if stops[0] != stops[-1] else [0, third, 2 * third, last]
    # A step from one member to the next is not a matter of sampling.
    steps = np.abs(walk.radii[1:, 0] - walk.radii[:-1, 1]) > tolerance
    cuts = sorted({*cuts, *(1 + np.flatnonzero(steps)).tolist()})
    keep = np.zeros(len(stops), dtype=np.bool_)
    for start, stop in pairwise(cuts):
        radii = np.append(walk.radii[start:stop, 0], walk.radii[stop - 1, 1])
        places = nodes[stops[start : stop + 1]]
        keep[start : stop + 1] |= kept_samples(places, radii, tolerance)
    return np.flatnonzero(keep)


def kept_samples(
    points: Points, radii: Floats, tolerance: float, spacing: float = LEAST_SPACING
) -> Bools:
    """Return which samples of a polyline to keep, its two ends always, shape (k,).

    Between kept samples neither the positions nor the radii stray more than `tolerance` (mm)
    from their linear interpolation (Douglas and Peucker's rule in x, y, z, r); of what is kept,
    a joint closer to its neighbor than `spacing` times its radius goes as well, unless the radius
    changes there: of a strut that leaves a ball.
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
    _drop_crowded(samples, spacing, np.maximum(tolerance, MOST_STRAY * radii), keep)
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


def _drop_crowded(samples: Floats, spacing: float, stray: Floats, keep: Bools) -> None:
    """Clear in `keep` the joints (k, 4) that stand closer to their neighbor than `spacing` radii.

    A joint stays where the radius of any sample between its neighbors would stray more than
    `stray` (k,), mm.
    """
    points, radii = samples[:, :3], samples[:, 3]
    kept = np.flatnonzero(keep)

    def crowded(a: int, b: int) -> bool:
        return bool(length(points[a] - points[b]) < spacing * max(radii[a], radii[b]))

    def joined(first: int, last: int) -> bool:
        between = kept[(kept > first) & (kept < last)]
        chord = points[last] - points[first]
        squared = max(float(chord @ chord), np.finfo(float).tiny)
        along = np.clip((points[between] - points[first]) @ chord / squared, 0.0, 1.0)
        off = radii[between] - (radii[first] + along * (radii[last] - radii[first]))
        return bool((np.abs(off) <= stray[between]).all())

    last, end = int(kept[0]), int(kept[-1])
    for sample, following in pairwise(kept[1:].tolist()):
        if crowded(last, sample) and joined(last, following):
            keep[sample] = False
        else:
            last = sample
    # Those that are left before the end give way to it.
    left = np.flatnonzero(keep).tolist()
    for before, sample in zip(left[-3::-1], left[-2:0:-1], strict=True):
        if not (crowded(sample, end) and joined(before, end)):
            break
        keep[sample] = False
