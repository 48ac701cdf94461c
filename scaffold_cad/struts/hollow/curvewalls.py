"""Walls along curves: thin where a strut tapers in a bend, and where bends change.

Circles a wall smaller across a cone leave the wall along a straight strut. In a bend of curvature k
the inner side is shorter by 1 - k r, and its slope is as much steeper, which makes the wall there
thinner. Between circles of different curvature sections are oblique, which makes it thinner, too.
The circles of the inside shrink by what walls beside them lack, until none is missing: the wall is
then thicker elsewhere around.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points, UnitVectors
from scaffold_cad.base.blocks import CACHE, cut
from scaffold_cad.base.vectors import dot, normalize
from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.struts.curves.curve import ALONG, Curves
from scaffold_cad.struts.hollow.insides import AIM, ENOUGH, LEAST

ALONGSIDE = 8
"""Intervals along a piece of a curve where walls are measured."""
AROUND = (32, 96)
"""Points around it, inside and outside."""
ROUNDS = 12
"""How often circles are shrunk at most."""
NARROWEST = 0.2
"""What is left of the radius of a circle that is shrunk, at least."""
AIMS = (AIM, ENOUGH)
"""What walls are to be over what is asked for, and the least with which circles shrink no more."""
BESIDE_STRAIGHT = (0.97, 0.96)
"""The same beside straight struts, whose circles stay: walls there hardly grow with the joint."""
PLACE_BYTES = 256
"""What a place on both sides takes while walls are measured."""


def walls_along(inner: Curves, outer: Curves, pieces: Ints) -> Floats:
    """Return how far what is inside of pieces (k,) of curves is from the outside of these.

    Returns
    -------
    (k, along) the least around each place, mm
    """
    found = [np.zeros((0, ALONGSIDE + 1))]
    for some in cut(pieces, 3 * PLACE_BYTES * (ALONGSIDE + 1) * AROUND[1]):
        near = np.clip(some + np.arange(-1, 2)[:, None], 0, len(outer.pieces) - 1)
        points, normals = _on_curves(outer, np.unique(near), AROUND[1])
        inside, _ = _on_curves(inner, some, AROUND[0])
        _, place = cKDTree(points).query(inside)
        walls = dot(points[place] - inside, normals[place])
        found.append(walls.reshape(len(some), ALONGSIDE + 1, -1).min(axis=2))
    return np.concatenate(found)


def with_walls_along(
    inner: Curves, outer: Curves, crowded: Bools, wall: float
) -> tuple[Curves, Ints]:
    """Return the inside of curves with circles so small that walls are kept.

    Parameters
    ----------
    crowded : (n,) joints whose walls do not count
    wall : thickness, mm

    Returns
    -------
    the curves, and the joints beside which no inside leaves enough of a wall
    """
    first, last = outer.pieces, outer.pieces + 1
    counts = ~(crowded[outer.nodes] & (outer.nodes >= 0))
    # The wall across changes evenly from circle to circle if both sides grow alike at each.
    made = replace(inner, outline=outer.outline, slopes=outer.slopes)
    thin = np.flatnonzero((_across(made, outer) < ENOUGH * wall) & counts[first] & counts[last])
    if len(thin) == 0:
        return made, thin
    is_joint = inner.nodes >= 0
    narrowest = NARROWEST * inner.radii
    for _ in range(ROUNDS):
        at_straight = _at_straight(made, thin)[:, None]
        aims, enough = np.where(at_straight, BESIDE_STRAIGHT, AIMS).T[:, :, None] * wall
        walls = walls_along(made, outer, thin)
        rows = (walls < enough).any(axis=1)
        lack = aims - walls
        thin, lack = thin[rows], lack[rows]
        if len(thin) == 0:
            return made, thin
        push = _lacking(made, thin, lack)
        radii = np.where(is_joint, np.maximum(made.radii - push, narrowest), made.radii)
        made = replace(made, radii=radii)
    thin = first[thin[walls_along(made, outer, thin).min(axis=1) < LEAST * wall]]
    nodes = np.unique(inner.nodes[np.append(thin, thin + 1)])
    return made, nodes[nodes >= 0]


def _lacking(curves: Curves, pieces: Ints, lack: Floats) -> Floats:
    """Return what walls beside each circle lack at most, (s,), mm.

    Parameters
    ----------
    pieces, lack : (k,), and what their walls lack along them, (k, along)
    """
    middle = lack.shape[1] // 2
    parts = lack[:, : middle + 1].max(axis=1), lack[:, middle:].max(axis=1)
    circles = curves.pieces[pieces] + np.arange(2)[:, None]  # (2, k)
    # Circles of straight struts stay as they are: that of the joint is there for both halves.
    alone = _at_straight(curves, pieces)
    found = np.zeros(len(curves.radii))
    for at, part in zip(circles, parts, strict=True):
        np.maximum.at(found, at, np.where(alone, lack.max(axis=1), part))
    ends = np.stack([curves.offsets[:-1], curves.offsets[1:] - 1])[:, curves.closed]  # one joint
    found[ends] = found[ends].max(axis=0)
    return found


def _at_straight(curves: Curves, pieces: Ints) -> Bools:
    """Return which pieces (k,) begin or end on the circle of a straight strut, (k,)."""
    first = curves.pieces[pieces]
    return np.asarray((curves.nodes[first] < 0) | (curves.nodes[first + 1] < 0))


def _across(inner: Curves, outer: Curves) -> Floats:
    """Return the walls of pieces (p,) across, the least from a place outside to that beside it."""
    every, count = np.arange(len(outer.pieces)), (ALONGSIDE + 1) * AROUND[0]
    inner = replace(inner, x=outer.x, twists=outer.twists)  # beyond straight struts they are not
    least = [np.zeros(0)]
    for some in cut(every, PLACE_BYTES * count, CACHE):
        outside, normals = _on_curves(outer, some, AROUND[0])
        inside, _ = _on_curves(inner, some, AROUND[0])
        least.append(dot(outside - inside, normals).reshape(-1, count).min(axis=1))
    return np.concatenate(least)


def _on_curves(curves: Curves, pieces: Ints, sides: int) -> tuple[Points, UnitVectors]:
    """Return points and unit normals of pieces (k,) of curves, both (k * along * sides, 3)."""
    at = np.linspace(0.0, 1.0, ALONGSIDE + 1)
    angle = 2 * np.pi / sides * np.arange(sides)
    around = np.stack([np.ones(sides), np.cos(angle), np.sin(angle)])
    turned = np.stack([np.zeros(sides), -np.sin(angle), np.cos(angle)])
    control = curves.frames[pieces]
    frames = np.einsum("lj,pjkx->plkx", bernstein(ALONG, at), control)
    slopes = np.einsum("lj,pjkx->plkx", bernstein(ALONG, at, 1), control)
    points = np.einsum("ks,plkx->plsx", around, frames)
    across = np.einsum("ks,plkx->plsx", turned, frames)
    ahead = np.einsum("ks,plkx->plsx", around, slopes)
    normals = normalize(np.cross(across, ahead))
    return points.reshape(-1, 3), normals.reshape(-1, 3)
