"""Hexahedra of a scaffold: four an edge, which conform at every valency and in every loop.

At a node with center C each side (v, w) of a section, or arc of a partition, gets one point m
outside it. The faces (C, v, m, w) are each shared by the two struts that share the side: so the
struts' hexahedra, from the four faces of one end to those of the other, meet face to face.

References
----------
Viville, Kraemer, Bechmann, Hexahedral mesh generation for tubular shapes using skeletons and
connection surfaces, GRAPP 2021.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from scaffold_cad.base.arguments import as_count, as_number, check_kind, checks_keywords
from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, Quads
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.mechanics.hexplacement import Sides, section_sides, surface_points
from scaffold_cad.mechanics.hexquality import (
    boundary_faces,
    enclosed_volume,
    hexahedron_volumes,
    scaled_jacobians,
)
from scaffold_cad.mechanics.hexrelax import Control, relaxed
from scaffold_cad.scaffold import Scaffold

CORE = 0.55
"""How far out the core of a section with layers reaches, in radii."""


@dataclass(frozen=True, eq=False)
class Hexahedra(Frozen):
    """A conforming mesh of hexahedra, and what each of them belongs to."""

    points: Points
    """Shape (p, 3), mm."""
    hexahedra: Ints
    """Corners of each, shape (k, 8): four counter-clockwise about the strut's direction, then the
    four across from them, as VTK and meshio order them."""
    edge_of_hexahedron: Ints
    """Edge of the skeleton that each belongs to, shape (k,)."""
    node_of_hexahedron: Ints
    """Branch point that each touches, -1 where it touches none, shape (k,)."""
    end_of_point: Ints
    """Extremity of the skeleton in whose end face each point lies, -1 for others, shape (p,)."""

    @cached_property
    def quality(self) -> Floats:
        """Least scaled Jacobian at the corners of each, in -1..1, shape (k,); > 0 is usable."""
        return scaled_jacobians(self.points, self.hexahedra)

    @cached_property
    def volumes(self) -> Floats:
        """Volume of each, shape (k,), mm³."""
        return hexahedron_volumes(self.points, self.hexahedra)

    @cached_property
    def boundary(self) -> Quads:
        """Outer faces, counter-clockwise seen from outside, shape (f, 4)."""
        return boundary_faces(self.hexahedra)

    @property
    def enclosed_volume(self) -> float:
        """Volume inside the outer faces, mm³: equal to the sum of `volumes`."""
        return enclosed_volume(self.points, self.boundary)

    @property
    def inverted(self) -> Ints:
        """Hexahedra with a scaled Jacobian that is not > 0."""
        return np.flatnonzero(self.quality <= 0)


@checks_keywords()
def hexahedra(
    scaffold: Scaffold, *, layers: int = 0, along: int = 1, relax: float = 0.2
) -> Hexahedra:
    """Return round struts as hexahedra, with the connectivity of the scaffold.

    Sections are octagons of the area of the circle; at branch points the outer points lie where
    the struts' surfaces meet.

    Parameters
    ----------
    scaffold : of any options; with collars the struts between them are straight
    layers : of hexahedra around the core of each strut; without any, four hexahedra a section
    along : pieces that each straight part of a strut is cut into
    relax : least scaled Jacobian that is aimed at: points near worse hexahedra are moved; 0
        moves none

    Raises
    ------
    OptionError
        If an argument is of another kind or out of its range.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold
    >>> star = Skeleton([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]], [[0, 1], [0, 2], [0, 3]], 1.0)
    >>> mesh = hexahedra(build_scaffold(star))
    >>> len(mesh.hexahedra), bool(mesh.quality.min() > 0.2)
    (12, True)
    """
    check_kind(scaffold, Scaffold)
    count = as_count(layers, "layers")
    pieces = as_count(along, "along", 1)
    goal = as_number(relax, "relax", unit="", or_zero=True)
    sides = section_sides(scaffold)
    rings, spread = _rings(scaffold, sides, count)
    sections, weights = _stations(rings, spread, pieces)
    cells = _between(sections, _section_quads(count))  # (m', k, 8)
    control = Control(weights, cells.reshape(-1, 8), *_movable(scaffold, sides))
    points = weights @ relaxed(control, surface_points(scaffold, sides), goal)
    _make_round(
        points, sections[(scaffold.refined.valency[scaffold.refined.edges] < 3).all(axis=1)]
    )
    per_edge = cells.shape[1]
    return Hexahedra(
        points=points,
        hexahedra=control.hexahedra,
        edge_of_hexahedron=np.repeat(scaffold.refinement.edge_of_edge, per_edge),
        node_of_hexahedron=_nodes_touched(scaffold, per_edge, per_edge // pieces),
        end_of_point=_end_points(scaffold, sections, len(points)),
    )


def sets_by_owner(prefix: str, owner: Ints) -> dict[str, Ints]:
    """Return the items of each owner that is not -1 by a name."""
    order = np.argsort(owner, kind="stable")
    kept = order[owner[order] >= 0]
    owners, first = np.unique(owner[kept], return_index=True)
    parts = np.split(kept, first[1:]) if len(owners) else []
    return {f"{prefix}_{one}": part for one, part in zip(owners.tolist(), parts, strict=True)}


def _make_round(points: Points, sections: Ints) -> None:
    """Move the points between the ends of straight parts to their distances from the axis.

    Sections twist from one end to the other: straight lines between them would make a waist.

    Parameters
    ----------
    sections : (e, stations, s) intp, points of each section, its center first
    """
    count = sections.shape[1]
    if count < 3 or len(sections) == 0:
        return
    start, end = points[sections[:, 0, 0]], points[sections[:, -1, 0]]  # (e, 3)
    axis = normalize(end - start)[:, None]

    def around(station: int) -> tuple[Points, Points, Floats]:
        center = (start + (end - start) * (station / (count - 1)))[:, None]  # (e, 1, 3)
        offsets = points[sections[:, station]] - center  # (e, s, 3)
        across = offsets - dot(offsets, np.broadcast_to(axis, offsets.shape))[..., None] * axis
        return points[sections[:, station]] - across, across, length(across)

    near, far = around(0)[2], around(count - 1)[2]  # (e, s)
    for station in range(1, count - 1):
        share = station / (count - 1)
        foot, across, distance = around(station)
        wanted = (1.0 - share) * near + share * far
        off_axis = distance > 1e-6 * wanted.max(axis=1, keepdims=True)
        scale = np.divide(wanted, distance, out=np.zeros_like(wanted), where=off_axis)
        points[sections[:, station]] = foot + scale[..., None] * across


def _nodes_touched(scaffold: Scaffold, per_edge: int, per_piece: int) -> Ints:
    """Return the branch point that each hexahedron touches, -1 for none, (k,)."""
    refined = scaffold.refined
    branch = np.where(refined.valency[refined.edges] >= 3, refined.edges, -1)  # (m', 2)
    node = np.full((len(branch), per_edge), -1, dtype=np.intp)
    node[:, :per_piece] = branch[:, :1]
    last = node[:, per_edge - per_piece :]
    last[:] = np.where(branch[:, 1:] >= 0, branch[:, 1:], last)
    return node.reshape(-1)


def _end_points(scaffold: Scaffold, sections: Ints, count: int) -> Ints:
    """Return the extremity in whose end face each point lies, -1 for none, (count,)."""
    refined = scaffold.refined
    ends = np.full(count, -1, dtype=np.intp)
    for slot, station in ((0, 0), (1, -1)):
        closing = np.flatnonzero(refined.valency[refined.edges[:, slot]] == 1)
        ends[sections[closing, station]] = refined.edges[closing, slot][:, None]
    return ends


def _movable(scaffold: Scaffold, sides: Sides) -> tuple[Bools, Floats]:
    """Return which corners, middles and centers may move, and by how much.

    Those of branch points may, by their radii: sections of struts stay circles.
    """
    refined = scaffold.refined
    owner = np.concatenate([scaffold.node_of_vertex, sides.node, np.arange(len(refined.nodes))])
    return refined.valency[owner] >= 3, refined.radii[owner]


def _rings(scaffold: Scaffold, sides: Sides, layers: int) -> tuple[Ints, sparse.csr_array]:
    """Return the points of each section, and these as combinations of control points.

    Control points are corners, middles of sides, centers. A section's points, (m', 2, s), are the
    center, then from the inside out four corners and four middles a ring.
    """
    corners, middles = len(scaffold.node_of_vertex), len(sides.node)
    rim, centers = corners + middles, len(scaffold.refined.nodes)
    owner = np.concatenate([scaffold.node_of_vertex, sides.node])
    factors = np.linspace(CORE, 1.0, layers + 1) if layers else np.ones(1)
    flat = np.repeat(factors, rim)
    row = centers + np.arange(len(flat))
    inside = np.flatnonzero(flat < 1.0)
    spread = sparse.csr_array(
        (
            np.concatenate([np.ones(centers), flat, 1.0 - flat[inside]]),
            (
                np.concatenate([np.arange(centers), row, row[inside]]),
                np.concatenate(
                    [
                        rim + np.arange(centers),
                        np.tile(np.arange(rim), layers + 1),
                        rim + owner[inside % rim],
                    ]
                ),
            ),
        ),
        shape=(centers + len(flat), rim + centers),
    )
    first = centers + rim * np.arange(layers + 1)[:, None, None, None]
    around = np.concatenate([scaffold.sleeves, corners + sides.of_end], axis=2)  # (m', 2, 8)
    numbers = (first + around).transpose(1, 2, 0, 3).reshape(len(around), 2, -1)
    return np.concatenate([scaffold.refined.edges[:, :, None], numbers], axis=2), spread


def _section_quads(layers: int) -> Ints:
    """Return the quads of a section by its points, counter-clockwise, (4 + 8 layers, 4)."""
    turn = np.arange(4)
    following = (turn + 1) % 4
    core = np.stack([0 * turn, 1 + turn, 5 + turn, 1 + following], axis=1)
    quads = [core]
    for layer in range(layers):
        inside, outside = 1 + 8 * layer, 9 + 8 * layer
        pairs = [(turn, turn + 4), (turn + 4, following)]
        quads += [
            np.stack([inside + a, outside + a, outside + b, inside + b], axis=1) for a, b in pairs
        ]
    return np.concatenate(quads)


def _stations(rings: Ints, spread: sparse.csr_array, pieces: int) -> tuple[Ints, sparse.csr_array]:
    """Return the points of all sections of each edge, (m', pieces + 1, s), and all points."""
    if pieces == 1:
        return rings, spread
    share = np.arange(1, pieces)[:, None] / pieces
    shape = (len(rings), pieces - 1, rings.shape[2])
    near = np.broadcast_to(rings[:, None, 0], shape).reshape(-1)
    far = np.broadcast_to(rings[:, None, 1], shape).reshape(-1)
    weight = np.broadcast_to(share, shape).reshape(-1)
    row = np.arange(len(near))
    between = sparse.csr_array(
        (np.concatenate([1.0 - weight, weight]), (np.tile(row, 2), np.concatenate([near, far]))),
        shape=(len(near), spread.shape[0]),
    )
    number = spread.shape[0] + row.reshape(shape)
    sections = np.concatenate([rings[:, :1], number, rings[:, 1:]], axis=1)
    return sections, sparse.csr_array(sparse.vstack([spread, between @ spread]))


def _between(sections: Ints, quads: Ints) -> Ints:
    """Return the hexahedra between neighboring sections, (m', pieces · q, 8)."""
    faces = sections[:, :, quads]  # (m', pieces + 1, q, 4)
    cells = np.concatenate([faces[:, :-1], faces[:, 1:]], axis=3)
    return cells.reshape(len(sections), -1, 8)
