"""The arcs of partitions: where quads meet, and which vertices they join.

Side 4 i + k of a partition is the arc from corner k of quad i to its next corner.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Ints


@dataclass(frozen=True, eq=False)
class Arcs:
    """The 2 N arcs of each of M partitions, each once."""

    starts: Ints
    """Vertex that each arc leaves, shape (M, 2 N)."""
    ends: Ints
    """Vertex that each arc reaches, shape (M, 2 N)."""
    left: Ints
    """Quad on the left of each arc, shape (M, 2 N)."""
    right: Ints
    """Quad on the right of each arc, shape (M, 2 N)."""


def sides(quads: Ints) -> tuple[Ints, Ints]:
    """Return the vertices that each side leaves and reaches, both (M, 4 N)."""
    shape = (len(quads), 4 * quads.shape[1])
    return quads.reshape(shape), np.roll(quads, -1, axis=2).reshape(shape)


def side_twins(quads: Ints) -> Ints:
    """Return the side that runs along each one the other way, shape (M, 4 N).

    Parameters
    ----------
    quads : (M, N, 4) intp, closed (see `certificate.is_closed`)
    """
    starts, ends = sides(quads)
    count = quads.shape[1] + 2
    twins = np.empty_like(starts)
    ahead = np.argsort(starts * count + ends, axis=1)
    back = np.argsort(ends * count + starts, axis=1)
    np.put_along_axis(twins, ahead, back, axis=1)
    return twins


def arcs_of(quads: Ints) -> Arcs:
    """Return the arcs of M closed partitions `quads` (M, N, 4)."""
    starts, ends = sides(quads)
    once = starts < ends
    quad = np.broadcast_to(np.arange(starts.shape[1]) // 4, starts.shape)
    shape = (len(quads), 2 * quads.shape[1])
    left, right = quad, side_twins(quads) // 4
    return Arcs(*(each[once].reshape(shape) for each in (starts, ends, left, right)))


def is_closed(quads: Ints) -> Bools:
    """Return whether the quads of each partition meet in pairs along every arc, shape (M,).

    Every arc must be run along once in either direction. In particular no two arcs join the
    same two vertices: as arcs of great circles they would be one.
    """
    starts, ends = sides(quads)
    count = quads.shape[1] + 2
    ahead = np.sort(starts * count + ends, axis=1)
    back = np.sort(ends * count + starts, axis=1)
    once = (np.diff(ahead, axis=1) > 0).all(axis=1)
    closed: Bools = (ahead == back).all(axis=1) & once
    return closed


def arc_counts(quads: Ints) -> Ints:
    """Return the number of arcs that meet at each vertex of M partitions, shape (M, N + 2)."""
    count = quads.shape[1] + 2
    flat = quads + count * np.arange(len(quads))[:, None, None]
    counts = np.bincount(flat.reshape(-1), minlength=count * len(quads))
    return counts.reshape(len(quads), count)
