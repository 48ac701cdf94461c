"""The bottom bracket of a bicycle's frame: tubes that meet in one hollow node.

Each tube keeps its own radius and its wall up to the node, whose blend has the same wall: to be
printed of metal and brazed.
"""

import numpy as np

from scaffold_cad import RoundStruts, Skeleton, round_struts, write

TUBES = np.array(
    [
        [105, 0, 14.3, 100],  # seat tube
        [42, 0, 17.5, 100],  # down tube
        [183, 22, 10.0, 110],  # chain stays
        [183, -22, 10.0, 110],
        [0, 90, 20.0, 60],  # both ends of the axle's shell
        [0, -90, 20.0, 60],
    ]
)
"""Angle to the road and out of the frame's plane, degrees; radius outside and length, mm."""

WALL = 3.0
"""Thickness of the walls, mm."""


def make() -> RoundStruts:
    """Return the hollow node."""
    up, out = np.radians(TUBES[:, :2].T)
    along = np.stack([np.cos(out) * np.cos(up), np.sin(out), np.cos(out) * np.sin(up)], axis=1)
    axes = Skeleton(
        np.vstack([np.zeros(3), along * TUBES[:, 3:]]),
        [[0, tip] for tip in range(1, len(TUBES) + 1)],
        TUBES[:, 2].max(),
    ).with_edge_radii(np.stack([TUBES[:, 2], TUBES[:, 2]], axis=1))
    return round_struts(axes, wall=WALL, ends="open")


if __name__ == "__main__":
    write(make(), "bike_node.step")
