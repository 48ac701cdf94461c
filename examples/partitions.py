"""The partitions of spheres around 3, 4 and 8 branches (figures 3 and 4 of the paper).

Each sphere is cut into as many spherical quads as branches leave it, one around each branch. The
arcs between the quads are written as a cage of struts with the branches inside, to be printed.
"""

from pathlib import Path

import numpy as np
from _common import out_folder, save, skeleton

from scaffold_cad import Partition, QuadMesh, Skeleton, partition_sphere, thicken
from scaffold_cad.base.vectors import normalize

RADIUS = 20.0
"""Radius of the cage, mm."""

WIRE = 0.6
"""Radius of its struts, mm."""

STEPS = 8
"""Struts an arc is made of."""


def main(folder: Path) -> None:
    """Write a cage for each number of branches."""
    for name in ("star_3", "star_4", "star_8"):
        star = skeleton(name)
        partition = partition_sphere(star.directions[::2])
        nearest = np.degrees(partition.clearance.min())
        print(f"{name}: no branch is closer than {nearest:.1f}° to a side of its quad")
        save(thicken(cage(partition), WIRE), folder / f"{name}_cage.stl")


def cage(partition: Partition) -> Skeleton:
    """Return the arcs of a partition on a sphere, and the branches from its center."""
    count = len(partition.vertices)
    ends = QuadMesh(partition.vertices, partition.quads).edges  # (a, 2)
    share = np.arange(1, STEPS)[:, None] / STEPS
    start, end = partition.vertices[ends][:, :, None].swapaxes(0, 1)  # (a, 1, 3)
    inner = normalize((1 - share) * start + share * end)  # (a, STEPS - 1, 3)
    rows = count + np.arange(len(ends) * (STEPS - 1)).reshape(len(ends), -1)
    walks = np.hstack([ends[:, :1], rows, ends[:, 1:]])  # (a, STEPS + 1)
    arcs = np.stack([walks[:, :-1], walks[:, 1:]], axis=2).reshape(-1, 2)

    points = np.vstack([partition.vertices, inner.reshape(-1, 3), np.zeros(3)])
    tips = len(points) + np.arange(len(partition.directions))
    spokes = np.stack([np.full(len(tips), len(points) - 1), tips], axis=1)
    nodes = RADIUS * np.vstack([points, 1.2 * partition.directions])
    return Skeleton(nodes, np.vstack([arcs, spokes]), np.array(WIRE))


if __name__ == "__main__":
    main(out_folder(__doc__))
