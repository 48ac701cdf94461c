"""smooth_mesh: the smooth solid as a fine quad mesh, for printing."""

from __future__ import annotations

from scaffold_cad.scaffold import Scaffold
from scaffold_cad.smooth.control import Caps
from scaffold_cad.smooth.limits import limit_points
from scaffold_cad.smooth.slabs import fine_surface
from scaffold_cad.smooth.subdivision import Subdivision, as_subdivision, subdivided


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

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold, smooth_mesh
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> smooth_mesh(build_scaffold(strut), levels=1).mesh.euler_characteristic
    2
    """
    surface = fine_surface(scaffold, levels, caps)
    fine, points = subdivided(surface.control, surface.points, surface.levels)
    subdivision = as_subdivision(fine, limit_points(fine, points), surface.levels)
    quads = surface.quad_of_quad[subdivision.quad_of_quad]
    return Subdivision(subdivision.mesh, subdivision.creases, quads)
