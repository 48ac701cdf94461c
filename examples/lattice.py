"""A finger ring of Kelvin cells whose struts grow from one side to the other.

The cells are tiled in a box, the box is bent into a ring, and its ends are welded. Written are the
coarse scaffold as a STEP solid, and the ring of round struts as an STL file.
"""

from pathlib import Path

import numpy as np
from _common import out_folder, save

from scaffold_cad import Skeleton, build_scaffold, mapped, round_struts, tile
from scaffold_cad.base.arrays import Floats, Points, Radii

CELL = 4.5
"""Size of a cell, mm."""

AROUND = 12
"""Cells around the ring."""

INNER_RADIUS = 8.5
"""Radius of the ring's inside, mm."""

THIN, THICK = 0.22, 0.4
"""Radii of struts on either side of the ring, mm."""


def main(folder: Path) -> None:
    """Write the ring."""
    scaffold = build_scaffold(ring())
    struts, certified = len(scaffold.skeleton.edges), scaffold.embedding().certified
    print(f"{struts} struts; certified that none overlaps another: {certified}")
    save(scaffold, folder / "ring.step")
    save(round_struts(scaffold.skeleton, blend=0.1), folder / "ring.stl")


def ring() -> Skeleton:
    """Return the cells bent into a ring."""
    return mapped(tile("kelvin", CELL, (AROUND, 1, 2), radius=graded), bent)


def angle(points: Points) -> Floats:
    """Return how far around the ring each point of the box (n, 3) comes, rad, shape (n,)."""
    return points[:, 0] * (2 * np.pi / (AROUND * CELL))


def graded(points: Points) -> Radii:
    """Return the strut radius at each point of the box, mm, shape (n,)."""
    return THIN + (THICK - THIN) * (1 - np.cos(angle(points))) / 2


def bent(points: Points) -> Points:
    """Return where each point of the box (n, 3) comes to lie on the ring, mm."""
    radius, theta = INNER_RADIUS + points[:, 1], angle(points)
    return np.stack([radius * np.cos(theta), radius * np.sin(theta), points[:, 2]], axis=1)


if __name__ == "__main__":
    main(out_folder(__doc__))
