"""The edges of the B-rep of round struts: circles of collars, balls, tori, curves; of nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Edges, Floats, Ints
from scaffold_cad.brep.analytic import Axes, BrepEdges, Knots, SplineCurves
from scaffold_cad.struts.blending.splines import Spline
from scaffold_cad.struts.breps.plan import (
    FacePlan,
    curve_corners,
    domes,
    groups_of,
    owners,
    placed,
)
from scaffold_cad.struts.breps.seams import QUARTER
from scaffold_cad.struts.breps.uses import TURN
from scaffold_cad.struts.model import BlendedNodes


@dataclass(frozen=True, eq=False)
class _Circles:
    """Edges on circles."""

    pairs: Edges
    """Vertices at both ends, shape (c, 2)."""
    axes: Axes
    """Of the circles, c of them."""
    radii: Floats
    """Of the circles, shape (c,), mm."""
    angles: Floats
    """Where the edges begin and end, shape (c, 2), rad."""


def edges_of(plan: FacePlan) -> BrepEdges:
    """Return all edges."""
    near = plan.seams.near
    seam = np.stack([plan.seam_vertex(near), plan.seam_vertex(near ^ 1)], axis=1)
    makers = (_collar_circles, _dome_circles, _torus_circles, _curve_circles)
    circles = [make(plan) for make in makers]
    pairs = [seam, *(each.pairs for each in circles)]
    curves = []
    for group, vertex, *_ in groups_of(plan):
        for made_pairs, table in _node_curves(plan, group, vertex):
            pairs.append(made_pairs)
            curves.append(table)
    pairs.append(curve_corners(plan).reshape(-1, 2))
    curves += plan.curves.spokes
    return BrepEdges(
        np.concatenate(pairs),
        Axes(
            np.concatenate([each.axes.origin for each in circles]),
            np.concatenate([each.axes.z for each in circles]),
            np.concatenate([each.axes.x for each in circles]),
        ),
        np.concatenate([each.radii for each in circles]),
        np.concatenate([each.angles for each in circles]),
        tuple(curves),
    )


def _collar_circles(plan: FacePlan) -> _Circles:
    """Return the quarters of collars, the second halves of split ones, and the rings of ends."""
    runs = plan.struts.runs
    ringed, split, ends = plan.ringed, plan.split, plan.ends
    quarter = np.tile(np.arange(4), len(ringed))
    of_arc = np.repeat(ringed, 4)
    arc_ends = 4 * plan.rank[of_arc][:, None] + np.stack([quarter, (quarter + 1) % 4], axis=1)
    angles = QUARTER * np.stack([quarter, quarter + 1], axis=1)
    halved = 4 * plan.rank[split] + plan.seams.quarter[split]
    middle = plan.split_vertices + np.arange(len(split))
    rest_ends = np.stack([middle, arc_ends[halved, 1]], axis=1)
    rest_angles = np.stack([plan.seams.angle[split], angles[halved, 1]], axis=1)
    arc_ends[halved, 1], angles[halved, 1] = middle, plan.seams.angle[split]
    ring = np.repeat((plan.end_vertices + np.arange(len(ends)))[:, None], 2, axis=1)
    ring_angles = np.tile([0.0, TURN], (len(ends), 1))
    half_run = np.concatenate([of_arc, split, ends])
    center = runs.nodes[runs.tails[half_run]]
    center = center + plan.struts.collar[half_run, None] * runs.directions[half_run]
    return _Circles(
        np.concatenate([arc_ends, rest_ends, ring]),
        Axes(center, runs.directions[half_run], plan.struts.x[half_run]),
        runs.radii_at(half_run, plan.struts.collar[half_run]),
        np.concatenate([angles, rest_angles, ring_angles]),
    )


def _dome_circles(plan: FacePlan) -> _Circles:
    """Return the meridians of balls and round ends, from the ring to the pole."""
    middle, size, latitude = domes(plan)
    domed = plan.ends[plan.balls]
    x = plan.struts.x[domed]
    ring = (plan.end_vertices + np.arange(len(plan.ends)))[plan.balls]
    return _Circles(
        np.stack([ring, plan.poles + np.arange(len(domed))], axis=1),
        Axes(middle, np.cross(x, -plan.struts.runs.directions[domed]), x),
        size,
        np.stack([latitude, np.full(len(domed), QUARTER)], axis=1),
    )


def _torus_circles(plan: FacePlan) -> _Circles:
    """Return the seams of tori, around the outside of bends."""
    tori = plan.tori
    tube = plan.struts.runs.radii.reshape(-1)[tori.half_runs[:, 0]]
    return _Circles(
        4 * plan.rank[tori.half_runs],
        Axes(tori.centers, tori.z, tori.x),
        tori.radii + tube,
        np.stack([0.0 * tori.turns, tori.turns], axis=1),
    )


def _curve_circles(plan: FacePlan) -> _Circles:
    """Return the quarters of the circles of curves."""
    number = np.arange(4 * len(plan.curves.own))
    pairs = plan.curve_vertices + np.stack([number, number & ~3 | (number + 1) & 3], axis=1)
    return _Circles(pairs, plan.curves.ring_axes, plan.curves.ring_radii, plan.curves.ring_angles)


def knots_of(spline: Spline) -> Knots:
    """Return the knots of patches in one direction."""
    values, counts = np.unique(spline.knots, return_counts=True)
    return Knots(values, counts.astype(np.intp))


def _node_curves(
    plan: FacePlan, group: BlendedNodes, vertex: int
) -> tuple[tuple[Ints, SplineCurves], tuple[Ints, SplineCurves]]:
    """Return the ends and the curves of the nodes' arcs, 2 N a node, and of their spokes, 4 N."""
    quads = group.quads[group.shape_of]
    nodes, valency = quads.shape[:2]
    _, control = placed(plan, group)
    _, owns = owners(quads)
    first = vertex + (valency + 2) * np.arange(nodes)[:, None]
    start = first + quads.reshape(nodes, -1)  # (M, 4 N)
    end = first + np.roll(quads, -1, axis=2).reshape(nodes, -1)
    collar = (4 * plan.rank[group.half_runs][:, :, None] + np.arange(4)).reshape(nodes, -1)
    layout = group.shapes.layout
    arcs = SplineCurves(control[:, :, :, 0][owns], knots_of(layout.u))
    spokes = SplineCurves(control[:, :, 0].reshape(nodes * 4 * valency, -1, 3), knots_of(layout.v))
    spoke_ends = np.stack([start, collar], axis=2).reshape(-1, 2)
    return (np.stack([start[owns], end[owns]], axis=1), arcs), (spoke_ends, spokes)
