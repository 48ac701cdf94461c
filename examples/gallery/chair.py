"""A cantilever chair of one bent tube: cylinders and exact tori, hollow, open at both ends."""

import numpy as np

from scaffold_cad import RoundStruts, Skeleton, round_struts, write

SIDE = np.array([[430, 0, 830], [400, 0, 430], [0, 0, 450], [0, 0, 0], [430, 0, 0]], dtype=float)
"""Top of the back, both ends of the seat, and both ends of the foot, mm."""

WIDTH, TUBE, WALL, BEND = 440.0, 25.0, 2.0, 60.0
"""Of the chair; outer diameter and wall of the tube; radius of its centerline in bends, mm."""


def make() -> RoundStruts:
    """Return the tube."""
    path = np.concatenate([SIDE, SIDE[::-1] + np.array([0, WIDTH, 0])])
    edges = np.stack([np.arange(9), np.arange(1, 10)], axis=1)
    tube = Skeleton(path, edges, TUBE / 2)
    return round_struts(tube, bend=BEND, wall=WALL, ends="open")


if __name__ == "__main__":
    write(make(), "chair.step")
