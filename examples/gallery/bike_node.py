"""The bottom bracket of a bicycle's frame: tubes that meet in one hollow node.

Round struts around the tubes' axes and a ball where they meet, less the bores: to be printed of
metal and brazed.
"""

import numpy as np
from manifold3d import Manifold

from scaffold_cad import Skeleton, round_struts, thicken, to_solid, write

TUBES = np.array(
    [
        [105, 0, 14.3, 100],  # seat tube
        [42, 0, 17.5, 100],  # down tube
        [183, 22, 10.0, 110],  # chain stays
        [183, -22, 10.0, 110],
        [0, 90, 20.0, 50],  # both ends of the axle's shell
        [0, -90, 20.0, 50],
    ]
)
"""Angle to the road and out of the frame's plane, degrees; radius outside and length, mm."""

BODY, WALL = 28.0, 3.0
"""Radius where the tubes meet, and thickness of their walls, mm."""


def make() -> Manifold:
    """Return the hollow node."""
    up, out = np.radians(TUBES[:, :2].T)
    along = np.stack([np.cos(out) * np.cos(up), np.sin(out), np.cos(out) * np.sin(up)], axis=1)
    tips = 1.3 * along * TUBES[:, 3:]
    axes = Skeleton(
        np.vstack([np.zeros(3), tips]),
        [[0, tip] for tip in range(1, len(tips) + 1)],
        np.concatenate([[BODY], TUBES[:, 2]]),
    )
    node = to_solid(round_struts(axes), sides=16)
    for (_, _, radius, length), direction, tip in zip(TUBES, along, tips, strict=True):
        axis = Skeleton([-0.02 * tip, 2 * tip], [[0, 1]], radius)  # bores overlap in the middle
        node -= thicken(axis, radius - WALL, sides=16)
        node = node.trim_by_plane(-direction, -length)  # flat ends
    return node


if __name__ == "__main__":
    write(make(), "bike_node.stl")
