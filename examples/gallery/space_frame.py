"""A space frame of two layers, as roofs of halls have: bars of three diameters screwed into balls.

Squares above squares, half a module aside, and four diagonals down from each upper node. The bars
of the layers are cylinders of their own diameters up to the balls, which are spheres.
"""

import numpy as np

from scaffold_cad import RoundStruts, Skeleton, round_struts, write

MODULE, RISE, BAYS = 40.0, 28.0, (4, 3)
"""Side of a square and height between the layers, mm; squares of the upper layer both ways."""

UPPER, LOWER, DIAGONAL, BALL = 2.5, 2.0, 1.5, 6.0
"""Radii of the bars of each kind and of the balls, mm."""


def frame() -> Skeleton:
    """Return the bars of the frame."""
    layers = []
    for count, start, height in ((0, 0.0, RISE), (1, MODULE / 2, 0.0)):
        x, y = np.meshgrid(*(np.arange(bays + 1 - count) for bays in BAYS), indexing="ij")
        places = np.stack([start + MODULE * x, start + MODULE * y, np.full(x.shape, height)], -1)
        layers.append(places.reshape(-1, 3))
    nodes = np.concatenate(layers)
    ways = np.linalg.norm(nodes[:, None] - nodes, axis=2)
    level = np.isclose(nodes[:, None, 2], nodes[:, 2])
    bars = np.isclose(ways, np.where(level, MODULE, np.hypot(MODULE / np.sqrt(2), RISE)))
    edges = np.argwhere(np.triu(bars))
    heights = nodes[edges, 2].mean(axis=1)
    radii = np.select([heights == RISE, heights == 0], [UPPER, LOWER], DIAGONAL)
    return Skeleton(nodes, edges, BALL, edge_radii=radii)


def make() -> RoundStruts:
    """Return the frame with its balls."""
    return round_struts(frame(), nodes="ball")


if __name__ == "__main__":
    write(make(), "space_frame.step")
