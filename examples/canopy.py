"""A tree that carries 64 points, its struts sized by what they carry.

A trunk forks into four limbs, each into four branches, each into four twigs. The tips carry a roof
and its wind. Before: one radius for all struts, so that none is overloaded. After: each strut as
thin as its forces and its own buckling allow.
"""

from pathlib import Path

import numpy as np
from _common import out_folder, save

from scaffold_cad import Skeleton, round_struts
from scaffold_cad.mechanics import BeamModel, Load, Sized, Support, beam_model, sized

SIDE = 240.0
"""Side of the roof, mm."""

HEIGHTS = (70.0, 130.0, 175.0, 200.0)
"""Of the trunk's top and of the ends of limbs, branches and twigs, mm."""

TIP_FORCE = (4.0, 0.0, -20.0)
"""On each tip: wind and weight, N."""

LEAST_RADIUS = 1.0
"""Thinnest strut that the printer makes, mm."""


def main(folder: Path) -> None:
    """Size the struts, tell what it brings, and write the tree."""
    before, after = results(loaded_tree())
    for name, result in (("one radius", before), ("sized", after)):
        solution = result.solution
        print(
            f"{name}: {1000 * result.mass:.0f} g, "
            f"radii {result.radii.min():.2f} to {result.radii.max():.2f} mm, "
            f"utilization {solution.utilization.max():.3f}, "
            f"sag and sway {solution.largest_displacement:.0f} mm"
        )
    save(round_struts(after.skeleton), folder / "canopy.step")


def loaded_tree() -> BeamModel:
    """Return the tree, its foot clamped and its tips loaded."""
    centers = np.zeros((1, 2))
    levels = [np.zeros((1, 3)), np.array([[0.0, 0.0, HEIGHTS[0]]])]
    edges, first = [np.array([[0, 1]])], 1
    for level, height in enumerate(HEIGHTS[1:], 1):
        step = SIDE / 2 ** (level + 1) * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
        centers = (centers[:, None] + step).reshape(-1, 2)
        levels.append(np.column_stack([centers, np.full(len(centers), height)]))
        parents = first + np.arange(len(levels[-2]))
        first += len(levels[-2])
        children = first + np.arange(len(centers))
        edges.append(np.column_stack([np.repeat(parents, 4), children]))
    tree = Skeleton(np.concatenate(levels), np.concatenate(edges), 4.0)
    tips = Load(tree.nodes[:, 2] > HEIGHTS[-1] - 0.1, force=TIP_FORCE, each=True)
    return beam_model(tree, "pa12", Support([0]), tips, gravity=(0, 0, -9.81))


def results(model: BeamModel) -> tuple[Sized, Sized]:
    """Return the tree with one radius, and with one for each kind of strut."""
    kinds = np.repeat(np.arange(4), 4 ** np.arange(4))  # trunk, limbs, branches, twigs
    one = sized(model, least_radius=LEAST_RADIUS, groups=np.zeros(85), least_mass=False)
    return one, sized(model, least_radius=LEAST_RADIUS, groups=kinds)


if __name__ == "__main__":
    main(out_folder(__doc__))
