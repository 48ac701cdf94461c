"""Fitting the smooth surfaces of one combinatorial type to the filleted unions of their nodes."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, UnitVectors
from scaffold_cad.base.products import row_products
from scaffold_cad.base.vectors import any_perpendicular
from scaffold_cad.partition.certificate import corners_of
from scaffold_cad.struts.blend import Solved, Stars
from scaffold_cad.struts.collars import Collars, collars
from scaffold_cad.struts.distances import Union
from scaffold_cad.struts.evenness import phases
from scaffold_cad.struts.fits import free_of_pulls, patch_fit
from scaffold_cad.struts.layouts import Layout
from scaffold_cad.struts.proof import prove
from scaffold_cad.struts.recipes import FIRST_STEPS, RAY_STEPS, Recipe
from scaffold_cad.struts.rows import Rings, given_rows, rings
from scaffold_cad.struts.system import System, system_of

BEHIND = 0.3
"""How far a collar stands beyond the corners of its patches, in radii, where there is room."""
CHECKED = 6
"""Samples of each piece in either direction at which the fit is measured."""


def solve(stars: Stars, vertices: UnitVectors, sides: Ints, twins: Ints, recipe: Recipe) -> Solved:
    """Return the blends of m nodes of one type.

    Parameters
    ----------
    stars : the nodes
    vertices : (m, N + 2, 3) float64, the vertices of their partitions, moved
    sides : (m, 4 N) intp, each node's own number of each side of the type
    twins : (4 N,) intp, the twin of each side of the type
    recipe : how to fit
    """
    # Struts and corners in the order of the type.
    row, strut, corner = np.arange(len(stars))[:, None], sides[:, ::4] // 4, sides[:, ::4] % 4
    turned = row[..., None], strut[..., None], (corner[..., None] + np.arange(4)) % 4
    corners = corners_of(vertices, stars.quads)[turned]  # (m, N, 4, 3)
    most = stars.most[row, strut]
    union, fitted = _placed(stars, row, strut, most, recipe.swell)
    at = np.concatenate([[0.0, 0.5], recipe.layout.at_u])
    arcs = _arcs(_leading(corners), at)  # (3, m, N, 4, n + 2) directions
    reached = union.reached(arcs.reshape(3, len(stars), -1), RAY_STEPS)
    on_arcs = reached.reshape(arcs.shape[1:]) * arcs
    fitted = _longer(union, fitted, on_arcs[..., 0], most)
    frame_x = any_perpendicular(stars.directions[row, strut])
    frame_y = np.cross(stars.directions[row, strut], frame_x)
    phase = phases(corners, frame_x, frame_y)
    ring = rings(union, fitted, _leading(frame_x), _leading(frame_y), phase)

    system = system_of(twins, recipe.layout)
    rows = _rows(union, fitted, ring, on_arcs[..., :2], system, recipe)
    points = _fitted(union, rows, on_arcs[..., 2:], system, twins, recipe)  # (3, m, count)
    control = points[:, :, system.net.number]  # (3, m, 4 N, n_u, n_v)
    misfit, depth = _errors(union, control, recipe.layout)
    control = np.moveaxis(control, 0, -1)
    proof = prove(_pieces(control, recipe.layout), fitted.distances, fitted.radii)

    own_control, own_corners = np.empty_like(control), np.empty_like(corners)
    own_control[row, sides] = control
    own_corners[turned] = np.moveaxis(ring.corners, 0, -1)
    distances, radii = np.empty_like(fitted.distances), np.empty_like(fitted.radii)
    distances[row, strut], radii[row, strut] = fitted.distances, fitted.radii
    return Solved(
        recipe.layout,
        own_control,
        vertices,
        distances,
        radii,
        own_corners,
        fitted.blends,
        fitted.has_room,
        proof.is_star_shaped,
        proof.solid_angle,
        proof.least_cosine,
        misfit / stars.radii.min(axis=1),
        depth,
    )


def _placed(
    stars: Stars, row: Ints, strut: Ints, most: Floats, swell: float
) -> tuple[Union, Collars]:
    """Return the union in the order of the type, with the ρ that has room, and its collars."""
    directions = _leading(stars.directions[row, strut])
    radii, slopes = stars.radii[row, strut], stars.slopes[row, strut]
    fitted = collars(Union(directions, radii, slopes, stars.balls, swell * stars.blends), most)
    return Union(directions, radii, slopes, stars.balls, fitted.blends), fitted


def _longer(union: Union, fitted: Collars, corners: Floats, most: Floats) -> Collars:
    """Return the collars moved out to where the corners (3, m, N, 4) of patches lie behind them."""
    along = (corners * union.directions[..., None]).sum(axis=0).max(axis=2)  # (m, N)
    distances = np.maximum(fitted.distances, np.minimum(along + BEHIND * fitted.radii, most))
    radii = union.radii + union.slopes * distances
    return Collars(distances, radii, fitted.blends, fitted.has_room)


def _pieces(control: Floats, layout: Layout) -> Floats:
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
    union: Union, fitted: Collars, ring: Rings, on_arcs: Floats, system: System, recipe: Recipe
) -> Floats:
    """Return the given rows among control points (3, m, 4 N, n_u, n_v); the others are 0.

    Parameters
    ----------
    on_arcs : (3, m, N, 4, 2) float64, start and middle of each arc on the surface
    """
    along = (on_arcs * union.directions[..., None, None]).sum(axis=0)  # (m, N, 4, 2)
    lengths = fitted.distances[:, :, None, None] - along
    start, end = ring.corners, np.roll(ring.corners, -1, axis=3)
    halfway = ring.centers[..., None] + fitted.radii[:, :, None] * (start + end) / np.sqrt(2)
    straight = np.sqrt(((on_arcs[..., 1] - halfway) ** 2).sum(axis=0))
    pinch = recipe.pinch
    wanted = lengths[..., 0], pinch * lengths[..., 1] + (1 - pinch) * straight
    last, before = given_rows(union, fitted, ring, wanted, system.shares, recipe.layout)
    rows = np.zeros((*last.shape, recipe.layout.v.count))
    rows[..., -1], rows[..., -2] = last, before
    return rows.reshape(3, last.shape[1], -1, *rows.shape[-2:])


def _fitted(
    union: Union, rows: Floats, on_arcs: Floats, system: System, twins: Ints, recipe: Recipe
) -> Floats:
    """Return the control points (3, m, count) that fit the union.

    Parameters
    ----------
    rows : (3, m, 4 N, n_u, n_v) float64, the given control points
    on_arcs : (3, m, N, 4, n) float64, where the samples in u lie on the arcs
    """
    layout, nodes = recipe.layout, rows.shape[1]
    wanted = _first_samples(union, rows[..., -1], on_arcs, layout)
    patches = rows.reshape(3 * nodes, len(twins), -1)
    known = patches[:, :, layout.given]
    given = patches.reshape(3 * nodes, -1)[:, system.given]
    fixed = given @ system.rim_of_given
    before = None
    for stiffness, rounds in recipe.rounds:
        patch, solving = patch_fit(layout, stiffness), free_of_pulls(twins, layout, stiffness)
        pulled = known @ patch.pulls_of_given + fixed[:, system.rims] @ patch.pulls_of_rim
        still = known @ patch.samples_of_given
        for _ in range(rounds):
            targets = wanted.reshape(3 * nodes, len(twins), -1)
            pulls = targets @ patch.pulls_of_samples + pulled
            rim = (pulls.reshape(3 * nodes, -1) @ solving) @ system.rim_of_free + fixed
            rims = rim[:, system.rims]
            samples = targets @ patch.samples_of_samples + rims @ patch.samples_of_rim + still
            samples = samples.reshape(3, nodes, -1)
            ahead = samples if before is None else samples + recipe.momentum * (samples - before)
            before = samples
            wanted = union.projected(ahead, 1, recipe.urge)
    core = targets @ patch.core_of_samples + rims @ patch.core_of_rim
    core += known @ patch.core_of_given
    points = np.empty((3 * nodes, system.net.count))
    points[:, : system.net.rim + system.net.given] = np.concatenate([rim, given], axis=1)
    points[:, system.net.number.reshape(len(twins), -1)[:, layout.core]] = core
    return points.reshape(3, nodes, -1)


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


def _errors(union: Union, control: Floats, layout: Layout) -> tuple[Floats, Floats]:
    """Return how far samples are from the filleted union, mm, and how deep in a strut, both (m,).

    The depth is that over the strut's radius.
    """
    at = (np.arange(CHECKED) + 0.5) / CHECKED
    points = layout.u.values(at) @ (control @ layout.v.values(at).T)
    points = points.reshape(3, control.shape[1], -1)
    value, gradient = union.value_and_slope(points)
    size = np.sqrt(np.maximum((gradient**2).sum(axis=0), 0.01))
    return np.abs(value / size).max(axis=1), union.deepest(points).max(axis=1)
