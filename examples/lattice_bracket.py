"""A bracket made with build123d, its inside an octet lattice under a closed skin.

What is left between the struts is a void: drill a hole for powder or resin to get out.
"""

from pathlib import Path

import build123d as bd
from _common import out_folder, save

from scaffold_cad import lattice_part

WIDTH, ARM, THICKNESS = 24.0, 44.0, 12.0
"""Width of the bracket, and length and thickness of its arms, mm."""

SKIN = 1.2
"""Thickness of the closed wall, mm."""


def main(folder: Path) -> None:
    """Write the bracket."""
    solid = bracket()
    part = lattice_part(solid, "octet", 8.0, 0.6, skin=SKIN)
    print(f"{part.volume() / solid.volume:.0%} of the solid bracket's volume is left")
    save(part, folder / "lattice_bracket.stl")


def bracket() -> bd.Part:
    """Return the bracket, massive."""
    arm = bd.Box(ARM, WIDTH, THICKNESS, align=(bd.Align.MIN, bd.Align.CENTER, bd.Align.MIN))
    other = bd.Box(THICKNESS, WIDTH, ARM, align=(bd.Align.MIN, bd.Align.CENTER, bd.Align.MIN))
    bolt = bd.Cylinder(4.0, 3 * THICKNESS)
    part = arm + other
    part -= bd.Pos(0.7 * ARM, 0, 0) * bolt
    part -= bd.Pos(0, 0, 0.7 * ARM) * bd.Rot(0, 90, 0) * bolt
    return bd.Part() + part


if __name__ == "__main__":
    main(out_folder(__doc__))
