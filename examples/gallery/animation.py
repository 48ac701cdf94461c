"""A tree that sways: every frame of the film has the same quads, and only vertices move.

So frames can be blended, textured once, or handed to an optimizer.
"""

from pathlib import Path

import numpy as np

from scaffold_cad import Scaffold, Skeleton, build_scaffold, read_skeleton, write

SKELETON = Path(__file__).parents[1] / "skeletons" / "tree.json"

FRAMES, SWAY = 3, 0.5
"""Frames from one side to the other, and how far the tip leans, rad."""


def swayed(tree: Skeleton, lean: float) -> Skeleton:
    """Return the tree bent by a wind: each height turns by its share of `lean`, rad."""
    x, y, z = tree.nodes.T
    angle = lean * z / z.max()
    bent = [x * np.cos(angle) + z * np.sin(angle), y, z * np.cos(angle) - x * np.sin(angle)]
    return tree.moved(np.stack(bent, axis=1))


def make() -> list[Scaffold]:
    """Return the frames."""
    tree = read_skeleton(SKELETON, strict=True)
    still = build_scaffold(tree)
    return [build_scaffold(swayed(tree, SWAY * t), like=still) for t in np.linspace(-1, 1, FRAMES)]


if __name__ == "__main__":
    for number, frame in enumerate(make()):
        write(frame, f"animation_{number}.obj")
