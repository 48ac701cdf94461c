"""Walls of hollow struts: what is inside them, and how thin they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, place_text
from scaffold_cad.errors import OptionError
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts.hollow.curvewalls import walls_along
from scaffold_cad.struts.hollow.gaps import Gaps
from scaffold_cad.struts.hollow.longends import with_long_ends
from scaffold_cad.struts.model import BlendedNodes, RoundStruts
from scaffold_cad.struts.options import Ends
from scaffold_cad.struts.runs import balls_of, straight_runs


def end_walls(skeleton: Skeleton, wall: float, ends: Ends) -> Floats:
    """Return by how much what is inside is shorter at extremities, (n,), mm.

    The spheres of round ends have one center inside and outside: they touch cones along circles
    that are a wall apart across the cone, and so not at the same place along its axis.
    """
    found = np.full(len(skeleton.nodes), wall if ends == "flat" else 0.0)
    if ends == "round":
        slope = np.diff(skeleton.edge_radii, axis=1)[:, 0] / skeleton.lengths
        lean = wall * slope / np.hypot(1.0, slope)  # (m,), the circles' distance along the axis
        is_end = skeleton.valency[skeleton.edges] == 1
        found[skeleton.edges[is_end]] = np.stack([lean, -lean], axis=1)[is_end]
    return found


def check_wall(skeleton: Skeleton, wall: float) -> None:
    """Raise if the radius of a strut is not larger than `wall`, mm; it is named."""
    across = _across(skeleton, wall)
    thin = np.flatnonzero(skeleton.edge_radii.min(axis=1) <= across)
    if len(thin):
        radius = skeleton.edge_radii[thin[0]].min()
        near = skeleton.nodes[skeleton.edges[thin[0]]].mean(axis=0)
        steep = f" ({across[thin[0]]:.3g} mm across the axis of a taper)" if radius > wall else ""
        raise OptionError(
            f"wall is {wall:g} mm{steep}, and edge {thin[0]} near {place_text(near)} has radius "
            f"{radius:g} mm; need a wall that is thinner than each radius"
        )


def _across(skeleton: Skeleton, wall: float) -> Floats:
    """Return how thick walls are across the axis of each strut, (m,): more at cones."""
    return wall * np.hypot(1.0, np.diff(skeleton.edge_radii, axis=1)[:, 0] / skeleton.lengths)


def without_wall(skeleton: Skeleton, wall: float, at_ends: Floats) -> Skeleton:
    """Return the skeleton of what is inside struts with walls, which `check_wall` lets pass.

    Parameters
    ----------
    wall : thickness, mm
    at_ends : (n,) by how much struts are shorter at extremities, mm

    Raises
    ------
    OptionError
        If a strut is not longer than its ends; it is named.
    """
    skeleton, at_ends = with_long_ends(skeleton, at_ends)
    is_end = skeleton.valency[skeleton.edges] == 1  # (m, 2)
    cut = at_ends[skeleton.edges] * is_end
    share = cut / skeleton.lengths[:, None]
    near, far = skeleton.edge_radii.T
    start = near + share[:, 0] * (far - near)
    end = far + share[:, 1] * (near - far)
    nodes = skeleton.nodes.copy()
    ahead = skeleton.directions.reshape(-1, 2, 3)
    nodes[skeleton.edges[is_end]] += (cut[..., None] * ahead)[is_end]
    inside = np.stack([start, end], axis=1) - _across(skeleton, wall)[:, None]
    return Skeleton(nodes, skeleton.edges, _balls_inside(skeleton, inside, wall), inside)


def _balls_inside(skeleton: Skeleton, inside: Floats, wall: float) -> Floats:
    """Return the radii of the nodes of what is inside: balls a wall smaller, else of the struts.

    Parameters
    ----------
    inside : (m, 2) radii of the edges inside, mm
    """
    own = np.zeros(len(skeleton.nodes))
    np.maximum.at(own, skeleton.edges, inside)
    is_ball = (balls_of(skeleton, straight_runs(skeleton)) > 0) | (own == 0)
    return np.where(is_ball, np.maximum(skeleton.radii - wall, 1e-3 * skeleton.radii), own)


@dataclass(frozen=True, eq=False)
class Walls(Frozen):
    """How thick the walls of hollow struts are, as measured. Between collars they are exact."""

    asked: float
    """What was asked for, mm."""
    nodes: Floats
    """Least thickness at each node that has a blend of its own, nan at others, shape (n,), mm."""
    curves: Floats
    """Least thickness of each curve, inf where all of it is crowded, shape (c,), mm."""
    sockets: Floats
    """What the bore of each socket leaves of its strut, shape (q,), mm."""

    @property
    def least(self) -> float:
        """The least of all, mm."""
        found = [self.nodes[np.isfinite(self.nodes)], self.curves, self.sockets]
        return min(self.asked, float(np.concatenate(found).min(initial=np.inf)))


def walls(struts: RoundStruts) -> Walls:
    """Return how thick the walls of hollow struts are, measured at samples of their inside.

    Raises
    ------
    OptionError
        If the struts are solid.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, round_struts
    >>> tube = Skeleton([[0, 0, 0], [0, 0, 20]], [[0, 1]], 5.0)
    >>> lug = round_struts(tube, wall=1.0, ends="open", sockets={1: (4.2, 6.0)})
    >>> walls(lug).sockets.round(6).tolist()
    [0.8]
    """
    if struts.inner is None:
        raise OptionError("the struts are solid; need wall=, mm")
    runs, sockets = struts.runs, struts.sockets
    half_runs = runs.incidence.half_edges[runs.incidence.offsets[sockets.nodes]]
    cosines = 1 / np.hypot(1.0, runs.slopes[half_runs])
    left = [
        cosines * (runs.radii_at(half_runs, depth) - sockets.radii)
        for depth in (0.0 * sockets.depths, sockets.depths)
    ]
    nodes = walls_at(struts.blended, struts.inner.blended, len(runs.nodes))
    nodes[struts.crowded | struts.inner.crowded] = np.nan
    curves = _along_curves(struts, struts.inner)
    return Walls(struts.options.wall or 0.0, nodes, curves, np.minimum(*left))


def walls_at(outer: Sequence[BlendedNodes], inner: Sequence[BlendedNodes], count: int) -> Floats:
    """Return the least wall of each node with blends outside and inside, nan elsewhere, mm.

    That of equal nodes is found once.

    Parameters
    ----------
    count : how many nodes there are

    Returns
    -------
    (count,) float64
    """
    found = np.full(count, np.nan)
    inside_of = {
        node: (group, row)
        for group in inner
        for node, row in zip(group.nodes.tolist(), group.shape_of.tolist(), strict=True)
    }
    for group in outer:
        known: dict[tuple[int, ...], float] = {}
        for node, row in zip(group.nodes.tolist(), group.shape_of.tolist(), strict=True):
            if node not in inside_of:
                continue
            inside, other = inside_of[node]
            key = _pair(group, row, inside, other)
            if key not in known:
                pair = group.shapes[np.array([row])], inside.shapes[np.array([other])]
                known[key] = float(Gaps(pair[0]).least(pair[1])[0])
            found[node] = known[key]
    return found


def _pair(outer: BlendedNodes, row: int, inner: BlendedNodes, other: int) -> tuple[int, ...]:
    """Return what an outside and an inside have that are turned alike, or else the two."""
    outside, inside = outer.originals, inner.originals
    alike = (outside.views.order[row] == inside.views.order[other]).all()
    if alike and (outside.views.frames[row] == inside.views.frames[other]).all():
        return int(outside.which[row]), id(inner), int(inside.which[other])
    return row, id(inner), other, 1


def _along_curves(outer: RoundStruts, inner: RoundStruts) -> Floats:
    """Return the least wall of each curve, (c,), mm, but for pieces at crowded nodes."""
    found = np.full(len(outer.curves.half_runs), np.inf)
    ends = np.stack([outer.curves.nodes[outer.curves.pieces + at] for at in (0, 1)])  # (2, p)
    crowded = outer.crowded | inner.crowded
    pieces = np.flatnonzero(~(crowded[ends] & (ends >= 0)).any(axis=0))
    if len(pieces):
        least = walls_along(inner.curves, outer.curves, pieces).min(axis=1)
        np.minimum.at(found, outer.curves.curve_of_piece[pieces], least)
    return found
