"""A shoe sole's cushion: cells on a free face, thicker and softer at the heel."""

import build123d as bd
import numpy as np

from scaffold_cad import RoundStruts, face_map, round_struts, tile, write


def make() -> RoundStruts:
    """Return the cushion's struts."""
    x, y = range(0, 241, 40), (-32, -10, 10, 32)
    rows = [[bd.Vector(a, b, 0.002 * (a - 60) ** 2 + 0.004 * b**2) for b in y] for a in x]
    sole = bd.Face.make_surface_from_array_of_points(rows)
    cells = face_map(sole, thickness=lambda points: 10 + 6 * np.exp(-points[:, 0] / 80))
    lattice = tile("kelvin", 12.0, radius=lambda points: 0.6 + points[:, 0] / 500, on=cells)
    return round_struts(lattice)


if __name__ == "__main__":
    write(make(), "shoe_sole.stl", sides=8)
