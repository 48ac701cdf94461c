"""The B-rep of round struts with sharp nodes: one face per strut from edge to edge, and balls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Ints, Points, place_text
from scaffold_cad.base.topology import component_labels
from scaffold_cad.brep.analytic import (
    AnalyticBrep,
    Axes,
    BrepEdges,
    BrepFaces,
    SplineCurves,
    Surface,
    Traces,
)
from scaffold_cad.errors import BrepError
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.sharp.faceparts import Around, Face, Parts, Use
from scaffold_cad.struts.sharp.interpolation import knots_of
from scaffold_cad.struts.sharp.loops import SEAMS, Steps
from scaffold_cad.struts.sharp.nodes import check_made, seams_of
from scaffold_cad.struts.sharp.seamed import Seamed, SharpEdge, Trace, seamed
from scaffold_cad.struts.sharp.shapes import SharpShape
from scaffold_cad.struts.sharp.strutfaces import add_ends, add_island, add_struts


@dataclass
class SharpBrep:
    """A B-rep, and its circles at ends."""

    brep: AnalyticBrep
    ends: Ints
    """Half-runs at extremities, shape (e,)."""
    rings: Ints
    """The edge around each, shape (e,)."""


def sharp_brep(struts: RoundStruts, open_at: Bools | None = None) -> SharpBrep:
    """Return the B-rep of solid struts with sharp nodes, open where `ends` is "open".

    Parameters
    ----------
    open_at : (n,) nodes where struts end without a face; none by default

    Raises
    ------
    BrepError
        If a node is not proved, or an edge cannot be written; it is named, and where it is.
    """
    runs, parts = struts.runs, Parts()
    check_made(runs, struts.sharp)
    seams = seams_of(runs, struts.sharp, struts.x)
    loops: dict[int, Around] = {}
    holes: dict[int, list[list[Use]]] = {}
    for group in struts.sharp:
        known: dict[tuple[int, ...], Seamed] = {}
        for node, half_runs, size, which in zip(
            group.nodes.tolist(),
            group.half_runs.tolist(),
            group.size.tolist(),
            group.shape_of.tolist(),
            strict=True,
        ):
            own = tuple(
                int(seams[each >> 1]) if each % 2 == 0 else SEAMS - 1 - int(seams[each >> 1])
                for each in half_runs
            )
            key = (which, *own)
            if key not in known:
                known[key] = _seamed(group.shapes[which], own, runs.nodes[node])
            made = known[key]
            _add_node(parts, made, group.shapes[which], struts, node, half_runs, size, loops, holes)
    rings = add_ends(parts, struts, seams, loops, open_at)
    add_struts(parts, struts, seams, loops, holes)
    brep, number = _assembled(parts, struts)
    ends = np.flatnonzero((runs.valency[runs.tails] == 1) & ~struts.at_balls)
    return SharpBrep(brep, ends, number[[rings[end] for end in ends.tolist()]])


def _seamed(shape: SharpShape, seams: tuple[int, ...], place: Points) -> Seamed:
    """Return a shape cut at seams.

    Raises
    ------
    BrepError
        If an edge cannot be written; the node's place is named.
    """
    try:
        return seamed(shape, seams)
    except BrepError as error:
        raise BrepError(f"{error}, at the node at {place_text(place)}") from None


def _add_node(
    parts: Parts,
    made: Seamed,
    shape: SharpShape,
    struts: RoundStruts,
    node: int,
    half_runs: list[int],
    size: float,
    loops: dict[int, Around],
    holes: dict[int, list[list[Use]]],
) -> None:
    """Add the edges of a node and the faces of its ball; note the loops of its struts.

    Parameters
    ----------
    size : radius of its ball, mm
    loops, holes : of half-runs, which grow
    """
    place = struts.runs.nodes[node]
    first = parts.add_points(place + size * made.vertices, size * made.slack)
    number = [_add_edge(parts, edge, first, place, size) for edge in made.edges]
    for face, steps in made.loops:
        uses = _uses(made, shape, face, steps, number, size)
        if face >= shape.valency:
            _add_ball(parts, shape, face, uses, place, size, node, len(struts.runs.edges))
        elif half_runs[face] in loops:
            holes.setdefault(half_runs[face], []).append(uses)
        else:
            seam = int(made.seams[face])
            height = float(made.vertices[seam] @ shape.curves.stars.directions[0, face])
            loops[half_runs[face]] = Around(uses, first + seam, size * height)
    for face, steps in made.islands:
        uses = _uses(made, shape, face, steps, number, size)
        add_island(parts, struts, half_runs[face], uses, node)


def _uses(
    made: Seamed, shape: SharpShape, face: int, steps: Steps, number: list[int], size: float
) -> list[Use]:
    """Return the uses of edges by a loop, their traces in rad and mm.

    Those on balls are around longitude π, as OCCT has longitudes of 0 to 2π.
    """
    uses = []
    scale, start = ([1.0, size], 0.0) if face < shape.valency else ([1.0, 1.0], [np.pi, 0.0])
    for edge, way in steps:
        trace = made.edges[edge].traces[0 if way else 1]
        uses.append(Use(number[edge], way, Trace(start + trace.control * scale, trace.pieces)))
    return uses


def _add_edge(parts: Parts, edge: SharpEdge, first: int, place: Points, size: float) -> int:
    ends = first + int(edge.ends[0]), first + int(edge.ends[1])
    if edge.pieces:
        return parts.add_edge(ends, 1 + edge.pieces, place + size * edge.control)
    axes = edge.axes.copy()
    axes[0] = place + size * axes[0]
    return parts.add_edge(ends, 1, axes, size * edge.radii, edge.angles)


def _add_ball(
    parts: Parts,
    shape: SharpShape,
    face: int,
    uses: list[Use],
    place: Points,
    size: float,
    node: int,
    runs: int,
) -> None:
    """Add a loop to the face of a ball."""
    x, _, z = shape.curves.frames[0]
    for other in reversed(parts.faces):
        if other.node != node:
            break
        if other.part == face:
            other.loops.append(uses)
            return
    axes = place, z, -x
    parts.faces.append(Face(Surface.SPHERE, axes, (size, 0.0), [uses], node, runs + node, face))


def _assembled(parts: Parts, struts: RoundStruts) -> tuple[AnalyticBrep, Ints]:
    """Return the B-rep in arrays, and the new number of each edge."""
    kind = np.array(parts.kind)
    order = np.argsort(kind, kind="stable")
    number = np.empty(len(order), dtype=np.intp)
    number[order] = np.arange(len(order))
    round_ones = [parts.curve[edge] for edge in order[kind[order] == 1].tolist()]
    axes = np.array([axes for axes, _, _ in round_ones]).reshape(-1, 3, 3)
    radii = np.array([radii for _, radii, _ in round_ones]).reshape(-1, 2)
    tables = []
    for pieces in np.unique(kind[kind > 1]).tolist():
        chosen = order[kind[order] == pieces].tolist()
        control = np.array([parts.curve[edge][0] for edge in chosen])
        tables.append(SplineCurves(control, knots_of(pieces - 1)))
    edges = BrepEdges(
        np.array(parts.ends, dtype=np.intp)[order],
        Axes(axes[:, 0], axes[:, 1], axes[:, 2]),
        radii[:, 0],
        np.array([angles for _, _, angles in round_ones]).reshape(-1, 2),
        tuple(tables),
        radii[:, 1],
    )
    brep = AnalyticBrep(
        np.concatenate(parts.vertices),
        edges,
        *_faces(parts, struts, number),
        np.concatenate(parts.slack),
    )
    return brep, number


def _faces(
    parts: Parts, struts: RoundStruts, number: Ints
) -> tuple[BrepFaces, Ints, tuple[str, ...]]:
    """Return the faces, the solid of each shell, and the names."""
    runs = struts.runs
    faces = sorted(parts.faces, key=lambda face: face.kind)
    loops = [loop for face in faces for loop in face.loops]
    uses = [use for loop in loops for use in loop]
    part = component_labels(struts.skeleton.edges, len(runs.nodes))
    used = np.unique(part[struts.skeleton.edges])
    shell = np.searchsorted(used, part)[[face.node for face in faces]]
    traces = []
    for pieces in sorted({use.trace.pieces for use in uses} - {0}):
        rows = [row for row, use in enumerate(uses) if use.trace.pieces == pieces]
        control = np.array([uses[row].trace.control for row in rows])
        traces.append(Traces(np.array(rows, dtype=np.intp), control, knots_of(pieces)))
    axes = [np.array([face.axes[k] for face in faces]) for k in range(3)]
    made = BrepFaces(
        np.array([face.kind for face in faces], dtype=np.intp),
        Axes(*axes),
        np.array([face.sizes for face in faces]),
        (),
        np.ones(len(faces), dtype=np.bool_),
        np.concatenate([[0], np.cumsum([len(face.loops) for face in faces])]),
        np.concatenate([[0], np.cumsum([len(loop) for loop in loops])]),
        number[[use.edge for use in uses]],
        np.array([use.along for use in uses]),
        np.array([use.trace.control[[0, -1]] for use in uses]),
        shell,
        np.array([face.name for face in faces], dtype=np.intp),
        tuple(traces),
    )
    return made, np.arange(int(shell.max()) + 1), _texts(struts)


def _texts(struts: RoundStruts) -> tuple[str, ...]:
    """Return the names of runs, then those of nodes."""
    runs = struts.runs
    edge = np.full(len(runs.edges), len(runs.run_of_edge))
    np.minimum.at(edge, runs.run_of_edge, np.arange(len(runs.run_of_edge)))
    of_node = np.where(runs.valency == 1, "end", "node").tolist()
    names = [f"strut {number}" for number in edge.tolist()]
    return *names, *(f"{kind} {node}" for node, kind in enumerate(of_node))
