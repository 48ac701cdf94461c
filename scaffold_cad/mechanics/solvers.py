"""Sparse systems of six equations per node: factored, or solved by conjugate gradients.

Factoring is exact and fast for trees, chains and small lattices, but its memory grows with the
4/3rd power of a lattice's nodes and more. Beyond a size conjugate gradients take over, helped by
a coarse model: groups of nodes that move as rigid bodies (smoothed aggregation).

References
----------
Vanek, Mandel, Brezina, Algebraic multigrid by smoothed aggregation, Computing 56, 1996.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, cg, splu

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points, place_text
from scaffold_cad.base.vectors import sums_by_row
from scaffold_cad.errors import OptionError
from scaffold_cad.mechanics.loading import rigid_motions

DIRECT_NODES = 1_500
"""Most nodes whose equations are factored at once, unless they form chains and trees."""

SPARSE_LINKS = 1.15
"""Struts a node up to which factors stay small at any number of nodes."""

GROUP = 24
"""Nodes that move together in the coarse model."""

COARSE_NODES = 800
"""Most groups of a coarse model that is factored; beyond it, it is coarsened again."""

RESIDUAL = 1e-10
"""Residual over the load at which conjugate gradients stop; no unit."""

MOST_ROUNDS = 3_000
"""Conjugate gradient steps before they are given up."""

SMOOTHING = 3
"""Steps that damp what the coarse model cannot, before and after it."""

SHIFT = 1e-10
"""What is added to a coarse matrix, in diagonals: groups whose nodes are held lose motions."""

REFINEMENTS = 5
"""Most steps that refine what factors give: struts of different radii spread the eigenvalues over
many decades."""

BALANCED = 1e-12
"""Forces out of balance over the largest load at which refinement ends; no unit."""

UNBALANCED = 1e-3
"""The same from which displacements are refused: they are wrong by more than that."""

_log = logging.getLogger(__name__)


def solve_sparse(
    matrix: sparse.bsr_array,
    nodes: Points,
    fixed: Bools,
    load: Floats,
    forces: Callable[[Floats], Floats] | None = None,
) -> Floats:
    """Return x of `matrix` x = `load` where x is 0 at the fixed freedoms.

    Parameters
    ----------
    matrix : (6 n, 6 n) symmetric; positive definite on the free freedoms
    nodes : (n, 3) float64, mm, positions
    fixed : (n, 6) bool
    load : (6 n,) float64
    forces : returns `matrix` x, where thin struts do not drown in the sums with thick ones

    Raises
    ------
    OptionError
        If memory does not suffice, the steps do not converge, or struts differ too much in
        stiffness.
    """

    def left(found: Floats) -> Floats:
        """Return what is out of balance at the free freedoms, (6 n,)."""
        balance = load - (matrix @ found if forces is None else forces(found))
        return np.where(fixed.reshape(-1), 0.0, balance)

    try:
        held = with_identity(matrix, fixed)
        right = np.where(fixed.reshape(-1), 0.0, load)
        links = (len(matrix.indices) - len(nodes)) / 2
        if len(nodes) <= DIRECT_NODES or links <= SPARSE_LINKS * len(nodes):
            found = _factored(held, right, left)
        else:
            found = _iterated(held, nodes, fixed, right)
        _check_balance(left(found), right, nodes)
        return found
    except MemoryError:
        raise OptionError(
            f"the equations of {len(nodes)} nodes do not fit into memory; "
            "need fewer nodes: a part of the skeleton, or one cell of the lattice"
        ) from None


def with_identity(matrix: sparse.bsr_array, fixed: Bools) -> sparse.bsr_array:
    """Return the matrix whose rows and columns of fixed freedoms are those of the identity."""
    free = ~fixed
    count = len(fixed)
    row = np.repeat(np.arange(count), np.diff(matrix.indptr))
    column = matrix.indices
    data = matrix.data * (free[row][:, :, None] & free[column][:, None, :])
    own = np.flatnonzero(row == column)
    diagonal = np.arange(6)
    data[own[:, None], diagonal, diagonal] += fixed[row[own]]
    return sparse.bsr_array((data, column, matrix.indptr), shape=matrix.shape)


def factor(matrix: sparse.csc_array | sparse.bsr_array) -> sparse.linalg.SuperLU:
    """Return the factors of a symmetric, positive definite matrix.

    Raises
    ------
    OptionError
        If it is singular in rounded numbers.
    """
    try:
        return splu(
            sparse.csc_array(matrix),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError as error:
        raise OptionError(
            f"the equations of {matrix.shape[0]} freedoms cannot be solved: {error}; need struts "
            "that differ less in radius"
        ) from None


def _factored(matrix: sparse.bsr_array, load: Floats, left: Callable[[Floats], Floats]) -> Floats:
    factors = factor(matrix)
    found: Floats = factors.solve(load)
    rest = left(found)
    for _ in range(REFINEMENTS):
        if np.abs(rest).max() <= BALANCED * np.abs(load).max():
            break
        better = found + factors.solve(rest)
        following = left(better)
        if not np.abs(following).max() < np.abs(rest).max():
            break
        found, rest = better, following
    return found


def _check_balance(rest: Floats, load: Floats, nodes: Points) -> None:
    """Raise if forces out of balance (6 n,) are not small beside the largest load."""
    forces = np.abs(rest.reshape(-1, 6)[:, :3]).max(axis=1)
    worst = int(forces.argmax())
    lever = float(np.ptp(nodes, axis=0).max())  # of moments
    over, most = (
        float(forces[worst]),
        float((np.abs(load.reshape(-1, 2, 3)) / [[1], [lever]]).max()),
    )
    if not over <= UNBALANCED * most:
        raise OptionError(
            f"node {worst} at {place_text(nodes[worst])} is {over:.3g} N out of balance, of loads "
            f"of {most:.3g} N: rounding hides its thin struts; need struts that differ less in "
            "radius"
        )


@dataclass(frozen=True, eq=False)
class _Level:
    """One level of the hierarchy, finer than the next one."""

    matrix: sparse.bsr_array
    inverse: sparse.bsr_array
    """Inverse of the diagonal blocks."""
    largest: float
    """Largest eigenvalue of inverse times matrix."""
    up: sparse.bsr_array
    """Motions of this level's nodes by those of the groups."""
    down: sparse.bsr_array
    """Its transpose."""

    def smoothed(self, residual: Floats, guess: Floats | None = None) -> Floats:
        """Return `guess` after a few Chebyshev steps, which damp what the groups cannot."""
        upper, lower = 1.1 * self.largest, self.largest / 8.0
        middle, half = (upper + lower) / 2.0, (upper - lower) / 2.0
        rest = residual if guess is None else residual - self.matrix @ guess
        step = (self.inverse @ rest) / middle
        found = step if guess is None else guess + step
        rate = half / middle
        rho = rate
        for _ in range(SMOOTHING - 1):
            rest = rest - self.matrix @ step
            following = 1.0 / (2.0 / rate - rho)
            step = following * rho * step + (2.0 * following / half) * (self.inverse @ rest)
            rho = following
            found = found + step
        return found


def _iterated(matrix: sparse.bsr_array, nodes: Points, fixed: Bools, load: Floats) -> Floats:
    levels: list[_Level] = []
    while len(nodes) > COARSE_NODES:
        level, nodes = _coarsened(matrix, nodes, fixed)
        levels.append(level)
        matrix = _shifted(level.down @ (level.matrix @ level.up))
        fixed = np.zeros((len(nodes), 6), dtype=np.bool_)
    coarsest = factor(matrix)

    def cycle(residual: Floats, depth: int = 0) -> Floats:
        if depth == len(levels):
            solved: Floats = coarsest.solve(residual)
            return solved
        level = levels[depth]
        guess = level.smoothed(residual)
        rest = residual - level.matrix @ guess
        guess = guess + level.up @ cycle(level.down @ rest, depth + 1)
        return level.smoothed(residual, guess)

    rounds = [0]

    def count(_: Floats) -> None:
        rounds[0] += 1

    finest = levels[0].matrix
    helper = LinearOperator(finest.shape, matvec=cycle, dtype=np.float64)
    found, failed = cg(
        finest, load, rtol=RESIDUAL, atol=0.0, maxiter=MOST_ROUNDS, M=helper, callback=count
    )
    _log.debug("%d freedoms solved in %d steps, %d levels", len(load), rounds[0], len(levels))
    if failed:
        raise OptionError(
            f"the equations of {len(load)} freedoms did not converge in {MOST_ROUNDS} steps; "
            "need struts that are less slender, or fewer of them"
        )
    return np.asarray(found)


def _coarsened(matrix: sparse.bsr_array, nodes: Points, fixed: Bools) -> tuple[_Level, Points]:
    """Return a level and the centers of the groups that its nodes are put in."""
    group = groups(nodes, GROUP)
    count = int(group.max()) + 1
    size = np.bincount(group, minlength=count)
    center = sums_by_row(nodes, group, count) / size[:, None]
    motions = rigid_motions(nodes - center[group]) * ~fixed[:, :, None]  # (n, 6, 6)
    rows = np.arange(len(nodes) + 1)
    rigid = sparse.bsr_array((motions, group, rows), shape=(6 * len(nodes), 6 * count))
    inverse = _block_inverse(matrix)
    largest = _largest_eigenvalue(matrix, inverse)
    up = sparse.bsr_array(rigid - (4.0 / 3.0 / largest) * (inverse @ (matrix @ rigid)))
    return _Level(matrix, inverse, largest, up, sparse.bsr_array(up.T)), center


def _block_inverse(matrix: sparse.bsr_array) -> sparse.bsr_array:
    """Return the inverses of the diagonal blocks as a matrix."""
    count = matrix.shape[0] // 6
    row = np.repeat(np.arange(count), np.diff(matrix.indptr))
    blocks = np.zeros((count, 6, 6))
    own = row == matrix.indices
    blocks[row[own]] = matrix.data[own]
    rows = np.arange(count + 1)
    return sparse.bsr_array((np.linalg.inv(blocks), rows[:-1], rows), shape=matrix.shape)


def _largest_eigenvalue(matrix: sparse.bsr_array, inverse: sparse.bsr_array) -> float:
    """Return about the largest eigenvalue of `inverse` @ `matrix`, by powers."""
    vector = np.cos(np.arange(matrix.shape[0]) * 1.7)  # of no pattern, and the same each time
    value = 1.0
    for _ in range(15):
        vector = inverse @ (matrix @ vector)
        value = float(np.linalg.norm(vector))
        vector /= value
    return value


def _shifted(matrix: sparse.bsr_array) -> sparse.bsr_array:
    diagonal = matrix.diagonal()
    shift = np.where(diagonal > 0, SHIFT * diagonal, 1.0)
    return sparse.bsr_array(matrix + sparse.diags_array(shift), blocksize=(6, 6))


def groups(points: Points, size: int) -> Ints:
    """Return a group for each point, of about `size` points each, by halving the longest side."""
    group = np.zeros(len(points), dtype=np.intp)
    for _ in range(max(0, int(np.ceil(np.log2(max(len(points) / size, 1.0)))))):
        count = int(group.max()) + 1
        low = np.full((count, 3), np.inf)
        high = np.full((count, 3), -np.inf)
        np.minimum.at(low, group, points)
        np.maximum.at(high, group, points)
        axis = np.argmax(high - low, axis=1)[group]
        value = points[np.arange(len(points)), axis]
        order = np.lexsort((value, group))
        sizes = np.bincount(group, minlength=count)
        starts = np.concatenate([[0], np.cumsum(sizes)])[:-1]
        rank = np.empty(len(points), dtype=np.intp)
        rank[order] = np.arange(len(points)) - starts[group[order]]
        group = 2 * group + (rank >= sizes[group] / 2)
    return np.unique(group, return_inverse=True)[1].reshape(-1)
