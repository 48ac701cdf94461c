"""Partitions checked by other means: `python -m tests.validation.partition_certificate [count]`.

The package proves a partition by determinants and by the areas of triangles. Nothing of that is
used here: corners must be met in turn, by their azimuths, on one walk around the direction; arcs
must be shared by two quads; the corners around each vertex must fill a full angle; and points
drawn on the sphere must lie in one quad each. Every family and valency gets its share of stars.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.partition import Partitions, partition_spheres
from tests.validation.star_families import FAMILIES, Random, drawn

Array = NDArray[np.float64]

VALENCIES = range(3, 27)
BATCH = 500
"""Stars of one family and valency partitioned at once."""


def failures(partitions: Partitions, random: Random) -> NDArray[np.bool_]:
    """Return which partitions are not what they must be, shape (M,)."""
    stars, vertices, quads = partitions.directions, partitions.vertices, partitions.quads
    corners = vertices[np.arange(len(quads))[:, None, None], quads]  # (M, N, 4, 3)
    return ~(
        walked_around(stars, corners)
        & shared_arcs(quads)
        & full_vertices(corners, quads)
        & covered_once(stars, corners, uniform_points(random, 20))
    )


def walked_around(stars: Array, corners: Array) -> NDArray[np.bool_]:
    """Return whether each direction sees its quad's corners in turn, once around, (M,)."""
    steps = turns(stars[:, :, None], corners, np.roll(corners, -1, axis=2))  # (M, N, 4)
    in_turn = ((steps > 0) & (steps < np.pi)).all(axis=2)
    once = np.abs(steps.sum(axis=2) - 2 * np.pi) < 1e-6
    return np.asarray((in_turn & once).all(axis=1))


def shared_arcs(quads: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return whether every arc is run along once each way, and every vertex used, (M,)."""
    shared = []
    for star in quads.tolist():
        arcs = [(quad[k - 1], quad[k]) for quad in star for k in range(4)]
        used = {vertex for quad in star for vertex in quad}
        shared.append(
            len(set(arcs)) == len(arcs)
            and {(b, a) for a, b in arcs} == set(arcs)
            and used == set(range(len(star) + 2))
        )
    return np.array(shared)


def full_vertices(corners: Array, quads: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return whether the quads around each vertex fill a full angle between them, (M,)."""
    angles = turns(corners, np.roll(corners, -1, axis=2), np.roll(corners, 1, axis=2))
    sums = np.zeros((len(quads), quads.shape[1] + 2))
    np.add.at(sums, (np.arange(len(quads))[:, None, None], quads), angles)
    return np.asarray((np.abs(sums - 2 * np.pi) < 1e-6).all(axis=1))


def covered_once(stars: Array, corners: Array, points: Array) -> NDArray[np.bool_]:
    """Return whether each of `points` (k, 3) lies in one quad of each partition, (M,).

    A point lies in a triangle if it is a sum of its corners with weights that are not negative.
    """
    centers = np.broadcast_to(stars[:, :, None], corners.shape)
    triangles = np.stack([centers, corners, np.roll(corners, -1, axis=2)], axis=-1)
    weights = np.linalg.inv(triangles) @ points.T  # (M, N, 4, 3, k)
    inside = (weights >= 0).all(axis=3).sum(axis=(1, 2))
    return np.asarray((inside == 1).all(axis=1))


def turns(poles: Array, starts: Array, ends: Array) -> Array:
    """Return the angles, seen from outside, from each start to each end around poles, in 0..2π."""
    east = np.cross(poles, starts)
    along = (np.cross(poles, east) * ends).sum(axis=-1)
    across = (east * ends).sum(axis=-1)
    return np.asarray(np.arctan2(across, -along) % (2 * np.pi))


def uniform_points(random: Random, count: int) -> Array:
    """Return points on the sphere, shape (count, 3)."""
    points = random.normal(size=(count, 3))
    return np.asarray(points / np.linalg.norm(points, axis=1, keepdims=True))


def batches(count: int, random: Random) -> Iterator[tuple[str, Partitions]]:
    """Yield partitions of at least `count` stars, of all families and valencies in turn."""
    each = -(-count // (len(VALENCIES) * len(FAMILIES)))
    for valency in VALENCIES:
        for family in FAMILIES:
            for start in range(0, each, BATCH):
                size = min(BATCH, each - start)
                yield family, partition_spheres(drawn(family, random, size, valency))


def main() -> None:
    """Print how many stars fail, by family."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 5000
    random = np.random.default_rng(int(sys.argv[2]) if len(sys.argv) > 2 else 0)
    checked = dict.fromkeys(FAMILIES, 0)
    failed = dict.fromkeys(FAMILIES, 0)
    worst = dict.fromkeys(FAMILIES, 1.0)
    start = time.perf_counter()
    for family, partitions in batches(count, random):
        checked[family] += len(partitions)
        failed[family] += int(failures(partitions, random).sum())
        worst[family] = min(worst[family], float(partitions.relative_clearance.min()))
    for family in FAMILIES:
        print(
            f"{family:14} {checked[family]:7} stars, {failed[family]} failures, "
            f"worst relative clearance {worst[family]:.3f}"
        )
    print(f"{sum(checked.values())} stars in {time.perf_counter() - start:.0f} s")
    sys.exit(1 if any(failed.values()) else 0)


if __name__ == "__main__":
    main()
