"""Bevels: sections beside sharp bends, so that struts keep their thickness up to the joint.

At a gentle bend one section in the bisecting plane is a miter, and both struts keep their own
section up to it. The miter of a sharp bend would stand far out. There the outside of the bend is
cut in three, by a further section across each strut, and the inside stays where the struts meet.
The corners of the further sections lie on the edges of their struts: between them and the far end
a strut is the prism, or the pyramid, that it would be alone.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, field, fields, replace
from typing import TypeVar

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.vectors import any_perpendicular, dot, length, normalize
from scaffold_cad.scaffold.collars import (
    RESOLUTION,
    Refinement,
    sharp_bends,
    split_edges,
    strut_radii,
)
from scaffold_cad.scaffold.sleeves import MITER_LIMIT
from scaffold_cad.skeleton import Skeleton

BEYOND = 0.25
"""How far from the inside of the bend the section across a strut begins, in radii."""

LEAST_ROOM = 0.05
"""Least distance between that section and the far end of its strut, in radii."""

MOST_TAKEN = 0.49
"""Most of a strut's axis that lies before the section across it."""

_log = logging.getLogger(__name__)

_T = TypeVar("_T", "_Bends", "_Rings")


@dataclass(frozen=True, eq=False)
class Sleeving(Frozen):
    """The sections of a scaffold and how sleeves join them."""

    refinement: Refinement
    """The skeleton with all further sections as joints."""
    vertices: Points
    """Vertices, shape (v, 3), mm."""
    sleeves: Ints
    """Vertices of the sections at both ends of each refined edge, shape (m', 2, 4)."""
    thinned: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    """Joints at sharp bends whose struts are too short for a bevel, ascending, shape (k,)."""


@dataclass(frozen=True, eq=False)
class _Bends:
    """Joints seen from inside of their bends; the two half-edges that leave each make axis 1."""

    node: Ints
    """Nodes, shape (j,)."""
    place: Points
    """Where they are, shape (j, 3), mm."""
    half_edge: Ints
    """Half-edges that leave them, shape (j, 2)."""
    corner: Ints
    """Vertices of the joint's section, in the order of each half-edge's sleeve, (j, 2, 4)."""
    away: UnitVectors
    """Directions of the half-edges, shape (j, 2, 3)."""
    inward: UnitVectors
    """Direction midway between both, shape (j, 3)."""
    side: UnitVectors
    """Direction across the plane of the bend, shape (j, 3)."""
    half: Floats
    """Half the angle between the half-edges, rad, shape (j,)."""
    out: Floats
    """How far each corner of the strut's square lies to the outside, in radii, (j, 2, 4)."""
    up: Floats
    """How far along `side`, in radii, shape (j, 2, 4)."""
    radius: Floats
    """Radius of each strut at the joint, mm, shape (j, 2)."""
    slope: Floats
    """Growth of that radius along the half-edge, shape (j, 2)."""
    room: Floats
    """Lengths of the half-edges, mm, shape (j, 2)."""

    @property
    def third(self) -> Floats:
        """A third of the way's turn, rad: that of each corner on its outside, (j,)."""
        third: Floats = (np.pi - 2.0 * self.half) / 3.0
        return third

    @property
    def most(self) -> Floats:
        """Largest of `out` and of -`out`, (j, 1)."""
        most: Floats = np.maximum(np.abs(self.out[:, 0]).max(axis=1, keepdims=True), 1e-3)
        return most

    def meeting(self, inner: Floats) -> tuple[Floats, Floats]:
        """Return where the edges of both struts meet inside the bend.

        Parameters
        ----------
        inner : (j, c) float64, how far they lie to the inside of their axes, in radii

        Returns
        -------
        (j, c, 2) float64, along `inward` and toward the first strut, from the joint, and
        (j, 2, c) float64, how far along each strut that is, mm; infinite where the struts grow so
        fast that they never meet
        """
        cosine, sine = np.cos(self.half), np.sin(self.half)
        along = np.array([[cosine, sine], [cosine, -sine]]).transpose(2, 0, 1)  # (j, 2, 2)
        across = np.array([[sine, -cosine], [sine, cosine]]).transpose(2, 0, 1)
        growth = self.slope[:, None, :] * inner[:, :, None]  # (j, c, 2)
        planes = across[:, None] - growth[..., None] * along[:, None]  # (j, c, 2, 2)
        wide = np.linalg.det(planes) > 1e-9
        planes[~wide] = np.eye(2)
        sizes = self.radius[:, None, :] * inner[:, :, None]
        place = np.linalg.solve(planes, sizes[..., None])[..., 0]
        reach = np.einsum("jci,jhi->jhc", place, along)
        return place, np.where(wide[:, None], reach, np.inf)


@dataclass(frozen=True, eq=False)
class _Rings:
    """Plane sections across the struts of bends."""

    start: Floats
    """Where their planes cut the axes, from the joint, mm, shape (j, 2)."""
    center: Points
    """The same as points, shape (j, 2, 3), mm."""
    normal: UnitVectors
    """Normals of the planes, away from the joint, shape (j, 2, 3)."""
    corners: Points
    """Corners, in the order of each half-edge's sleeve, shape (j, 2, 4, 3), mm."""


def with_bevels(skeleton: Skeleton, made: Sleeving, like: Bools | None = None) -> Sleeving:
    """Return the sections of a scaffold with bevels at its sharp bends; they come last.

    A bend is sharp where its miter would exceed `MITER_LIMIT`. One whose struts are too short for
    a bevel is left as it is, and a warning is logged.

    Parameters
    ----------
    skeleton : the one that was asked for
    made : the sections with miters at all joints
    like : (m, 2) bool; exactly the joints at these ends get a bevel, squeezed where room is short
    """
    refined = made.refinement.skeleton
    joints = refined.joints
    pairs = refined.incidence.at_nodes(joints, 2)  # (j, 2)
    sharp = sharp_bends(refined)[joints]
    asked = sharp
    if like is not None:
        kept = np.zeros(2 * len(refined.edges), dtype=np.bool_)
        kept[made.refinement.leaving] = like.reshape(-1)
        asked = np.asarray(kept[pairs].all(axis=1))
    if not (sharp | asked).any():
        return made
    bends = _bends(made, strut_radii(skeleton, made.refinement), joints[asked], pairs[asked])
    rings = _rings(bends)
    fits = _fits(made, bends, rings)
    if like is None:
        thinned = bends.node[~fits]
        _warn(bends, ~fits)
        bends, rings = _only(bends, fits), _only(rings, fits)
    else:
        thinned = np.sort(np.concatenate([joints[sharp & ~asked], bends.node[~fits]]))
    vertices = made.vertices.copy()
    vertices[bends.corner[:, 0]] = _middle(bends, refined.radii[bends.node])
    mitered = replace(made, vertices=vertices, thinned=thinned)
    return _inserted(mitered, strut_radii(skeleton, made.refinement), bends, rings)


def _bends(made: Sleeving, radii: Floats, node: Ints, half_edge: Ints) -> _Bends:
    """Return the bends at joints, with the squares that their mitered sections come from.

    Parameters
    ----------
    radii : (m', 2) float64, of each strut at the ends of each refined edge, mm
    """
    refined = made.refinement.skeleton
    away = refined.directions[half_edge]  # (j, 2, 3)
    both, apart = away.sum(axis=1), away[:, 0] - away[:, 1]
    across = normalize(apart)
    straight = length(both)[:, None] < 1e-9
    inward = np.where(straight, any_perpendicular(across), normalize(both))
    side = np.cross(across, inward)
    corner = made.sleeves[half_edge >> 1, half_edge & 1]  # (j, 2, 4)
    spokes = made.vertices[corner] - refined.nodes[node][:, None, None]
    spokes = spokes / refined.radii[node][:, None, None, None]
    widening = 1.0 / np.maximum(length(apart) / 2.0, 1.0 / MITER_LIMIT)
    room = refined.lengths[half_edge >> 1]
    near, far = radii.reshape(-1)[half_edge], radii.reshape(-1)[half_edge ^ 1]
    return _Bends(
        node=node,
        place=refined.nodes[node],
        half_edge=half_edge,
        corner=corner,
        away=away,
        inward=inward,
        side=side,
        half=np.arctan2(length(apart), length(both)),
        out=-np.einsum("jhci,ji->jhc", spokes, inward) / widening[:, None, None],
        up=np.einsum("jhci,ji->jhc", spokes, side),
        radius=near,
        slope=(far - near) / room,
        room=room,
    )


def _rings(bends: _Bends) -> _Rings:
    """Return the sections across both struts of each bend.

    A plane cuts the strut beyond the point where both meet on the inside, and on the outside
    where the way around the joint has made a third of its turn. Corners lie in it and on the
    edges of the strut.
    """
    radius, slope, most = bends.radius, bends.slope, bends.most
    outer = -most * radius * np.tan(bends.third / 2)[:, None]  # (j, 2), from the joint
    inner = bends.meeting(most)[1][:, :, 0] + BEYOND * radius
    inner = np.minimum(inner, 2.0 * MOST_TAKEN * bends.room)
    low = most * np.maximum(radius + slope * inner, LEAST_ROOM * radius)
    high = most * np.maximum(radius + slope * outer, LEAST_ROOM * radius)
    tilt = (inner - outer) / (low + high)
    start = np.clip(inner - tilt * low, 1e-3 * bends.room, MOST_TAKEN * bends.room)

    # Across the strut, in the plane of the bend and to its outside, (j, 2, 3).
    outward = np.cos(bends.half)[:, None, None] * bends.away - bends.inward[:, None]
    outward = normalize(outward)
    lean = tilt[:, :, None] * bends.out  # (j, 2, 4)
    along = start[:, :, None] - lean * radius[:, :, None]
    along = along / np.maximum(1.0 + lean * slope[:, :, None], LEAST_ROOM)
    size = radius[:, :, None] + slope[:, :, None] * along
    across = (
        bends.out[..., None] * outward[:, :, None] + bends.up[..., None] * bends.side[:, None, None]
    )
    corners = along[..., None] * bends.away[:, :, None] + size[..., None] * across
    return _Rings(
        start=start,
        center=bends.place[:, None] + start[..., None] * bends.away,
        normal=normalize(bends.away + tilt[..., None] * outward),
        corners=bends.place[:, None, None] + corners,
    )


def _middle(bends: _Bends, radius: Floats) -> Points:
    """Return the corners of the section between both struts of each bend, (j, 4, 3), mm.

    On the inside they lie where the edges of the struts meet, on the outside opposite to that.
    They are in the order of the first half-edge's sleeve.

    Parameters
    ----------
    radius : (j,) float64, of the nodes, mm
    """
    out, up = bends.out[:, 0], bends.up[:, 0]  # (j, 4)
    place, reach = bends.meeting(np.maximum(-out, 0.0))
    reach = np.clip(reach, 0.0, bends.room[:, :, None])
    size = (bends.radius[:, :, None] + bends.slope[:, :, None] * reach).max(axis=1)
    size = np.where(out < 0, size, radius[:, None])
    far = np.maximum(out, 0.0) * (radius / np.cos(bends.third / 2))[:, None]
    inmost = bends.meeting(bends.most)[0][:, 0]  # (j, 2)
    place = place - far[..., None] * (inmost / np.hypot(*inmost.T)[:, None])[:, None]
    toward = normalize(bends.away[:, 0] - bends.away[:, 1])
    corners = place[..., :1] * bends.inward[:, None] + place[..., 1:] * toward[:, None]
    corners += (size * up)[..., None] * bends.side[:, None]
    section: Points = bends.place[:, None] + corners
    return section


def _fits(made: Sleeving, bends: _Bends, rings: _Rings) -> Bools:
    """Return at which bends both sections keep apart from the far ends of their struts, (j,)."""
    refined = made.refinement.skeleton
    far_edge, far_slot = bends.half_edge >> 1, 1 - (bends.half_edge & 1)
    number = np.full(2 * len(refined.edges), -1, dtype=np.intp)
    number[bends.half_edge.reshape(-1)] = np.arange(bends.half_edge.size)
    facing = number[bends.half_edge ^ 1]  # (j, 2), -1 where the far end is not one of `bends`
    corners = rings.corners.reshape(-1, 4, 3)
    section = made.vertices[made.sleeves[far_edge, far_slot]]  # (j, 2, 4, 3)
    section = np.where((facing >= 0)[..., None, None], corners[facing], section)

    least = LEAST_ROOM * bends.radius
    ahead = _heights(section, rings.center, rings.normal)
    normal = normalize(
        np.cross(section[:, :, 2] - section[:, :, 0], section[:, :, 3] - section[:, :, 1])
    )
    normal *= np.where(far_slot == 0, 1.0, -1.0)[..., None]  # toward the bend
    behind = _heights(rings.corners, section.mean(axis=2), normal)
    plane = refined.valency[refined.edges[far_edge, far_slot]] < 3
    fits = (ahead > least) & ((behind > least) | ~plane)
    fits &= bends.meeting(bends.most)[1][:, :, 0] < bends.room
    coordinates = np.abs(refined.nodes[refined.edges[far_edge]]).max(axis=(2, 3))  # (j, 2)
    fits &= rings.start > RESOLUTION * coordinates
    return np.asarray(fits.all(axis=1))


def _heights(points: Points, foot: Points, normal: UnitVectors) -> Floats:
    """Return the least height of points (..., 4, 3) over planes, (...)."""
    heights: Floats = dot(points - foot[..., None, :], normal[..., None, :]).min(axis=-1)
    return heights


def _warn(bends: _Bends, tight: Bools) -> None:
    """Log which bends are too sharp for their struts."""
    if not tight.any():
        return
    first = int(np.argmax(tight))
    place = ", ".join(f"{x:g}" for x in bends.place[first])
    _log.warning(
        "%s too sharply for the length of the struts, as at [%s] mm, where struts of %.3g and "
        "%.3g mm meet at %.3g°: quads are thinner there (to_solid unites these struts instead)",
        counted(int(tight.sum()), "joint bends", "joints bend"),
        place,
        *bends.room[first],
        np.degrees(2.0 * bends.half[first]),
    )


def _only(values: _T, rows: Bools) -> _T:
    """Return the `rows` of all fields."""
    return type(values)(*(getattr(values, of.name)[rows] for of in fields(values)))


def _inserted(made: Sleeving, radii: Floats, bends: _Bends, rings: _Rings) -> Sleeving:
    """Return the scaffold's sections with those across struts among them."""
    refined, sleeves = made.refinement.skeleton, made.sleeves
    half_edge = bends.half_edge.reshape(-1)
    order = np.argsort(half_edge)  # in which new joints are numbered
    share = np.full(2 * len(refined.edges), np.nan)
    share[half_edge] = (rings.start / bends.room).reshape(-1)
    share[1::2] = 1.0 - share[1::2]

    stops = np.full((len(refined.edges), 4, 4), -1, dtype=np.intp)  # edge, stop, corner
    stops[:, 0], stops[:, 3] = sleeves[:, 0], sleeves[:, 1]
    new = len(made.vertices) + np.arange(4 * len(half_edge)).reshape(-1, 4)
    stops[half_edge[order] >> 1, 1 + (half_edge[order] & 1)] = new
    there = stops[:, :, 0] >= 0
    owner = np.broadcast_to(np.arange(len(stops))[:, None], there.shape)[there]
    flat = stops[there]
    joined = owner[:-1] == owner[1:]
    corners = rings.corners.reshape(-1, 4, 3)[order].reshape(-1, 3)
    refinement = split_edges(made.refinement, share.reshape(-1, 2), radii)
    return Sleeving(
        refinement=replace(refinement, beveled=refinement.collared & ~made.refinement.collared),
        vertices=np.concatenate([made.vertices, corners]),
        sleeves=np.stack([flat[:-1], flat[1:]], axis=1)[joined],
        thinned=made.thinned,
    )
