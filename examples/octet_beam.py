"""An octet beam in three-point bending, its struts sized by what they carry.

Before: one radius for all struts, so that none is overloaded. After: each strut as thin as its
forces, buckling and the printer allow. Written is the sized beam, as a solid.
"""

from pathlib import Path

import numpy as np
from _common import out_folder, save

from scaffold_cad import build_scaffold, tile
from scaffold_cad.mechanics import BeamModel, Load, Sized, Support, beam_model, sized

CELL = 20.0
"""Size of a cell, mm."""

CELLS = 6
"""Cells along the beam."""

FORCE = 2000.0
"""In the middle, N."""

LEAST_RADIUS = 0.6
"""Thinnest strut that the printer makes, mm."""


def main(folder: Path) -> None:
    """Size the struts, tell what it brings, and write the beam."""
    before, after = results(bent_beam())
    for name, result in (("one radius", before), ("sized", after)):
        solution = result.solution
        print(
            f"{name}: {1000 * result.mass:.1f} g, "
            f"radii {result.radii.min():.2f} to {result.radii.max():.2f} mm, "
            f"utilization {solution.utilization.max():.3f}, "
            f"sag {solution.largest_displacement:.3f} mm"
        )
    save(build_scaffold(after.skeleton), folder / "octet_beam.stl")


def bent_beam() -> BeamModel:
    """Return the beam on two supports with a force in the middle."""
    lattice = tile("octet", CELL, (CELLS, 1, 1), radius=1.0)
    x, _, z = lattice.nodes.T
    low = z < 0.1
    return beam_model(
        lattice,
        "aluminum",
        [
            Support((x < 0.1) & low, "pinned"),
            Support((x > CELLS * CELL - 0.1) & low, "y z"),
        ],
        Load((np.abs(x - CELLS * CELL / 2) < 0.1) & (z > CELL - 0.1), force=(0, 0, -FORCE)),
    )


def results(model: BeamModel) -> tuple[Sized, Sized]:
    """Return the beam with one radius, and with one for each strut."""
    one_radius = np.zeros(len(model.skeleton.edges))
    even = sized(model, least_radius=LEAST_RADIUS, groups=one_radius, least_mass=False)
    return even, sized(model, least_radius=LEAST_RADIUS)


if __name__ == "__main__":
    main(out_folder(__doc__))
