"""A lamp of helices: tubes that wind both ways around a waist and are joined where they cross.

The tubes are hollow, and open at their feet: for its wires, and for powder to leave.
"""

import numpy as np

from scaffold_cad import RoundStruts, Skeleton, round_struts, write

HEIGHT, WAIST, RIM, FOOT = 160.0, 32.0, 56.0, 8.0
"""Height, radii at the waist and at both rims, and height of the feet, mm."""

TUBE, WALL = 2.5, 0.8
"""Radius and wall of the tubes, mm."""

TUBES, LEVELS = 10, 12
"""Helices that wind each way, and steps along them: half of their crossings are at each level."""


def lamp() -> Skeleton:
    """Return the axes of the tubes."""
    level, number = np.meshgrid(np.arange(LEVELS + 1), np.arange(TUBES), indexing="ij")
    turn = 2 * np.pi * (number + level / 2) / TUBES
    height = HEIGHT * level / LEVELS
    radius = WAIST + (RIM - WAIST) * (2 * level / LEVELS - 1) ** 2
    nodes = np.stack([radius * np.cos(turn), radius * np.sin(turn), height], axis=-1)
    node = np.arange(nodes.size // 3).reshape(level.shape)
    ahead = np.stack([node[:-1], node[1:]], axis=-1)
    back = np.stack([node[:-1], np.roll(node, 1, axis=1)[1:]], axis=-1)
    rim = np.stack([node[-1], np.roll(node[-1], 1)], axis=-1)
    legs = np.stack([node[0], node.size + node[0]], axis=-1)
    edges = np.concatenate([ahead.reshape(-1, 2), back.reshape(-1, 2), rim, legs])
    return Skeleton(np.vstack([nodes.reshape(-1, 3), nodes[0] - [0, 0, FOOT]]), edges, TUBE)


def make() -> RoundStruts:
    """Return the hollow lamp."""
    return round_struts(lamp(), wall=WALL, ends="open")


if __name__ == "__main__":
    write(make(), "helix_lamp.step")
