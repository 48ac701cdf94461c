"""A shoe sole's cushion: cells on a free face, thicker and softer at the heel."""

import build123d as bd
import numpy as np
from manifold3d import Manifold

from scaffold_cad import face_map, round_struts, tile, to_solid, write

X, Y = range(0, 241, 40), (-32, -10, 10, 32)


def make() -> Manifold:
    """Return the cushion as a solid."""
    rows = [[bd.Vector(x, y, 0.002 * (x - 60) ** 2 + 0.004 * y**2) for y in Y] for x in X]
    sole = bd.Face.make_surface_from_array_of_points(rows)
    cells = face_map(sole, thickness=lambda points: 10 + 6 * np.exp(-points[:, 0] / 80))
    lattice = tile("kelvin", 12.0, radius=lambda points: 0.6 + points[:, 0] / 500, on=cells)
    return to_solid(round_struts(lattice), sides=8)


if __name__ == "__main__":
    write(make(), "shoe_sole.stl")
