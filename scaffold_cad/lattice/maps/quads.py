"""Cells on the quads of a mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scaffold_cad.base.arguments import check_kind, checks_keywords
from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, Quads, UnitVectors
from scaffold_cad.base.topology import sides_of
from scaffold_cad.base.vectors import dot, normalize, sums_by_row
from scaffold_cad.errors import MeshError
from scaffold_cad.lattice.maps.leaning import leaned
from scaffold_cad.lattice.maps.surfaces import Height, SurfaceMap, heights_at
from scaffold_cad.mesh.quadmesh import QuadMesh

SHARP = 0.6
"""Cosine of the angle between a vertex's mean normal and a quad's from which it is turned."""

TURNS = 60
"""Steps by which it is turned."""


@dataclass(frozen=True, eq=False)
class QuadSurface(Frozen):
    """The bilinear patches of a quad mesh; between them the normals turn evenly.

    Quads are turned so that u goes on as u in the next quad wherever that can be.
    """

    vertices: Points
    """Vertex positions, shape (v, 3), mm."""
    quads: Quads
    """Vertices at (u, v) = (0, 0), (1, 0), (1, 1) and (0, 1) of each patch, shape (f, 4)."""
    normals: UnitVectors
    """Unit normal at each vertex, shape (v, 3)."""

    wraps = (False, False)
    loops: tuple[Floats, ...] = ()

    @classmethod
    def of(cls, mesh: QuadMesh) -> QuadSurface:
        """Return the patches of a mesh, closed or not.

        Raises
        ------
        OptionError
            If it is not a quad mesh.
        MeshError
            If it has no quads, or two quads run along a side the same way.
        """
        check_kind(mesh, QuadMesh)
        if len(mesh.quads) == 0:
            raise MeshError("the mesh has no quads; need at least one")
        return cls(mesh.vertices, _turned_alike(mesh.quads), vertex_normals(mesh))

    @property
    def patches(self) -> int:
        """Number of quads."""
        return len(self.quads)

    def at(self, places: Floats, patch: Ints) -> tuple[Points, UnitVectors]:
        """Return positions and unit normals; see `Surface`."""
        u, v = places[:, :1], places[:, 1:]
        weights = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v])  # (4, n, 1)
        corners = self.quads[patch].T  # (4, n)
        points = (weights * self.vertices[corners]).sum(axis=0)
        return points, normalize((weights * self.normals[corners]).sum(axis=0))


@checks_keywords()
@dataclass(frozen=True, eq=False)
class QuadMap(SurfaceMap):
    """Cells on the quads of a mesh, as many in each: w runs along the vertices' normals.

    Where cells would fold, as beside sharp edges, it leans away from these.

    A cell must meet itself when it is turned by a quarter or mirrored, as cubic ones do; others
    fit where no vertex is irregular.

    >>> from scaffold_cad import QuadMesh, tile
    >>> strip = QuadMesh([[0, 0, 0], [9, 0, 0], [9, 9, 3], [0, 9, 3]], [[0, 1, 2, 3]])
    >>> len(tile("bcc", counts=(3, 3, 1), radius=0.3, on=QuadMap(strip, 3.0)).edges)
    72
    """

    def __init__(self, mesh: QuadMesh, thickness: Height, offset: Height = 0.0) -> None:
        """Take the quads of a mesh; thickness and offset are those of `SurfaceMap`."""
        surface = QuadSurface.of(mesh)
        super().__init__(surface, thickness, offset)
        low = heights_at(self.offset, surface.vertices, "offset")
        high = low + heights_at(self.thickness, surface.vertices, "thickness")
        normals = leaned(surface.vertices, surface.quads, surface.normals, low, high)
        self._keep(surface=replace(surface, normals=normals))


def vertex_normals(mesh: QuadMesh) -> UnitVectors:
    """Return the unit normal at each vertex, the mean of its quads' by area, shape (v, 3)."""
    corners = mesh.vertices[mesh.quads]  # (f, 4, 3)
    areas = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    total = np.zeros_like(mesh.vertices)
    for column in mesh.quads.T:
        total += sums_by_row(areas, column, len(total))
    flat = ~total.any(axis=1)
    total[flat] = (0.0, 0.0, 1.0)  # of vertices that no quad has
    return _seen_by_all(normalize(total), mesh.quads, normalize(areas + np.finfo(float).tiny))


def _seen_by_all(normals: UnitVectors, quads: Quads, of_quads: UnitVectors) -> UnitVectors:
    """Return normals (v, 3), turned toward the quads that they are at large angles to.

    The center of the smallest ball around the unit normals of a vertex's quads is in the direction
    at the least angle to all of them (Badoiu and Clarkson, Smaller core-sets for balls, 2003).
    """
    vertex, quad = quads.reshape(-1), np.repeat(np.arange(len(quads)), 4)
    seen = dot(normals[vertex], of_quads[quad])
    sharp = np.zeros(len(normals), dtype=np.bool_)
    sharp[vertex[seen < SHARP]] = True
    some = sharp[vertex]
    vertex, quad = vertex[some], quad[some]
    center = normals.copy()
    for step in range(2, TURNS):
        off = -dot(center[vertex], of_quads[quad])
        order = np.lexsort([off, vertex])
        last = np.flatnonzero(np.diff(vertex[order], append=-1))
        worst = order[last]
        center[vertex[worst]] += (of_quads[quad[worst]] - center[vertex[worst]]) / step
    return np.where(sharp[:, None], normalize(center), normals)


def _turned_alike(quads: Quads) -> Quads:
    """Return the quads with their first corner chosen so that neighbors' directions agree."""
    partner = _partners(quads)
    turn = np.full(len(quads), -1)
    for seed in range(len(quads)):
        if turn[seed] >= 0:
            continue
        turn[seed], front = 0, [seed]
        while front:
            here = front.pop()
            for side, there in enumerate(partner[here].tolist()):
                if there < 0 or turn[there // 4] >= 0:
                    continue
                # Side k of this quad must be opposite, k + 2, in the next one.
                wanted = (side - turn[here] + 2) % 4
                turn[there // 4] = (there % 4 - wanted) % 4
                front.append(there // 4)
    return np.take_along_axis(quads, (np.arange(4) + turn[:, None]) % 4, axis=1)


def _partners(quads: Quads) -> Ints:
    """Return quad · 4 + side that runs back along each side, -1 for none, shape (f, 4).

    Raises
    ------
    MeshError
        If two quads run along a side the same way.
    """
    count = int(quads.max()) + 1
    start, end = sides_of(quads).T
    ahead, back = start * count + end, end * count + start
    order = np.argsort(ahead, kind="stable")
    ranked = ahead[order]
    repeated = np.flatnonzero(ranked[1:] == ranked[:-1])
    if len(repeated):
        a, b = divmod(int(ranked[repeated[0]]), count)
        raise MeshError(f"two quads run along the edge from vertex {a} to {b}; need one")
    at = np.minimum(np.searchsorted(ranked, back), len(ranked) - 1)
    found = ranked[at] == back
    return np.where(found, order[at], -1).reshape(-1, 4)
