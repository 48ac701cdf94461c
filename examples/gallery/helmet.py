"""A helmet's liner: cells between an inner and an outer dome, which are not concentric."""

import build123d as bd
from manifold3d import Manifold

from scaffold_cad import between_faces, round_struts, tile, to_solid, write

STEPS = (-0.95, -0.5, 0.0, 0.5, 0.95)


def dome(a: float, b: float, height: float) -> bd.Face:
    """Return the part of an ellipsoid above a rectangle of the plane."""
    rows = [[(a * x, b * y, height * (2 - x * x - y * y) ** 0.5) for y in STEPS] for x in STEPS]
    return bd.Face.make_surface_from_array_of_points([[bd.Vector(*p) for p in row] for row in rows])


def make() -> Manifold:
    """Return the liner as a solid."""
    cells = between_faces(dome(100.0, 80.0, 60.0), dome(118.0, 95.0, 75.0))
    return to_solid(round_struts(tile("bcc", 20.0, radius=1.2, on=cells)), sides=8)


if __name__ == "__main__":
    write(make(), "helmet.stl")
