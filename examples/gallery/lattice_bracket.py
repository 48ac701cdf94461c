"""A bracket made with build123d, its inside an octet lattice under a closed skin.

What is left between the struts is a void: drill a hole for powder or resin to get out.
"""

import build123d as bd
from manifold3d import Manifold

from scaffold_cad import lattice_part, write

WIDTH, ARM, THICKNESS = 24.0, 44.0, 12.0
"""Width of the bracket, and length and thickness of its arms, mm."""


def bracket() -> bd.Part:
    """Return the bracket, massive."""
    arm = bd.Box(ARM, WIDTH, THICKNESS, align=(bd.Align.MIN, bd.Align.CENTER, bd.Align.MIN))
    other = bd.Box(THICKNESS, WIDTH, ARM, align=(bd.Align.MIN, bd.Align.CENTER, bd.Align.MIN))
    bolt = bd.Cylinder(4.0, 3 * THICKNESS)
    part = arm + other
    part -= bd.Pos(0.7 * ARM, 0, 0) * bolt
    part -= bd.Pos(0, 0, 0.7 * ARM) * bd.Rot(0, 90, 0) * bolt
    return bd.Part() + part


def make() -> Manifold:
    """Return the bracket with the lattice."""
    return lattice_part(bracket(), "octet", 8.0, 0.6, skin=1.2)


if __name__ == "__main__":
    part = make()
    print(f"{part.volume() / bracket().volume:.0%} of the massive bracket's volume is left")
    write(part, "lattice_bracket.stl")
