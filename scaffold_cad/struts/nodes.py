"""The blends of nodes: patches that join the collars of a node's struts smoothly, and their proof."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, UnitVectors
from scaffold_cad.base.threads import in_order
from scaffold_cad.base.vectors import any_perpendicular
from scaffold_cad.partition.arcs import side_twins
from scaffold_cad.partition.certificate import corners_of
from scaffold_cad.struts.collars import Collars, collars
from scaffold_cad.struts.distances import Union
from scaffold_cad.struts.evenness import even, phases
from scaffold_cad.struts.joins import types_of
from scaffold_cad.struts.proof import prove
from scaffold_cad.struts.rows import Rings, given_rows, rings
from scaffold_cad.struts.system import Layout, System, system_of

LAYOUT = Layout(1, 1, 6)
SKEW = 1.0
STIFFNESS = (1e-2, 1e-3, 1e-3)
"""Weight of the thin-plate energy in each round."""
FIRST_STEPS, STEPS = 4, 1
"""Newton steps of the first samples, and of those of each round."""
MOMENTUM = 0.7
"""Part of its last move that a sample goes on along the surface."""
BEHIND = 0.5
"""How far a collar stands beyond the corners of its patches, in radii, where there is room."""
BLOCK = 16384
"""Samples treated at once: their arrays stay in the processor's cache."""
SAME = 1e-9
"""Nodes whose numbers agree to this part of their radii are solved once."""


@dataclass(frozen=True, eq=False)
class Stars(Frozen):
    """M branch points of one valency N ≥ 2, everything relative to the node."""

    directions: UnitVectors
    """Direction of each strut, unit vectors, shape (M, N, 3)."""
    radii: Floats
    """Radius of each strut in the plane across it through the node, mm, shape (M, N)."""
    slopes: Floats
    """Growth of each strut's radius along it, mm a mm, shape (M, N)."""
    blends: Floats
    """Fillet radius ρ that is asked for, mm, > 0, shape (M,)."""
    balls: Floats
    """Radius of the node's ball, mm, 0 for none, shape (M,)."""
    most: Floats
    """Greatest collar distance that there is room for, mm, shape (M, N)."""
    vertices: UnitVectors
    """Vertices of the node's partition, unit vectors, shape (M, N + 2, 3)."""
    quads: Ints
    """Vertices of the quad around each strut, counter-clockwise from outside, (M, N, 4)."""

    def __len__(self) -> int:
        return len(self.directions)

    def __getitem__(self, item: Ints) -> Stars:
        return Stars(*(getattr(self, name)[item] for name in self.__dataclass_fields__))


@dataclass(frozen=True, eq=False)
class Blends(Frozen):
    """The blends of M nodes of one valency N. Nodes that are equal share one of U blends."""

    stars: Stars
    """The nodes that were asked for, M."""
    blend_of: Ints
    """Blend of each node, shape (M,)."""
    control: Floats
    """Control points, relative to the node, mm, shape (U, 4 N, D + 1, D + 1, 3).

    Patch 4 i + k lies between arc k of quad i (v = 0) and quarter k of collar i (v = 1).
    """
    twins: Ints
    """Patch that shares the arc of each one, run along the other way, shape (U, 4 N)."""
    vertices: UnitVectors
    """Vertices of the partition as they were moved, shape (U, N + 2, 3)."""
    collar_distances: Floats
    """Distance of each collar from the node, mm, shape (U, N)."""
    collar_radii: Floats
    """Radius of each collar, mm, shape (U, N)."""
    collar_corners: UnitVectors
    """Unit vectors across each strut to the starts of its collar's quarters, (U, N, 4, 3)."""
    rho: Floats
    """Fillet radius that had room, mm, shape (U,)."""
    has_room: Bools
    """Whether collars are as near as asked for, shape (U,)."""
    is_star_shaped: Bools
    """Whether the surface is proved to be star-shaped around the node, shape (U,)."""
    solid_angle: Floats
    """What the surface and its discs cover of the sphere of directions, sr, shape (U,)."""
    misfit: Floats
    """Greatest distance of samples from the filleted union, over the least radius, (U,)."""
    depth: Floats
    """Greatest depth of samples inside the union of the struts, over the least radius, (U,)."""

    @property
    def proved(self) -> Bools:
        """Whether the blend is proved to be free of folds, shape (U,)."""
        covered = np.abs(self.solid_angle - 4 * np.pi) < 1.0
        return np.asarray(self.is_star_shaped & covered & self.has_room)

    @property
    def reach(self) -> Floats:
        """Greatest distance of a control point from the node, mm, shape (U,)."""
        square = np.einsum("upabx,upabx->upab", self.control, self.control)
        return np.asarray(np.sqrt(square.max(axis=(1, 2, 3))))


def blends(stars: Stars) -> Blends:
    """Return the blends of `stars`, equal ones solved once."""
    first, blend_of = _distinct(stars)
    own = stars[first]
    vertices = even(own.directions, own.vertices, own.quads)
    kinds = types_of(own.quads)
    count = 4 * own.directions.shape[1]
    room = max(1, BLOCK // (count * len(LAYOUT.weights)))
    solved: list[tuple[Ints, _Solved]] = []
    for kind in range(len(kinds.twins)):
        members = np.flatnonzero(kinds.type_of == kind)
        systems = [system_of(kinds.twins[kind], LAYOUT, stiffness) for stiffness in STIFFNESS]
        pieces = [members[at : at + room] for at in range(0, len(members), room)]

        def solve(piece: Ints, systems: list[System] = systems) -> tuple[Ints, _Solved]:
            sides = kinds.sides[piece]
            return piece, _solve(own[piece], vertices[piece], sides, systems)

        solved += in_order(solve, pieces)
    order = np.concatenate([piece for piece, _ in solved])
    back = np.argsort(order)
    fields = {
        name: np.concatenate([getattr(part, name) for _, part in solved])[back]
        for name in _Solved.__dataclass_fields__
    }
    return Blends(stars, blend_of, twins=side_twins(own.quads), vertices=vertices, **fields)


def _distinct(stars: Stars) -> tuple[Ints, Ints]:
    """Return one node of each kind of equal nodes, (U,), and the kind of each node, (M,)."""
    scale = SAME * stars.radii.mean(axis=1)
    sizes = [stars.radii, stars.blends, stars.balls, np.minimum(stars.most, 1e6 * scale[:, None] / SAME)]
    shapes = [stars.directions, stars.slopes, stars.vertices]
    rows = [np.rint(each.reshape(len(stars), -1) / scale.mean()) for each in sizes]
    rows += [np.rint(each.reshape(len(stars), -1) / SAME) for each in shapes]
    rows.append(stars.quads.reshape(len(stars), -1).astype(np.float64))
    table = np.concatenate(rows, axis=1) + 0.0  # no -0.0
    keys = np.ascontiguousarray(table).view(np.dtype((np.void, table.shape[1] * 8))).reshape(-1)
    _, first, kind = np.unique(keys, return_index=True, return_inverse=True)
    return first, kind.reshape(-1)


@dataclass(frozen=True, eq=False)
class _Solved:
    """Fields of `Blends` for a part of its nodes."""

    control: Floats
    collar_distances: Floats
    collar_radii: Floats
    collar_corners: UnitVectors
    rho: Floats
    has_room: Bools
    is_star_shaped: Bools
    solid_angle: Floats
    misfit: Floats
    depth: Floats


def _solve(stars: Stars, vertices: UnitVectors, sides: Ints, systems: list[System]) -> _Solved:
    """Return the blends of nodes of one type, whose sides have the numbers `sides` (m, 4 N)."""
    # Struts and corners in the order of the type.
    row, strut, corner = np.arange(len(stars))[:, None], sides[:, ::4] // 4, sides[:, ::4] % 4
    corners = corners_of(vertices, stars.quads)  # (m, N, 4, 3)
    turned = (corner[..., None] + np.arange(4)) % 4
    corners = corners[row[..., None], strut[..., None], turned]
    directions = stars.directions[row, strut]
    frame_x = any_perpendicular(directions)
    frame_y = np.cross(directions, frame_x)
    phase = phases(corners, frame_x, frame_y)
    first = _first(stars, row, strut)
    fitted = collars(first, stars.most[row, strut])
    union = Union(first.directions, first.radii, first.slopes, first.balls, fitted.blends)
    fitted = _longer(union, fitted, corners, stars.most[row, strut])
    ring = rings(union, fitted, _leading(frame_x), _leading(frame_y), phase)
    layout = systems[0].layout
    at = np.concatenate([[0.0, 0.5], layout.at_u])
    arcs = _arcs(_leading(corners), at)  # (3, m, N, 4, n + 2) directions
    on_arcs = union.reached(arcs.reshape(3, len(stars), -1)).reshape(arcs.shape[1:]) * arcs
    rows = _rows(union, fitted, ring, on_arcs[..., :2], layout)
    points = _fitted(union, rows, on_arcs[..., 2:], systems)  # (3, m, count)
    control = points[:, :, systems[0].net.number]  # (3, m, 4 N, n_u, n_v)
    misfit, depth = _errors(union, control, layout)
    control = np.moveaxis(control, 0, -1)
    proof = prove(_pieces(control, layout), fitted.distances, fitted.radii)
    own_control, own_corners = np.empty_like(control), np.empty_like(corners)
    own_control[row, sides] = control
    own_corners[row[..., None], strut[..., None], turned] = np.moveaxis(ring.corners, 0, -1)
    distances, radii = np.empty_like(fitted.distances), np.empty_like(fitted.radii)
    distances[row, strut], radii[row, strut] = fitted.distances, fitted.radii
    least = stars.radii.min(axis=1)
    return _Solved(
        own_control,
        distances,
        radii,
        own_corners,
        fitted.blends,
        fitted.has_room,
        proof.is_star_shaped,
        proof.solid_angle,
        misfit / least,
        depth / least,
    )


def _longer(union: Union, fitted: Collars, corners: UnitVectors, most: Floats) -> Collars:
    """Return the collars moved out to where the corners of their patches lie behind them."""
    flat = _leading(corners.reshape(len(corners), -1, 3))  # (3, m, 4 N)
    points = (union.reached(flat) * flat).reshape(3, *corners.shape[:3])
    along = (points * union.directions[..., None]).sum(axis=0).max(axis=2)  # (m, N)
    distances = np.maximum(fitted.distances, np.minimum(along + BEHIND * fitted.radii, most))
    radii = union.radii + union.slopes * distances
    return Collars(distances, radii, fitted.blends, fitted.has_room)


def _pieces(control: Floats, layout: Layout) -> Floats:
    """Return the Bézier pieces of patches (m, 4 N, n_u, n_v, 3), (m, pieces, D + 1, D + 1, 3)."""
    pieces = np.einsum(
        "aiu,mpuvx,bjv->mpabijx", layout.u.extraction, control, layout.v.extraction, optimize=True
    )
    return np.asarray(pieces.reshape(len(control), -1, *pieces.shape[-3:]))


def _leading(vectors: Floats) -> Floats:
    """Return `vectors` (..., 3) with their coordinates first."""
    return np.ascontiguousarray(np.moveaxis(vectors, -1, 0))


def _first(stars: Stars, row: Ints, strut: Ints) -> Union:
    """Return the union that is asked for, its struts in the order of the type."""
    return Union(
        _leading(stars.directions[row, strut]),
        stars.radii[row, strut],
        stars.slopes[row, strut],
        stars.balls,
        stars.blends,
    )


def _arcs(corners: Floats, at: Floats) -> Floats:
    """Return directions at `at` (n,) on the arcs from `corners` (3, m, N, 4), (3, m, N, 4, n)."""
    start, end = corners[..., None], np.roll(corners, -1, axis=3)[..., None]
    angle = np.arccos(np.clip((start * end).sum(axis=0), -1, 1))
    arcs: Floats = (np.sin((1 - at) * angle) * start + np.sin(at * angle) * end) / np.sin(angle)
    return arcs


def _rows(union: Union, fitted: Collars, ring: Rings, on_arcs: Floats, layout: Layout) -> Floats:
    """Return the given rows among control points (3, m, 4 N, n_u, n_v); the others are 0.

    Parameters
    ----------
    on_arcs : (3, m, N, 4, 2) float64, start and middle of each arc on the surface
    """
    along = (on_arcs * union.directions[..., None, None]).sum(axis=0)  # (m, N, 4, 2)
    lengths = fitted.distances[:, :, None, None] - along
    first = on_arcs[..., 0]
    side = np.cross(union.directions, ring.corners, axis=0) if False else np.stack(
        np.cross(np.moveaxis(np.broadcast_to(union.directions[..., None], first.shape), 0, -1), np.moveaxis(ring.corners, 0, -1)).transpose(3, 0, 1, 2))
    turn = np.arctan2((first * side).sum(axis=0), (first * ring.corners).sum(axis=0))
    turn = -SKEW * fitted.radii[:, :, None] * np.clip(turn, -1.0, 1.0)
    last, before = given_rows(union, fitted, ring, (lengths[..., 0], lengths[..., 1], turn), layout)
    rows = np.zeros((*last.shape, layout.v.count))
    rows[..., -1], rows[..., -2] = last, before
    return rows.reshape(3, last.shape[1], -1, *rows.shape[-2:])


def _fitted(union: Union, rows: Floats, on_arcs: Floats, systems: list[System]) -> Floats:
    """Return the control points (3, m, count) that fit the union."""
    nodes, layout = rows.shape[1], systems[0].layout
    far = np.einsum("ai,xmpi->xmpa", layout.u.values(layout.at), rows[..., -1])[..., None]
    near = on_arcs.reshape(3, nodes, -1, len(layout.at_u))[..., None]
    samples = near + (far - near) * layout.at_v  # (3, m, 4 N, n, n)
    wanted = union.projected(samples.reshape(3, nodes, -1), FIRST_STEPS)
    given = rows.reshape(3, nodes, -1)[:, :, systems[0].given].reshape(3 * nodes, -1)
    for round_, system in enumerate(systems):
        points = wanted.reshape(3 * nodes, -1) @ system.by_sample + given @ system.by_given
        if round_ < len(systems) - 1:
            samples = (points @ system.sampled).reshape(3, nodes, -1)
            ahead = samples + MOMENTUM * (samples - before) if round_ else samples
            before = samples
            wanted = union.projected(ahead, STEPS)
    return points.reshape(3, nodes, -1)


def _errors(union: Union, control: Floats, layout: Layout) -> tuple[Floats, Floats]:
    """Return how far samples are from the filleted union, and how deep in the union, both (m,)."""
    at = (np.arange(6) + 0.5) / 6
    points = layout.u.values(at) @ (control @ layout.v.values(at).T)
    points = points.reshape(3, control.shape[1], -1)
    value, gradient = union.value_and_slope(points)
    size = np.sqrt(np.maximum((gradient**2).sum(axis=0), 0.01))
    return np.abs(value / size).max(axis=1), np.maximum(-union.nearest(points), 0).max(axis=1)
