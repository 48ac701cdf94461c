"""Which points are near which edges, found a block of neighboring points at a time."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points
from scaffold_cad.base.blocks import CACHE, blocks
from scaffold_cad.base.boxes import order_in_space, overlapping_boxes
from scaffold_cad.base.vectors import dot, length

BLOCK = 32
"""Points looked for together."""

PAIR_BYTES = 64
"""What a pair of a point and an edge takes where it is worked on."""


def nearby_pairs(
    points: Points, starts: Points, ends: Points, reaches: Floats
) -> Iterator[tuple[Ints, Ints]]:
    """Yield pairs of a point and an edge, among them all that are within reach.

    They come as arrays of points and of edges that are to be broadcast against each other.

    Parameters
    ----------
    points : (n, 3) float64, mm
    starts, ends : (m, 3) float64, mm
    reaches : (m,) float64, mm; from each edge

    Notes
    -----
    O((n + m) log (n + m)) for edges that are not much longer than their reach.
    """
    order = order_in_space(points, points)
    firsts = np.arange(0, len(points), BLOCK)
    low = np.minimum.reduceat(points[order], firsts, axis=0)
    high = np.maximum.reduceat(points[order], firsts, axis=0)
    block, edge = _overlaps(low, high, starts, ends, reaches)

    centers, radii = (low + high) / 2, length(high - low) / 2
    spans = ends - starts
    offsets = centers[block] - starts[edge]
    share = dot(offsets, spans[edge]) / dot(spans, spans)[edge]
    gaps = length(offsets - np.clip(share, 0, 1)[:, None] * spans[edge])
    near = gaps <= (radii[block] + reaches[edge]) * (1 + 1e-9)
    block, edge = block[near], edge[near]
    full = len(points) // BLOCK
    of_block = order[: full * BLOCK].reshape(full, BLOCK)
    in_full = np.flatnonzero(block < full)
    for some in blocks(len(in_full), BLOCK * PAIR_BYTES, CACHE):
        part = in_full[some]
        yield of_block[block[part]], edge[part, None]
    yield order[None, full * BLOCK :], edge[block == full, None]


def all_pairs(point_count: int, edge_count: int) -> Iterator[tuple[Ints, Ints]]:
    """Yield all pairs of a point and an edge, as `nearby_pairs` does."""
    edges = np.arange(edge_count)[None]
    for some in blocks(point_count, edge_count * PAIR_BYTES, CACHE):
        yield np.arange(some.start, some.stop)[:, None], edges


def _overlaps(
    low: Points, high: Points, starts: Points, ends: Points, reaches: Floats
) -> tuple[Ints, Ints]:
    """Return the pairs of a box of points and an edge whose box, grown by its reach, meets it."""
    count = len(low)
    lower = np.minimum(starts, ends) - reaches[:, None]
    upper = np.maximum(starts, ends) + reaches[:, None]
    found = [np.zeros((2, 0), dtype=np.intp)]
    for i, j in overlapping_boxes(np.concatenate([low, lower]), np.concatenate([high, upper])):
        mixed = (i < count) & (j >= count)
        found.append(np.stack([i[mixed], j[mixed] - count]))
    block, edge = np.concatenate(found, axis=1)
    return block, edge
