"""The linear system of a node's patches: smooth joins exactly, samples as near as can be.

Patch s belongs to side s of the node's type: u runs along the arc, v from the arc (v = 0) to a
quarter of the collar (v = 1). Its control points (D + 1, D + 1) are numbered with those of its
neighbors. The two rows next to the collar are given. The others meet the conditions of tangent
planes, see below, and of all that do they are those with the least sum of squared distances from
the wanted samples and thin-plate energy.

Two patches f and g meet smoothly along their common curve e if D_v f + D_v g = α e', with both
derivatives taken away from the curve, and α of degree 2 with the coefficients 2 cos(2π/n₀), 0,
−2 cos(2π/n₁), where n₀ and n₁ patches meet at the ends: it is linear, and corners on the collar,
where 4 patches meet, agree with any given rows.

All of it depends on the type only. It is factored once, and what remains for a node are products
of a few matrices with its samples and its given rows.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.linalg import cho_factor, cho_solve, qr, solve_triangular
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints
from scaffold_cad.brep.bernstein import bernstein, elevation, product, thin_plate
from scaffold_cad.struts.joins import valences
from scaffold_cad.struts.quarter import DEGREE

SAMPLES = 6
"""Samples of each patch in either direction, at the nodes of Gauss and Legendre."""
RANK = 1e-9
"""Equations whose pivot is below this part of the first follow from the others."""

W = DEGREE + 1


@dataclass(frozen=True, eq=False)
class Net(Frozen):
    """The control points of a type, numbered; neighbors share them."""

    number: Ints
    """Number of each control point, shape (4 N, D + 1, D + 1)."""
    count: int
    """How many there are."""
    is_given: Bools
    """Whether each is in one of the two rows next to a collar, shape (count,)."""


@dataclass(frozen=True, eq=False)
class System(Frozen):
    """What takes a node's samples and given control points to its control points.

    Rows are nodes' coordinates: (rows, samples) @ by_sample + (rows, given) @ by_given.
    """

    net: Net
    """The numbers of the control points."""
    given: Ints
    """Place of each given control point among those of all patches, shape (g,)."""
    by_sample: Floats
    """From wanted samples to control points, (4 N n², count)."""
    by_given: Floats
    """From given control points to control points, (g, count)."""
    sampled: Floats
    """From control points to samples, (count, 4 N n²)."""


def sample_parameters() -> tuple[Floats, Floats]:
    """Return the parameters of the samples in either direction and their weights, both (n,)."""
    nodes, weights = np.polynomial.legendre.leggauss(SAMPLES)
    return np.asarray((nodes + 1) / 2), np.asarray(weights / 2)


def net_of(twins: Ints) -> Net:
    """Return the numbered control points of the type with `twins` (4 N,)."""
    sides = np.arange(len(twins))
    place = np.arange(len(twins) * W * W).reshape(-1, W, W)
    following = (sides & ~3) | ((sides + 1) & 3)
    one = np.concatenate([place[:, -1, :].reshape(-1), place[:, :, 0].reshape(-1)])
    two = np.concatenate([place[following, 0, :].reshape(-1), place[twins, ::-1, 0].reshape(-1)])
    graph = coo_array((np.ones(len(one)), (one, two)), shape=(place.size, place.size))
    count, number = connected_components(graph, directed=False)
    number = number.reshape(place.shape)
    is_given = np.zeros(count, dtype=np.bool_)
    is_given[number[:, :, -2:]] = True
    return Net(number.astype(np.intp), int(count), is_given)


def equations(twins: Ints, net: Net) -> Floats:
    """Return the conditions of smooth joins, whose products with the control points are 0.

    Returns
    -------
    (6 N (D + 2), count) float64
    """
    sides = np.arange(len(twins))
    following = (sides & ~3) | ((sides + 1) & 3)
    number, valence = net.number, valences(twins)
    once = sides[sides < twins]
    four = np.full(len(sides), 4)
    # Spokes from vertices to collars, then arcs: the curve, and the rows beside it.
    curve = np.concatenate([number[:, -1, :], number[once, :, 0]])
    left = np.concatenate([number[:, -2, :], number[once, :, 1]])
    right = np.concatenate([number[following, 1, :], number[twins[once], ::-1, 1]])
    starts = np.concatenate([valence[following], valence[once]])
    ends = np.concatenate([four, valence[following][once]])
    alpha = np.zeros((len(curve), 3))
    alpha[:, 0] = np.where(starts == 4, 0.0, 2 * np.cos(2 * np.pi / starts))
    alpha[:, 2] = np.where(ends == 4, 0.0, -2 * np.cos(2 * np.pi / ends))
    slope = product(alpha, DEGREE - 1) @ np.diff(np.eye(W), axis=0)  # (c, D + 2, D + 1)
    raised = np.broadcast_to(elevation(DEGREE, W), slope.shape)
    values = np.concatenate([raised, raised, -2 * raised - slope], axis=2)
    columns = np.concatenate([left, right, curve], axis=1)
    matrix = np.zeros((*slope.shape[:2], net.count))
    place = np.arange(len(curve))[:, None, None], np.arange(W + 1)[None, :, None]
    np.add.at(matrix, (*place, columns[:, None, :]), values)
    return matrix.reshape(-1, net.count)


def system_of(twins: Ints, stiffness: float) -> System:
    """Return the factored system of a type.

    Parameters
    ----------
    twins : (4 N,) intp, the twin of each side
    stiffness : weight of the thin-plate energy against the mean of squared distances
    """
    return _system(tuple(twins.tolist()), stiffness)


@lru_cache(maxsize=64)
def _system(key: tuple[int, ...], stiffness: float) -> System:
    twins = np.array(key, dtype=np.intp)
    net = net_of(twins)
    at, weights = sample_parameters()
    basis = bernstein(DEGREE, at)
    block = np.einsum("ai,bj->abij", basis, basis).reshape(SAMPLES**2, W * W)
    weight = np.outer(weights, weights).reshape(-1)
    flat = net.number.reshape(len(twins), -1)  # (4 N, (D + 1)²)
    sampled = np.zeros((len(twins), SAMPLES**2, net.count))
    for patch, numbers in enumerate(flat):
        np.add.at(sampled[patch], (slice(None), numbers), block)
    sampled = sampled.reshape(-1, net.count)
    energy = np.zeros((net.count, net.count))
    for numbers in flat:
        energy[np.ix_(numbers, numbers)] += stiffness * thin_plate(DEGREE)
    weighted = sampled * np.tile(weight, len(twins))[:, None]
    matrix = sampled.T @ weighted + energy

    free, given = np.flatnonzero(~net.is_given), np.flatnonzero(net.is_given)
    conditions = equations(twins, net)
    inner, outer = conditions[:, free], conditions[:, given]
    basis_free, particular = _solutions(inner, -outer)
    # Free points: particular p + basis y, and y makes the energy least.
    stiff = matrix[np.ix_(free, free)]
    reduced = cho_factor(basis_free.T @ stiff @ basis_free)
    into = basis_free @ cho_solve(reduced, basis_free.T)  # (free, free)
    from_given = particular - into @ (stiff @ particular + matrix[np.ix_(free, given)])
    by_sample = np.zeros((len(sampled), net.count))
    by_sample[:, free] = weighted[:, free] @ into
    by_given = np.zeros((len(given), net.count))
    by_given[:, free] = from_given.T
    by_given[np.arange(len(given)), given] = 1.0
    _, first = np.unique(net.number.reshape(-1), return_index=True)
    return System(net, first[given], by_sample, by_given, np.ascontiguousarray(sampled.T))


def _solutions(matrix: Floats, right: Floats) -> tuple[Floats, Floats]:
    """Return a basis (n, k) of the null space of `matrix` (m, n), and x (n, g) with matrix x = right.

    `right` (m, g) must have solutions where the rows depend on each other.
    """
    q, r, order = qr(matrix.T, pivoting=True)
    sizes = np.abs(np.diagonal(r))
    rank = int((sizes > RANK * sizes[0]).sum())
    lower = solve_triangular(r[:rank, :rank], right[order[:rank]], trans="T")
    return np.ascontiguousarray(q[:, rank:]), q[:, :rank] @ lower
