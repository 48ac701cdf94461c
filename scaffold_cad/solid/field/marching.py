"""Marching tetrahedra: triangles where the surface cuts tetrahedra, vertices on grid edges."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.base.arrays import Floats, Ints
from scaffold_cad.solid.field.grid import Grid, Tetrahedra
from scaffold_cad.solid.field.lattice import FINEST_FRACTION, steps_on_edges
from scaffold_cad.solid.field.union import FilletedUnion, values

SIDES = np.array(list(combinations(range(4), 2)))
"""Corners of each edge of a tetrahedron, shape (6, 2)."""

_PLACES = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])  # positively oriented


def _cut(mask: int) -> list[int]:
    """Return the edges cut where the corners in `mask` are inside, around, seen from outside."""
    signs = np.array([mask >> i & 1 for i in range(4)])
    cut = [e for e, (i, j) in enumerate(SIDES) if signs[i] != signs[j]]
    if not cut:
        return []
    outward = _PLACES[signs == 0].mean(axis=0) - _PLACES[signs == 1].mean(axis=0)
    middles = _PLACES[SIDES[cut]].mean(axis=1)
    if len(cut) == 4:  # neighbors around share a corner of the tetrahedron
        far = next(i for i in range(1, 4) if not set(SIDES[cut[0]]) & set(SIDES[cut[i]]))
        order = [0, *(i for i in range(1, 4) if i != far)]
        order = [order[0], order[1], far, order[2]]
        cut, middles = [cut[i] for i in order], middles[order]
    normal = np.cross(middles[1] - middles[0], middles[2] - middles[0])
    return cut if normal @ outward > 0 else cut[::-1]


CUTS = [_cut(mask) for mask in range(16)]


def surface(
    union: FilletedUnion, grid: Grid, tetrahedra: Tetrahedra, rounds: int
) -> tuple[Floats, Ints]:
    """Return the vertices, local (v, 3) mm, and the triangles (t, 3) of the zero set.

    Parameters
    ----------
    rounds : times that F is evaluated along a grid edge to place its vertex
    """
    inside = tetrahedra.inside[tetrahedra.corners]  # (t, 4)
    mask = inside @ np.array([1, 2, 4, 8])
    faces, keys, owners = [], [], []
    total = len(tetrahedra.places)
    count = 0
    for m in range(1, 15):
        rows = np.flatnonzero(mask == m)
        corners = tetrahedra.corners[rows].astype(np.int64)
        sides = SIDES[CUTS[m]]  # (3 or 4, 2)
        ends = np.sort(corners[:, sides], axis=2)
        keys.append((ends[:, :, 0] * total + ends[:, :, 1]).reshape(-1))
        owners.append(np.repeat(tetrahedra.owners[rows], len(sides)))
        faces.append(count + np.arange(keys[-1].size).reshape(-1, len(sides)))
        count += keys[-1].size
    unique, seen, inverse = np.unique(
        np.concatenate(keys), return_index=True, return_inverse=True
    )
    start, end = np.divmod(unique, total)
    owner = np.concatenate(owners)[seen]
    vertices = _vertices(union, grid, tetrahedra, start, end, owner, rounds)
    triangles = [inverse[face] for face in faces if face.shape[1] == 3]
    quads = np.concatenate([inverse[face] for face in faces if face.shape[1] == 4])
    return vertices, np.concatenate([*triangles, _halves(vertices, quads)])


def _halves(vertices: Floats, quads: Ints) -> Ints:
    """Return the triangles of quads (q, 4), each cut along its shorter diagonal."""
    p = [vertices[quads[:, i]] for i in range(4)]
    first = ((p[0] - p[2]) ** 2).sum(axis=1) <= ((p[1] - p[3]) ** 2).sum(axis=1)
    one, other = quads[first], quads[~first]
    return np.concatenate(
        [one[:, [0, 1, 2]], one[:, [0, 2, 3]], other[:, [0, 1, 3]], other[:, [1, 2, 3]]]
    )


def _vertices(
    union: FilletedUnion,
    grid: Grid,
    tetrahedra: Tetrahedra,
    start: Ints,
    end: Ints,
    owner: Ints,
    rounds: int,
) -> Floats:
    """Return where the surface cuts grid edges, on them and exact in 32 bits, (e, 3) mm."""
    swap = ~tetrahedra.inside[start]
    start, end = np.where(swap, end, start), np.where(swap, start, end)  # from inside to outside
    place_a, place_b = tetrahedra.places[start], tetrahedra.places[end]
    a, b = grid.lattice.places(place_a), grid.lattice.places(place_b)
    at_a, at_b = _field_at(union, grid, start, a, owner), _field_at(union, grid, end, b, owner)
    t = _roots(union, grid, a, b - a, at_a, at_b, owner, rounds)
    steps = steps_on_edges(grid.lattice, place_a.astype(np.intp), place_b.astype(np.intp))
    scale = np.ldexp(1.0, steps)
    margin = np.ldexp(1.0, -np.minimum(steps, FINEST_FRACTION))
    t = np.round(np.clip(t, margin, 1.0 - margin) * scale) / scale
    return a + t[:, None] * (b - a)


def _field_at(
    union: FilletedUnion, grid: Grid, points: Ints, places: Floats, owner: Ints
) -> Floats:
    """Return F at grid points, evaluated at those put in for cells left out."""
    known = points < len(grid.field)
    field = grid.field[np.where(known, points, 0)]
    if not known.all():
        field[~known] = values(union, places[~known], owner[~known], grid.lists)
    return field


def _roots(
    union: FilletedUnion,
    grid: Grid,
    a: Floats,
    along: Floats,
    at_a: Floats,
    at_b: Floats,
    owner: Ints,
    rounds: int,
) -> Floats:
    """Return where F is 0 between points a and a + along, as a part of the way, shape (e,).

    Each round evaluates F where the parabola through the last three values, or at first a line,
    has its root; the root stays between values of different sign.
    """
    low, high = np.zeros(len(a)), np.ones(len(a))
    f_low, f_high = at_a.copy(), at_b.copy()
    t = _secant(low, high, f_low, f_high)
    for _ in range(rounds):
        f = values(union, a + t[:, None] * along, owner, grid.lists)
        guess = _parabola(low, t, high, f_low, f, f_high)
        inside = f < 0
        low, f_low = np.where(inside, t, low), np.where(inside, f, f_low)
        high, f_high = np.where(inside, high, t), np.where(inside, f_high, f)
        between = (guess > low) & (guess < high)
        t = np.where(between, guess, _secant(low, high, f_low, f_high))
    return t


def _secant(low: Floats, high: Floats, f_low: Floats, f_high: Floats) -> Floats:
    rise = f_high - f_low
    return low + (high - low) * np.where(rise > 0, -f_low / np.where(rise > 0, rise, 1.0), 0.5)


def _parabola(
    x0: Floats, x1: Floats, x2: Floats, f0: Floats, f1: Floats, f2: Floats
) -> Floats:
    """Return the root nearest x1 of the parabolas through three points each, nan where none."""
    with np.errstate(all="ignore"):
        d01, d12 = (f1 - f0) / (x1 - x0), (f2 - f1) / (x2 - x1)
        bend = (d12 - d01) / (x2 - x0)
        slope = d01 + bend * (x1 - x0)
        root = np.sqrt(slope * slope - 4.0 * bend * f1)
        return x1 - 2.0 * f1 / (slope + np.copysign(root, slope))


