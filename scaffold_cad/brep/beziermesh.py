"""BezierMesh: one tensor-product Bézier patch per quad, joined along shared boundary curves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from scaffold_cad.base.arrays import (
    Bools,
    Floats,
    Frozen,
    Ints,
    Quads,
    UnitVectors,
    as_quads,
    read_only,
)
from scaffold_cad.base.vectors import length, normalize, triple
from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.quadmesh import QuadMesh

GAP_TOLERANCE = 1e-8
"""Distance within which the control points that two patches share must agree, mm."""

FLATNESS_TOLERANCE = 1e-8
"""Distance within which the control points of a flat patch lie of their plane, mm."""


@dataclass(frozen=True, eq=False)
class BezierMesh(Frozen):
    """A mesh of Bézier patches of one degree d, one per quad.

    The first index of a patch's control points follows the quad's first side, from corner 0 to
    corner 1, the second its last side, from corner 0 to corner 3. Neighboring patches have the
    same boundary control points.
    """

    quads: Quads
    """Vertex indices of the patches' corners, shape (f, 4), counter-clockwise from outside."""
    control_points: Floats
    """Control points of each patch, shape (f, d + 1, d + 1, 3), mm."""

    def __post_init__(self) -> None:
        points = np.array(self.control_points, dtype=np.float64, order="C")
        if points.ndim != 4 or points.shape[1] != points.shape[2] or points.shape[3] != 3:
            raise MeshError(f"control_points has shape {points.shape}; need (f, d + 1, d + 1, 3)")
        if points.shape[1] < 2:
            raise MeshError("the patches have degree 0; need 1 or more")
        bad = np.flatnonzero(~np.isfinite(points).all(axis=(1, 2, 3)))
        if len(bad):
            raise MeshError(f"patch {bad[0]} has control points that are not finite numbers")
        count = int(np.max(self.quads, initial=-1)) + 1
        quads = as_quads(self.quads, "quads", count)
        if len(quads) != len(points):
            raise MeshError(f"{len(points)} patches given for {len(quads)} quads; need one each")
        read_only(points)
        object.__setattr__(self, "quads", quads)
        object.__setattr__(self, "control_points", points)
        self._check_joined()

    @classmethod
    def bilinear(cls, mesh: QuadMesh) -> BezierMesh:
        """Return the patches of degree 1 on the corners of each quad of `mesh`."""
        points = mesh.vertices[mesh.quads[:, [0, 3, 1, 2]]].reshape(-1, 2, 2, 3)
        read_only(points)
        patches = object.__new__(cls)
        object.__setattr__(patches, "quads", mesh.quads)
        object.__setattr__(patches, "control_points", points)
        object.__setattr__(patches, "mesh", mesh)
        return patches

    @property
    def degree(self) -> int:
        """Degree d of the patches in both directions."""
        return int(self.control_points.shape[1]) - 1

    @cached_property
    def mesh(self) -> QuadMesh:
        """The patches' corners as a quad mesh; a vertex that no quad uses is at the origin."""
        last = self.degree
        vertices = np.zeros((int(self.quads.max(initial=-1)) + 1, 3))
        # Reversed, so that a vertex has the position that its first patch gives it.
        corners = self.control_points[::-1, [0, last, last, 0], [0, 0, last, last]]
        vertices[self.quads[::-1]] = corners
        return QuadMesh(vertices, self.quads)

    @cached_property
    def runs_forward(self) -> Bools:
        """Whether each of a quad's four sides runs from its edge's lower vertex, shape (f, 4)."""
        forward: Bools = self.mesh.half_edges[:, 0] < self.mesh.half_edges[:, 1]
        return forward.reshape(-1, 4)

    @cached_property
    def edge_control_points(self) -> Floats:
        """Control points of each edge of `mesh` from its lower vertex on, shape (e, d + 1, 3)."""
        edge = self.mesh.edge_of_half_edge
        first = np.empty(len(self.mesh.edges), dtype=np.intp)
        first[edge[::-1]] = np.arange(len(edge))[::-1]  # the last one assigned stays
        return self._rows_along_edges()[first]

    @cached_property
    def plane_normals(self) -> UnitVectors:
        """Unit normal of each patch that lies in a plane; zero for all others, shape (f, 3)."""
        a, b, c, d = (self.mesh.vertices[self.quads[:, k]] for k in range(4))
        normals = normalize(np.cross(c - a, d - b))
        points = self.control_points.reshape(len(self.quads), -1, 3)
        # Corners that are not in a plane are all equally far from this one.
        offsets = points - ((a + b + c + d) / 4)[:, None]
        height = np.abs(np.einsum("fik,fk->fi", offsets, normals)).max(axis=1, initial=0.0)
        normals[height > FLATNESS_TOLERANCE] = 0.0
        return normals

    @property
    def signed_volume(self) -> float:
        """Volume inside the patches, mm³: > 0 for a closed mesh with outward patches.

        Gauss's rule with enough points is exact: the integrand is a polynomial of degree 3 d − 1
        in each direction.
        """
        if len(self.quads) == 0:
            return 0.0
        nodes, weights = np.polynomial.legendre.leggauss((3 * self.degree + 1) // 2)
        nodes, weights = (nodes + 1) / 2, weights / 2
        value, slope = (bernstein(self.degree, nodes, order) for order in (0, 1))  # (g, d + 1)
        points = self.control_points - self.control_points.mean(axis=(0, 1, 2))
        place = np.einsum("gi,hj,fijk->fghk", value, value, points, optimize=True)
        along_u = np.einsum("gi,hj,fijk->fghk", slope, value, points, optimize=True)
        along_v = np.einsum("gi,hj,fijk->fghk", value, slope, points, optimize=True)
        flux = triple(along_u, along_v, place)  # (f, g, g)
        return float(np.einsum("g,h,fgh->", weights, weights, flux)) / 3.0

    def _rows_along_edges(self) -> Floats:
        """Return each side's control points from its edge's lower vertex on, (4 f, d + 1, 3)."""
        patches = self.control_points.reshape(-1, (self.degree + 1) ** 2, 3)
        rows = patches[:, side_indices(self.degree)].reshape(-1, self.degree + 1, 3)
        return np.where(self.runs_forward.reshape(-1)[:, None, None], rows, rows[:, ::-1])

    def _check_joined(self) -> None:
        """Raise unless patches have the same control points at what they share."""
        rows = self._rows_along_edges()
        gaps = length(rows - self.edge_control_points[self.mesh.edge_of_half_edge]).max(axis=1)
        # A vertex may belong to patches that share no edge.
        corners = rows[np.arange(len(rows)), np.where(self.runs_forward, 0, -1).reshape(-1)]
        gaps = np.maximum(gaps, length(corners - self.mesh.vertices[self.quads.reshape(-1)]))
        if gaps.max(initial=0.0) > GAP_TOLERANCE:
            worst = int(np.argmax(gaps))
            a, b = self.mesh.half_edges[worst].tolist()
            raise MeshError(
                f"patch {worst // 4} is {gaps[worst]:g} mm off its neighbor along the edge "
                f"from vertex {a} to {b}; need at most {GAP_TOLERANCE:g} mm"
            )


def side_indices(degree: int) -> Ints:
    """Return which of a patch's flattened control points lie on its four sides, (4, d + 1)."""
    grid = np.arange((degree + 1) ** 2).reshape(degree + 1, degree + 1)
    return np.stack([grid[:, 0], grid[-1, :], grid[::-1, -1], grid[0, ::-1]])
