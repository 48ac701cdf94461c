"""Nodes that tests of sharp nodes are made of."""

from __future__ import annotations

import numpy as np

from scaffold_cad import Skeleton
from scaffold_cad.base.arrays import Floats
from scaffold_cad.base.vectors import normalize
from tests.struts.stars import BODY_CENTERED, CUBIC, TEE, TRIPOD, random_stars

LENGTH = 8.0
"""Length of the struts, mm."""


def node(
    directions: Floats | list[list[float]],
    radii: Floats | list[float] | float = 1.0,
    slopes: Floats | list[float] | float = 0.0,
    ball: float | None = None,
) -> Skeleton:
    """Return struts of `LENGTH` from the origin, with a ball there where one is given."""
    ways = normalize(np.asarray(directions, dtype=np.float64))
    near = np.broadcast_to(np.asarray(radii, dtype=np.float64), (len(ways),))
    ends = np.stack([near, near + np.asarray(slopes) * LENGTH], axis=1)
    edges = np.stack([np.zeros(len(ways), dtype=np.intp), 1 + np.arange(len(ways))], axis=1)
    sizes = np.concatenate([[near.max() if ball is None else ball], ends[:, 1]])
    nodes = np.concatenate([np.zeros((1, 3)), LENGTH * ways])
    return Skeleton(nodes, edges, sizes, ends)


def random_node(kind: int) -> Skeleton:
    """Return one of many nodes: 3 to 6 struts, equal ones, or of other radii, or cones."""
    rng = np.random.default_rng(kind)
    valency = int(rng.integers(3, 7))
    (ways,) = random_stars(1, valency, (50, 45, 30)[kind % 3], rng)
    radii = np.ones(valency) if kind % 9 < 3 else rng.uniform(0.4, 1.0, valency)
    slopes = rng.uniform(-0.04, 0.04, valency) if kind % 9 > 5 else np.zeros(valency)
    return node(ways, radii, slopes)


BEND = node([[1, 0, 0], [0, 1, 0]])
SHARP_BEND = node([[1, 0, 0], [0.7, 0.7, 0]])
NODES = {
    "sharp bend": SHARP_BEND,
    "corner": node(TRIPOD),
    "tee": node(TEE),
    "thin tee": node(TEE, [1.0, 1.0, 0.6]),
    "thin oblique tee": node([[1, 0, 0], [-1, 0, 0], [1, 1, 0]], [1.0, 1.0, 0.3]),
    "in a plane": node([[1, 0, 0], [-0.5, 0.75**0.5, 0], [-0.5, -(0.75**0.5), 0]]),
    "tetrahedral": node([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]),
    "cubic": node(CUBIC),
    "body-centered": node(BODY_CENTERED),
    "cones": node(TRIPOD, 1.0, [0.1, -0.05, 0.02]),
    "ball": node(TRIPOD, 1.0, ball=2.5),
    "step": node([[1, 0, 0], [-1, 0, 0]], [1.0, 0.6]),
}
"""Nodes by name, all of which are unions of cylinders, cones and a ball."""
