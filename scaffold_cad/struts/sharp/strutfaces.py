"""The faces of struts between sharp nodes: from edge to edge along a seam, and their ends."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints
from scaffold_cad.brep.analytic import Surface
from scaffold_cad.struts.meshes.ends import end_spheres
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.sharp.faceparts import Around, Face, Parts, Use
from scaffold_cad.struts.sharp.loops import seam_angles
from scaffold_cad.struts.sharp.seamed import Trace

TURN = 2 * np.pi


def add_island(
    parts: Parts, struts: RoundStruts, half_run: int, uses: list[Use], node: int
) -> None:
    """Add a face that is apart from the rest of its strut; its seam is opposite to it."""
    runs = struts.runs
    axis, x = runs.directions[half_run], struts.x[half_run]
    slope = float(runs.slopes[half_run])
    turned = float(uses[0].trace.control[0, 0]) - np.pi
    start = np.cos(turned) * x + np.sin(turned) * np.cross(axis, x)
    placed = _placed(uses, _near_map(turned, float(np.hypot(1.0, slope))), np.pi)
    kind = Surface.CYLINDER if slope == 0 else Surface.CONE
    if slope < 0:  # cones grow along their axis
        axis, slope = -axis, -slope
        placed = [
            Use(
                use.edge,
                use.along,
                Trace(use.trace.control * [-1.0, -1.0] + [TURN, 0.0], use.trace.pieces),
            )
            for use in placed
        ]
    sizes = float(runs.radii.reshape(-1)[half_run]), float(np.arctan(slope))
    axes = runs.nodes[node], axis, start
    parts.faces.append(Face(kind, axes, sizes, [placed], node, half_run >> 1))


def add_ends(
    parts: Parts,
    struts: RoundStruts,
    seams: Ints,
    loops: dict[int, Around],
    open_at: Bools | None,
) -> dict[int, int]:
    """Add the circles at extremities and what closes them; return the circle of each half-run."""
    runs, rings = struts.runs, {}
    for half_run in np.flatnonzero(runs.valency[runs.tails] == 1).tolist():
        node, axis = int(runs.tails[half_run]), runs.directions[half_run]
        height = float(struts.collar[half_run])
        place = runs.nodes[node] + height * axis
        radius = float(runs.radii_at(np.array([half_run]), np.array([height]))[0])
        x = _seam_direction(struts, seams, half_run)
        vertex = parts.add_points((place + radius * x)[None])
        axes = np.stack([place, axis, x])
        whole = np.array([0.0, TURN])
        ring = parts.add_edge((vertex, vertex), 1, axes, np.full(2, radius), whole)
        rings[half_run] = ring
        trace = Trace(np.array([[0.0, height], [TURN, height]]), 0)
        loops[half_run] = Around([Use(ring, True, trace)], vertex, height)
        name = len(runs.edges) + node
        if open_at is not None and open_at[node]:
            continue
        if struts.options.ends == "round" or struts.at_balls[half_run]:
            _add_dome(parts, struts, half_run, ring, vertex, x, name)
        elif struts.options.ends == "flat":
            nothing = Trace(np.full((2, 2), np.nan), 0)
            uses = [Use(ring, False, nothing)]
            parts.faces.append(
                Face(Surface.PLANE, (place, -axis, x), (0.0, 0.0), [uses], node, name)
            )
    return rings


def _add_dome(
    parts: Parts, struts: RoundStruts, half_run: int, ring: int, vertex: int, x: Floats, name: int
) -> None:
    """Add the part of a sphere in which a strut ends, beyond its last circle."""
    sphere = end_spheres(struts, np.array([half_run]))
    size, low = float(sphere.size[0]), float(sphere.start[0])
    node, axis = int(struts.runs.tails[half_run]), struts.runs.directions[half_run]
    center = struts.runs.nodes[node] - sphere.center[0] * axis
    pole = parts.add_points((center - size * axis)[None])
    placed = np.stack([center, np.cross(x, -axis), x])
    begin = np.mod(low, TURN)
    span = np.array([begin, begin + TURN / 4 - low])
    meridian = parts.add_edge((vertex, pole), 1, placed, np.full(2, size), span)
    top = TURN / 4
    uses = [
        Use(ring, False, Trace(np.array([[TURN, low], [0.0, low]]), 0)),
        Use(meridian, True, Trace(np.array([[TURN, low], [TURN, top]]), 0)),
        Use(meridian, False, Trace(np.array([[0.0, low], [0.0, top]]), 0)),
    ]
    parts.faces.append(Face(Surface.SPHERE, (center, -axis, x), (size, 0.0), [uses], node, name))


def _seam_direction(struts: RoundStruts, seams: Ints, half_run: int) -> Floats:
    """Return the direction across a strut in which its seam is, (3,)."""
    ahead, x = struts.runs.directions[half_run & ~1], struts.x[half_run & ~1]
    angle = seam_angles(ahead)[seams[half_run >> 1]]
    found: Floats = np.cos(angle) * x + np.sin(angle) * np.cross(ahead, x)
    return found


def add_struts(
    parts: Parts,
    struts: RoundStruts,
    seams: Ints,
    loops: dict[int, Around],
    holes: dict[int, list[list[Use]]],
) -> None:
    """Add the face of each strut: around its near end, along the seam, around its far end, back."""
    runs = struts.runs
    for run in range(len(runs.edges)):
        near = 2 * run + int(runs.slopes[2 * run] < 0)  # the thinner end of cones
        slope, length = float(runs.slopes[near]), float(runs.lengths[run])
        stretch = float(np.hypot(1.0, slope))
        start = float(seam_angles(runs.directions[2 * run])[seams[run]])
        start *= 1.0 if near % 2 == 0 else -1.0
        node, radius = int(runs.tails[near]), float(runs.radii.reshape(-1)[near])
        ends = loops[near], loops[near ^ 1]
        heights = ends[0].height, length - ends[1].height
        seam = parts.add_edge((ends[0].vertex, ends[1].vertex), 0)
        maps = _near_map(start, stretch), _far_map(start, stretch, length)
        is_end = [runs.valency[runs.tails[each]] == 1 for each in (near, near ^ 1)]
        # Rings at ends begin at the seam.
        placing = [
            _mapped_from(each, offset) if end else each
            for each, end, offset in zip(maps, is_end, (start, -start), strict=True)
        ]
        lines = [
            Trace(np.array([[turn, heights[0] * stretch], [turn, heights[1] * stretch]]), 0)
            for turn in (TURN, 0.0)
        ]
        outer = _placed(ends[0].uses, placing[0], 0.0)
        outer.append(Use(seam, True, lines[0]))
        outer += _placed(ends[1].uses, placing[1], TURN)
        outer.append(Use(seam, False, lines[1]))
        inner = [
            _placed(uses, maps[side], None)
            for side in (0, 1)
            for uses in holes.get(near ^ side, [])
        ]
        kind = Surface.CYLINDER if slope == 0 else Surface.CONE
        axes = runs.nodes[node], runs.directions[near], _seam_direction(struts, seams, near)
        sizes = radius, float(np.arctan(slope))
        parts.faces.append(Face(kind, axes, sizes, [outer, *inner], node, run))


_Map = tuple[Floats, Floats]
"""Factors and offsets, (2,), from an angle and a height to the parameters of a strut's face."""


def _near_map(start: float, stretch: float) -> _Map:
    return np.array([1.0, stretch]), np.array([-start, 0.0])


def _far_map(start: float, stretch: float, length: float) -> _Map:
    return np.array([-1.0, -stretch]), np.array([-start, stretch * length])


def _mapped_from(given: _Map, offset: float) -> _Map:
    """Return the map of angles that are counted from an offset on."""
    factors, offsets = given
    return factors, offsets + factors * np.array([offset, 0.0])


def _placed(uses: list[Use], given: _Map, start: float | None) -> list[Use]:
    """Return the uses in the parameters of their strut's face, one behind the other.

    Parameters
    ----------
    start : where the first begins; within the first turn by default
    """
    factors, offsets = given
    found = []
    for use in uses:
        control = use.trace.control * factors + offsets
        first, last = (0, -1) if use.along else (-1, 0)
        if start is None:
            start = float(np.mod(control[first, 0], TURN))
        control[:, 0] += TURN * np.round((start - control[first, 0]) / TURN)
        start = float(control[last, 0])
        found.append(Use(use.edge, use.along, Trace(control, use.trace.pieces)))
    return found
