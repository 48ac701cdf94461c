"""The edges of a sharp shape as points: its vertices, and where edges meet the generators of rings.

The ring of a strut has points at equal angles. Where an edge meets the generator of one of them it
has a point, so that each strut's face falls into columns between generators. Points that would be
very close together are one, which then stands a little beside its generator.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points
from scaffold_cad.base.ranges import steps
from scaffold_cad.struts.sharp.shapes import SharpShape

SAMPLES = 65
"""Points of an edge between which it is looked for generators."""

HALVINGS = 50
"""Halvings between these in which the point on a generator is found."""

ON_LINE = 1e-7
"""Part of a side by which an end of an edge may be short of a generator on which it is."""

CLOSE = 0.1
"""Distance of points that are one, in sides of the thinnest strut's ring."""

Crossing = tuple[Points, int, int, tuple[int, float]]
"""A place where an edge meets a generator, its strut and number, the edge and the angle there."""


@dataclass
class SampledEdges:
    """Points of the edges of a shape."""

    points: list[Floats] = field(default_factory=list)
    """Positions, in radii of the ball; first those of the vertices."""
    on: list[dict[int, int]] = field(default_factory=list)
    """The generator of each strut on which each point is: strut to generator."""
    at: list[tuple[int, float]] = field(default_factory=list)
    """The edge on which each point is that is no vertex, and its angle there, rad."""
    edges: list[list[int]] = field(default_factory=list)
    """Points of each edge, its vertices included."""

    def add(self, place: Floats, on: dict[int, int], at: tuple[int, float]) -> int:
        """Add a point of an edge; return its number."""
        self.points.append(place)
        self.on.append(on)
        self.at.append(at)
        return len(self.points) - 1


def sampled(shape: SharpShape, sides: int, close: float = CLOSE) -> SampledEdges:
    """Return the points of edges.

    Parameters
    ----------
    sides : points of a ring
    close : see `CLOSE`
    """
    found = SampledEdges([*shape.vertices], [{} for _ in shape.vertices])
    edge, angle, strut, number = _with_turns(shape, *_crossings(shape, sides))
    points = shape.curves.points(shape.outlines.curve[edge], angle)[0]
    near = close * 2 * np.pi / sides * shape.curves.stars.radii[0].min()
    rows: list[list[Crossing]] = [[] for _ in shape.outlines.curve]
    for row in np.lexsort((angle, edge)).tolist():
        at = int(edge[row]), float(angle[row])
        rows[at[0]].append((points[row], int(strut[row]), int(number[row]), at))
    for own, (start, end) in zip(rows, shape.ends.tolist(), strict=True):
        found.edges.append(_merged(found, own, start, end, near))
    return found


def _merged(
    found: SampledEdges,
    crossings: list[Crossing],
    start: int,
    end: int,
    near: float,
) -> list[int]:
    """Return the points of an edge; those that are new are added.

    Parameters
    ----------
    crossings : of the edge, in order
    near : distance of points that are one
    """
    path = [start]
    for place, which, line, at in crossings:
        if which < 0:
            if min(_apart(found.points[known], place) for known in (path[-1], end)) > near:
                path.append(found.add(place, {}, at))
            continue
        for known in (path[-1], end):
            own = found.on[known]
            if _apart(found.points[known], place) < near and own.get(which, line) == line:
                own[which] = line
                break
        else:
            path.append(found.add(place, {which: line}, at))
    path.append(end)
    return path


def _apart(a: Floats, b: Floats) -> float:
    return float(np.sqrt(((a - b) ** 2).sum()))


def _with_turns(
    shape: SharpShape, edge: Ints, angle: Floats, strut: Ints, number: Ints
) -> tuple[Ints, Floats, Ints, Ints]:
    """Return crossings and, as strut -1, where edges turn back around one of their struts."""
    curves, outlines = shape.curves, shape.outlines
    angles = outlines.angles(SAMPLES)
    own, side = np.nonzero(shape.sides < shape.valency)
    points = curves.points(np.repeat(outlines.curve[own], SAMPLES), angles[own].reshape(-1))[0]
    zero = np.zeros(len(points), dtype=np.intp)
    around = curves.stars.angles(zero, np.repeat(shape.sides[own, side], SAMPLES), points)
    step = np.diff(np.unwrap(around.reshape(-1, SAMPLES), axis=1), axis=1)
    row, place = np.nonzero(step[:, 1:] * step[:, :-1] < 0)
    none = np.full(len(row), -1, dtype=np.intp)
    return (
        np.concatenate([edge, own[row]]),
        np.concatenate([angle, angles[own[row], place + 1]]),
        np.concatenate([strut, none]),
        np.concatenate([number, none]),
    )


def _crossings(shape: SharpShape, sides: int) -> tuple[Ints, Floats, Ints, Ints]:
    """Return where edges meet generators: edge, angle, strut and generator of each, all (q,)."""
    curves, outlines = shape.curves, shape.outlines
    angles = outlines.angles(SAMPLES)
    edge, side = np.nonzero(shape.sides < shape.valency)
    strut = shape.sides[edge, side]
    step = 2 * np.pi / sides
    curve = np.repeat(outlines.curve[edge], SAMPLES)
    points = curves.points(curve, angles[edge].reshape(-1))[0]
    zero = np.zeros(len(points), dtype=np.intp)
    around = curves.stars.angles(zero, np.repeat(strut, SAMPLES), points).reshape(-1, SAMPLES)
    around = np.unwrap(around, axis=1) / step
    level = np.floor(around + ON_LINE)
    passed = np.abs(np.diff(level, axis=1)).astype(np.intp)  # generators between two samples
    row, place = (np.repeat(each, passed[passed > 0]) for each in np.nonzero(passed))
    line = np.minimum(level[row, place], level[row, place + 1]) + 1 + steps(passed[passed > 0])
    low, high = angles[edge[row], place], angles[edge[row], place + 1]
    rises = level[row, place + 1] > level[row, place]
    zero = np.zeros(len(row), dtype=np.intp)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        points = curves.points(outlines.curve[edge[row]], middle)[0]
        value = curves.stars.angles(zero, strut[row], points) / step
        value += sides * np.round((line - value) / sides)
        beyond = (value >= line - ON_LINE) == rises
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return edge[row], (low + high) / 2, strut[row], np.asarray(line, dtype=np.intp) % sides
