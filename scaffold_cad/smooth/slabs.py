"""Smooth surfaces finer than memory holds, made one part after the other.

Only the control mesh is kept. Each quad's part of the surface depends on the quads around it, and
is computed from them with the same operations in the same order whatever part of the mesh is
looked at: parts fit together to the last bit.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from scaffold_cad.base.arguments import as_count
from scaffold_cad.base.arrays import Bools, Frozen, Ints, Points, Quads
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.smooth.connectivity import Connectivity
from scaffold_cad.smooth.control import Caps, control_mesh
from scaffold_cad.smooth.grids import grid_places
from scaffold_cad.smooth.limits import limit_points
from scaffold_cad.smooth.subdivision import subdivided_points

QUADS_AT_ONCE = 1 << 19
"""Quads of the surface made together if nobody asks for a number of slabs: some 500 MB."""


@dataclass(frozen=True, eq=False)
class FineSurface(Frozen):
    """The smooth surface of a scaffold, of which one slab at a time is in memory."""

    control: Connectivity
    """The quads that are subdivided."""
    points: Points
    """Their vertices, shape (v, 3), mm."""
    levels: int
    """How often they are subdivided."""
    quad_of_quad: Ints
    """Scaffold quad that each of the quads that are subdivided is a part of, shape (f,)."""

    @property
    def quad_count(self) -> int:
        """Number of quads of the surface."""
        return len(self.control.quads) << (2 * self.levels)

    @property
    def vertex_count(self) -> int:
        """Number of vertices of the surface."""
        return int(self._first_vertex[-1])

    def cut(self, slabs: int | None) -> list[Ints]:
        """Return the control quads in `slabs` runs, by default as many as memory suggests.

        Raises
        ------
        OptionError
            If there are fewer than 1.
        """
        if slabs is None:
            slabs = -(-self.quad_count // QUADS_AT_ONCE)
        slabs = as_count(slabs, "slabs", least=1)
        quads = np.arange(len(self.control.quads))
        return [part for part in np.array_split(quads, slabs) if len(part)]

    def corners(self, rows: Ints) -> Points:
        """Return the corners of the quads that control quads `rows` (k,) become, ascending.

        Returns
        -------
        (k · 4^levels, 4, 3) float64, mm, those of one control quad after those of the one before
        """
        part, points, core = _neighbourhood(self.control, self.points, _marked(self.control, rows))
        for _ in range(self.levels):
            points = subdivided_points(part, points)
            part, core = part.subdivided(), np.repeat(core, 4)
            part, points, core = _neighbourhood(part, points, core)
        corners: Points = limit_points(part, points)[part.quads[core]]
        return corners

    def vertices(self, rows: Ints) -> Points:
        """Return the vertices whose first control quad is one of a run of `rows`, (k, 3), mm.

        Those of all runs, one after the other, are the vertices that `quads` numbers.
        """
        first, last = self._first_vertex[[rows[0], rows[-1] + 1]]
        numbers = self.quads(rows).reshape(-1)
        own = (numbers >= first) & (numbers < last)
        vertices = np.empty((last - first, 3))
        vertices[numbers[own] - first] = self.corners(rows).reshape(-1, 3)[own]
        return vertices

    def quads(self, rows: Ints) -> Quads:
        """Return the vertex numbers of the quads that control quads `rows` become.

        Returns
        -------
        (k · 4^levels, 4) intp, as `corners`
        """
        size = 2**self.levels
        at = grid_places(self.levels)  # (4^levels, 4, 2)
        grid = self._grid(rows)  # (k, size + 1, size + 1)
        numbers = grid.reshape(len(rows), -1)[:, at[..., 0] * (size + 1) + at[..., 1]]
        quads: Quads = numbers.reshape(-1, 4)
        return quads

    def _grid(self, rows: Ints) -> Ints:
        """Return the vertex numbers on each control quad, (k, 2^levels + 1, 2^levels + 1).

        Corner 0 is at [0, 0], corner 1 at [-1, 0], corner 2 at [-1, -1].
        """
        size = 2**self.levels
        inner = np.arange(1, size)
        quads = self.control.quads[rows]
        grid = np.empty((len(rows), size + 1, size + 1), dtype=np.intp)
        ends = ((0, 0), (size, 0), (size, size), (0, size))
        for corner, (i, j) in enumerate(ends):
            grid[:, i, j] = self._number_of_vertex[quads[:, corner]]
        for side, (i, j) in enumerate(ends):
            edge = self.control.edge_of_side[rows, side]
            forward = self.control.edges[edge, 0] == quads[:, side]
            along = np.where(forward[:, None], inner, size - inner) - 1
            following = ends[(side + 1) % 4]
            di, dj = np.sign(np.subtract(following, (i, j)))
            grid[:, i + di * inner, j + dj * inner] = self._first_on_edge[edge][:, None] + along
        middle = self._first_within_quad[rows][:, None] + np.arange((size - 1) ** 2)
        grid[:, 1:-1, 1:-1] = middle.reshape(len(rows), size - 1, size - 1)
        return grid

    @cached_property
    def _owned(self) -> tuple[Bools, Bools]:
        """Whether each quad's corners and sides are met there first, (f, 4) each."""
        return _first_of_each(self.control.quads), _first_of_each(self.control.edge_of_side)

    @cached_property
    def _first_vertex(self) -> Ints:
        """Number of the first vertex of each control quad's own, and how many there are, (f + 1,).

        Its own are first the corners, then those on its sides, then those within.
        """
        corners, sides = self._owned
        inner = 2**self.levels - 1
        own = corners.sum(axis=1) + inner * sides.sum(axis=1) + inner**2
        return np.concatenate([[0], np.cumsum(own)])

    @cached_property
    def _number_of_vertex(self) -> Ints:
        """Number of each vertex of the control mesh, (v,)."""
        corners, _ = self._owned
        numbers = np.zeros(self.control.count, dtype=np.intp)
        rank = np.cumsum(corners, axis=1) - 1
        numbers[self.control.quads[corners]] = (self._first_vertex[:-1, None] + rank)[corners]
        return numbers

    @cached_property
    def _first_on_edge(self) -> Ints:
        """Number of the first vertex within each edge of the control mesh, (e,)."""
        corners, sides = self._owned
        numbers = np.zeros(len(self.control.edges), dtype=np.intp)
        rank = (2**self.levels - 1) * (np.cumsum(sides, axis=1) - 1)
        first = (self._first_vertex[:-1] + corners.sum(axis=1))[:, None] + rank
        numbers[self.control.edge_of_side[sides]] = first[sides]
        return numbers

    @cached_property
    def _first_within_quad(self) -> Ints:
        """Number of the first vertex within each control quad, (f,)."""
        first: Ints = self._first_vertex[1:] - (2**self.levels - 1) ** 2
        return first


def fine_surface(scaffold: Scaffold, levels: int, caps: Caps = "round") -> FineSurface:
    """Return the surface of `smooth_mesh` without making it: `write` does, slab by slab.

    Parameters
    ----------
    levels : ≥ 0; a section has 4 · 2^levels corners
    caps : see `control_mesh`

    Raises
    ------
    OptionError
        If `scaffold` is none, `levels` is no whole number ≥ 0, or `caps` has none of its values.
    """
    levels = as_count(levels, "levels")
    control = control_mesh(scaffold, caps)
    connectivity = Connectivity.of(control.mesh, control.creases)
    return FineSurface(connectivity, control.mesh.vertices, levels, control.quad_of_quad)


def _neighbourhood(
    connectivity: Connectivity, points: Points, core: Bools
) -> tuple[Connectivity, Points, Bools]:
    """Return the part of a mesh that the quads of `core` (f,) and those that touch them make.

    Vertices, edges and quads keep their order, and so sums theirs.
    """
    touched = np.zeros(connectivity.count, dtype=np.bool_)
    touched[connectivity.quads[core]] = True
    rows = np.flatnonzero(touched[connectivity.quads].any(axis=1))
    vertices, quads = np.unique(connectivity.quads[rows], return_inverse=True)
    edges, edge_of_side = np.unique(connectivity.edge_of_side[rows], return_inverse=True)
    rank = np.zeros(connectivity.count, dtype=np.intp)
    rank[vertices] = np.arange(len(vertices))
    part = Connectivity(
        quads=quads.reshape(-1, 4),
        count=len(vertices),
        edges=rank[connectivity.edges[edges]],
        edge_of_side=edge_of_side.reshape(-1, 4),
        is_crease=connectivity.is_crease[edges],
    )
    return part, points[vertices], core[rows]


def _marked(connectivity: Connectivity, rows: Ints) -> Bools:
    marked = np.zeros(len(connectivity.quads), dtype=np.bool_)
    marked[rows] = True
    return marked


def _first_of_each(table: Ints) -> Bools:
    """Return where each number stands in `table` for the first time."""
    first = np.zeros(table.size, dtype=np.bool_)
    first[np.unique(table, return_index=True)[1]] = True
    return first.reshape(table.shape)
