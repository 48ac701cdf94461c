"""G1 patches: the surface of given degree nearest the Catmull-Clark limit without a crease.

Two patches f and g meet smoothly along their common curve e(u) if their slopes across it, both
inwards, add up to α(u) e'(u). With α of degree 2 and coefficients 2 cos(2π/n₀), 0, −2 cos(2π/n₁),
n₀ and n₁ the valences of the edge's ends, the tangents at a vertex of valence n are an affine image
of those of a regular n-gon, and the condition is linear: d + 2 equations an edge.

Among all surfaces that meet them the one is taken whose distance from the limit surface is least,
in the norm that adds the thin-plate energy of the difference to its square: no wiggles beyond those
of the limit. It is one sparse linear system for all three coordinates.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import block_array, coo_array, csr_array, diags_array
from scipy.sparse.linalg import splu

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points
from scaffold_cad.brep.bernstein import elevation, product, square_norm, thin_plate
from scaffold_cad.brep.g1.alike import alike_parts
from scaffold_cad.brep.g1.bicubic import smooth_valence
from scaffold_cad.brep.g1.controlnet import ControlNet

CLOSENESS = 1e3
"""Weight of the square of the distance from the limit surface against its thin-plate energy."""

REGULARIZATION = 1e-8
"""What makes the scaled system quasi-definite: some of the equations depend on others."""

REFINEMENTS = 3
"""Solutions of the system, each for what the ones before left over."""


@dataclass(frozen=True, eq=False)
class G1System:
    """The equations of smooth joins over a control net, and what they leave free.

    Patches whose vertices are all regular join smoothly as they are, and keep their control points
    and those beside them: between them the rest falls into parts that do not depend on each other.
    The system of a part depends on its connectivity only: parts that are alike are solved at once.
    """

    net: ControlNet
    """The control points."""
    is_flat: Bools
    """Whether each patch is a part of a flat cap and stays as it is, shape (f,)."""

    @cached_property
    def is_irregular(self) -> Bools:
        """Whether a vertex of each patch has not valence 4, shape (f,)."""
        connectivity = self.net.connectivity
        is_extraordinary = smooth_valence(connectivity) != 4
        irregular = np.asarray(is_extraordinary[connectivity.quads].any(axis=1))
        if self.net.degree < 5:
            # Not free enough beside patches that do not move.
            near = np.zeros(connectivity.count, dtype=np.bool_)
            near[connectivity.quads[irregular]] = True
            irregular = np.asarray(near[connectivity.quads].any(axis=1))
        irregular[self.is_flat] = False
        return irregular

    @cached_property
    def is_free(self) -> Bools:
        """Whether each control point may move."""
        free = np.zeros(self.net.count, dtype=np.bool_)
        free[self.net.of_patch[self.is_irregular]] = True
        free[self.net.of_patch[~self.is_irregular]] = False
        sides = self.net.connectivity.sides_of_edge[~self.net.connectivity.is_crease]
        for here, there in ((0, 1), (1, 0)):
            held = sides[~self.is_irregular[sides[:, there] >> 2], here]
            free[self.net.beside(held, 1)] = False
        return free

    def solved(self, near: Points) -> Points:
        """Return the control points (count, 3) of the smooth surface nearest to those of `near`."""
        points = near.copy()
        for parts in alike_parts(np.flatnonzero(self.is_irregular), self._twins, self._marks):
            table = self.net.seen_from(parts.sides)  # (p, q, (d + 1)²)
            _, first, place = np.unique(table[0], return_index=True, return_inverse=True)
            points_of_part = table.reshape(len(table), -1)[:, first]  # (p, n)
            free = np.flatnonzero(self.is_free[points_of_part[0]])
            place = place.reshape(table[0].shape)
            equations = self._equations(parts.sides[0], points_of_part[0])
            energy = _energy(self.net.degree, place, len(first))
            values = near[points_of_part].transpose(1, 0, 2).reshape(len(first), -1)
            change = _least_change(energy[free][:, free], equations[:, free], -(equations @ values))
            moved = change.reshape(len(free), -1, 3).transpose(1, 0, 2)
            points[points_of_part[:, free]] += moved
        return points

    @cached_property
    def _twins(self) -> Ints:
        """Side of an irregular patch that each side must join smoothly; -1 for none, (4 f,)."""
        connectivity = self.net.connectivity
        alone = ~self.is_irregular[connectivity.twin >> 2]
        alone |= connectivity.is_crease[connectivity.edge_of_side].reshape(-1)
        return np.where(alone, -1, connectivity.twin)

    @cached_property
    def _marks(self) -> Ints:
        """What the equations and the free points beside each side depend on, (4 f,)."""
        connectivity = self.net.connectivity
        corner = connectivity.quads.reshape(-1)
        marks = 2 * smooth_valence(connectivity)[corner] + self.is_free[corner]
        marks = 2 * marks + connectivity.is_crease[connectivity.edge_of_side].reshape(-1)
        return np.where(self._twins < 0, -1 - marks, marks)

    def _equations(self, sides: Ints, points: Ints) -> csr_array:
        """Return the equations of smooth joins between the patches with `sides` (q,), (k, n).

        Parameters
        ----------
        points : (n,) intp, the control points that the columns stand for, ascending
        """
        connectivity, degree = self.net.connectivity, self.net.degree
        all_sides = ((sides & ~3)[:, None] + np.arange(4)).reshape(-1)
        twin = self._twins[all_sides]
        one = all_sides[twin > all_sides]  # of the two sides of each edge
        curve = self.net.beside(one, 0)  # (k, d + 1)
        left = self.net.beside(one, 1)
        right = self.net.beside(self._twins[one], 1)[:, ::-1]

        valence = smooth_valence(connectivity)[curve[:, [0, -1]]]  # (k, 2)
        # Exactly 0 at regular vertices: some equations are there between fixed points only.
        share = np.where(valence == 4, 0.0, 2 * np.cos(2 * np.pi / valence))
        alpha = np.stack([share[:, 0], np.zeros(len(one)), -share[:, 1]], axis=1)
        along = product(alpha, degree - 1) @ np.diff(np.eye(degree + 1), axis=0)
        raised = np.broadcast_to(elevation(degree, degree + 1), along.shape)
        values = np.concatenate([raised, raised, -2 * raised - along], axis=2)
        columns = np.searchsorted(points, np.concatenate([left, right, curve], axis=1))
        return _sparse(values, columns, len(points))


def _sparse(rows: Floats, columns: Ints, count: int) -> csr_array:
    """Return the matrix of `rows` (k, r, c), whose entries stand in `columns` (k, c), (k r, n)."""
    blocks, height, _ = rows.shape
    row = np.arange(blocks * height).reshape(blocks, height, 1)
    row = np.broadcast_to(row, rows.shape)
    column = np.broadcast_to(columns[:, None, :], rows.shape)
    matrix = coo_array(
        (rows.reshape(-1), (row.reshape(-1), column.reshape(-1))), shape=(blocks * height, count)
    ).tocsr()
    matrix.eliminate_zeros()
    return matrix


def _energy(degree: int, place: Ints, count: int) -> csr_array:
    """Return the norm of changes of `count` control points, (count, count).

    Parameters
    ----------
    place : (q, (d + 1)²) intp, which of them each of q patches has
    """
    block = thin_plate(degree) + CLOSENESS * square_norm(degree)
    shape = (*place.shape, place.shape[1])
    row = np.broadcast_to(place[:, :, None], shape).reshape(-1)
    column = np.broadcast_to(place[:, None, :], shape).reshape(-1)
    values = np.broadcast_to(block, shape).reshape(-1)
    return coo_array((values, (row, column)), shape=(count, count)).tocsr()


def _least_change(energy: csr_array, equations: csr_array, missing: Floats) -> Floats:
    """Return the x (n, m) of least xᵀ E x for which `equations` (k, n) give `missing` (k, m)."""
    some = np.diff(equations.indptr) > 0
    equations, missing = equations[some], missing[some]
    if missing.shape[1] > len(missing):
        # Many parts: what a part needs is a linear map of what it misses.
        return _least_change(energy, equations, np.eye(len(missing))) @ missing
    scale = 1 / np.sqrt(energy.diagonal())
    energy = diags_array(scale) @ energy @ diags_array(scale)
    equations = equations @ diags_array(scale)
    size = 1 / np.sqrt(equations.multiply(equations).sum(axis=1))
    equations = diags_array(size) @ equations
    exact = block_array([[energy, equations.T], [equations, None]], format="csc")
    unknown = np.arange(len(scale) + len(size)) < len(scale)
    nearly = exact - diags_array(np.where(unknown, 0.0, REGULARIZATION), format="csc")
    # Quasi-definite: it has a triangular factorization for any order of its rows.
    factors = splu(
        nearly,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    wanted = np.concatenate([np.zeros((len(scale), missing.shape[1])), size[:, None] * missing])
    solution = np.zeros_like(wanted)
    for _ in range(REFINEMENTS):
        solution += factors.solve(wanted - exact @ solution)
    change: Floats = scale[:, None] * solution[unknown]
    return change
