"""Where the surface cuts grid edges, and the triangles between."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points
from scaffold_cad.base.blocks import cut
from scaffold_cad.base.counts import tracked
from scaffold_cad.base.threads import in_order
from scaffold_cad.solid.field.faces import polygons_of
from scaffold_cad.solid.field.grid import Grid
from scaffold_cad.solid.field.gridedges import GridEdges, grid_edges
from scaffold_cad.solid.field.marching import Polygons
from scaffold_cad.solid.field.slots import Slots
from scaffold_cad.solid.field.union import FilletedUnion, values

ROUNDS = 10
"""Most times that F is evaluated along a grid edge to place its vertex."""

NEAR_ENOUGH = 0.005
"""|F| from which one more round leads to the root."""

EDGE_BYTES = 256
"""What a grid edge takes where it is looked at."""


@dataclass(frozen=True, eq=False)
class Surface(Frozen):
    """The zero set of F as a mesh whose vertices are on edges of the grid."""

    vertices: Points
    """Shape (v, 3), mm from the union's origin."""
    triangles: Ints
    """Shape (t, 3)."""
    groups: Ints
    """A group at each vertex, shape (v,)."""
    edges: Ints
    """Number of the grid edge of each vertex, shape (v,)."""
    slots: Slots
    """What numbers the grid edges have."""

    @property
    def grid(self) -> Grid:
        """Where vertices stand."""
        return self.slots.grid

    def edges_of(self, vertices: Ints) -> GridEdges:
        """Return the grid edges of some vertices (k,)."""
        return grid_edges(self.grid, self.slots, self.edges[vertices])


def surface_of(union: FilletedUnion, grid: Grid) -> Surface:
    """Return the zero set of F."""
    slots = Slots(grid)
    parts = polygons_of(grid, slots)
    used = _used(parts, slots)
    edges = list(cut(used, EDGE_BYTES))
    placed = in_order(lambda some: _vertices(union, grid, grid_edges(grid, slots, some)), edges)
    found = tracked("vertices", placed, [len(some) for some in edges])
    vertices = np.concatenate([np.zeros((0, 3)), *found])
    rank = Ranks(used, slots)
    triangles = []
    while parts:
        part = parts.pop()
        quads = rank.of(part.quads)
        triangles += [rank.of(part.triangles), _halves(vertices, quads)]
    return Surface(vertices, np.concatenate(triangles), slots.ends(used)[2], used, slots)


def _used(parts: list[Polygons], slots: Slots) -> Ints:
    """Return the numbers of all edges that are cut, ascending, shape (e,)."""
    marks = np.zeros(slots.rare, dtype=np.bool_)
    rare = []
    for part in parts:
        for numbers in (part.triangles, part.quads):
            common = numbers < slots.rare
            marks[numbers[common]] = True
            rare.append(numbers[~common])
    return np.concatenate([np.flatnonzero(marks), np.unique(np.concatenate(rare))])


class Ranks:
    """Gives edges that are cut their place among them."""

    def __init__(self, used: Ints, slots: Slots) -> None:
        self.limit = slots.rare
        self.common = int(np.searchsorted(used, slots.rare))
        self.table = np.zeros(slots.rare, dtype=np.int32)
        self.table[used[: self.common]] = np.arange(self.common, dtype=np.int32)
        self.rare = used[self.common :]

    def of(self, numbers: Ints) -> Ints:
        """Return the places of edges among those that are cut."""
        if len(self.rare) == 0:
            return self.table[numbers].astype(np.intp)
        common = numbers < self.limit
        near = self.table[np.where(common, numbers, 0)]
        return np.where(common, near, self.common + np.searchsorted(self.rare, numbers))


def _halves(vertices: Floats, quads: Ints) -> Ints:
    """Return the triangles of quads (q, 4), each cut along its shorter diagonal."""
    p = [vertices[quads[:, i]] for i in range(4)]
    first = ((p[0] - p[2]) ** 2).sum(axis=1) <= ((p[1] - p[3]) ** 2).sum(axis=1)
    one, other = quads[first], quads[~first]
    return np.concatenate(
        [one[:, [0, 1, 2]], one[:, [0, 2, 3]], other[:, [0, 1, 3]], other[:, [1, 2, 3]]]
    )


def _vertices(union: FilletedUnion, grid: Grid, edges: GridEdges) -> Floats:
    """Return where the surface cuts grid edges, on them and exact in 32 bits, (e, 3) mm."""
    at_a, at_b = grid.field[edges.points]
    far = edges.put_in
    if far.any():
        at_b[far] = values(union, (edges.start + edges.way)[far], edges.owner[far], grid.lists)
    line = edges.start, edges.way
    return edges.at(_roots(union, grid, line, (at_a, at_b), edges.owner))


def _roots(
    union: FilletedUnion,
    grid: Grid,
    line: tuple[Floats, Floats],
    ends: tuple[Floats, Floats],
    owner: Ints,
) -> Floats:
    """Return where F is 0 on lines (start and way along), as a part of the way, shape (e,).

    Each round evaluates F where the inverse parabola through three points is 0, or in the middle
    where that may not converge, as beside a kink. The root stays between values of different sign.

    References
    ----------
    Chandrupatla, A new hybrid quadratic/bisection algorithm for finding the zero of a nonlinear
    function without using derivatives, Advances in Engineering Software 28(3), 1997.
    """
    x = np.stack([np.ones(len(owner)), np.zeros(len(owner)), np.ones(len(owner))])  # (3, e)
    f = np.stack([ends[1], ends[0], ends[1]])
    t = f[1] / np.where(f[0] != f[1], f[1] - f[0], 1.0)
    rows = np.arange(len(t))
    for _ in range(ROUNDS):
        at = values(union, line[0][rows] + t[rows, None] * line[1][rows], owner[rows], grid.lists)
        own_x, own_f = x[:, rows], f[:, rows]
        same = (at < 0) == (own_f[0] < 0)
        # Where F is no nearer to 0 than on this side before, as at grid points near the surface,
        # it turns back.
        back = np.abs(at) > np.abs(np.where(same, own_f[0], own_f[1])) / 2
        for old, new in ((own_x, t[rows]), (own_f, at)):
            old[2] = np.where(same, old[0], old[1])
            old[1] = np.where(same, old[1], old[0])
            old[0] = new
        x[:, rows], f[:, rows] = own_x, own_f
        far = back | (np.abs(at) > NEAR_ENOUGH)
        t[rows] = own_x[0] + _next(own_x, own_f, far) * (own_x[1] - own_x[0])
        rows = rows[far]
    return np.asarray(t)


def _next(x: Floats, f: Floats, far: Bools) -> Floats:
    """Return where to look next, as a part of the way from the last point to that beyond, (k,).

    Parameters
    ----------
    x, f : (3, k) the last point, that beyond the root, and the one before
    far : (k,) where the last point is not near enough to the root for a line
    """
    with np.errstate(all="ignore"):
        place, rise = (x[0] - x[1]) / (x[2] - x[1]), (f[0] - f[1]) / (f[2] - f[1])
        parabola = f[0] / (f[1] - f[0]) * f[2] / (f[1] - f[2])
        parabola += (x[2] - x[0]) / (x[1] - x[0]) * f[0] / (f[2] - f[0]) * f[1] / (f[2] - f[1])
        fits = (rise * rise < place) & ((1.0 - rise) ** 2 < 1.0 - place)
        line = np.where(f[0] != f[1], f[0] / (f[0] - f[1]), 0.0)
        part = np.where(fits, parabola, np.where(far, 0.5, line))
    return np.asarray(np.clip(part, 0.0, 1.0))
