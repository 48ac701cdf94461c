"""Where smooth surfaces cross themselves."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints
from scaffold_cad.base.vectors import dot, normalize
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.smooth.connectivity import Connectivity
from scaffold_cad.smooth.grids import as_grids, grid_places
from scaffold_cad.smooth.limits import limit_points, sum_of_normals
from scaffold_cad.smooth.patches import Patches
from scaffold_cad.smooth.slabs import FineSurface
from scaffold_cad.smooth.subdivision import subdivided

TRIED_LEVELS = (2, 3)
"""Levels of the meshes that are tested in turn: 4 × 4 cells a quad, and 8 × 8 where those cross;
sections of struts with 16 corners, and with 32."""

MARGIN = 1.25
"""How far out the tested mesh is moved, in distances by which the surface bulges out of it."""


def crossing_struts(surface: Patches | FineSurface, scaffold: Scaffold) -> Ints:
    """Return the struts whose smooth surface is not known to keep apart from itself, ascending.

    The surface itself is sampled, on 17 × 17 points a quad. A mesh through 9 × 9 of them, whose
    cells share their corners, is moved outwards by 1.25 times what the other points stand out of
    it, so that it goes around the surface; it is tested exactly, as it was and moved. Struts whose
    gap is less than some hundredths of their radius may be named although they keep apart. Struts
    that cross are missed only where the surface has bumps between its samples. Patches that turn
    over count as crossing.

    Parameters
    ----------
    surface : of `smooth_patches` or `fine_surface`, of `scaffold`
    """
    if isinstance(surface, Patches):
        control = Connectivity.of(surface.control.mesh, surface.control.creases)
        owner, faulty = surface.quad_of_patch, surface.turned
    else:
        control, owner = surface.control, surface.quad_of_quad
        faulty = np.zeros(0, dtype=np.intp)
    crossing = np.arange(len(control.quads))
    for levels in TRIED_LEVELS:
        if len(crossing):
            crossing = _crossing_quads(control, _samples(surface, levels + 1), crossing)
    found: Ints = np.unique(scaffold.edge_of_quad[owner[np.union1d(crossing, faulty)]])
    return found


def _samples(surface: Patches | FineSurface, levels: int) -> Floats:
    """Return points of the surface on a grid a quad, (f, 2^levels + 1, 2^levels + 1, 3), mm."""
    if isinstance(surface, Patches):
        points, _ = surface.sampled(2**levels + 1)
        return points
    fine, vertices = subdivided(surface.control, surface.points, levels)
    return as_grids(limit_points(fine, vertices)[fine.quads], levels)


def _crossing_quads(control: Connectivity, grids: Floats, among: Ints) -> Ints:
    """Return the quads of `among` whose parts of a mesh around the surface cross each other.

    Parameters
    ----------
    grids : (f, 2 n + 1, 2 n + 1, 3) float64, mm, points of the surface on each quad, n a power
        of 2; every second one is a corner of the mesh
    among : (k,) intp, rows of `control.quads`, ascending
    """
    levels = (grids.shape[1] - 1).bit_length() - 2
    fine = control
    for _ in range(levels):
        fine = fine.subdivided()
    at = 2 * grid_places(levels)  # (4^levels, 4, 2)

    def points(at: Ints) -> Floats:
        return np.asarray(grids[:, at[..., 0], at[..., 1]].reshape(-1, at.shape[1], 3))

    corners = points(at)
    following = np.roll(corners, -1, axis=1)
    opposite = np.roll(corners, -2, axis=1)[:, :2]
    vertices = np.empty((fine.count, 3))
    vertices[fine.quads] = corners

    # What stands out between the corners: on the sides, and over both diagonals.
    on_sides = points((at + np.roll(at, -1, axis=1)) // 2) - (corners + following) / 2
    in_middle = points(at.sum(axis=1, keepdims=True) // 4) - (corners[:, :2] + opposite) / 2
    normals = normalize(np.cross(opposite[:, 0] - corners[:, 0], opposite[:, 1] - corners[:, 1]))
    bulge = dot(np.concatenate([on_sides, in_middle], axis=1), normals[:, None]).max(axis=1)
    reach = np.zeros(fine.count)
    np.maximum.at(reach, fine.quads, bulge[:, None])
    outward = normalize(sum_of_normals(fine, vertices))
    tested = fine.quads.reshape(-1, 4**levels, 4)[among].reshape(-1, 4)
    # The mesh itself too: moved outwards, small folds come apart.
    crossing = [
        self_intersections(QuadMesh(vertices + margin * reach[:, None] * outward, tested))
        for margin in (0.0, MARGIN)
    ]
    found: Ints = among[np.unique(np.concatenate(crossing) >> 1) // 4**levels]
    return np.unique(found)
