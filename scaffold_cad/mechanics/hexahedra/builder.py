"""Hexahedra of a scaffold: four per edge, which conform at every valency and in every loop.

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
from typing import Literal, TypeAlias, get_args

import numpy as np
from scipy import sparse

from scaffold_cad.base.arguments import (
    as_count,
    as_number,
    check_choice,
    check_kind,
    checks_keywords,
)
from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, Quads
from scaffold_cad.base.summaries import size_text
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.errors import OptionError
from scaffold_cad.mechanics.hexahedra.compensation import compensated
from scaffold_cad.mechanics.hexahedra.placement import scaffold_plan
from scaffold_cad.mechanics.hexahedra.plans import Plan, Span
from scaffold_cad.mechanics.hexahedra.quality import (
    boundary_faces,
    enclosed_volume,
    hexahedron_volumes,
    scaled_jacobians,
)
from scaffold_cad.mechanics.hexahedra.relax import relaxed
from scaffold_cad.mechanics.hexahedra.rounds import round_plan
from scaffold_cad.mechanics.hexahedra.sections import Sections
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.struts import RoundStruts

Keep: TypeAlias = Literal["surface", "volume"]
"""What hexahedra of round struts keep exactly: see `hexahedra`."""


@checks_keywords()
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

    def __str__(self) -> str:
        """Return one line: counts, size, the least scaled Jacobian."""
        return (
            f"Hexahedra: {len(self.hexahedra)} with {len(self.points)} points, "
            f"{size_text(self.points)}, least scaled Jacobian {self.quality.min():.3g}"
        )

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
    struts: Scaffold | RoundStruts,
    *,
    sides: int | None = None,
    layers: int | None = None,
    along: int = 1,
    relax: float = 0.2,
    keep: Keep = "surface",
) -> Hexahedra:
    """Return struts as hexahedra that meet face to face.

    Those of a scaffold have its connectivity, and octagons of the area of the circle for sections;
    at branch points the outer points lie where the struts' surfaces meet. Those of round struts
    have their outer points on the exact surface, or where the volume is exact: of cylinders, cones,
    curves, blends, round ends.

    Parameters
    ----------
    struts : scaffold of any options; with collars the struts between them are straight. Or round
        struts, solid, with blends
    sides : points around a section: 8, 16, 24, ...; 8 for scaffolds, and by default 16 for round
        struts. A section's core is 4 (sides / 8)² hexahedra
    layers : of hexahedra around the core of each strut, `sides` each; 0 by default for scaffolds, 1
        for round struts
    along : pieces that each straight part of a strut is cut into
    relax : least scaled Jacobian that is aimed at: points near worse hexahedra are moved, of round
        struts those inside; 0 moves none
    keep : of round struts: "surface" has the outer points on the exact one, so that the flat faces
        between them lack volume, 2.6 % of a cylinder's with 16 sides; "volume" moves them outward
        by as much as makes up for that, as meshes of round struts do

    Raises
    ------
    OptionError
        If an argument is of another kind or out of its range, or round struts have a wall, sharp
        nodes, or overlap: the node or strut is named with its place.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold, round_struts
    >>> star = Skeleton([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]], [[0, 1], [0, 2], [0, 3]], 1.0)
    >>> mesh = hexahedra(build_scaffold(star))
    >>> len(mesh.hexahedra), bool(mesh.quality.min() > 0.2)
    (12, True)
    >>> bool(hexahedra(round_struts(star)).quality.min() > 0.2)
    True
    >>> rod = round_struts(Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0))
    >>> for keep in ("surface", "volume"):
    ...     print(f"{hexahedra(rod, keep=keep).volumes.sum():.2f} mm³")
    27.55 mm³
    28.27 mm³
    """
    check_kind(struts, Scaffold, RoundStruts)
    pieces = as_count(along, "along", 1)
    goal = as_number(relax, "relax", unit="", or_zero=True)
    check_choice(keep, "keep", get_args(Keep))
    if isinstance(struts, Scaffold):
        around, count = _sides(sides, 8), as_count(layers or 0, "layers")
        if around != 8:
            raise OptionError(f"sides is {around} for a scaffold; need 8, or round struts")
        if keep != "surface":
            raise OptionError(f"keep is {keep!r} for a scaffold; need round struts")
        plan = scaffold_plan(struts, pieces)
    else:
        around = _sides(sides, 16)
        count = 1 if layers is None else as_count(layers, "layers")
        plan = round_plan(struts, around, pieces)
    return _made(plan, count, goal, keep)


def _sides(sides: int | None, usual: int) -> int:
    """Return the points around a section."""
    around = usual if sides is None else as_count(sides, "sides", 8)
    if around % 8:
        raise OptionError(f"sides is {around}; need a multiple of 8")
    return around


def _made(plan: Plan, layers: int, goal: float, keep: Keep) -> Hexahedra:
    """Return the hexahedra of a plan."""
    sections = Sections(plan.frame, layers)
    stations, weights = _stations(plan.spans, sections)
    cells = [_between(each, sections.quads) for each in stations]  # (e, pieces, q, 8) each
    control = plan.control(weights, np.concatenate([each.reshape(-1, 8) for each in cells]), layers)
    places = relaxed(control, plan.frame.controls(layers), goal)
    points = weights @ places
    for span, each in zip(plan.spans, stations, strict=True):
        _make_round(points, each[span.straight])
    edges, nodes = [], []
    for span, each in zip(plan.spans, cells, strict=True):
        edges.append(np.broadcast_to(span.edge[:, None, None], each.shape[:3]).reshape(-1))
        nodes.append(span.nodes_touched(each.shape[2]))
    closing = sections.numbers[plan.closing]
    if plan.caps is not None:
        plan.caps.put_on(points, closing)
    ends = np.full(len(points), -1, dtype=np.intp)
    ends[closing] = plan.closed[:, None]
    if keep == "volume":
        normals = plan.normals(places, points, weights, closing)
        faces = _round_faces(control.hexahedra, np.full_like(ends, -1) if plan.caps else ends)
        points = compensated(points, control.hexahedra, faces, normals, goal)
    return Hexahedra(points, control.hexahedra, np.concatenate(edges), np.concatenate(nodes), ends)


def _round_faces(cells: Ints, flat: Ints) -> Quads:
    """Return the outer faces but for those with all points in one flat end of `flat`, (f, 4)."""
    faces = boundary_faces(cells)
    end = flat[faces]
    kept: Quads = faces[(end[:, 0] < 0) | (end != end[:, :1]).any(axis=1)]
    return kept


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


def _stations(spans: tuple[Span, ...], sections: Sections) -> tuple[list[Ints], sparse.csr_array]:
    """Return the points of all sections of each span, (e, pieces + 1, s), and all points."""
    numbers, weights = sections.numbers, sections.weights
    stations, more = [], [weights]
    count = sections.count
    for span in spans:
        first, last = np.moveaxis(numbers[span.sections], 1, 0)  # (e, s)
        shape = (len(first), span.pieces - 1, first.shape[1])
        share = np.arange(1, span.pieces)[:, None] / span.pieces
        weight = np.broadcast_to(share, shape).reshape(-1)
        near = np.broadcast_to(first[:, None], shape).reshape(-1)
        far = np.broadcast_to(last[:, None], shape).reshape(-1)
        row = np.arange(len(near))
        number = count + row.reshape(shape)
        stations.append(np.concatenate([first[:, None], number, last[:, None]], axis=1))
        count += len(row)
        values = np.concatenate([1.0 - weight, weight])
        places = (np.tile(row, 2), np.concatenate([near, far]))
        matrix = sparse.csr_array((values, places), shape=(len(row), sections.count))
        more.append(matrix @ weights)
    return stations, sparse.csr_array(sparse.vstack(more))


def _between(stations: Ints, quads: Ints) -> Ints:
    """Return the hexahedra between neighboring sections, (e, pieces, q, 8)."""
    faces = stations[:, :, quads]  # (e, pieces + 1, q, 4)
    return np.concatenate([faces[:, :-1], faces[:, 1:]], axis=3)
