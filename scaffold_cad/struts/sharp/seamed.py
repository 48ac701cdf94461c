"""Shapes of sharp nodes for B-reps: their edges as circles, ellipses and splines, cut at seams.

The edge in which two equal cylinders meet is an ellipse, whose own angle is that around the
cylinder; struts leave the ball on circles; all other edges are splines. On faces, edges have traces
in the angle around a strut and the height on its axis, or in longitude and latitude of the ball.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.vectors import length, normalize
from scaffold_cad.errors import BrepError
from scaffold_cad.struts.sharp.ballfaces import in_turn
from scaffold_cad.struts.sharp.curves import Kind, StarCurves
from scaffold_cad.struts.sharp.interpolation import FAIR, NEAR, PIECES, checked, interpolated
from scaffold_cad.struts.sharp.loops import Loop, Steps, seam_angles
from scaffold_cad.struts.sharp.shapes import SharpShape

SAME_PLACE = 1e-9
"""Angle below which two seams meet an edge in one place, rad."""

SEEN_AT, BENDING = 257, 2.0
"""Points at which a curve's bends are looked for, and the turn a rad of those that are sharp."""

LEAST_STEP = 1e-6
"""Angle between points at which the place of a bend is not looked for more closely, rad."""

HALVINGS = 60
"""Halvings of an edge in which the point on a generator is found."""


@dataclass(frozen=True, eq=False)
class Trace(Frozen):
    """An edge in the parameters of a face."""

    control: Floats
    """Control points of a spline of degree 5, or both ends of a line, shape (n, 2)."""
    pieces: int
    """Of the spline; 0 for a line."""


@dataclass(frozen=True, eq=False)
class SharpEdge(Frozen):
    """An edge, relative to its node and in radii of the ball."""

    ends: Ints
    """First and last vertex, shape (2,)."""
    axes: Floats
    """Of circles and ellipses: center, axis and direction of the greater half-diameter, (3, 3)."""
    radii: Floats
    """Half-diameters, shape (2,); 0 for splines."""
    angles: Floats
    """First and last angle, the first in [0, 2π), shape (2,)."""
    control: Points
    """Control points of splines, shape (n, 3)."""
    pieces: int
    """Pieces of splines; 0 for others."""
    sides: tuple[int, int]
    """Faces to the left and to the right."""
    traces: tuple[Trace, Trace]
    """The edge on both of these."""
    off: float
    """How far splines are off the edge, where that is more than `NEAR`."""


@dataclass(frozen=True, eq=False)
class Seamed(Frozen):
    """A shape whose edges are cut where the seams of its struts meet them."""

    vertices: Points
    slack: Floats
    """As that of the shape, or how far edges there are off their faces, shape (v,)."""
    edges: tuple[SharpEdge, ...]
    loops: tuple[Loop, ...]
    """As those of the shape; those around struts begin at their seam."""
    islands: tuple[Loop, ...]
    """As those of the shape."""
    seams: Ints
    """The vertex on each strut's seam, shape (N,)."""


def seamed(shape: SharpShape, seams: tuple[int, ...]) -> Seamed:
    """Return a shape cut at seams.

    Parameters
    ----------
    seams : generator of each strut that is its seam, see `SharpShape.clear`

    Raises
    ------
    BrepError
        If an edge is not within `FAIR` of a spline of `PIECES` pieces.
    """
    angles_of = seam_angles(shape.curves.stars.directions[0])  # (N, SEAMS)
    cuts = _cuts(shape, angles_of[np.arange(shape.valency), list(seams)])
    vertices = list(shape.vertices)
    edges: list[SharpEdge] = []
    pieces_of: list[list[int]] = []
    at_seam = np.zeros(shape.valency, dtype=np.intp)
    for edge, (start, end) in enumerate(
        zip(shape.outlines.start.tolist(), shape.outlines.end.tolist(), strict=True)
    ):
        here = sorted(cuts.get(edge, []))
        angles = [start]
        number = [int(shape.ends[edge, 0])]
        if here and (shape.ends == number[0]).sum() == 2 and number[0] == shape.ends[edge, 1]:
            # Closed and with no other there: it begins at the first seam.
            angles, end = [here[0][0]], here[0][0] + end - start
            curve = shape.outlines.curve[[edge]]
            vertices[number[0]] = shape.curves.points(curve, np.array(angles))[0][0]
        for angle, strut in here:
            if angle - angles[-1] > SAME_PLACE:
                angles.append(angle)
                number.append(len(vertices))
                curve = shape.outlines.curve[[edge]]
                vertices.append(shape.curves.points(curve, np.array([angle]))[0][0])
            at_seam[strut] = number[-1]
        angles.append(end)
        number.append(int(shape.ends[edge, 1]))
        pieces_of.append(list(range(len(edges), len(edges) + len(angles) - 1)))
        for k in range(len(angles) - 1):
            made = _edge(shape, edge, angles[k], angles[k + 1], (number[k], number[k + 1]))
            edges.append(made)
    loops = [(face, _replaced(steps, pieces_of)) for face, steps in shape.loops]
    for strut in range(shape.valency):
        face, steps = loops[strut]
        tails = [int(edges[edge].ends[0 if way else 1]) for edge, way in steps]
        first = tails.index(int(at_seam[strut]))
        loops[strut] = face, steps[first:] + steps[:first]
    islands = tuple((face, _replaced(steps, pieces_of)) for face, steps in shape.islands)
    slack = np.zeros(len(vertices))
    slack[: len(shape.slack)] = shape.slack
    for each in edges:
        slack[each.ends] = np.maximum(slack[each.ends], each.off)
    return Seamed(np.array(vertices), slack, tuple(edges), tuple(loops), islands, at_seam)


def _replaced(steps: Steps, pieces: list[list[int]]) -> Steps:
    """Return the steps of a loop along the pieces of its edges."""
    return tuple(
        (piece, way)
        for edge, way in steps
        for piece in (pieces[edge] if way else pieces[edge][::-1])
    )


def _cuts(shape: SharpShape, seams: Floats) -> dict[int, list[tuple[float, int]]]:
    """Return the angles on edges at which seams meet them, and of which strut each is."""
    found: dict[int, list[tuple[float, int]]] = {}
    curves, outlines = shape.curves, shape.outlines
    angles = outlines.angles(65)
    for strut in range(shape.valency):
        edges = np.flatnonzero((shape.sides == strut).any(axis=1))
        offset = _offsets(shape, edges, angles[edges], strut, seams[strut])
        turns = np.floor(offset / (2 * np.pi))
        row, step = np.argwhere(np.diff(turns, axis=1) != 0)[0]
        low, high = angles[edges[row], step], angles[edges[row], step + 1]
        level = 2 * np.pi * turns[row, step : step + 2].max()
        start = offset[row, step]
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            points = curves.points(outlines.curve[edges[[row]]], np.array([middle]))[0]
            zero = np.zeros(1, dtype=np.intp)
            value = float(curves.stars.angles(zero, zero + strut, points)[0]) - seams[strut]
            value += 2 * np.pi * np.round((level - value) / (2 * np.pi))
            if (value < level) == (start < level):
                low = middle
            else:
                high = middle
        found.setdefault(int(edges[row]), []).append(((low + high) / 2, strut))
    return found


def _offsets(shape: SharpShape, edges: Ints, angles: Floats, strut: int, seam: float) -> Floats:
    """Return the angles around a strut from its seam of points on edges, (e, s)."""
    number = np.repeat(shape.outlines.curve[edges], angles.shape[1])
    points = shape.curves.points(number, angles.reshape(-1))[0]
    zero = np.zeros(len(points), dtype=np.intp)
    found = shape.curves.stars.angles(zero, zero + strut, points) - seam
    return np.asarray(np.unwrap(found.reshape(angles.shape), axis=1))


def _edge(
    shape: SharpShape, edge: int, start: float, end: float, ends: tuple[int, int]
) -> SharpEdge:
    """Return the piece of an edge between two angles."""
    curves, curve = shape.curves, int(shape.outlines.curve[edge])
    sides = int(shape.sides[edge, 0]), int(shape.sides[edge, 1])
    round_one = curves.kind[curve] != Kind.PAIR
    slopes = curves.stars.slopes[0, [curves.one[curve], curves.other[curve]]]
    is_ellipse = bool(curves.is_plane[curve]) and not slopes.any()
    even = round_one or is_ellipse
    is_seam = curves.kind[curve] == Kind.SEAM
    if is_seam:
        low, high = start - np.pi, end - np.pi  # latitudes, where the face begins and ends
        traces = [Trace(np.array([[at, low], [at, high]]), 0) for at in (np.pi, -np.pi)]
        control, pieces, off = np.zeros((0, 7)), 0, 0.0
    else:
        control, pieces, off = _fitted(shape, curve, start, end, sides, even)
        traces = [
            Trace(control[[0, -1], some], 0)
            if round_one and side < shape.valency
            else Trace(control[:, some], pieces)
            for side, some in zip(sides, (slice(3, 5), slice(5, 7)), strict=True)
        ]
    if round_one:
        axes = np.stack(
            [curves.center[curve], np.cross(curves.x[curve], curves.y[curve]), curves.x[curve]]
        )
        radii = np.full(2, curves.radius[curve])
        first = start
    elif is_ellipse:
        axes, radii, turned = _ellipse(shape, curve)
        first = start - turned
    else:
        axes, radii, first = np.zeros((3, 3)), np.zeros(2), 0.0
    is_spline = not (round_one or is_ellipse)
    begin = float(np.mod(first, 2 * np.pi))
    return SharpEdge(
        np.array(ends, dtype=np.intp),
        axes,
        radii,
        np.array([begin, begin + end - start]),
        control[:, :3] if is_spline else np.zeros((0, 3)),
        pieces if is_spline else 0,
        sides,
        (traces[0], traces[1]),
        off,
    )


def _fitted(
    shape: SharpShape, curve: int, start: float, end: float, sides: tuple[int, int], even: bool
) -> tuple[Floats, int, float]:
    """Return the control points of a spline in space and on both faces, (n, 7), and its pieces.

    The last value is how far it is off where that is more than `NEAR`.

    Parameters
    ----------
    even : whether its parameter is the curve's angle; else that may run slower where it bends

    Raises
    ------
    BrepError
        If it is not within `FAIR` of one of `PIECES` pieces.
    """
    paces = [None] if even else [None, Pace.of(shape.curves, curve, start, end)]
    best, found = np.inf, (np.zeros((0, 7)), 0)
    for pace in paces:
        for pieces in PIECES:
            share = checked(pieces)
            share = share if pace is None else pace.at(share)
            angles = start + (end - start) * share
            points = shape.curves.points(np.full(len(share), curve), angles)[0]
            tracks = [_track(shape, side, points) for side in sides]
            control, off = interpolated(np.concatenate([points, *tracks], axis=1), pieces)
            if off < NEAR:
                return control, pieces, 0.0
            if off < best:
                best, found = off, (control, pieces)
            if pace is None and not even and pieces == 32:
                break
    if best < FAIR:
        return *found, best
    raise BrepError(
        f"an edge between two struts bends too sharply for a spline of {PIECES[-1]} pieces, which "
        f"is off by {best:.1g} radii; need struts whose radii differ by more, or are equal"
    )


@dataclass(frozen=True, eq=False)
class Pace(Frozen):
    """How fast the angle of a curve grows: slower where the curve bends sharply."""

    start: float
    end: float
    bends: Floats
    """Angles at which it does, shape (b,), rad."""
    widths: Floats
    """Angles over which it does, shape (b,), rad."""

    @staticmethod
    def of(curves: StarCurves, curve: int, start: float, end: float) -> Pace:
        """Return the pace on a curve from one angle to another."""
        angle = np.linspace(start, end, SEEN_AT)
        rate = _bending(curves, curve, angle)
        before, after = np.append(0.0, rate[:-1]), np.append(rate[1:], 0.0)
        peaks = np.flatnonzero((rate > before) & (rate >= after) & (rate > BENDING))
        found = [_peak(curves, curve, angle[[k, k + 2]], start, end) for k in peaks.tolist()]
        return Pace(start, end, *np.array(found).reshape(-1, 2).T)

    def at(self, share: Floats) -> Floats:
        """Return the parts of the angle that belong to parts of the parameter, (n,)."""
        low, high = np.zeros_like(share), np.ones_like(share)
        first, last = self._sum(np.array([0.0, 1.0]))
        wanted = first + (last - first) * share
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            beyond = self._sum(middle) > wanted
            low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
        found = (low + high) / 2
        found[share == 0.0], found[share == 1.0] = 0.0, 1.0
        return np.asarray(found)

    def _sum(self, part: Floats) -> Floats:
        angle = self.start + (self.end - self.start) * part
        bent = np.arcsinh((angle[:, None] - self.bends) / self.widths).sum(axis=1)
        return np.asarray(angle + bent)


def _bending(curves: StarCurves, curve: int, angle: Floats) -> Floats:
    """Return how fast a curve turns at angles but the first and the last, a rad, (n - 2,)."""
    points = curves.points(np.full(len(angle), curve), angle)[0]
    ways = normalize(np.diff(points, axis=0))
    return np.asarray(length(np.diff(ways, axis=0)) / (angle[1] - angle[0]))


def _peak(
    curves: StarCurves, curve: int, between: Floats, start: float, end: float
) -> tuple[float, float]:
    """Return where a curve bends most between two angles, and over which angle it does, rad."""
    low, high = between.tolist()
    while True:
        angle = np.linspace(low, high, SEEN_AT)
        rate = _bending(curves, curve, angle)
        step, most = angle[1] - angle[0], int(rate.argmax())
        place, width = float(angle[1 + most]), 1.0 / float(rate[most])
        if width > 4 * step or step < LEAST_STEP:
            return place, max(width, step)
        low, high = max(place - 8 * step, start), min(place + 8 * step, end)


def _track(shape: SharpShape, side: int, points: Points) -> Floats:
    """Return points (q, 3) in the parameters of a face, (q, 2)."""
    if side < shape.valency:
        zero = np.zeros(len(points), dtype=np.intp)
        angle = _running(shape.curves.stars.angles(zero, zero + side, points))
        height = points @ shape.curves.stars.directions[0, side]
    else:
        x, y, z = (points @ shape.curves.frames[0].T).T
        angle = in_turn(_running(np.arctan2(y, x)))
        height = np.arcsin(np.clip(z, -1.0, 1.0))
    return np.stack([angle, height], axis=1)


def _running(angle: Floats) -> Floats:
    """Return angles at `checked` without jumps, (c,): the first ones are apart from the rest."""
    count = (len(angle) + 2) // 3
    order = np.empty(len(angle), dtype=np.intp)
    order[::3] = np.arange(count)
    order[1::3] = count + 2 * np.arange(count - 1)
    order[2::3] = order[1::3] + 1
    found = np.empty_like(angle)
    found[order] = np.unwrap(angle[order])
    return found


def _ellipse(shape: SharpShape, curve: int) -> tuple[Floats, Floats, float]:
    """Return axes and half-diameters of an ellipse, and the curve's angle at its first one."""
    stars, one, other = shape.curves.stars, shape.curves.one[curve], shape.curves.other[curve]
    axis, far = stars.directions[0, one], stars.directions[0, other]
    normal: UnitVectors = (axis - far) / np.linalg.norm(axis - far)
    wide: UnitVectors = axis + far
    wide = wide - (wide @ normal) * normal
    wide = wide / np.linalg.norm(wide)
    across = wide - (wide @ axis) * axis
    spoke = across / np.linalg.norm(across)
    radius = float(stars.radii[0, one])
    turned = float(np.arctan2(spoke @ stars.y[0, one], spoke @ stars.x[0, one]))
    narrow = np.cross(axis, spoke)
    axes = np.stack([np.zeros(3), np.cross(wide, narrow), wide])
    return axes, np.array([radius / np.linalg.norm(across), radius]), turned
