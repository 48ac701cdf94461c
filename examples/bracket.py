"""A bracket: a lattice arm on a wall, and a weight at its tip.

The arm's cells get smaller toward the tip; its struts are sized for aluminum. Written is the
solid.
"""

from pathlib import Path

import numpy as np
from _common import out_folder, save

from scaffold_cad import build_scaffold, mapped, tile
from scaffold_cad.base.arrays import Points
from scaffold_cad.mechanics import BeamModel, Load, Sized, Support, beam_model, sized

REACH = 150.0
"""Length of the arm, mm."""

ROOT, TIP = 60.0, 20.0
"""Height of the arm at the wall and at its tip, mm."""

WEIGHT = 500.0
"""At the tip, N."""

LEAST_RADIUS = 0.8
"""Thinnest strut, mm."""


def main(folder: Path) -> None:
    """Size the bracket, tell what it brings, and write it."""
    before, after = results(bracket())
    for name, result in (("one radius", before), ("sized", after)):
        solution = result.solution
        print(
            f"{name}: {1000 * result.mass:.1f} g, "
            f"radii {result.radii.min():.2f} to {result.radii.max():.2f} mm, "
            f"utilization {solution.utilization.max():.3f}, "
            f"sag {solution.largest_displacement:.2f} mm"
        )
    save(build_scaffold(after.skeleton), folder / "bracket.stl")


def bracket() -> BeamModel:
    """Return the arm, held at the wall's nodes and loaded at its tip."""
    arm = mapped(tile("bccz", 1.0, (5, 1, 2), radius=2.0), shaped).with_radii(2.0)
    x = arm.nodes[:, 0]
    return beam_model(
        arm,
        "aluminum",
        Support(x < 0.1),
        Load(x > REACH - 0.1, force=(0, 0, -WEIGHT)),
    )


def results(model: BeamModel) -> tuple[Sized, Sized]:
    """Return the arm with one radius, and with one for each strut."""
    one_radius = np.zeros(len(model.skeleton.edges))
    even = sized(model, least_radius=LEAST_RADIUS, groups=one_radius, least_mass=False)
    return even, sized(model, least_radius=LEAST_RADIUS)


def shaped(points: Points) -> Points:
    """Return where points of a block of 5 × 1 × 2 cells come to lie, mm."""
    along = points[:, 0] / 5
    height = ROOT + (TIP - ROOT) * along
    return np.stack(
        [REACH * along, 0.7 * height * (points[:, 1] - 0.5), height * points[:, 2] / 2], axis=1
    )


if __name__ == "__main__":
    main(out_folder(__doc__))
