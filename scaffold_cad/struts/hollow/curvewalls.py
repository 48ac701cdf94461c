"""Walls along curves: thin where a strut tapers in a bend.

Circles a wall smaller across a cone leave the wall along a straight strut. In a bend of curvature k
the inner side is shorter by 1 - k r, and its slope is as much steeper, which makes the wall there
thinner. The circles of the inside shrink by what walls beside them lack, until none is missing: the
wall is then thicker on the outer side of the bend.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points, UnitVectors
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.struts.curves.curve import ALONG, Curves
from scaffold_cad.struts.hollow.insides import AIM, ENOUGH, LEAST

ALONGSIDE = 8
"""Intervals along a piece of a curve where walls are measured."""
AROUND = (32, 96)
"""Points around it, inside and outside."""
STEEP = 0.1
"""Slope on the inner side of a bend up to which walls lack less than `ENOUGH` leaves."""
ROUNDS = 12
"""How often circles are shrunk at most."""
NARROWEST = 0.2
"""What is left of the radius of a circle that is shrunk, at least."""


class CurveGaps:
    """How far what is inside of curves is from the outside of some of their pieces."""

    def __init__(self, outer: Curves, pieces: Ints) -> None:
        beside = np.unique(np.clip(pieces + np.arange(-1, 2)[:, None], 0, len(outer.pieces) - 1))
        self._points, self._normals = _on_curves(outer, beside, AROUND[1])
        self._tree = cKDTree(self._points)

    def measured(self, inner: Curves, pieces: Ints) -> Floats:
        """Return the walls along pieces (k,), the least around each place, (k, along), mm."""
        inside, _ = _on_curves(inner, pieces, AROUND[0])
        _, place = self._tree.query(inside)
        walls = dot(self._points[place] - inside, self._normals[place])
        return np.asarray(walls.reshape(len(pieces), ALONGSIDE + 1, -1).min(axis=2))


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
    thin = np.flatnonzero(_is_steep(outer) & counts[first] & counts[last])
    if len(thin) == 0:
        return made, thin
    gaps, is_joint = CurveGaps(outer, thin), inner.nodes >= 0
    narrowest = NARROWEST * inner.radii
    for _ in range(ROUNDS):
        walls = gaps.measured(made, thin)
        rows = walls.min(axis=1) < ENOUGH * wall
        thin, walls = thin[rows], walls[rows]
        if len(thin) == 0:
            return made, thin
        push = _lacking(made, thin, AIM * wall - walls)
        radii = np.where(is_joint, np.maximum(made.radii - push, narrowest), made.radii)
        made = replace(made, radii=radii)
    thin = first[thin[gaps.measured(made, thin).min(axis=1) < LEAST * wall]]
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
    whole = lack.max(axis=1)
    circles = curves.pieces[pieces] + np.arange(2)[:, None]  # (2, k)
    # Circles of straight struts stay as they are: that of the joint is there for both halves.
    alone = (curves.nodes[circles] < 0).any(axis=0)
    found = np.zeros(len(curves.radii))
    for at, part in zip(circles, parts, strict=True):
        np.maximum.at(found, at, np.where(alone, whole, part))
    ends = np.stack([curves.offsets[:-1], curves.offsets[1:] - 1])[:, curves.closed]  # one joint
    found[ends] = found[ends].max(axis=0)
    return found


def _is_steep(curves: Curves) -> Bools:
    """Return which pieces may be steep on the inner side of their bend, (p,)."""
    first, last = curves.pieces, curves.pieces + 1
    span = length(curves.centers[last] - curves.centers[first])
    growth = 1.5 * np.abs(curves.radii[last] - curves.radii[first]) / span  # of a cubic at most
    bend = np.maximum(*(length(curves.bends[at]) * curves.radii[at] for at in (first, last)))
    slope = np.maximum(growth, np.maximum(*(np.abs(curves.slopes[at]) for at in (first, last))))
    return np.asarray(slope > STEEP * (1.0 - bend))


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
