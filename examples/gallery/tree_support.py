"""A support like a tree: from one foot on the plate to 64 points under an overhang.

Each branch forks into four, and its section is the sum of theirs.
"""

import numpy as np
from manifold3d import Manifold

from scaffold_cad import Skeleton, round_struts, to_solid, write

SPAN, TIP = 48.0, 0.6
"""Side of the square under the overhang, and radius of the tips, mm."""

HEIGHTS = (10.0, 30.0, 44.0, 54.0)
"""Heights of the forks, and of the tips under the lowest place of the overhang, mm."""


def support() -> Skeleton:
    """Return the branches."""
    nodes, edges, radii = [(0.0, 0.0, 0.0)], [], [10 * TIP]

    def grow(foot: int, x: float, y: float, depth: int) -> None:
        last = len(HEIGHTS) - 1
        rise = 4 * np.cos(x / 12) * np.cos(y / 16) if depth == last else 0.0
        node = len(nodes)
        nodes.append((x, y, HEIGHTS[depth] + rise))
        edges.append((foot, node))
        radii.append(TIP * 2 ** (last - depth))
        if depth < last:
            aside = SPAN / 2 ** (depth + 2)
            for along_x in (-aside, aside):
                for along_y in (-aside, aside):
                    grow(node, x + along_x, y + along_y, depth + 1)

    grow(0, 0.0, 0.0, 0)
    return Skeleton(nodes, edges, radii)


def make() -> Manifold:
    """Return the support as a solid of round struts."""
    return to_solid(round_struts(support()), sides=8)


if __name__ == "__main__":
    write(make(), "tree_support.stl")
