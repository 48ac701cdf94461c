"""The control mesh of a smooth solid: the scaffold, moved so that its limit has the asked radii.

The Catmull-Clark limit lies inside the scaffold. It is measured, and the sections of the control
mesh are scaled and shifted until the limit is what the skeleton asks.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np

from scaffold_cad.base.arguments import check_kind
from scaffold_cad.base.arrays import Edges, Frozen, Ints
from scaffold_cad.base.vectors import length
from scaffold_cad.errors import OptionError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.scaffold.stars import APOTHEM
from scaffold_cad.smooth.connectivity import NO_CREASES, Connectivity
from scaffold_cad.smooth.limits import limit_points
from scaffold_cad.smooth.rig import Rig, cap_rows, make_rig
from scaffold_cad.smooth.subdivision import subdivided_points
from scaffold_cad.smooth.targets import Domes, Pose, Rails, RoundStruts, Spheres, StrutRadii, Target

Caps: TypeAlias = Literal["round", "flat"]
"""How extremities end: in a dome that reaches one radius beyond the node, or flat at the node."""

RADIUS_TOLERANCE = 0.002
"""Acceptable error of a strut's radius, as a part of it."""

PLACE_TOLERANCE = 0.01
"""Acceptable error of the top of a dome and of a branch point's sphere, as a part of the radius."""

MOST_ROUNDS = 12
"""Most times that sections are corrected; collared struts need three."""

STAR_APOTHEM = 0.94
"""As `APOTHEM`, for the vertices of branch points that are to enclose their struts: the blends are
just large enough for the limit to keep to the struts within 8 %."""


_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class ControlMesh(Frozen):
    """A closed quad mesh whose Catmull-Clark limit is the smooth solid."""

    mesh: QuadMesh
    """The quads of the scaffold in their order, on moved vertices, and four more for each section
    that was added."""
    creases: Edges
    """Vertex pairs of the edges that stay sharp, around flat caps, shape (k, 2)."""
    quad_of_quad: Ints
    """Scaffold quad that each quad is a part of, shape (f,)."""


def control_mesh(scaffold: Scaffold, caps: Caps = "round") -> ControlMesh:
    """Return the mesh whose Catmull-Clark limit has the radii of the scaffold's skeleton.

    The limit's radius in the middle of each strut is the strut's, whatever the scaffold's
    `section`: within 1 % on average and 2.5 % all around where a strut has sections of its own
    and its middle is clear of the blends, and so on struts 8 radii long with `collars=True`; else
    struts that share sections come as near as these allow.
    The limit encloses the spheres of branch points.

    Four quads are added for a section before each dome, so that it is round, and for one on each
    side of a bend, so that struts are straight up to it and its corner is kept. Bends get them
    where the limit's axis would else pass more than half a radius from the joint, with
    `collars=True` more than a tenth; milder ones are rounded by that much. Sections move closer
    together where edges are short, and are left out where less than a quarter of a radius remains.

    Parameters
    ----------
    caps : "round" ends each extremity in a dome that reaches one radius beyond its node, "flat"
        in a plane at its node

    Raises
    ------
    OptionError
        If `scaffold` is none, or `caps` has none of its values.
    """
    check_kind(scaffold, Scaffold)
    if caps not in get_args(Caps):
        raise OptionError(f"caps is {caps!r}; need one of {', '.join(get_args(Caps))}")
    rig = make_rig(scaffold, domes=caps == "round")
    mesh = QuadMesh(rig.centres + rig.spokes, rig.quads)
    creases = _cap_sides(scaffold) if caps == "flat" else NO_CREASES
    coarse = Connectivity.of(mesh, creases)
    fine = coarse.subdivided()
    targets = [*_struts(scaffold, rig, coarse), _spheres(scaffold, rig, coarse)]
    if caps == "round":
        targets.append(_domes(scaffold, coarse))

    pose = Pose(np.ones(int(rig.group.max(initial=-1)) + 1), np.zeros_like(rig.spokes))
    if scaffold.options.fit == "enclose":
        stars = slice(len(scaffold.stars.vertices))
        pose.scale[stars] = STAR_APOTHEM / APOTHEM[scaffold.options.section]
    least, best = np.inf, rig.centres + rig.spokes
    for _ in range(MOST_ROUNDS):
        points = rig.centres + pose.shift + pose.scale[rig.group][:, None] * rig.spokes
        limits = limit_points(fine, subdivided_points(coarse, points))
        error = max(target.error(limits) for target in targets)
        if error < least:
            least, best = error, points
        if error < 1:
            break
        for target in targets:
            target.correct(limits, pose)
    else:
        _log.debug(
            "the radii are missed by %.3g times what is acceptable after %d rounds",
            least,
            MOST_ROUNDS,
        )
    return ControlMesh(mesh.moved(best), creases, rig.quad_of_quad)


def _cap_sides(scaffold: Scaffold) -> Edges:
    """Return the vertex pairs of all sides of the caps, (4 k, 2)."""
    caps = scaffold.mesh.quads[cap_rows(scaffold)]
    return np.stack([caps, np.roll(caps, -1, axis=1)], axis=2).reshape(-1, 2)


def _struts(scaffold: Scaffold, rig: Rig, coarse: Connectivity) -> list[Target]:
    """Return the radii of the struts of the skeleton as targets.

    Measured on the piece between a strut's collars, or at its only collar if that stands between
    two branch points.
    """
    skeleton, refined = scaffold.skeleton, scaffold.refined
    collared = scaffold.refinement.collared
    pieces = 1 + collared.sum(axis=1)
    # The second of three, and the one of two that leads away from the branch point.
    piece = np.cumsum(pieces) - pieces + collared[:, 0]  # (m,)
    alone = (pieces == 2) & (skeleton.valency[skeleton.edges] >= 3).all(axis=1)
    middles = skeleton.nodes[skeleton.edges].mean(axis=1)
    radii = skeleton.radii[skeleton.edges].mean(axis=1)
    slopes = np.diff(skeleton.radii[skeleton.edges])[:, 0] / skeleton.lengths
    rails = coarse.count + coarse.edge_of_side[4 * piece[:, None] + np.arange(4), 3]  # (m, 4)
    ends = rig.sleeves[piece]  # (m, 2, 4)
    # A lone collar is the start of the second piece or the end of the first.
    at = np.where(collared[alone, 0], 0, 1)
    collar = refined.edges[piece[alone], at]
    middles[alone], radii[alone] = refined.nodes[collar], refined.radii[collar]
    rails[alone] = ends[alone, at]
    ends[alone] = ends[alone, at][:, None]
    samples = np.stack([ends[:, 0], rails, ends[:, 1]], axis=1)  # (m, 3, 4)

    axes = skeleton.directions[::2]
    is_own = rig.is_own[ends[:, :, 0]].all(axis=1)
    round_ones, others = (
        Rails(samples[rows], middles[rows], axes[rows], radii[rows], slopes[rows])
        for rows in (is_own, ~is_own)
    )
    # A strut's vertices and those that are scaled with them, a dome's.
    rail_of_group = np.full(len(rig.centres), -1)
    rail_of_group[rig.group[ends[is_own]]] = np.arange(4 * is_own.sum()).reshape(-1, 1, 4)
    rail = rail_of_group[rig.group]
    moved = np.flatnonzero(rail >= 0)
    rail, size = rail[moved], length(rig.spokes[moved])
    share = size * np.bincount(rail)[rail] / np.bincount(rail, size)[rail]
    return [
        RoundStruts(round_ones, moved, rail, share, RADIUS_TOLERANCE),
        StrutRadii(others, rig.group[ends[~is_own]], RADIUS_TOLERANCE),
    ]


def _domes(scaffold: Scaffold, coarse: Connectivity) -> Domes:
    """Return the domes, whose tops are to be one radius beyond the extremities."""
    refined = scaffold.refined
    nodes, rows = refined.extremities, cap_rows(scaffold)
    outward = -refined.directions[refined.leaving_extremities]
    return Domes(
        caps=scaffold.mesh.quads[rows],
        tops=coarse.count + len(coarse.edges) + rows,
        wanted=refined.nodes[nodes] + refined.radii[nodes][:, None] * outward,
        tolerance=PLACE_TOLERANCE * refined.radii[nodes],
    )


def _spheres(scaffold: Scaffold, rig: Rig, coarse: Connectivity) -> Spheres:
    """Return the spheres of the branch points."""
    stars = slice(len(scaffold.stars.vertices))
    valence = coarse.valence[stars]
    return Spheres(
        centres=rig.centres[stars],
        radii=scaffold.refined.radii[scaffold.node_of_vertex[stars]],
        # The weight of a vertex in its own limit.
        gain=valence / (valence + 5) * length(rig.spokes[stars]),
        tolerance=PLACE_TOLERANCE,
    )
