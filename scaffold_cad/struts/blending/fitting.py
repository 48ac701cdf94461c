"""Fitting smooth surfaces to the filleted unions of their nodes, those of many types at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, UnitVectors
from scaffold_cad.base.frames import square_phases
from scaffold_cad.base.vectors import any_perpendicular
from scaffold_cad.partition.certificate import corners_of
from scaffold_cad.struts.blending.blend import Solved, Stars
from scaffold_cad.struts.blending.collars import Collars, collars
from scaffold_cad.struts.blending.curves import share
from scaffold_cad.struts.blending.depths import misfit
from scaffold_cad.struts.blending.distances import Union
from scaffold_cad.struts.blending.fits import TypeFit
from scaffold_cad.struts.blending.joins import valences
from scaffold_cad.struts.blending.layouts import Layout
from scaffold_cad.struts.blending.proof import prove
from scaffold_cad.struts.blending.recipes import AIM, FIRST_STEPS, RAY_STEPS, Recipe, Stage
from scaffold_cad.struts.blending.rows import Rings, given_rows, rings
from scaffold_cad.struts.blending.system import net_of

BEHIND = 0.3
"""How far a collar stands beyond the corners of its patches, in radii, where there is room."""


@dataclass(frozen=True, eq=False)
class Turned(Frozen):
    """Nodes of one valency by their types, their struts and corners in the order of the type."""

    stars: Stars
    """The nodes, with struts in their own order."""
    vertices: UnitVectors
    """Vertices of the partitions, moved, shape (m, N + 2, 3)."""
    sides: Ints
    """Each node's own number of each side of its type, shape (m, 4 N)."""
    parts: tuple[tuple[slice, Ints], ...]
    """The nodes of each type, and the twin of each of its sides, (4 N,)."""

    @property
    def struts(self) -> tuple[Ints, Ints]:
        """What takes an array (m, N, ...) to the order of the type."""
        return np.arange(len(self.stars))[:, None], self.sides[:, ::4] // 4

    @property
    def corners(self) -> tuple[Ints, Ints, Ints]:
        """What takes an array (m, N, 4, ...) to the order of the type."""
        row, strut = self.struts
        first = self.sides[:, ::4] % 4
        return row[..., None], strut[..., None], (first[..., None] + np.arange(4)) % 4


def collars_of(stars: Stars, swell: float) -> Collars:
    """Return the collars of nodes, and the ρ that has room, for ρ times `swell`."""
    return collars(union_of(stars, swell * stars.blends), stars.most)


def solve(turned: Turned, fitted: Collars, recipe: Recipe, begun: Solved | None = None) -> Solved:
    """Return the blends of m nodes.

    Parameters
    ----------
    turned : the nodes
    fitted : their collars, in their own order of struts
    recipe : how to fit
    begun : their blends of the same vertices and collars from which to begin
    """
    stars, own_order = turned.stars, turned.struts
    corners = corners_of(turned.vertices, stars.quads)[turned.corners]  # (m, N, 4, 3)
    most, directions = stars.most[own_order], stars.directions[own_order]
    union = Union(
        _leading(directions),
        stars.radii[own_order],
        stars.slopes[own_order],
        stars.balls,
        fitted.blends,
    )
    fitted = replace(fitted, distances=fitted.distances[own_order], radii=fitted.radii[own_order])
    first = recipe.stages[0].layout
    at = np.concatenate([[0.0, 0.5], first.at_u if recipe.is_fitted else first.u.middles])
    arcs = _arcs(_leading(corners), at)  # (3, m, N, 4, n + 2) directions
    reached = union.reached(arcs.reshape(3, len(stars), -1), RAY_STEPS)
    on_arcs = reached.reshape(arcs.shape[1:]) * arcs
    fitted = _longer(union, fitted, on_arcs[..., 0], most)
    ring = _rings(union, fitted, directions, corners)
    given = partial(_rows, union, fitted, ring, on_arcs[..., :2], _shares(turned), recipe.pinch)
    if not recipe.is_fitted:
        control = _ruled(given(first), on_arcs[..., 2:], turned, first)
    elif begun is None:
        wanted = _first_samples(union, given(first)[..., -1], on_arcs[..., 2:], first)
        control = _fitted(union, given, wanted, turned, recipe)  # (3, m, 4 N, n_u, n_v)
    else:
        control = np.moveaxis(begun.control[own_order[0], turned.sides], -1, 0)
        wanted = _resampled(union, control, begun.layout, first)
        control = _fitted(union, given, wanted, turned, recipe)
    off = misfit(union, control, recipe.layout)
    control = np.moveaxis(control, 0, -1)
    proof = prove(pieces_of_patches(control, recipe.layout), fitted.distances, fitted.radii)

    return Solved(
        recipe.layout,
        _in_own_order(control, (own_order[0], turned.sides)),
        turned.vertices,
        _in_own_order(fitted.distances, own_order),
        _in_own_order(fitted.radii, own_order),
        _in_own_order(np.moveaxis(ring.corners, 0, -1), turned.corners),
        fitted.blends,
        fitted.has_room,
        proof.is_star_shaped,
        proof.solid_angle,
        proof.least_cosine,
        off.distance / stars.radii.min(axis=1),
        off.bulge / stars.radii.min(axis=1),
        off.depth,
    )


def _in_own_order(values: Floats, order: tuple[Ints, ...]) -> Floats:
    """Return values in the order of the type as nodes have them, given what took them there."""
    own = np.empty_like(values)
    own[order] = values
    return own


def union_of(stars: Stars, blends: Floats) -> Union:
    """Return the filleted unions of nodes, with ρ of `blends` (M,), mm."""
    return Union(_leading(stars.directions), stars.radii, stars.slopes, stars.balls, blends)


def _rings(union: Union, fitted: Collars, directions: UnitVectors, corners: UnitVectors) -> Rings:
    """Return the circles of collars, with their corners where those of spherical quads are.

    Parameters
    ----------
    directions : (m, N, 3) float64
    corners : (m, N, 4, 3) float64
    """
    frame_x = any_perpendicular(directions)
    frame_y = np.cross(directions, frame_x)
    phase = square_phases(corners, frame_x, frame_y)
    return rings(union, fitted, _leading(frame_x), _leading(frame_y), phase)


def _shares(turned: Turned) -> Floats:
    """Return 2 cos(2π/n) at the corners of patches, n of which meet there, (m, N, 4)."""
    shares = np.empty((len(turned.stars), turned.sides.shape[1] // 4, 4))
    for part, twins in turned.parts:
        shares[part] = share(valences(twins)).reshape(-1, 4)
    return shares


def _longer(union: Union, fitted: Collars, corners: Floats, most: Floats) -> Collars:
    """Return the collars moved out to where the corners (3, m, N, 4) of patches lie behind them."""
    along = (corners * union.directions[..., None]).sum(axis=0).max(axis=2)  # (m, N)
    distances = np.maximum(fitted.distances, np.minimum(along + BEHIND * fitted.radii, most))
    radii = union.radii + union.slopes * distances
    return Collars(distances, radii, fitted.blends, fitted.has_room)


def pieces_of_patches(control: Floats, layout: Layout) -> Floats:
    """Return the Bézier pieces of patches (m, 4 N, n_u, n_v, 3), (m, pieces, D + 1, D + 1, 3)."""
    if layout.along_arc == layout.along_strut == 1:
        return control
    pieces = np.einsum(
        "aiu,mpuvx,bjv->mpabijx", layout.u.extraction, control, layout.v.extraction, optimize=True
    )
    return np.asarray(pieces.reshape(len(control), -1, *pieces.shape[-3:]))


def _leading(vectors: Floats) -> Floats:
    """Return `vectors` (..., 3) with their coordinates first."""
    return np.ascontiguousarray(np.moveaxis(vectors, -1, 0))


def _arcs(corners: Floats, at: Floats) -> Floats:
    """Return directions at `at` (n,) on the arcs from `corners` (3, m, N, 4), (3, m, N, 4, n)."""
    start, end = corners[..., None], np.roll(corners, -1, axis=3)[..., None]
    angle = np.arccos(np.clip((start * end).sum(axis=0), -1, 1))
    arcs: Floats = (np.sin((1 - at) * angle) * start + np.sin(at * angle) * end) / np.sin(angle)
    return arcs


def _rows(
    union: Union,
    fitted: Collars,
    ring: Rings,
    on_arcs: Floats,
    shares: Floats,
    pinch: float,
    layout: Layout,
) -> Floats:
    """Return the given rows among control points (3, m, 4 N, n_u, n_v); the others are 0.

    Parameters
    ----------
    on_arcs : (3, m, N, 4, 2) float64, start and middle of each arc on the surface
    shares : (m, N, 4) float64, see `given_rows`
    """
    along = (on_arcs * union.directions[..., None, None]).sum(axis=0)  # (m, N, 4, 2)
    lengths = fitted.distances[:, :, None, None] - along
    start, end = ring.corners, np.roll(ring.corners, -1, axis=3)
    halfway = ring.centers[..., None] + fitted.radii[:, :, None] * (start + end) / np.sqrt(2)
    straight = np.sqrt(((on_arcs[..., 1] - halfway) ** 2).sum(axis=0))
    wanted = lengths[..., 0], pinch * lengths[..., 1] + (1 - pinch) * straight
    last, before = given_rows(union, fitted, ring, wanted, shares, layout)
    rows = np.zeros((*last.shape, layout.v.count))
    rows[..., -1], rows[..., -2] = last, before
    return rows.reshape(3, last.shape[1], -1, *rows.shape[-2:])


def _ruled(rows: Floats, on_arcs: Floats, turned: Turned, layout: Layout) -> Floats:
    """Return the control points (3, m, 4 N, n_u, n_v) of patches straight from arcs to collars.

    Nothing is fitted and no system is made: neighbors share their rims, and that is all.

    Parameters
    ----------
    rows : (3, m, 4 N, n_u, n_v) float64, with the given rows
    on_arcs : (3, m, N, 4, n_u) float64, points of the union on the arcs
    """
    near = on_arcs.reshape(*rows.shape[:3], -1)[..., None]
    inner = rows.shape[-1] - 2
    control = rows.copy()
    control[..., :inner] = near + (rows[..., -2:-1] - near) * (np.arange(inner) / inner)
    for part, twins in turned.parts:
        number = net_of(twins, layout).number
        shared = np.empty((*rows[:, part].shape[:2], int(number.max()) + 1))
        shared[..., number] = control[:, part]
        control[:, part] = shared[..., number]
    return control


def _fitted(
    union: Union,
    given: Callable[[Layout], Floats],
    wanted: Floats,
    turned: Turned,
    recipe: Recipe,
) -> Floats:
    """Return the control points (3, m, 4 N, n_u, n_v) that fit the union.

    Parameters
    ----------
    given : returns the given control points (3, m, 4 N, n_u, n_v) of a layout
    wanted : (3, m, samples of all patches) float64, the first samples
    """
    control, layout = np.empty(0), recipe.stages[0].layout
    for stage in recipe.stages:
        if stage.layout != layout:
            wanted = _resampled(union, control, layout, stage.layout)
        layout = stage.layout
        rows = given(layout)
        fits = [TypeFit(twins, layout, rows[:, part]) for part, twins in turned.parts]
        parts = [part for part, _ in turned.parts]
        _settle(union, list(zip(fits, parts, strict=True)), wanted, stage, recipe)
        control = np.concatenate([fit.control() for fit in fits], axis=1)
    return control


def _settle(
    union: Union,
    fits: list[tuple[TypeFit, slice]],
    wanted: Floats,
    stage: Stage,
    recipe: Recipe,
) -> None:
    """Fit to wanted samples (3, m, S), and to where they are moved, as a stage says.

    Samples that are deep inside a strut are lifted more each round, until they are not: the
    multipliers of a condition on one side.
    """
    before, planes, lift, number = None, None, None, 0
    for stiffness, rounds in stage.rounds:
        for fit, _ in fits:
            fit.stiffen(stiffness)
        for _ in range(rounds):
            samples = np.concatenate([fit.samples(wanted[:, part]) for fit, part in fits], axis=1)
            ahead = samples if before is None else samples + recipe.momentum * (samples - before)
            before = samples
            if planes is None or number % recipe.kept == 0:
                if not stage.lifted:
                    planes = union.planes_at(ahead)
                else:
                    planes, more = union.planes_and_excess(ahead, AIM)
                    lift = np.maximum(more if lift is None else lift + more, 0.0)
            wanted = planes.reached(ahead, recipe.urge, lift)
            number += 1


def _first_samples(union: Union, last: Floats, on_arcs: Floats, layout: Layout) -> Floats:
    """Return samples on the union between arcs and collars, (3, m, samples of all patches).

    Parameters
    ----------
    last : (3, m, 4 N, n_u) float64, the control points on the collars
    on_arcs : (3, m, N, 4, n) float64, where the samples in u lie on the arcs
    """
    far = np.einsum("ai,xmpi->xmpa", layout.u.values(layout.at), last)[..., None]
    near = on_arcs.reshape(*last.shape[:3], -1)[..., None]
    samples = near + (far - near) * layout.at_v  # (3, m, 4 N, n, n)
    return union.projected(samples.reshape(3, last.shape[1], -1), FIRST_STEPS)


def _resampled(union: Union, control: Floats, was: Layout, layout: Layout) -> Floats:
    """Return samples for a layout of surfaces of another one, moved to the union, (3, m, S)."""
    samples = was.u.values_at(layout.at_u) @ (control @ was.v.values_at(layout.at_v).T)
    return union.projected(samples.reshape(3, control.shape[1], -1), 1)
