"""A bracket with holes and fillets, its inside round struts under a closed skin: a STEP solid."""

import build123d as bd

from scaffold_cad import lattice_solid, write


def make() -> bd.Solid:
    """Return the bracket with the struts, true cylinders up to the skin."""
    part = bd.Box(40, 24, 10) + bd.Pos(-15, 0, 15) * bd.Box(10, 24, 40)
    part -= bd.Pos(9, 0, 0) * bd.Cylinder(4, 10)
    part -= bd.Pos(-15, 0, 22) * bd.Rot(0, 90, 0) * bd.Cylinder(5, 10)
    inner = part.edges().filter_by(bd.Axis.Y).sort_by_distance((-10, 0, 5))[0]
    upright = part.edges().filter_by(bd.Axis.Z).sort_by_distance((20, 0, 0))[:2]
    return lattice_solid(bd.fillet([inner, *upright], 6), "bcc", 10.0, 0.8, skin=1.2)


if __name__ == "__main__":
    write(make(), "filled_bracket.step")
