"""A cooling sleeve on a pipe with a port: its cells close around it and leave the port free."""

import build123d as bd
from manifold3d import Manifold

from scaffold_cad import face_map, round_struts, tile, to_solid, write


def make() -> Manifold:
    """Return the sleeve as a solid."""
    port = bd.Pos(20, 0, 2) * bd.Rot(0, 90, 0) * bd.Cylinder(6.0, 30.0)
    pipe = bd.Cylinder(20.0, 36.0) - bd.Cylinder(18.0, 36.0) - port
    outside = max(pipe.faces().filter_by(bd.GeomType.CYLINDER), key=lambda face: face.area)
    cells = face_map(outside, thickness=8.0)
    sleeve = tile("bcc", 9.0, radius=1.0, on=cells, dangling=False)
    return to_solid(round_struts(sleeve), sides=8)


if __name__ == "__main__":
    write(make(), "pipe_sleeve.stl")
