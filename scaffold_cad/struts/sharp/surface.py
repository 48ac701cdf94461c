"""The triangles of sharp nodes in place: their shapes, as much larger as polygons are.

Nodes of struts that are made like others have the triangles of these.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from weakref import WeakKeyDictionary

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, Triangles, place_text
from scaffold_cad.errors import PartitionError
from scaffold_cad.struts.meshes.bands import enlargement
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.sharp.moved import moved
from scaffold_cad.struts.sharp.shapes import BESIDE, CLEAR, SharpShape
from scaffold_cad.struts.sharp.strands import matched, strands_of
from scaffold_cad.struts.sharp.triangles import ShapeTriangles, triangles_of

SHORT = 0.5
"""Greatest length of new edges in what was a corner, in sides of the thinnest strut's ring."""

_known: WeakKeyDictionary[SharpShape, dict[int, ShapeTriangles | None]] = WeakKeyDictionary()
_moved: WeakKeyDictionary[SharpShape, dict[tuple[int, ShapeTriangles], ShapeTriangles]]
_moved = WeakKeyDictionary()
"""By number of sides and the triangles that were moved, of struts that are made like others."""


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
    """Yield the triangles of sharp nodes, those of one shape together.

    Raises
    ------
    PartitionError
        If a node moved too far from where struts that these are made like have it.
    """
    if struts.like is not None:
        yield from _like_others(struts, sides)
        return
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


def _like_others(struts: RoundStruts, sides: int) -> Iterator[NodeTriangles]:
    """Yield the triangles of the first of struts that are made like others, with the points moved.

    Raises
    ------
    PartitionError
        If a node moved too far.
    """
    first, *later = _chain(struts)
    shapes = [_at_nodes(each) for each in (first, *later)]
    for model in node_triangles(first, sides):
        points = np.empty_like(model.points)
        for row, node in enumerate(model.nodes.tolist()):
            steps, place = [own[node][1] for own in shapes], struts.runs.nodes[node]
            made = _triangles(steps[0], sides)
            assert made is not None
            for before, after in pairwise(steps):
                made = _followed(made, before, after, sides, node, place)
            points[row] = place + shapes[-1][node][0] * _larger(steps[-1], sides) * made.points
        yield replace(model, points=points)


def _chain(struts: RoundStruts) -> list[RoundStruts]:
    """Return the first of struts that are made like others, what is made like it, and so on."""
    found = [struts]
    while found[-1].like is not None:
        found.append(found[-1].like)
    return found[::-1]


def _at_nodes(struts: RoundStruts) -> dict[int, tuple[float, SharpShape]]:
    """Return the radius of the ball, mm, and the shape of each node that has one."""
    return {
        node: (size, group.shapes[which])
        for group in struts.sharp
        for node, size, which in zip(
            group.nodes.tolist(), group.size.tolist(), group.shape_of.tolist(), strict=True
        )
    }


def _followed(
    made: ShapeTriangles,
    before: SharpShape,
    after: SharpShape,
    sides: int,
    node: int,
    place: Points,
) -> ShapeTriangles:
    """Return the triangles of a shape moved to another one, which a node at a place has."""
    known = _moved.setdefault(after, {})
    if (sides, made) not in known:
        short = SHORT * 2 * np.pi / sides * float(after.curves.stars.radii[0].min())
        same = matched(strands_of(before), strands_of(after), made.strand, short)
        found = None if same is None else moved(made, before, same, sides)
        if found is None:
            what = "turned too far for the triangles of like"
            if same is None:
                what = "meet in other edges than in like"
            raise PartitionError(
                f"the struts of node {node} at {place_text(place)} {what}; need smaller moves, or "
                "a larger radius of the node, for a ball that they leave apart from each other"
            )
        known[sides, made] = found
    return known[sides, made]


def without_triangles(struts: RoundStruts, sides: int) -> Bools:
    """Return which nodes have a shape, but no triangles, (n,)."""
    found = np.zeros(len(struts.runs.nodes), dtype=np.bool_)
    for group in struts.first.sharp:
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
