"""smooth_mesh: the smooth solid as a fine quad mesh, for printing."""

from __future__ import annotations

from scaffold_cad.scaffold import Scaffold
from scaffold_cad.smooth.catmull_clark import (
    Connectivity,
    Subdivision,
    as_subdivision,
    limit_points,
    subdivided,
)
from scaffold_cad.smooth.control import Caps, control_mesh


def smooth_mesh(scaffold: Scaffold, levels: int = 2, caps: Caps = "round") -> Subdivision:
    """Return a quad mesh whose vertices lie on the smooth solid around the scaffold's skeleton.

    The solid turns at sharp bends as the struts do; mild ones it rounds, by half a radius at most
    and by a tenth with `collars=True`, see `control_mesh`.

    Parameters
    ----------
    levels : ≥ 0; a section has 4 · 2^levels corners
    caps : see `control_mesh`

    Raises
    ------
    OptionError
        If `scaffold` is none, `levels` is no whole number ≥ 0, or `caps` has none of its values.
    """
    control = control_mesh(scaffold, caps)
    coarse = Connectivity.of(control.mesh, control.creases)
    fine, points = subdivided(coarse, control.mesh.vertices, levels)
    subdivision = as_subdivision(fine, limit_points(fine, points), levels)
    quads = control.quad_of_quad[subdivision.quad_of_quad]
    return Subdivision(subdivision.mesh, subdivision.creases, quads)
