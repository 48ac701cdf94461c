"""Chains of edges along curves, for tests. Lengths in mm."""

from __future__ import annotations

import numpy as np

from scaffold_cad.skeleton import Skeleton
from tests.skeletons import polyline


def helix(
    count: int, turns: float = 2.0, *, radius: float = 10.0, pitch: float = 6.0, wire: object = 1.0
) -> Skeleton:
    """Return a helix of `count` nodes around the z axis."""
    angle = np.linspace(0, 2 * np.pi * turns, count)
    nodes = [radius * np.cos(angle), radius * np.sin(angle), pitch * angle / (2 * np.pi)]
    return Skeleton(np.stack(nodes, axis=1), polyline(count), wire)


def circle(count: int, radius: float = 10.0, wire: object = 1.0) -> Skeleton:
    """Return a closed circle of `count` nodes in the xy plane."""
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    nodes = [radius * np.cos(angle), radius * np.sin(angle), 0 * angle]
    return Skeleton(np.stack(nodes, axis=1), polyline(count, closed=True), wire)


TAPERED = helix(60, wire=np.linspace(0.6, 1.4, 60))
"""A helix whose wire gets thicker."""

HOOK = Skeleton(
    np.array(
        [[0, 0, -30], *[[5 - 5 * np.cos(t), 0, 5 * np.sin(t)] for t in np.linspace(0, np.pi, 13)]]
    ),
    polyline(14),
    np.array(1.0),
)
"""A long straight edge that passes into half a circle of radius 5."""


def crossed(skeleton: Skeleton, place: int) -> Skeleton:
    """Return a chain that a strut crosses at one of its nodes, a little beside it."""
    here, count = skeleton.nodes[place], len(skeleton.nodes)
    along = skeleton.nodes[(place + 1) % count] - skeleton.nodes[place - 1]
    across = np.cross(along, here - skeleton.nodes.mean(axis=0))
    across *= 4 / np.linalg.norm(across)
    beside = here + 0.3 * along / np.linalg.norm(along)
    return Skeleton(
        np.vstack([skeleton.nodes, beside - across, beside + across]),
        np.vstack([skeleton.edges, [[count, count + 1]]]),
        np.append(skeleton.radii, [0.5, 0.5]),
    )


COIL = helix(60)
CROSSED_COIL = crossed(COIL, 30)
"""A helix that a strut crosses in the middle."""
