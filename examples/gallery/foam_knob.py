"""A knob with a thread hole, its inside a foam of finer cells near its foot, under a skin."""

import build123d as bd
import numpy as np
from manifold3d import Manifold

from scaffold_cad import strut_part, voronoi_foam, write


def make() -> Manifold:
    """Return the knob: the foam is larger than it, and cut by its skin."""
    outline = bd.Polyline((4, 0), (11, 0), (9, 18), (18, 26), (18, 34), (14, 38), (4, 38), (4, 0))
    knob = bd.revolve(bd.Plane.XZ * bd.make_face(outline), bd.Axis.Z)
    foam = voronoi_foam(
        None,
        [[-30, -30, -12], [30, 30, 50]],
        0.7,
        size=lambda points: np.clip(7 + points[:, 2] / 8, 7, 12),
        regularity=0.6,
        shortest=1.8,
    )
    return strut_part(knob, foam, skin=1.2, section="round", sides=8)


if __name__ == "__main__":
    write(make(), "foam_knob.stl")
