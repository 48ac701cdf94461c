"""Stiffness of beams in space as blocks of 6 × 6, and the sparse matrix that they make up.

A round section has no preferred axes: the strut's direction t gives all. With P = 1 − t tᵀ
and T v = t × v the stiffness of the second end, the first held, is

    [ axial t tᵀ + shear P        −coupling T             ]
    [ coupling T                  twisting t tᵀ + bending P ]

and equilibrium gives the other end: force −f and moment −m − l t × f.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from scaffold_cad.base.arrays import Edges, Floats, UnitVectors
from scaffold_cad.mechanics.sections import Stiffnesses


def cross_matrices(vectors: Floats) -> Floats:
    """Return the matrices (m, 3, 3) that make cross products: row k times w is v_k × w."""
    out = np.zeros((*vectors.shape[:-1], 3, 3))
    x, y, z = np.moveaxis(vectors, -1, 0)
    out[..., 0, 1], out[..., 0, 2], out[..., 1, 2] = -z, y, -x
    out[..., 1, 0], out[..., 2, 0], out[..., 2, 1] = z, -y, x
    return out


def second_end(directions: UnitVectors, stiffness: Stiffnesses) -> Floats:
    """Return the stiffness of each strut's second end, the first held, (m, 6, 6)."""
    along = directions[:, :, None] * directions[:, None, :]  # (m, 3, 3)
    across = np.eye(3) - along
    turn = cross_matrices(directions)
    out = np.empty((len(directions), 6, 6))
    out[:, :3, :3] = stiffness.axial[:, None, None] * along
    out[:, :3, :3] += stiffness.shear[:, None, None] * across
    out[:, :3, 3:] = -stiffness.coupling[:, None, None] * turn
    out[:, 3:, :3] = -out[:, :3, 3:]
    out[:, 3:, 3:] = stiffness.twisting[:, None, None] * along
    out[:, 3:, 3:] += stiffness.bending[:, None, None] * across
    return out


def first_by_second(spans: Floats) -> Floats:
    """Return what makes of the forces at the second end those at the first, (m, 6, 6)."""
    out = np.zeros((len(spans), 6, 6))
    diagonal = np.arange(6)
    out[:, diagonal, diagonal] = -1.0
    out[:, 3:, :3] = -cross_matrices(spans)
    return out


def beam_blocks(spans: Floats, directions: UnitVectors, stiffness: Stiffnesses) -> Floats:
    """Return the stiffness of each strut as blocks by its ends, (m, 2, 2, 6, 6)."""
    far = second_end(directions, stiffness)
    back = first_by_second(spans)
    near_far = back @ far
    out = np.empty((len(spans), 2, 2, 6, 6))
    out[:, 1, 1] = far
    out[:, 0, 1] = near_far
    out[:, 1, 0] = np.swapaxes(near_far, 1, 2)
    out[:, 0, 0] = near_far @ np.swapaxes(back, 1, 2)
    return out


def assembled(edges: Edges, blocks: Floats, count: int) -> sparse.bsr_array:
    """Return the stiffness matrix of `count` nodes, 6 rows per node, of blocks (m, 2, 2, 6, 6)."""
    rows = np.repeat(edges, 2, axis=1).reshape(-1)  # i i j j
    columns = np.tile(edges, (1, 2)).reshape(-1)  # i j i j
    key = rows * count + columns
    order = np.argsort(key, kind="stable")
    starts = np.flatnonzero(np.diff(key[order], prepend=-1))
    data = np.add.reduceat(blocks.reshape(-1, 6, 6)[order], starts, axis=0)
    row, column = np.divmod(key[order][starts], count)
    offsets = np.concatenate([[0], np.cumsum(np.bincount(row, minlength=count))])
    return sparse.bsr_array((data, column, offsets), shape=(6 * count, 6 * count))
