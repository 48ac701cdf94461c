"""The inside of a closed triangle mesh as a region: where struts pierce it, what is inside."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points, read_only
from scaffold_cad.base.regions import surface_tolerance
from scaffold_cad.base.vectors import dot, length, rotate
from scaffold_cad.lattice.boxgrid import BoxGrid, Rooms
from scaffold_cad.mesh.bodies import check_balanced, report_crossed, turned_outwards
from scaffold_cad.mesh.nearest import nearest_on_triangles
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.mesh.welding import welded, without_repeated_corners

SURFACE_FRACTION = 1e-6
"""Distance within which a point is on the surface, as a fraction of the bounds' diagonal.

Meshes from STL files have coordinates of seven digits."""

BORDER = 1e-6
"""How far beyond its sides a triangle is met, as a fraction of its size: no gaps between them."""


class MeshRegion:
    """The inside of a closed triangle mesh and its surface.

    Shells may lie in or on each other: inside is where the surface winds around a point at
    least once.
    """

    def __init__(self, mesh: TriangleMesh, error: float = 0.0) -> None:
        """Keep the triangles of a closed mesh, counter-clockwise seen from outside.

        Bodies of the mesh may touch along edges. Shells that are inside out are turned; the log
        says so, and names a place where a shell crosses itself.

        Parameters
        ----------
        error : how far triangles may be off the surface that they stand for, mm: what is as near
            to them is on it

        Raises
        ------
        MeshError
            If the mesh is not closed; the place is named in mm.
        """
        mesh = without_repeated_corners(welded(mesh))
        check_balanced(mesh)
        mesh = turned_outwards(mesh)
        self._corners = mesh.vertices[mesh.triangles]  # (t, 3, 3)
        self.bounds = np.stack([self._corners.min(axis=(0, 1)), self._corners.max(axis=(0, 1))])
        read_only(self.bounds)
        exact = surface_tolerance(self.bounds, SURFACE_FRACTION)
        self.tolerance = max(exact, error)
        report_crossed(mesh, exact)

    def crossings(self, nodes: Points, edges: Edges) -> tuple[Ints, Floats]:
        """Return where edges pierce triangles or pass them within the tolerance.

        A shared side is met as often as triangles meet there.
        """
        start, end = nodes[edges[:, 0]], nodes[edges[:, 1]]
        found_strut, found_along = [np.zeros(0, dtype=np.intp)], [np.zeros(0)]
        for strut, triangle in self._grid.near(np.minimum(start, end), np.maximum(start, end)):
            a, normal = self._corners[triangle, 0], self._normals[triangle]
            above, below = dot(start[strut] - a, normal), dot(end[strut] - a, normal)
            facing = (above > 0) != (below > 0)
            strut, triangle, above, below = (
                rows[facing] for rows in (strut, triangle, above, below)
            )
            along = above / (above - below)
            place = start[strut] + along[:, None] * (end[strut] - start[strut])
            met = self._is_over(triangle, place)
            found_strut.append(strut[met])
            found_along.append(along[met])
        return np.concatenate(found_strut), np.concatenate(found_along)

    def contains(self, points: Points) -> Bools:
        """Return whether each of `points` (n, 3) is inside or on the surface, (n,)."""
        return self._rooms.contains(
            points, lambda near: self._is_inside(near) | self._on_surface(near)
        )

    @cached_property
    def _rooms(self) -> Rooms:
        return Rooms(self._grid, self._is_inside)

    @cached_property
    def _grid(self) -> BoxGrid:
        return BoxGrid(self._corners, self.tolerance)

    @cached_property
    def _turned(self) -> Floats:
        """Corners of the triangles in the frame in which rays run along z, (t, 3, 3)."""
        return _turn(self._corners)

    @cached_property
    def _columns(self) -> BoxGrid:
        return BoxGrid(self._turned[:, :, :2])

    def _is_inside(self, points: Points) -> Bools:
        return self._winding_numbers(points) > 0

    def _winding_numbers(self, points: Points) -> Ints:
        """Return how often the surface winds around each of `points` (n, 3), shape (n,).

        Each triangle above a point counts once, down if it faces down. The products that tell
        on which side of an edge the point lies are negated exactly for the triangle on the
        other side of it: no ray slips between two triangles.
        """
        turned = _turn(points)
        winding = np.zeros(len(points))
        shadow = turned[:, :2]
        for point, triangle in self._columns.near(shadow, shadow):
            corners = self._turned[triangle]  # (k, 3, 3)
            x, y = np.moveaxis(corners[:, :, :2] - shadow[point][:, None], 2, 0)  # (k, 3)
            sides = np.stack(
                [x[:, k - 2] * y[:, k - 1] - y[:, k - 2] * x[:, k - 1] for k in range(3)]
            )
            up, down = sides.min(axis=0) > 0, sides.max(axis=0) < 0  # side k is opposite corner k
            struck = np.flatnonzero(up | down)
            weight = sides[:, struck]
            height = (weight * corners[struck, :, 2].T).sum(axis=0) / weight.sum(axis=0)
            above = struck[height > turned[point[struck], 2]]
            winding += np.bincount(
                point[above], weights=np.where(up[above], 1.0, -1.0), minlength=len(points)
            )
        return np.rint(winding).astype(np.intp)

    def _on_surface(self, points: Points) -> Bools:
        """Return whether each of `points` (n, 3) is within the tolerance of a triangle, (n,)."""
        on = np.zeros(len(points), dtype=np.bool_)
        for point, triangle in self._grid.near(points, points):
            off = points[point] - nearest_on_triangles(points[point], self._corners[triangle])
            on[point[length(off) <= self.tolerance]] = True
        return on

    @cached_property
    def _normals(self) -> Floats:
        """Normals as long as twice the triangles' areas, shape (t, 3), mm²."""
        a, b, c = (self._corners[:, k] for k in range(3))
        return np.cross(b - a, c - a)

    def _is_over(self, triangle: Ints, points: Points) -> Bools:
        """Return whether each point (k, 3) in its triangle's plane is within it, or about."""
        normal, corners = self._normals[triangle], self._corners[triangle]
        spokes = corners - points[:, None]
        slack = BORDER * dot(normal, normal)
        over = np.ones(len(triangle), dtype=np.bool_)
        for k in range(3):
            area = dot(np.cross(spokes[:, k], spokes[:, k - 2]), normal)
            side = length(corners[:, k - 2] - corners[:, k])
            over &= area >= -np.maximum(slack, self.tolerance * side * length(normal))
        return over


def _turn(points: Floats) -> Floats:
    """Return `points` (..., 3) turned so that what lies along the axes is nowhere near z."""
    x, z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
    return rotate(rotate(points, z, np.asarray(0.7)), x, np.asarray(1.1))
