"""Nodes as stacks of rings: the patches of each strut sampled around it, from the arcs outward.

Level 0 of a strut's stack runs along the four arcs of its quad and is shared with its neighbors;
the last level is the ring at its collar, of `sides` points. The others have as many a patch as an
arc has steps: a quarter of the sides, or more, and then several of them are joined to one of the
last level.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, UnitVectors, read_only
from scaffold_cad.base.blocks import blocks
from scaffold_cad.base.vectors import normalize
from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.struts.blending.blend import Solved
from scaffold_cad.struts.blending.quarter import ARC, DEGREE
from scaffold_cad.struts.meshes.bands import ring_triangles
from scaffold_cad.struts.meshes.facing import faced
from scaffold_cad.struts.meshes.lifts import Lifted, Samples
from scaffold_cad.struts.meshes.volumes import cells_of
from scaffold_cad.struts.model import BlendedNodes

GRADING = 1.5
"""Power by which levels stand closer beside the arcs, where blends turn, than at the collars."""

TABLE = 240
"""Parts of a quarter circle whose parameters are looked up; those of 4, 8, ... sides are exact."""

POINT_BYTES = 32
"""What each coefficient of a point on a turned ring takes."""

SAME = 1e-6
"""Growths that agree to this part of a radius are the same; nodes with one blend are made once."""


@dataclass(frozen=True, eq=False)
class Stacks(Frozen):
    """The sampled surfaces of M nodes of valency N."""

    points: Points
    """Vertices node by node, shape (M, b, 3), mm: corners, points of arcs, levels 1 and on."""
    rings: Ints
    """Vertices of each level of each strut, in 0..b-1, shape (M, N, levels + 1, 4 steps)."""
    collars: Ints
    """Vertices of the rings at the collars, in 0..b-1, shape (M, N, sides)."""
    triangles: Ints
    """Vertices of the triangles between levels, in 0..b-1, shape (M, t, 3)."""
    swell: Floats
    """How far samples are moved, where that is further than the slack, mm, shape (M,)."""


@dataclass(frozen=True)
class Grid:
    """How many samples the patches of nodes have."""

    steps: int
    """Intervals of an arc."""
    levels: int
    """Intervals from an arc to a collar."""
    sides: int
    """Points of the ring at a collar, a multiple of 4, at most 4 `steps`."""

    @property
    def nearest(self) -> Ints:
        """Point at the collar that each sample around a strut is joined to, (4 steps,)."""
        fine = 4 * self.steps
        return (2 * self.sides * np.arange(fine) + fine) // (2 * fine) % self.sides

    def block_size(self, valency: int) -> int:
        """Return how many vertices the surface of a node of a valency has."""
        inner = 4 * self.steps * (self.levels - 1)
        return self.shared(valency) + valency * (inner + self.sides)

    def shared(self, valency: int) -> int:
        """Return how many of them are on arcs."""
        return valency + 2 + 2 * valency * (self.steps - 1)


def stacks(
    group: BlendedNodes, growth: Floats, grid: Grid, slack: float, given: Ints | None = None
) -> Stacks:
    """Sample the patches of nodes, and move the samples so that the volume is that of the blends.

    Where triangles are not seen from their node then, samples are moved aside.

    Parameters
    ----------
    group : M nodes
    growth : (M, N) how much larger than the collars the last rings are, over their radii
    grid : how many samples patches have
    slack : how far samples are moved, over their distance from their strut's axis: further only
        where that does not make up for the volume
    given : (M, t, 3) the triangles between samples, see `Stacks`; by default the best ones
    """
    rings = _rings(group.quads, grid)
    u, v = quarter_parameters(grid.steps), graded(grid.levels)
    points, normals = around_struts(group.shapes, u, v)
    at_collars = quarter_parameters(grid.sides // 4), v[-1:]
    for samples, last in zip(
        (points, normals), around_struts(group.shapes, *at_collars), strict=True
    ):
        samples[:, :, -1] = last[:, :, 0, grid.nearest]
    cells = cells_of(group.shapes, np.append(u, 1.0), v)
    lifted = Lifted.of(group.shapes, group.axes, Samples(points, normals, rings), cells)
    rounded = np.rint(growth / SAME)
    rows = [group.shape_of[:, None], rounded]
    if given is not None:
        rows.append(np.unique(given, axis=0, return_inverse=True)[1].reshape(-1, 1))
    kinds, first, kind = np.unique(
        np.concatenate(rows, axis=1), axis=0, return_index=True, return_inverse=True
    )
    kind = kind.reshape(-1)
    which = group.shape_of[first]
    moved = lifted.moved(which, SAME * rounded[first], grid.sides, slack)
    placed = np.empty((len(kinds), grid.block_size(rings.shape[1]), 3))
    # Of the samples at one vertex the last one written stays, for all the same.
    placed[np.arange(len(kinds))[:, None, None, None], rings[which]] = moved.points
    triangles = _triangles(placed, rings[which]) if given is None else given[first]
    collars = rings[:, :, -1, np.unique(grid.nearest, return_index=True)[1]]
    fixed = collars[which].reshape(len(kinds), -1)
    made = faced(placed, triangles, fixed, 4 * grid.steps)
    widest = lifted.reach.reshape(len(lifted.reach), -1).max(axis=1)  # (U,)
    furthest = np.maximum(moved.swell, slack * widest[which]) + made.aside
    swell = np.where(made.aside > 0, furthest, moved.swell)
    of = group.shape_of
    return Stacks(made.points[kind], rings[of], collars[of], triangles[kind], swell[kind])


def _rings(quads: Ints, grid: Grid) -> Ints:
    """Return the vertices of each level of the struts of nodes, (U, N, levels + 1, 4 steps)."""
    count, valency = quads.shape[:2]
    inner = (grid.levels - 1, 4 * grid.steps)
    block = inner[0] * inner[1] + grid.sides
    first = grid.shared(valency) + block * np.arange(valency)
    rings = np.empty((count, valency, grid.levels + 1, inner[1]), dtype=np.intp)
    rings[:, :, 0] = first_rings(quads, grid.steps)
    rings[:, :, 1:-1] = first[:, None, None] + np.arange(inner[0] * inner[1]).reshape(inner)
    rings[:, :, -1] = first[:, None] + inner[0] * inner[1] + grid.nearest
    return rings


def _triangles(points: Floats, rings: Ints) -> Ints:
    """Return the triangles between levels of nodes, (K, t, 3).

    Parameters
    ----------
    points, rings : of K nodes, see `Stacks`
    """
    count, block = points.shape[:2]
    first = block * np.arange(count)[:, None, None, None]
    rows = rings + first
    low, high = (some.reshape(-1, rings.shape[3]) for some in (rows[:, :, :-1], rows[:, :, 1:]))
    triangles = ring_triangles(points.reshape(-1, 3), low, high).reshape(count, -1, 3)
    # Where neighbors are joined to one point of a collar the second triangle between has no area.
    is_whole = np.ones((*rings.shape[1:2], rings.shape[2] - 1, rings.shape[3], 2), dtype=np.bool_)
    is_whole[:, -1, :, 1] = rings[0, :, -1] != np.roll(rings[0, :, -1], -1, axis=1)
    return np.asarray(triangles[:, is_whole.reshape(-1)] - first[..., 0])


def first_rings(quads: Ints, steps: int) -> Ints:
    """Return the vertices along the arcs of each quad, counter-clockwise, (M, N, 4 steps).

    Corners come first, then the steps - 1 inner points of each arc from its lower corner.

    Parameters
    ----------
    quads : (M, N, 4) corners in 0..N+1; two quads share each side, in opposite directions
    steps : intervals of an arc
    """
    count, valency = quads.shape[:2]
    start = quads.reshape(count, -1)  # (M, 4 N)
    end = np.roll(quads, -1, axis=2).reshape(count, -1)
    key = np.minimum(start, end) * (valency + 2) + np.maximum(start, end)
    order = np.argsort(key, axis=1, kind="stable")
    arc = np.empty_like(order)
    np.put_along_axis(arc, order, np.arange(4 * valency)[None] // 2, axis=1)
    step = np.arange(1, steps)
    backward = (start > end)[..., None]
    inner = valency + 2 + (steps - 1) * arc[..., None]
    inner = inner + np.where(backward, steps - 1 - step, step - 1)  # (M, 4 N, steps - 1)
    rings: Ints = np.concatenate([start[..., None], inner], axis=2)
    return rings.reshape(count, valency, 4 * steps)


def graded(levels: int) -> Floats:
    """Return the parameters from arcs to collars, (levels + 1,)."""
    return np.linspace(0.0, 1.0, levels + 1) ** GRADING


@cache
def quarter_parameters(steps: int) -> Floats:
    """Return the parameters in [0, 1) at which the quarter circle is at equal angles, (steps,).

    They lie alike from both ends, as the curve is symmetric: so two patches meet on an arc.
    """
    found = parameters_at(np.arange(steps) / steps * (np.pi / 2))
    # The same numbers from both ends, to the last bit.
    found[1:] = (found[1:] + (1 - found[:0:-1])) / 2
    found[0] = 0.0
    return read_only(found)


def parameters_at(angles: Floats) -> Floats:
    """Return the parameters at which the quarter circle is at angles (k,) in [0, π/2], rad."""
    low, high = np.zeros(len(angles)), np.ones(len(angles))
    for _ in range(60):
        middle = (low + high) / 2
        beyond = angles_at(middle) > angles
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return (low + high) / 2


def angles_at(parameters: Floats) -> Floats:
    """Return the angles of the quarter circle at parameters (...) in [0, 1], rad, (...)."""
    place = bernstein(DEGREE, parameters.reshape(-1)) @ ARC  # (k, 2)
    angles: Floats = np.arctan2(place[:, 1], place[:, 0])
    return angles.reshape(parameters.shape)


def turned_rings(
    group: BlendedNodes, turns: Floats, at: Floats, sides: int, slopes: tuple[int, int] = (0, 0)
) -> Points:
    """Return points on the patches of M nodes, from the arcs outward, (M, N, k, sides, 3), mm.

    Rings at the arcs are those that `first_rings` numbers. Further out they are turned about their
    strut, the more the nearer they are to its collar, and stay on the patches.

    Parameters
    ----------
    turns : (M, N) turn of the rings at the collars, counter-clockwise about their struts, rad
    at : (k,) parameters from the arcs, 0, to the collars, 1
    slopes : which derivatives by u, around the strut, and by v are returned in place of points
    """
    by_u, by_v = slopes
    layout, control = group.shapes.layout, group.shapes.control  # (U, 4 N, n_u, n_v, 3)
    count, valency = turns.shape
    rows = np.einsum("vj,upijx->upvix", layout.v.values_at(at, by_v), control)
    rings = np.empty((count, valency, len(at), sides, 3))
    even = np.arange(sides) * (4.0 / sides)
    strut, level = np.arange(valency)[:, None, None], np.arange(len(at))[:, None]
    for part in blocks(count, valency * len(at) * sides * layout.u.count * POINT_BYTES):
        turned = even + turns[part, :, None, None] / (np.pi / 2) * at[:, None]
        quarter = np.floor(turned).astype(np.intp)  # (m, N, k, sides)
        patch = 4 * strut + quarter % 4
        values = layout.u.values_at(_parameters(turned - quarter).reshape(-1), by_u)
        values = values.reshape(*turned.shape, -1)
        shape = group.shape_of[part, None, None, None]
        rings[part] = np.einsum("mnksi,mnksix->mnksx", values, rows[shape, patch, level])
    return rings


def _parameters(quarters: Floats) -> Floats:
    """Return parameters of the quarter circle near its parts (...) in [0, 1), each its own."""
    steps = quarter_parameters(TABLE)
    even = np.linspace(0.0, 1.0, TABLE + 1)
    return np.asarray(np.interp(quarters, even, np.append(steps, 1.0)))


def around_struts(shapes: Solved, u: Floats, v: Floats) -> tuple[Floats, UnitVectors]:
    """Return points and unit normals around each strut, both (U, N, levels + 1, 4 steps, 3).

    Parameters
    ----------
    u : (steps,) parameters of each patch around its strut, in [0, 1)
    v : (levels + 1,) parameters from its arc, 0, to its collar, 1
    """
    patches = shapes.control.reshape(-1, *shapes.control.shape[2:])  # (f, n_u, n_v, 3)
    control = np.ascontiguousarray(np.moveaxis(patches, -1, 0))
    across, along = shapes.layout.u, shapes.layout.v
    rows = control @ along.values_at(v).T  # (3, f, n_u, levels + 1)
    points, by_u = across.values_at(u) @ rows, across.values_at(u, 1) @ rows
    by_v = across.values_at(u) @ (control @ along.values_at(v, 1).T)
    normals = normalize(np.moveaxis(np.cross(by_u, by_v, axis=0), 0, -1))
    return _around(np.moveaxis(points, 0, -1), len(shapes)), _around(normals, len(shapes))


def _around(values: Floats, count: int) -> Floats:
    """Return samples (U 4N, steps, levels + 1, 3) in the order of rings."""
    _, steps, levels, _ = values.shape
    by_strut = values.reshape(count, -1, 4, steps, levels, 3)
    return np.moveaxis(by_strut, 4, 2).reshape(count, -1, levels, 4 * steps, 3)
