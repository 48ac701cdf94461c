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

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints
from scaffold_cad.base.vectors import sums_by_row
from scaffold_cad.brep.bernstein import bernstein, elevation, product
from scaffold_cad.struts.joins import shared_numbers, valences
from scaffold_cad.struts.quarter import DEGREE
from scaffold_cad.struts.splines import Spline, spline

KEPT_SYSTEMS = 16
"""Types whose matrices are kept: those of valency 12 take some 20 MB each."""
RANK = 1e-9
"""Equations whose pivot is below this part of the first follow from the others."""


@dataclass(frozen=True)
class Layout:
    """How patches are cut into polynomial pieces, and how they are sampled."""

    along_arc: int
    """Pieces in the direction of u."""
    along_strut: int
    """Pieces in the direction of v."""
    samples: int
    """Samples of each piece in either direction, at the nodes of Gauss and Legendre."""

    @property
    def u(self) -> Spline:
        """The splines in u."""
        return spline(self.along_arc)

    @property
    def v(self) -> Spline:
        """The splines in v."""
        return spline(self.along_strut)

    @property
    def at(self) -> Floats:
        """Parameters of the samples in a piece, shape (samples,)."""
        return np.asarray((np.polynomial.legendre.leggauss(self.samples)[0] + 1) / 2)

    @property
    def at_u(self) -> Floats:
        """Parameters of all samples in u, shape (samples of all pieces,)."""
        return _spread(self.at, self.along_arc)

    @property
    def at_v(self) -> Floats:
        """Parameters of all samples in v, shape (samples of all pieces,)."""
        return _spread(self.at, self.along_strut)

    @property
    def weights(self) -> Floats:
        """Weight of each sample of a patch in the integral over it, in the order of (u, v)."""
        one = np.polynomial.legendre.leggauss(self.samples)[1] / 2
        wide = np.tile(one / self.along_arc, self.along_arc)
        high = np.tile(one / self.along_strut, self.along_strut)
        return np.asarray(np.outer(wide, high).reshape(-1))


def _spread(at: Floats, pieces: int) -> Floats:
    return np.asarray(((at + np.arange(pieces)[:, None]) / pieces).reshape(-1))


@dataclass(frozen=True, eq=False)
class Net(Frozen):
    """The control points of a type, numbered; neighbors share them."""

    number: Ints
    """Number of each control point, shape (4 N, n_u, n_v)."""
    count: int
    """How many there are."""
    is_given: Bools
    """Whether each is in one of the two rows next to a collar, shape (count,)."""


@dataclass(frozen=True, eq=False)
class System(Frozen):
    """The surfaces of a type that are smooth: given points and k free numbers make all others.

    Rows are nodes' coordinates: (rows, given) and (rows, k) times these matrices, added.
    """

    layout: Layout
    """How patches are cut and sampled."""
    net: Net
    """The numbers of the control points."""
    shares: Floats
    """What α has at the vertex of each spoke, 2 cos(2π/n), shape (N, 4)."""
    given: Ints
    """Place of each given control point among those of all patches, shape (g,)."""
    points_of_given: Floats
    """From given control points to control points, (g, count)."""
    points_of_free: Floats
    """From the free numbers to control points, (k, count)."""
    samples_of_given: Floats
    """From given control points to samples, (g, samples)."""
    samples_of_free: Floats
    """From the free numbers to samples, (k, samples)."""


@dataclass(frozen=True, eq=False)
class Fit(Frozen):
    """What takes wanted samples and given points to the free numbers of the best surface."""

    free_of_samples: Floats
    """From wanted samples, (samples, k)."""
    free_of_given: Floats
    """From given control points, (g, k)."""


def net_of(twins: Ints, layout: Layout) -> Net:
    """Return the numbered control points of the type with `twins` (4 N,)."""
    number, count = shared_numbers(twins, layout.u.count, layout.v.count)
    is_given = np.zeros(count, dtype=np.bool_)
    is_given[number[:, :, -2:]] = True
    return Net(number, count, is_given)


def equations(twins: Ints, net: Net, layout: Layout) -> Floats:
    """Return the conditions of smooth joins, whose products with the control points are 0.

    Returns
    -------
    (k, count) float64; some rows follow from others
    """
    sides = np.arange(len(twins))
    following = (sides & ~3) | ((sides + 1) & 3)
    number, valence = net.number, valences(twins)
    once = sides[sides < twins]
    spokes = _conditions(
        (number[:, -1, :], number[:, -2, :], number[following, 1, :]),
        (valence[following], np.full(len(sides), 4)),
        (layout.v, layout.u.step),
        net.count,
        is_spoke=True,
    )
    arcs = _conditions(
        (number[once, :, 0], number[once, :, 1], number[twins[once], ::-1, 1]),
        (valence[once], valence[following][once]),
        (layout.u, layout.v.step),
        net.count,
        is_spoke=False,
    )
    return np.concatenate([spokes, arcs])


def _conditions(
    rows: tuple[Ints, Ints, Ints],
    valence: tuple[Ints, Ints],
    shape: tuple[Spline, float],
    count: int,
    *,
    is_spoke: bool,
) -> Floats:
    """Return the conditions along curves, given by the numbers of their and the next rows.

    Parameters
    ----------
    rows : three (c, n) intp, control points of the curves, and of the rows on either side
    valence : two (c,) intp, how many patches meet at the curves' starts and ends
    shape : the splines along the curves, and the length of a piece across them
    """
    curve, left, right = rows
    starts, ends = valence
    along, across = shape
    alpha = np.stack([share(starts), np.zeros(len(curve)), -share(ends)], axis=1)
    if is_spoke:
        # Of degree 1, which leaves the spoke its full degree.
        alpha[:, 1] = alpha[:, 0] / 2
    columns = np.concatenate([left, right, curve], axis=1)[:, None, :]
    difference = np.diff(np.eye(DEGREE + 1), axis=0) / along.step
    parts = []
    for piece, extraction in enumerate(along.extraction):
        part = alpha @ _restriction(piece, along.pieces).T
        slope = product(part, DEGREE - 1) @ difference @ extraction  # (c, D + 2, n)
        raised = np.broadcast_to(elevation(DEGREE, DEGREE + 1) @ extraction / across, slope.shape)
        values = np.concatenate([raised, raised, -2 * raised - slope], axis=2)
        size = len(curve) * (DEGREE + 2)
        entries = np.arange(size).reshape(len(curve), -1, 1) * count + columns
        parts.append(sums_by_row(values, entries, size * count).reshape(size, count))
    return np.concatenate(parts)


def share(valence: Ints) -> Floats:
    """Return 2 cos(2π/n), exactly 0 where 4 patches meet, for each of `valence`."""
    return np.asarray(np.where(valence == 4, 0.0, 2 * np.cos(2 * np.pi / valence)))


def _restriction(piece: int, pieces: int) -> Floats:
    """Return what takes quadratics to one of equal pieces, both in Bernstein form, (3, 3)."""
    at = np.array([0.0, 0.5, 1.0])
    return np.asarray(np.linalg.solve(bernstein(2, at), bernstein(2, (at + piece) / pieces)))


def system_of(twins: Ints, layout: Layout) -> System:
    """Return the smooth surfaces of the type with `twins` (4 N,)."""
    return _system(tuple(twins.tolist()), layout)


def fit_of(twins: Ints, layout: Layout, stiffness: float) -> Fit:
    """Return the factored least-squares problem of a type.

    Parameters
    ----------
    twins : (4 N,) intp, the twin of each side
    layout : how patches are cut and sampled
    stiffness : weight of the thin-plate energy against the mean of squared distances
    """
    return _fit(tuple(twins.tolist()), layout, stiffness)


@lru_cache(maxsize=KEPT_SYSTEMS)
def _system(key: tuple[int, ...], layout: Layout) -> System:
    twins = np.array(key, dtype=np.intp)
    net = net_of(twins, layout)
    free, given = np.flatnonzero(~net.is_given), np.flatnonzero(net.is_given)
    conditions = equations(twins, net, layout)
    basis, particular = _solutions(conditions[:, free], -conditions[:, given])
    points_of_free = np.zeros((basis.shape[1], net.count))
    points_of_free[:, free] = basis.T
    points_of_given = np.zeros((len(given), net.count))
    points_of_given[:, free] = particular.T
    points_of_given[np.arange(len(given)), given] = 1.0
    _, first = np.unique(net.number.reshape(-1), return_index=True)
    return System(
        layout,
        net,
        share(valences(twins)).reshape(-1, 4),
        first[given],
        points_of_given,
        points_of_free,
        _sampled(points_of_given, net, layout),
        _sampled(points_of_free, net, layout),
    )


def forget_systems() -> None:
    """Let all matrices be made anew: their last bits depend on how many threads made them."""
    _system.cache_clear()
    _fit.cache_clear()


@lru_cache(maxsize=4 * KEPT_SYSTEMS)
def _fit(key: tuple[int, ...], layout: Layout, stiffness: float) -> Fit:
    system = _system(key, layout)
    weights = np.tile(layout.weights, len(key))
    weighted = system.samples_of_free * weights
    plate = stiffness * _energy(system)
    energy = weighted @ system.samples_of_free.T + system.points_of_free @ plate.T
    mixed = weighted @ system.samples_of_given.T + plate @ system.points_of_given.T
    factor = cho_factor(energy)
    return Fit(
        np.ascontiguousarray(cho_solve(factor, weighted).T),
        np.ascontiguousarray(-cho_solve(factor, mixed).T),
    )


def _sampled(points: Floats, net: Net, layout: Layout) -> Floats:
    """Return the samples of rows of control points (r, count), shape (r, samples)."""
    patches = points[:, net.number]  # (r, 4 N, n_u, n_v)
    samples = layout.u.values(layout.at) @ patches @ layout.v.values(layout.at).T
    return np.asarray(samples.reshape(len(points), -1))


def _energy(system: System) -> Floats:
    """Return the gradient of half the thin-plate energy for each free number, (k, count)."""
    net, plate = system.net, _thin_plate(system.layout)
    numbers = net.number.reshape(len(net.number), -1)  # (4 N, n)
    pulls = plate @ np.moveaxis(system.points_of_free[:, numbers], 0, 2)  # (4 N, n, k)
    return sums_by_row(pulls, numbers, system.points_of_free.shape[1]).T


def _thin_plate(layout: Layout) -> Floats:
    """Return the matrix of the thin-plate energy of a patch, (n_u n_v, n_u n_v)."""
    u, v = ([each.products(order) for order in range(3)] for each in (layout.u, layout.v))
    return np.asarray(np.kron(u[2], v[0]) + 2 * np.kron(u[1], v[1]) + np.kron(u[0], v[2]))


def _solutions(matrix: Floats, right: Floats) -> tuple[Floats, Floats]:
    """Return a null-space basis (n, k) of `matrix` (m, n), and x (n, g) with matrix x = right.

    `right` (m, g) must have solutions where the rows depend on each other.
    """
    q, r, order = qr(matrix.T, pivoting=True)
    sizes = np.abs(np.diagonal(r))
    rank = int((sizes > RANK * sizes[0]).sum())
    lower = solve_triangular(r[:rank, :rank], right[order[:rank]], trans="T")
    return np.ascontiguousarray(q[:, rank:]), q[:, :rank] @ lower
