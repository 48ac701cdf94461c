"""Where a scaffold is embedded: which struts stay apart from the others, edge by edge.

Every strut is a *tube*: its sleeves, closed at both ends toward its nodes. The tubes tile the
inside of the scaffold. No two faces meet outside shared edges if

- each strut leaves each of its nodes within its own cone, the part of space that the spherical
  quad around its direction cuts out (at a joint or an extremity: within its own half-space), and
  its sleeves follow each other in the half-spaces beyond its collars,
- no sleeve crosses itself, and its axis is inside: it is star-shaped around a point of its axis,
  or else found whole by the exact test of its few triangles,
- tubes that share no node keep apart.

A strut that breaks a condition is left out, and the quads that it leaves open at its branch
points are closed by *stubs*, four triangles around a point on its axis. Stubs must keep apart
from what is left as well; a branch point whose stub does not is left out with all its struts.

Every condition is sufficient and none is necessary: what breaks one may still be embedded.

The conditions hold with some room. Where it is more than the rounding to 32-bit coordinates, the
scaffold is embedded in files of these as well.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.arrays import Bools, Edges, Frozen, Ints, Points
from scaffold_cad.base.blocks import cut
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.vectors import dot, length
from scaffold_cad.base.visibility import SINGLE_ROUNDING, in_front, rounding_of
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.scaffold.bodies import Bodies, conflicting
from scaffold_cad.scaffold.collars import Refinement
from scaffold_cad.scaffold.shells import seen_once, solid_angle, whole
from scaffold_cad.scaffold.stars import Stars
from scaffold_cad.skeleton import Skeleton


class Sleeved(Protocol):
    """What a scaffold says of its surface; see the fields of `Scaffold`."""

    @property
    def skeleton(self) -> Skeleton:
        """The skeleton that was asked for."""

    @property
    def refined(self) -> Skeleton:
        """The skeleton with its collars as joints."""

    @property
    def refinement(self) -> Refinement:
        """Where the edges of `refined` come from."""

    @property
    def mesh(self) -> QuadMesh:
        """The quads."""

    @property
    def sleeves(self) -> Ints:
        """Vertices of the sections at both ends of each edge of `refined`, (m', 2, 4)."""

    @property
    def stars(self) -> Stars:
        """The partitions of the branch points."""

    @property
    def thinned(self) -> Ints:
        """Joints where the quads are thinner than the struts, (k,)."""


STAR_CENTERS = (0.5, 0.25, 0.75, 0.1, 0.9, 0.02, 0.98)
"""Where on its axis a sleeve is tried to be star-shaped, as fractions of its length."""

MOST_SLEEVES = 3
"""Most sleeves of a strut, one on each side of a collar."""

STUB_HEIGHT = 0.25
"""Least height of a stub's apex, as a fraction of the distance of its corners from the node."""

SLEEVE_BYTES = 1280
"""What a sleeve takes where it is looked at."""


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Embedding(Frozen):
    """Which struts of a scaffold stay apart from the others.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> build_scaffold(strut).embedding().certified
    True
    """

    within_cone: Bools
    """Whether each strut leaves each of its two nodes within its own cone, shape (m, 2)."""
    uncrossed: Bools
    """Whether no sleeve of each strut crosses itself or its axis, shape (m,)."""
    conflicts: Edges
    """Pairs of struts without a common node that could not be shown to keep apart, (k, 2)."""
    kept: Bools
    """Struts that make an embedded surface with the nodes that are kept, shape (m,)."""
    kept_nodes: Bools
    """Nodes whose sphere keeps apart from all others and from all kept struts, shape (n,)."""
    room: float
    """How far every vertex may be off and all of this still holds, mm."""

    def __str__(self) -> str:
        """Return one line: whether it is certified, or how many struts and nodes are left out."""
        if self.certified:
            return "Embedding: certified"
        nodes = counted(int((~self.kept_nodes).sum()), "node")
        return (
            f"Embedding: {len(self.left_out)} of {counted(len(self.kept), 'strut')} and {nodes} "
            f"left out, {counted(len(self.conflicts), 'pair')} too close"
        )

    @property
    def certified(self) -> bool:
        """Whether the whole scaffold is embedded: no two faces meet outside shared edges."""
        return bool(self.kept.all())

    @property
    def left_out(self) -> Ints:
        """Edges that break a condition, or end at a node that does, ascending."""
        return np.flatnonzero(~self.kept)


def embedding(scaffold: Sleeved) -> Embedding:
    """Return which struts of `scaffold` stay apart from the others.

    If they all do so with room for 32-bit coordinates, it says so; if not, they need no more room
    than for 64-bit ones.

    Notes
    -----
    Linear in the number of struts, but for the pairs of sleeves whose bounding boxes overlap.
    """
    vertices = scaffold.mesh.vertices
    roomy = _of_struts(scaffold, rounding_of(vertices, SINGLE_ROUNDING))
    if roomy.certified:
        return roomy
    return _with_nodes(scaffold, _of_struts(scaffold, rounding_of(vertices)))


def _of_struts(scaffold: Sleeved, rounding: float) -> Embedding:
    """Return which struts stay apart where vertices are off by `rounding`, mm."""
    edge_count = len(scaffold.skeleton.edges)
    within_cone = _within_cones(scaffold, rounding)
    uncrossed = np.ones(edge_count, dtype=np.bool_)
    uncrossed[scaffold.refinement.edge_of_edge[~_uncrossed(scaffold, rounding)]] = False
    kept = within_cone.all(axis=1) & uncrossed

    tubes = tubes_of(scaffold)
    candidates = tubes.only(kept[tubes.owner])
    conflicts = np.unique(candidates.owner[conflicting(candidates, rounding)], axis=0)
    kept[conflicts] = False
    kept_nodes = np.ones(len(scaffold.skeleton.nodes), dtype=np.bool_)
    return Embedding(within_cone, uncrossed, conflicts, kept, kept_nodes, rounding)


def _with_nodes(scaffold: Sleeved, found: Embedding) -> Embedding:
    """Return which nodes keep apart from all that is kept as well, and the struts between them."""
    kept, kept_nodes, tubes = found.kept.copy(), found.kept_nodes.copy(), tubes_of(scaffold)
    while True:
        left_out = np.flatnonzero(~kept)
        bodies = with_stubs(scaffold, tubes.only(kept[tubes.owner]), left_out, kept_nodes)
        meeting = conflicting(bodies, found.room, bodies.node >= 0)
        dropped = np.unique(bodies.node[meeting])
        dropped = dropped[dropped >= 0]
        if len(dropped) == 0:
            return replace(found, kept=kept, kept_nodes=kept_nodes)
        kept_nodes[dropped] = False
        kept &= kept_nodes[scaffold.skeleton.edges].all(axis=1)


def stub_apexes(scaffold: Sleeved, half_edges: Ints) -> Points:
    """Return the point on each half-edge's axis that closes its spherical quad, (k, 3), mm.

    Seen from the node, the four triangles from the sides of the quad to it are positive, as the
    quad is star-shaped around its direction.
    """
    skeleton = scaffold.skeleton
    node = skeleton.nodes[skeleton.edges.reshape(-1)[half_edges]]
    axis = skeleton.directions[half_edges]
    spokes = scaffold.mesh.vertices[scaffold.stars.corners[half_edges]] - node[:, None, :]
    height = dot(spokes, np.broadcast_to(axis[:, None, :], spokes.shape)).mean(axis=1)
    least = STUB_HEIGHT * length(spokes).mean(axis=1)
    apexes: Points = node + np.maximum(height, least)[:, None] * axis
    return apexes


def _within_cones(scaffold: Sleeved, rounding: float) -> Bools:
    """Return whether each strut leaves each of its nodes within its own cone, (m, 2)."""
    skeleton, refined = scaffold.skeleton, scaffold.refined
    vertices = scaffold.mesh.vertices
    # Struts that are thinned at a joint overlap there in full thickness.
    inside = ~np.isin(skeleton.edges.reshape(-1), scaffold.thinned)

    # At branch points: no section of the strut but the first crosses a side plane of the cone.
    edge = scaffold.refinement.edge_of_edge
    for side in (0, 1):
        half_edge = 2 * edge + side  # (m',) of the skeleton
        for part in cut(np.flatnonzero(scaffold.stars.corners[half_edge, 0] >= 0), SLEEVE_BYTES):
            node = skeleton.nodes[skeleton.edges[edge[part], side]][:, None, :]
            quad = vertices[scaffold.stars.corners[half_edge[part]]] - node
            planes = np.cross(quad, np.roll(quad, -1, axis=1))  # (k, 4, 3)
            spread = length(quad)
            spread = spread + np.roll(spread, -1, axis=1)  # (k, 4)
            far = vertices[scaffold.sleeves[part, 1 - side]] - node  # (k, 4, 3)
            fine = in_front(planes, far, spread, rounding).all(axis=(1, 2))
            inside[half_edge[part][~fine]] = False

    # At joints and extremities, collars among them: all of the strut that begins at a section
    # stays in front of it, the sleeve there and those that follow.
    for side, step in ((0, 1), (1, -1)):
        ends = refined.edges[:, side]
        for part in cut(np.flatnonzero(refined.valency[ends] < 3), SLEEVE_BYTES):
            node = refined.nodes[ends[part]][:, None, :]
            section = vertices[scaffold.sleeves[part, side]]
            along, across = section[:, 2] - section[:, 0], section[:, 3] - section[:, 1]
            plane = np.cross(along, across)
            spread = 2.0 * (length(along) + length(across))[:, None]  # (k, 1)
            plane = (plane if side == 0 else -plane)[:, None, :]
            for distance in range(MOST_SLEEVES):
                sleeve = np.clip(part + step * distance, 0, len(edge) - 1)
                far = vertices[scaffold.sleeves[sleeve, 1 - side]] - node
                fine = in_front(plane, far, spread, rounding).all(axis=(1, 2))
                fine |= edge[sleeve] != edge[part]
                inside[2 * edge[part][~fine] + side] = False
    return inside.reshape(-1, 2)


def _uncrossed(scaffold: Sleeved, rounding: float) -> Bools:
    """Return whether each sleeve, closed toward its nodes, holds its axis and is whole, (m',).

    Nearly all are star-shaped around a point of their axis: their triangles are all seen from one
    side and together cover the sphere of directions once.
    """
    refined = scaffold.refined
    start, end = (refined.nodes[refined.edges[:, side]] for side in (0, 1))
    sides = scaffold.mesh.triangles[: 8 * len(refined.edges)].reshape(-1, 8, 3)
    fine = np.zeros(len(refined.edges), dtype=np.bool_)
    for fraction in STAR_CENTERS:
        for part in cut(np.flatnonzero(~fine), SLEEVE_BYTES):
            center = (1 - fraction) * start[part] + fraction * end[part]
            shell = _closed_sleeves(scaffold, part, sides[part])  # (k, 16, 3, 3)
            fine[part] = seen_once(shell - center[:, None, None, :], rounding)
    exact = rounding <= rounding_of(scaffold.mesh.vertices)
    for part in cut(np.flatnonzero(~fine) if exact else np.zeros(0, np.intp), SLEEVE_BYTES):
        shell = _closed_sleeves(scaffold, part, sides[part])
        fine[part] = whole(shell)
        for fraction in STAR_CENTERS:
            center = (1 - fraction) * start[part] + fraction * end[part]
            fine[part] &= solid_angle(shell - center[:, None, None, :]) > 2 * np.pi
    return fine


def _closed_sleeves(scaffold: Sleeved, sleeves: Ints, sides: Ints) -> Points:
    """Return the corners of a sleeve's triangles and of those that close it, (k, 16, 3, 3)."""
    refined, vertices = scaffold.refined, scaffold.mesh.vertices
    triangles = [vertices[sides]]
    for side in (0, 1):
        ring = vertices[scaffold.sleeves[sleeves, side]]  # (k, 4, 3)
        node = np.broadcast_to(refined.nodes[refined.edges[sleeves, side]][:, None, :], ring.shape)
        following = np.roll(ring, -1, axis=1)
        order = [following, ring, node] if side == 0 else [ring, following, node]
        triangles.append(np.stack(order, axis=2))
    return np.concatenate(triangles, axis=1)


def tubes_of(scaffold: Sleeved) -> Bodies:
    """Return each sleeve with its ends closed as a body, one per edge of the refined skeleton."""
    refined, vertices = scaffold.refined, scaffold.mesh.vertices
    edge = scaffold.refinement.edge_of_edge
    axis = refined.nodes[refined.edges]  # (m', 2, 3)
    rings = vertices[scaffold.sleeves]  # (m', 2, 4, 3)
    near, far = rings[:, 0], rings[:, 1]
    # Both triangulations of a side share these normals' directions closely enough to try.
    along = np.roll(far, -1, axis=1) + far - np.roll(near, -1, axis=1) - near
    normals = [np.cross(np.roll(ring, -1, axis=1) - ring, along) for ring in (near, far)]
    return Bodies(
        points=np.concatenate([rings.reshape(-1, 8, 3), axis], axis=1),
        normals=np.concatenate(normals, axis=1),
        axis=axis,
        ends=scaffold.skeleton.edges[edge],
        owner=edge,
        node=np.full(len(edge), -1),
    )


def with_stubs(scaffold: Sleeved, tubes: Bodies, left_out: Ints, kept_nodes: Bools) -> Bodies:
    """Return `tubes` and the stubs of the edges left out, at the branch points that are kept."""
    skeleton = scaffold.skeleton
    half_edges = np.stack([2 * left_out, 2 * left_out + 1], axis=1).reshape(-1)
    tails = skeleton.edges.reshape(-1)
    at_star = (scaffold.stars.corners[half_edges, 0] >= 0) & kept_nodes[tails[half_edges]]
    half_edges = half_edges[at_star]
    node = tails[half_edges]
    quad = scaffold.mesh.vertices[scaffold.stars.corners[half_edges]]  # (k, 4, 3)
    apex = stub_apexes(scaffold, half_edges)
    axis = np.stack([skeleton.nodes[node], apex], axis=1)
    following = np.roll(quad, -1, axis=1)
    center, top = axis[:, :1], axis[:, 1:]
    sides = np.cross(following - center, quad - center)
    caps = np.cross(following - top, quad - top)
    stubs = Bodies(
        points=np.concatenate([quad, axis, quad], axis=1),
        normals=np.concatenate([sides, caps], axis=1),
        axis=axis,
        ends=np.stack([node, node], axis=1),
        owner=half_edges >> 1,
        node=node,
    )
    return Bodies(
        *(
            np.concatenate([getattr(tubes, name), getattr(stubs, name)])
            for name in ("points", "normals", "axis", "ends", "owner", "node")
        )
    )
