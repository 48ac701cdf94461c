"""A neuron that grows from its soma: dendrites turn, thin and fork at random.

Where one forks, radii follow Rall: the power 3/2 of the parent's is the sum of the children's. The
skeleton is written as an SWC file too, as programs for neurons read it.
"""

import numpy as np
from manifold3d import Manifold

from scaffold_cad import Skeleton, round_struts, to_solid, write
from scaffold_cad.base.vectors import normalize

DENDRITES, STEP, THINNEST = 6, 7.0, 0.55
"""Dendrites, length of a step, and radius where growth ends, in mm for a large print."""


def neuron(seed: int) -> Skeleton:
    """Return a neuron's skeleton."""
    random = np.random.default_rng(seed)
    nodes, edges, radii = [np.zeros(3)], [], [6.0]
    angles = 2 * np.pi * np.arange(DENDRITES) / DENDRITES
    outward = np.stack([np.cos(angles), np.sin(angles), random.normal(0, 0.5, DENDRITES)], axis=1)
    tips = [(0, direction, 2.0) for direction in normalize(outward)]
    while tips:
        parent, direction, radius = tips.pop()
        direction = normalize(direction + random.normal(0, 0.22, 3))
        nodes.append(nodes[parent] + direction * max(STEP, 2.5 * radii[parent]))
        edges.append((parent, len(nodes) - 1))
        radii.append(radius)
        if radius < THINNEST:
            continue
        if random.random() < 0.75:
            tips.append((len(nodes) - 1, direction, 0.93 * radius))
            continue
        share = random.uniform(0.35, 0.65)
        aside = 0.7 * normalize(np.cross(direction, random.normal(size=3)))
        for part, turn in ((share, aside), (1 - share, -aside)):
            tips.append((len(nodes) - 1, normalize(direction + turn), radius * part ** (2 / 3)))
    return Skeleton(nodes, edges, radii)


def make() -> Manifold:
    """Return the neuron as a solid; branches that touch are united."""
    return to_solid(round_struts(neuron(seed=11), ends="round"), sides=8)


if __name__ == "__main__":
    write(neuron(seed=11), "neuron.swc")
    write(make(), "neuron.stl")
