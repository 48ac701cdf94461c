"""The control mesh of a smooth solid: the scaffold, moved so that its limit has the asked radii.

The Catmull-Clark limit lies inside the scaffold. It is measured, and the sections of the control
mesh are scaled and shifted until the limit is what the skeleton asks.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np

from scaffold_cad.arrays import Edges, Ints
from scaffold_cad.errors import OptionError
from scaffold_cad.quadmesh import QuadMesh
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.smooth.catmull_clark import (
    NO_CREASES,
    Connectivity,
    limit_points,
    subdivided_points,
)
from scaffold_cad.smooth.rig import Rig, cap_rows, leaving_extremities, make_rig
from scaffold_cad.smooth.targets import Domes, Pose, Spheres, StrutRadii, Target
from scaffold_cad.stars import APOTHEM
from scaffold_cad.vectors import length

Caps: TypeAlias = Literal["round", "flat"]
"""How extremities end: in a dome that reaches one radius beyond the node, or flat at the node."""

RADIUS_TOLERANCE = 0.002
"""Acceptable error of a strut's mean radius, as a part of it."""

PLACE_TOLERANCE = 0.01
"""Acceptable error of the top of a dome and of a branch point's sphere, as a part of the radius."""

MOST_ROUNDS = 12
"""Most times that sections are corrected; collared struts need three."""

STAR_APOTHEM = 0.95
"""As `APOTHEM`, for the vertices of branch points that are to enclose their struts: the blends are
just large enough for the limit to keep to the struts within 8 %."""


@dataclass(frozen=True, eq=False)
class ControlMesh:
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

    The mean radius of the limit in the middle of each strut is the strut's, whatever the
    scaffold's `section`. It is exact where every strut has sections of its own, and so with
    `collars=True`; else struts that share their sections come as near as these allow. The limit
    encloses the spheres of branch points.

    A section is added before each dome, so that it is round, and with `collars=True` on both sides
    of each bend, so that struts are straight up to it; where edges have room for them.

    Parameters
    ----------
    caps : "round" ends each extremity in a dome that reaches one radius beyond its node, "flat"
        in a plane at its node

    Raises
    ------
    OptionError
        If `caps` has none of its values.
    """
    if caps not in get_args(Caps):
        raise OptionError(f"caps is {caps!r}; need one of {', '.join(get_args(Caps))}")
    rig = make_rig(scaffold, domes=caps == "round")
    mesh = QuadMesh(rig.centres + rig.spokes, rig.quads)
    creases = _cap_sides(scaffold) if caps == "flat" else NO_CREASES
    coarse = Connectivity.of(mesh, creases)
    fine = coarse.subdivided()
    targets: list[Target] = [
        _strut_radii(scaffold, rig, coarse),
        _spheres(scaffold, rig, coarse),
    ]
    if caps == "round":
        targets.append(_domes(scaffold, coarse))

    pose = Pose(np.ones(int(rig.group.max(initial=-1)) + 1), np.zeros_like(rig.spokes))
    if scaffold.options.fit == "enclose":
        stars = slice(len(scaffold.stars.vertices))
        pose.scale[stars] = STAR_APOTHEM / APOTHEM[scaffold.options.section]
    for _ in range(MOST_ROUNDS):
        points = rig.centres + pose.shift + pose.scale[rig.group][:, None] * rig.spokes
        limits = limit_points(fine, subdivided_points(coarse, points))
        if max(target.error(limits) for target in targets) < 1:
            break
        for target in targets:
            target.correct(limits, pose)
    return ControlMesh(mesh.moved(points), creases, rig.quad_of_quad)


def _cap_sides(scaffold: Scaffold) -> Edges:
    """Return the vertex pairs of all sides of the caps, (4 k, 2)."""
    caps = scaffold.mesh.quads[cap_rows(scaffold)]
    return np.stack([caps, np.roll(caps, -1, axis=1)], axis=2).reshape(-1, 2)


def _strut_radii(scaffold: Scaffold, rig: Rig, coarse: Connectivity) -> StrutRadii:
    """Return where the radius of each strut of the skeleton is measured.

    On the piece between its collars, or at its only collar if that stands between two branch
    points.
    """
    skeleton, refined = scaffold.skeleton, scaffold.refined
    collared = scaffold.refinement.collared
    pieces = 1 + collared.sum(axis=1)
    # The second of three, and the one of two that leads away from the branch point.
    piece = np.cumsum(pieces) - pieces + collared[:, 0]  # (m,)
    alone = (pieces == 2) & (skeleton.valency[skeleton.edges] >= 3).all(axis=1)

    first_edge, first_quad = coarse.count, coarse.count + len(coarse.edges)
    quads = 4 * piece[:, None] + np.arange(4)  # (m, 4)
    start, rails, end = (first_edge + coarse.edge_of_side[quads, side] for side in (0, 3, 2))
    samples = np.stack(
        [
            np.concatenate([rig.sleeves[piece, 0], start], axis=1),
            np.concatenate([first_quad + quads, rails], axis=1),
            np.concatenate([rig.sleeves[piece, 1], end], axis=1),
        ],
        axis=1,
    )
    ends = rig.sleeves[piece].copy()
    # A lone collar is the start of the second piece or the end of the first.
    at = np.where(collared[alone, 0], 0, 1)
    samples[alone] = samples[alone, 2 * at][:, None]
    ends[alone] = ends[alone, at][:, None]
    collar = refined.edges[piece[alone], at]
    middles = skeleton.nodes[skeleton.edges].mean(axis=1)
    middles[alone] = refined.nodes[collar]
    radii = skeleton.radii[skeleton.edges].mean(axis=1)
    radii[alone] = refined.radii[collar]
    groups = rig.group[ends.reshape(-1, 8)]
    axes = skeleton.directions[::2]
    return StrutRadii(samples, groups, middles, axes, radii, RADIUS_TOLERANCE)


def _domes(scaffold: Scaffold, coarse: Connectivity) -> Domes:
    """Return the domes, whose tops are to be one radius beyond the extremities."""
    refined = scaffold.refined
    nodes, rows = refined.extremities, cap_rows(scaffold)
    outward = -refined.directions[leaving_extremities(scaffold)]
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
