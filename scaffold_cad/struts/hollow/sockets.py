"""Sockets: open ends of hollow struts that are bored to another radius, to take a tube.

A socket is a cylinder from the plane of the end to a flat shoulder.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import (
    Bools,
    Floats,
    Frozen,
    Ints,
    Points,
    Triangles,
    UnitVectors,
    place_text,
)
from scaffold_cad.brep.analytic import AnalyticBrep, Axes, BrepEdges, BrepFaces, Surface
from scaffold_cad.errors import OptionError
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts.hollow.longends import SPARE
from scaffold_cad.struts.runs import ball_ends, straight_runs

TURN = 2 * np.pi


@dataclass(frozen=True, eq=False)
class Sockets(Frozen):
    """The sockets of hollow struts, ascending by node."""

    nodes: Ints
    """Extremities, shape (q,)."""
    radii: Floats
    """Inner radius, shape (q,), mm."""
    depths: Floats
    """Length from the end to the shoulder, shape (q,), mm."""

    def chosen(self, keep: Bools) -> Sockets:
        """Return some of the sockets."""
        return Sockets(self.nodes[keep], self.radii[keep], self.depths[keep])


NO_SOCKETS = Sockets(np.empty(0, dtype=np.intp), np.empty(0), np.empty(0))


def sockets_of(
    given: Mapping[int, tuple[float, float]] | None, skeleton: Skeleton, wall: float
) -> Sockets:
    """Return the sockets that are asked for.

    Parameters
    ----------
    given : radius and depth by node, mm
    wall : of the struts, mm

    Raises
    ------
    OptionError
        If a node is not an extremity or is a ball, or its strut has no room for the socket; it is
        named.
    """
    rows = sorted((given or {}).items())
    nodes = np.array([node for node, _ in rows], dtype=np.intp)
    radii, depths = np.array([size for _, size in rows], dtype=np.float64).reshape(-1, 2).T
    wrong = [node for node in nodes.tolist() if node not in set(skeleton.extremities.tolist())]
    if wrong:
        raise OptionError(f"sockets has node {wrong[0]}, which is not an end of a strut; need one")
    runs = straight_runs(skeleton)
    half = runs.incidence.half_edges[runs.incidence.offsets[nodes]]  # (q,)
    outer = runs.radii.reshape(-1)[half]
    for row in np.flatnonzero(ball_ends(skeleton, runs)[nodes])[:1].tolist():
        node = nodes[row]
        raise OptionError(
            f"the socket at node {node} at {place_text(skeleton.nodes[node])} is in a ball of "
            f"radius {skeleton.radii[node]:g} mm; need the {outer[row]:g} mm of its strut, whose "
            "end is open"
        )
    taken = np.zeros(len(skeleton.nodes))
    taken[nodes] = depths
    lengths = runs.lengths[half >> 1]
    room = lengths - taken[runs.tails[half ^ 1]]
    at_shoulder = runs.radii_at(half, np.minimum(depths, lengths))
    for node, place, radius, depth, length, left, size, inside in zip(
        nodes.tolist(),
        [place_text(point) for point in skeleton.nodes[nodes]],
        radii.tolist(),
        depths.tolist(),
        lengths.tolist(),
        room.tolist(),
        np.minimum(outer, at_shoulder).tolist(),
        (at_shoulder - wall).tolist(),
        strict=True,
    ):
        if not 0 < radius < size:
            raise OptionError(
                f"the socket at node {node} at {place} has radius {radius:g} mm; need > 0 "
                f"and less than the {size:g} mm of its strut, down to the shoulder"
            )
        if not 0 < depth < left - SPARE * length:
            raise OptionError(
                f"the socket at node {node} at {place} is {depth:g} mm deep; need > 0 and less "
                f"than the {left:g} mm that its strut has for it"
            )
        if abs(radius - inside) < 1e-6 * size:
            raise OptionError(
                f"the socket at node {node} at {place} has the {radius:g} mm of the strut's "
                "inside, and so no shoulder; need another radius"
            )
    return Sockets(nodes, radii, depths)


def socket_triangles(shoulder: Ints, end: Ints, inside: Ints) -> Triangles:
    """Return the triangles of bores and shoulders, seen from the material's outside.

    Parameters
    ----------
    shoulder, end : (q, s) vertices of the rings of the bore, counter-clockwise seen from within
    inside : (q, s) those of the ring of the strut's inside at the shoulder
    """
    parts = []
    for outer, inner in ((end, shoulder), (shoulder, inside)):
        a, b = np.roll(outer, -1, axis=1), outer
        d, c = np.roll(inner, -1, axis=1), inner
        parts += [np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)]
    return np.concatenate(parts).reshape(-1, 3)


def bores(
    ends: Points, inward: UnitVectors, x: UnitVectors, sockets: Sockets, shell: Ints, shells: int
) -> AnalyticBrep:
    """Return the cylinders of sockets; circles 2 i and 2 i + 1 are at shoulder and end of i.

    Parameters
    ----------
    ends : (q, 3) centers of the ends, mm
    inward, x : (q, 3) axes from there, and where circles begin
    shell : (q,) shell of each
    shells : how many there are
    """
    count = len(ends)
    centers = np.stack([ends + sockets.depths[:, None] * inward, ends], axis=1)  # (q, 2, 3)
    vertices = centers + sockets.radii[:, None, None] * x[:, None]
    number = np.arange(2 * count).reshape(-1, 2)
    circles = Axes(centers.reshape(-1, 3), np.repeat(inward, 2, axis=0), np.repeat(x, 2, axis=0))
    edges = BrepEdges(
        np.concatenate([number[:, ::-1], np.repeat(number.reshape(-1, 1), 2, axis=1)]),
        circles,
        np.repeat(sockets.radii, 2),
        np.tile([0.0, TURN], (2 * count, 1)),
        (),
    )
    seam, ring = np.arange(count), count + number
    zero, turn, high = np.zeros(count), np.full(count, TURN), sockets.depths
    corners = np.stack(
        [
            np.stack([zero, zero, turn, zero], axis=1),
            np.stack([turn, zero, turn, high], axis=1),
            np.stack([zero, high, turn, high], axis=1),
            np.stack([zero, zero, zero, high], axis=1),
        ],
        axis=1,
    )  # (q, 4, 4)
    faces = BrepFaces(
        np.full(count, Surface.CYLINDER, dtype=np.intp),
        Axes(ends, inward, x),
        np.stack([sockets.radii, zero], axis=1),
        (),
        outward=np.ones(count, dtype=np.bool_),
        loops=np.arange(count + 1),
        uses=4 * np.arange(count + 1),
        edge=np.stack([ring[:, 1], seam, ring[:, 0], seam], axis=1).reshape(-1),
        forward=np.tile([True, True, False, False], count),
        parameters=corners.reshape(-1, 2, 2),
        shell=shell,
        name=np.arange(count),
    )
    names = tuple(f"socket {node}" for node in sockets.nodes.tolist())
    return AnalyticBrep(vertices.reshape(-1, 3), edges, faces, np.arange(shells), names)
