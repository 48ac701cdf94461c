"""The bottom bracket of a bicycle's frame: a hollow node with sockets for the frame's tubes.

Each socket takes its tube with a play of 0.15 mm, down to a shoulder, with 3 mm of wall around it,
and the node's blend has the same wall as its arms: to be printed of metal and brazed.
"""

import numpy as np

from scaffold_cad import RoundStruts, Skeleton, round_struts, write

TUBES = np.array(
    [
        [105, 0, 28.6, 100],  # seat tube
        [42, 0, 35.0, 100],  # down tube
        [183, 22, 20.0, 110],  # chain stays
        [183, -22, 20.0, 110],
        [0, 90, 34.0, 60],  # both ends of the axle's shell
        [0, -90, 34.0, 60],
    ]
)
"""Angle to the road and out of the frame's plane, degrees; diameter of the tube and length, mm."""

AROUND, SHOULDER, PLAY, DEPTH = 3.0, 1.0, 0.15, 25.0
"""Wall around tubes, height of shoulders, play of tubes and depth of their sockets, mm."""


def make() -> RoundStruts:
    """Return the hollow node."""
    up, out = np.radians(TUBES[:, :2].T)
    along = np.stack([np.cos(out) * np.cos(up), np.sin(out), np.cos(out) * np.sin(up)], axis=1)
    axes = Skeleton(
        np.vstack([np.zeros(3), along * TUBES[:, 3:]]),
        [[0, tip] for tip in range(1, len(TUBES) + 1)],
        1.0,
    ).with_edge_radii((TUBES[:, 2] + PLAY) / 2 + AROUND)
    sockets = {tip: ((TUBES[tip - 1, 2] + PLAY) / 2, DEPTH) for tip in range(1, 5)}
    return round_struts(axes, wall=AROUND + SHOULDER, ends="open", sockets=sockets)


if __name__ == "__main__":
    write(make(), "bike_node.step")
