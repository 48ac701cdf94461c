"""The solid of a beam lattice: cones between circles, spheres, balls, clipping, as 3MF has them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Points
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.vectors import any_perpendicular
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.skeleton.beams import BUTT, BeamLattice
from scaffold_cad.solid import manifolds
from scaffold_cad.solid.cleaning import FaultySurfaceError, clean_surface

if TYPE_CHECKING:
    from manifold3d import Manifold

GOLDEN_ANGLE = np.pi * (3 - np.sqrt(5))
"""Turn between neighboring struts, and balls, that keeps their faces out of common planes, rad."""

TURNS = (0.0, 0.1, 0.23, 0.37, 0.71)
"""Turns of all sections about their axes, rad; the first that gives a clean union counts."""


INSET = 0.05
"""How far prisms begin at most inside the balls at their ends, in radii, which makes struts 1/800
thinner there: ends that stand in the plane of a face of a mesh would leave gaps of rounding."""

SHORT = 1 / 8
"""How far at most, in lengths of the beam."""


def beam_solid(lattice: BeamLattice, sides: int, flat_joints: bool) -> Manifold:
    """Return the solid of a beam lattice: its beams and balls, clipped, and the mesh beside them.

    Sections have the area of the circles that they stand for, and balls the volume of the spheres.

    Parameters
    ----------
    lattice : its clip and its mesh are a TriangleMesh each, or None
    sides : of the beams
    flat_joints : whether beams with flat ends have them where they meet others too, see
        `assembly_solid`

    Raises
    ------
    MeshError
        If a mesh is not closed, or every union tried crosses itself.
    MissingBackendError
        If manifold3d is not installed.
    """
    solids = (manifolds.union([], _pieces(lattice, sides, flat_joints, turn)) for turn in TURNS)
    return _first_clean(lattice, solids)


def strut_solid(lattice: BeamLattice, struts: Manifold, sides: int) -> Manifold:
    """Return what `beam_solid` does, with a solid of struts that is made already for the beams.

    Parameters
    ----------
    lattice : its clip and its mesh are a TriangleMesh each, or None
    struts : with the ends and nodes that they have; its balls are united with them
    sides : of the balls' polygons

    Raises
    ------
    MeshError
        If a mesh is not closed, or every union tried crosses itself.
    MissingBackendError
        If manifold3d is not installed.
    """
    if not lattice.balls.any():
        alone = lattice.clip is None and lattice.mesh is None
        return struts if alone else _first_clean(lattice, [struts])
    hulls = (_hulls(lattice.skeleton.nodes, lattice.balls, sides, turn) for turn in TURNS)
    return _first_clean(lattice, (manifolds.union([struts], [*balls]) for balls in hulls))


def _with_meshes(lattice: BeamLattice, beams: Manifold) -> Manifold:
    """Return a solid of beams, cut by the lattice's clip, and united with its mesh."""
    if lattice.clip is not None:
        clip = manifolds.to_manifold(lattice.clip)
        beams = beams ^ clip if lattice.clipping == "inside" else beams - clip
    return beams if lattice.mesh is None else beams + manifolds.to_manifold(lattice.mesh)


def _first_clean(lattice: BeamLattice, beams: Iterable[Manifold]) -> Manifold:
    """Return the first solid of beams that has a clean surface with its meshes, or is empty."""
    fault: FaultySurfaceError | None = None
    for each in beams:
        solid = _with_meshes(lattice, each)
        if solid.is_empty():
            return solid
        try:
            return manifolds.to_manifold(clean_surface(solid))
        except FaultySurfaceError as error:
            fault = error
    raise MeshError(
        f"the union of {counted(len(lattice.skeleton.edges), 'beam')} {fault}; need a clean surface"
    )


def united(parts: list[Manifold]) -> Manifold:
    """Return the union of solids.

    Raises
    ------
    MeshError
        If it crosses itself.
    """
    import manifold3d

    if len(parts) == 1:
        return parts[0]
    solid = manifold3d.Manifold.batch_boolean(parts, manifold3d.OpType.Add)
    if solid.is_empty():
        return solid
    try:
        return manifolds.to_manifold(clean_surface(solid))
    except FaultySurfaceError as error:
        raise MeshError(f"the union of {len(parts)} solids {error}; need a clean surface") from None


def solid_of_mesh(mesh: TriangleMesh) -> Manifold:
    """Return a closed mesh as a solid.

    Raises
    ------
    MeshError
        If it is not closed, or not outward.
    """
    return manifolds.to_manifold(mesh)


def _pieces(lattice: BeamLattice, sides: int, flat_joints: bool, turn: float) -> list[Points]:
    """Return the corners of a prism along each beam and of a ball at each node that has one."""
    skeleton = lattice.skeleton
    ends, count = skeleton.edges, len(skeleton.edges)
    axis = skeleton.directions[::2]
    angle = turn + GOLDEN_ANGLE * np.arange(count)[:, None] + 2 * np.pi / sides * np.arange(sides)
    x = any_perpendicular(axis)
    y = np.cross(axis, x)
    ring = np.cos(angle)[:, :, None] * x[:, None] + np.sin(angle)[:, :, None] * y[:, None]
    # A section has the area of its circle.
    widths = skeleton.edge_radii * np.sqrt(
        2 * np.pi / (sides * np.sin(2 * np.pi / sides))
    )  # (m, 2)
    inset = _insets(lattice, flat_joints)  # (m, 2)
    along = np.stack([inset[:, 0], 1 - inset[:, 1]], axis=1)[:, :, None]
    start, end = skeleton.nodes[ends[:, :1]], skeleton.nodes[ends[:, 1:]]  # (m, 1, 3)
    centers = (1 - along) * start + along * end  # (m, 2, 3)
    sizes = (1 - along) * widths[:, :1, None] + along * widths[:, 1:, None]
    sections = sizes[..., None] * ring[:, None]  # (m, 2, sides, 3)
    prisms = (centers[:, :, None] + sections).reshape(-1, 2 * sides, 3)
    return [*prisms, *_balls(lattice, sides, flat_joints, turn)]


def _insets(lattice: BeamLattice, flat_joints: bool) -> Floats:
    """Return how far each end of a prism is inside the ball there, in its length, (m, 2)."""
    skeleton = lattice.skeleton
    # No two beams alike, or their ends would be in common planes.
    spread = 0.5 + 0.5 * np.mod(GOLDEN_ANGLE * np.arange(len(skeleton.edges)), 1.0)
    inset = INSET * spread[:, None] * skeleton.edge_radii / skeleton.lengths[:, None]
    return np.where(_flat_ends(lattice, flat_joints), 0.0, np.minimum(inset, SHORT))


def _flat_ends(lattice: BeamLattice, flat_joints: bool) -> Bools:
    """Return which ends of beams stay flat, (m, 2)."""
    flat: Bools = lattice.caps == BUTT
    if not flat_joints:
        flat &= lattice.skeleton.valency[lattice.skeleton.edges] == 1
    return flat


def _balls(lattice: BeamLattice, sides: int, flat_joints: bool, turn: float) -> Points:
    """Return the corners of a ball at each node that has one, the largest of its spheres."""
    skeleton = lattice.skeleton
    radii = lattice.balls.copy()
    rounded = np.where(_flat_ends(lattice, flat_joints), 0.0, skeleton.edge_radii)
    np.maximum.at(radii, skeleton.edges.reshape(-1), rounded.reshape(-1))
    return _hulls(skeleton.nodes, radii, sides, turn)


def _hulls(places: Points, radii: Floats, sides: int, turn: float) -> Points:
    """Return the corners of a ball at each of the places (n, 3) whose radius is > 0, (k, p, 3)."""
    nodes = np.flatnonzero(radii > 0)
    angle = turn + GOLDEN_ANGLE * np.arange(len(nodes))
    unit = _unit_ball(sides)
    turned = np.stack(
        [
            np.cos(angle)[:, None] * unit[:, 0] - np.sin(angle)[:, None] * unit[:, 1],
            np.sin(angle)[:, None] * unit[:, 0] + np.cos(angle)[:, None] * unit[:, 1],
            np.broadcast_to(unit[:, 2], (len(nodes), len(unit))),
        ],
        axis=2,
    )
    corners: Points = places[nodes, None] + radii[nodes, None, None] * turned
    return corners


def _unit_ball(sides: int) -> Points:
    """Return points whose convex hull has the volume of the unit sphere, shape (p, 3)."""
    import manifold3d

    count = sides**2 // 2
    height = 1 - (2 * np.arange(count) + 1) / count
    angle = GOLDEN_ANGLE * np.arange(count)
    across = np.sqrt(1 - height**2)
    points: Floats = np.stack([across * np.cos(angle), across * np.sin(angle), height], axis=1)
    volume = manifold3d.Manifold.hull_points(points).volume()
    larger: Points = points * np.cbrt(4 / 3 * np.pi / volume)
    return larger
