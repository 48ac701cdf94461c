"""Bends of struts that are made like others: how they are turned so that struts twist least.

Rings keep their vertices when nodes move, so struts twist where what is at their two ends turns
about them by different angles. What is at branch points is as it is. Bends may have any angle:
theirs are those that leave the squares of all twists the least sum.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse
import scipy.sparse.linalg

from scaffold_cad.base.arrays import Bools, Floats, Ints, UnitVectors
from scaffold_cad.base.vectors import dot, normalize, rotated, shortest_turns
from scaffold_cad.struts.blending.bends import bend_partitions
from scaffold_cad.struts.blending.blend import Stars
from scaffold_cad.struts.groups import Group
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.runs import Runs

ROUNDS = 3
"""Times that angles are found anew: at bends struts turn by a little more or less than these."""

LOOSE = 1e-9
"""What holds bends that no strut holds to the angle they have, as against a strut."""


def untwisted(runs: Runs, bends: Group, stars: Stars, x: UnitVectors, like: RoundStruts) -> Stars:
    """Return the stars of bends with their partitions turned, and numbered as in others.

    Parameters
    ----------
    bends, stars : M bends and what they are asked for
    x : (2 k, 3) where the rings of half-runs begin, across them; zeros for those not known
    like : the struts that these are made like
    """
    held = (x != 0).any(axis=1)
    held[bends.half_runs] = True
    matrix, rows = _matrix(runs, bends, held)
    carried = rotated(like.x, shortest_turns(like.runs.directions, runs.directions))
    axes, begins, quads = np.repeat(runs.directions[0::2], 2, axis=0), x.copy(), _quads(bends, like)

    def turned(angles: Floats) -> Stars:
        made, vertices = bend_partitions(stars.directions, angles), np.empty((len(quads), 4, 3))
        np.put_along_axis(vertices, quads[:, 0, :, None], made.vertices, axis=1)
        return replace(stars, vertices=vertices, quads=quads)

    def twists() -> Floats:
        """Return how far the rings of half-runs are turned about their runs, (2 k,), rad."""
        sine, cosine = dot(np.cross(carried, begins), axes), dot(carried, begins)
        return np.asarray(np.arctan2(sine, cosine))

    begins[bends.half_runs] = _begins(turned(np.zeros(len(quads))))
    angles = -_senses(bends)[:, 0] * twists()[bends.half_runs[:, 0]]
    normal = matrix.T @ matrix + LOOSE * scipy.sparse.identity(len(quads))
    solve = scipy.sparse.linalg.factorized(normal.tocsc())
    for _ in range(ROUNDS):
        begins[bends.half_runs] = _begins(turned(angles))
        ends = twists().reshape(-1, 2)[rows]
        left = np.remainder(ends[:, 0] - ends[:, 1] + np.pi, 2 * np.pi) - np.pi
        angles = angles - solve(matrix.T @ left)
    return turned(angles)


def _quads(bends: Group, like: RoundStruts) -> Ints:
    """Return the quads of bends in other struts, (M, 2, 4)."""
    quads = np.empty((len(bends.nodes), 2, 4), dtype=np.intp)
    for other in like.blended:
        if other.half_runs.shape[1] == 2:
            some = np.flatnonzero(np.isin(other.nodes, bends.nodes))
            place = np.searchsorted(bends.nodes, other.nodes[some])
            quads[place] = other.quads[other.shape_of[some]]
    return quads


def _begins(stars: Stars) -> UnitVectors:
    """Return where the rings of struts begin, across them, (M, N, 3)."""
    first = np.take_along_axis(stars.vertices, stars.quads[:, :, 0, None], axis=1)
    return normalize(first - dot(first, stars.directions)[..., None] * stars.directions)


def _senses(bends: Group) -> Floats:
    """Return whether the run of a bend's half-run turns as the bend does, 1, or against it, -1.

    A bend turns about its first half-run, and against the second: shape (M, 2).
    """
    return np.where(bends.half_runs % 2 == 0, 1.0, -1.0) * [1.0, -1.0]


def _matrix(runs: Runs, bends: Group, held: Bools) -> tuple[scipy.sparse.csr_matrix, Ints]:
    """Return what turns of bends add to the twists of runs, (r, M), and which runs, (r,).

    Parameters
    ----------
    held : (2 k,) half-runs whose rings are not turned by what is at the other end
    """
    rows = np.unique(bends.half_runs >> 1)
    rows = rows[held.reshape(-1, 2)[rows].all(axis=1)]
    number = np.full(len(runs.edges), -1)
    number[rows] = np.arange(len(rows))
    row = number[bends.half_runs >> 1]  # (M, 2)
    value = _senses(bends) * np.where(bends.half_runs % 2 == 0, 1.0, -1.0)
    column = np.repeat(np.arange(len(row))[:, None], 2, axis=1)
    some = row >= 0
    shape = len(rows), len(row)
    return scipy.sparse.csr_matrix((value[some], (row[some], column[some])), shape=shape), rows
