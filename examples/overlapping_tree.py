"""A tree whose spheres intersect (figure 8 of the paper).

It is the tree of `tree.py` with radii so large that the spheres of neighboring nodes overlap. The
scaffold has the same quads as before, and the embedding report tells whether it crosses itself.
"""

from pathlib import Path

import numpy as np
from _common import out_folder, save, skeleton

from scaffold_cad import build_scaffold, to_solid

RADIUS = 3.2
"""Radius of every node, mm; half the edges are shorter than twice this."""


def main(folder: Path) -> None:
    """Write the scaffold of the tree."""
    tree = skeleton("tree").with_radii(RADIUS)
    scaffold = build_scaffold(tree, fit="paper")
    overlapping = np.count_nonzero(tree.lengths < 2 * RADIUS)
    print(f"the spheres at the ends of {overlapping} of {len(tree.edges)} edges intersect")
    print(f"certified that the scaffold does not: {scaffold.embedding().certified}")
    save(scaffold, folder / "overlapping_tree.step")
    save(to_solid(scaffold), folder / "overlapping_tree.stl")


if __name__ == "__main__":
    main(out_folder(__doc__))
