"""The triangles of sharp nodes in place: their shapes, as much larger as polygons are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, Triangles
from scaffold_cad.struts.meshes.bands import enlargement
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.sharp.nodes import BESIDE, CLEAR, SharpNodes
from scaffold_cad.struts.sharp.shapes import SharpShape
from scaffold_cad.struts.sharp.triangles import ShapeTriangles, triangles_of

_known: WeakKeyDictionary[SharpShape, dict[int, ShapeTriangles | None]] = WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class NodeTriangles(Frozen):
    """Triangles of nodes that have one shape, and of their rings."""

    nodes: Ints
    """Shape (M,)."""
    half_runs: Ints
    """Shape (M, N)."""
    points: Points
    """Shape (M, p, 3), mm."""
    triangles: Triangles
    """Of each node: points, and from p on those of the rings, strut by strut, shape (t, 3)."""


def node_triangles(struts: RoundStruts, sides: int) -> Iterator[NodeTriangles]:
    """Yield the triangles of sharp nodes, those of one shape together."""
    for group in struts.sharp:
        for number, shape in enumerate(group.shapes):
            rows = np.flatnonzero(group.shape_of == number)
            made = _triangles(shape, sides)
            if made is None or len(rows) == 0:
                continue
            size = group.size[rows] * _larger(shape, sides)
            place = struts.runs.nodes[group.nodes[rows]]
            points = place[:, None] + size[:, None, None] * made.points
            yield NodeTriangles(group.nodes[rows], group.half_runs[rows], points, made.triangles)


def without_triangles(sharp: tuple[SharpNodes, ...], sides: int, count: int) -> Bools:
    """Return which of `count` nodes have a shape, but no triangles, (n,)."""
    found = np.zeros(count, dtype=np.bool_)
    for group in sharp:
        bad = np.array([_triangles(shape, sides) is None for shape in group.shapes])
        found[group.nodes[bad[group.shape_of]]] = True
    return found


def _triangles(shape: SharpShape, sides: int) -> ShapeTriangles | None:
    known = _known.setdefault(shape, {})
    if sides not in known:
        known[sides] = triangles_of(shape, sides)
    return known[sides]


def _larger(shape: SharpShape, sides: int) -> float:
    """Return how much larger polygons are than their circles, but for what reaches past collars."""
    heights: Floats = np.maximum(shape.heights, 1e-9)
    room = CLEAR + BESIDE / 2 * shape.curves.stars.radii[0] / heights
    return float(min(enlargement(np.zeros(1), sides)[0], room.min()))
