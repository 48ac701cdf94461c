"""The volume of rolling-ball fillets between the cylinders of a frame, by Monte Carlo.

A place outside all struts belongs to a fillet of radius ρ if no ball of that radius covers it
without reaching into a strut. Only the struts of one node are looked at, as endless ones.
"""

from __future__ import annotations

import numpy as np

from scaffold_cad import Skeleton
from scaffold_cad.base.arrays import Bools, Floats, Points, UnitVectors

SAMPLES = 4000
"""Places of a node that are looked at."""
WAYS = 600
"""Directions in which a ball's center is looked for."""


def fillet_volume(skeleton: Skeleton, fillets: Floats, generator: np.random.Generator) -> float:
    """Return the volume of all fillets, mm³.

    Parameters
    ----------
    skeleton : struts of one radius each
    fillets : (n,) float64, fillet radius of each node, mm
    """
    assert (skeleton.edge_radii[:, 0] == skeleton.edge_radii[:, 1]).all()
    total = 0.0
    for node in np.flatnonzero(skeleton.valency > 1):
        edges, ends = np.nonzero(skeleton.edges == node)
        spans = skeleton.nodes[skeleton.edges[edges, 1 - ends]] - skeleton.nodes[node]
        lengths = np.linalg.norm(spans, axis=1)
        directions = spans / lengths[:, None]
        radii = skeleton.edge_radii[edges, 0]
        total += _at_node(directions, radii, lengths, float(fillets[node]), generator)
    return total


def _at_node(
    directions: UnitVectors,
    radii: Floats,
    lengths: Floats,
    fillet: float,
    generator: np.random.Generator,
) -> float:
    """Return the volume of the fillets at a node with N struts.

    Places are drawn in the shells around struts in which fillets are, as deep as their radius, and
    count the less the more of these they are in.
    """
    cosines = directions @ directions.T - 2 * np.eye(len(radii))
    halves = np.sqrt((1 - cosines.max(axis=1)) / 2)  # sine of half the least angle
    far = np.minimum((radii.max() + fillet) / halves, lengths)
    volumes = np.pi * ((radii + fillet) ** 2 - radii**2) * far
    own = generator.choice(len(radii), SAMPLES, p=volumes / volumes.sum())
    along = far[own] * generator.random(SAMPLES)
    inner, outer = radii[own] ** 2, (radii[own] + fillet) ** 2
    across = np.sqrt(inner + (outer - inner) * generator.random(SAMPLES))
    way = generator.normal(size=(SAMPLES, 3))
    way -= (way * directions[own]).sum(axis=1, keepdims=True) * directions[own]
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    points = along[:, None] * directions[own] + across[:, None] * way
    heights = points @ directions.T  # (s, N)
    away = np.sqrt(np.maximum((points**2).sum(axis=1)[:, None] - heights**2, 0.0))
    in_shell = (heights >= 0) & (heights <= far) & (away >= radii) & (away <= radii + fillet)
    free = np.flatnonzero(_distances(points, directions, radii) > 0)
    covered = _covered(points[free], directions, radii, fillet)
    weights = covered / np.maximum(in_shell[free].sum(axis=1), 1)
    return float(volumes.sum() * weights.sum() / SAMPLES)


def _covered(points: Points, directions: UnitVectors, radii: Floats, fillet: float) -> Bools:
    """Return which points no ball covers that keeps out of the struts."""
    step = np.arange(WAYS) + 0.5
    height, turn = 1 - 2 * step / WAYS, np.pi * (1 + np.sqrt(5)) * step
    flat = np.sqrt(1 - height**2)
    ways = np.stack([flat * np.cos(turn), flat * np.sin(turn), height], axis=1)
    free = _distances(points, directions, radii) >= fillet
    for way in ways:
        free |= _distances(points + fillet * way, directions, radii) >= fillet
    return np.asarray(~free)


def _distances(points: Points, directions: UnitVectors, radii: Floats) -> Floats:
    """Return how far points are from the nearest of cylinders with a ball at their end, mm."""
    heights = np.maximum(points @ directions.T, 0.0)  # (p, N)
    square = (points**2).sum(axis=1)[:, None] + heights**2 - 2 * heights * (points @ directions.T)
    found: Floats = (np.sqrt(np.maximum(square, 0.0)) - radii).min(axis=1)
    return found
