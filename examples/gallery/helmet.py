"""A helmet's liner: cells between an inner and an outer dome, which are not concentric."""

import build123d as bd

from scaffold_cad import RoundStruts, between_faces, round_struts, tile, write


def make() -> RoundStruts:
    """Return the liner's struts."""
    steps = (-0.95, -0.5, 0.0, 0.5, 0.95)
    rows = [[bd.Vector(x, y, (2 - x * x - y * y) ** 0.5) for y in steps] for x in steps]
    dome = bd.Face.make_surface_from_array_of_points(rows)
    inner, outer = (bd.scale(dome, by).face() for by in ((100, 80, 60), (118, 95, 75)))
    return round_struts(tile("octet", 20.0, radius=1.2, on=between_faces(inner, outer)))


if __name__ == "__main__":
    write(make(), "helmet.stl", sides=8)
