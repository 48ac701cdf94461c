"""The smooth surfaces of a node's patches, by as few numbers as make them.

Patch s belongs to side s of the node's type: u runs along the arc, v from the arc (v = 0) to a
quarter of the collar (v = 1). Its control points (n_u, n_v) are numbered with those of its
neighbors. The two rows next to the collar are given. Those of the rims meet the conditions of
smooth joins.

These conditions are solved for each curve by itself as far as they are its own, see `curves`. A
few are left for the node, on the points at the corners of its patches. All of it depends on the
type only, and what remains for a node are products of a few matrices with its given rows and its
free numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import qr, solve_triangular

from scaffold_cad.base.arrays import Floats, Frozen, Ints
from scaffold_cad.base.kept import kept
from scaffold_cad.base.products import row_products
from scaffold_cad.base.vectors import sums_by_row
from scaffold_cad.struts.blending.curves import RANK, Curve, Kind, curve_of
from scaffold_cad.struts.blending.joins import shared_numbers, valences
from scaffold_cad.struts.blending.layouts import Layout

KEPT_BYTES = 2**28
"""Memory for the matrices of types: those of valency 12 take some 20 MB each."""
AT_ENDS = np.array([0, 1, -2, -1])
"""Numbers of a curve that belong to its ends."""


@dataclass(frozen=True, eq=False)
class Net(Frozen):
    """The control points of a type, numbered: those of rims, those that are given, and the rest.

    Neighbors share them.
    """

    number: Ints
    """Number of each control point, shape (4 N, n_u, n_v)."""
    rim: int
    """How many are in the rims of patches."""
    given: int
    """How many are given."""
    count: int
    """How many there are."""


@dataclass(frozen=True, eq=False)
class System(Frozen):
    """The surfaces of a type that are smooth: given points and k free numbers make the rims.

    Rows are nodes' coordinates: (rows, given) and (rows, k) times these matrices, added.
    """

    net: Net
    """The numbers of the control points."""
    given: Ints
    """Place of each given control point among those of all patches, shape (g,)."""
    rims: Ints
    """Numbers of the points in the rim of each patch, shape (4 N, rim of a patch)."""
    rim_of_given: Floats
    """From given control points to those of rims, (g, rim)."""
    rim_of_free: Floats
    """From the free numbers to the control points of rims, (k, rim)."""
    wide: int
    """How many free numbers, which come first, are of corners: they move the rims of many patches.

    The others are of one curve each.
    """

    @cached_property
    def _by_number(self) -> tuple[Ints, Ints]:
        """The points in the rims of all patches by their numbers, and where each begins there."""
        numbers = self.rims.reshape(-1)
        order = np.argsort(numbers, kind="stable")
        return order, np.searchsorted(numbers[order], np.arange(self.net.rim))

    def pulls_at_free(self, pulls: Floats) -> Floats:
        """Return pulls at the free numbers, (rows, k), of those at rims (rows, 4 N rim)."""
        order, first = self._by_number
        at_rims = np.add.reduceat(pulls[:, order], first, axis=1)
        return row_products(at_rims, self.rim_of_free.T)


@dataclass(frozen=True, eq=False)
class _Curves(Frozen):
    """Curves of one kind: the numbers of their control points, and of the rows beside them."""

    kind: Kind
    curve: Ints
    """Shape (c, n)."""
    left: Ints
    """Shape (c, n)."""
    right: Ints
    """Shape (c, n)."""

    @property
    def solved(self) -> Curve:
        return curve_of(self.kind)

    @property
    def own(self) -> int:
        """How many numbers are free on each curve, and beside it."""
        return int(self.solved.of_free.shape[1] + self.curve.shape[1] - len(AT_ENDS))

    def ends(self, points: Floats) -> Floats:
        """Return the numbers of the ends, for points (count, k), shape (c, 8, k)."""
        beside = points[self.left[:, AT_ENDS]] + points[self.right[:, AT_ENDS]]
        return np.concatenate([points[self.curve[:, AT_ENDS]], beside], axis=1)

    def fill(self, points: Floats, column: int) -> None:
        """Set the points between the ends, which come from those there and from own numbers.

        Parameters
        ----------
        points : (count, k) float64, with the corners set
        column : the first of the curves' own numbers
        """
        solved, inner, free = self.solved, slice(2, -2), self.solved.of_free.shape[1]
        half = len(solved.of_free) // 2
        between = solved.of_ends @ self.ends(points)  # (c, 2 (n - 4), k)
        first = column + self.own * np.arange(len(self.curve))
        for number in range(free):
            between[np.arange(len(first)), :, first + number] = solved.of_free[:, number]
        points[self.curve[:, inner]] = between[:, :half]
        points[self.left[:, inner]] = points[self.right[:, inner]] = between[:, half:] / 2
        apart = (first + free)[:, None] + np.arange(half)
        points[self.left[:, inner], apart] = 1.0
        points[self.right[:, inner], apart] = -1.0


def net_of(twins: Ints, layout: Layout) -> Net:
    """Return the numbered control points of the type with `twins` (4 N,)."""
    found, count = shared_numbers(twins, layout.u.count, layout.v.count)
    part = np.zeros(count, dtype=np.intp)
    part[found.reshape(len(twins), -1)[:, layout.given]] = 1
    part[found.reshape(len(twins), -1)[:, layout.core]] = 2
    number = np.empty(count, dtype=np.intp)
    number[np.argsort(part, kind="stable")] = np.arange(count)
    return Net(number[found], int((part == 0).sum()), int((part == 1).sum()), count)


def system_of(twins: Ints, layout: Layout) -> System:
    """Return the smooth surfaces of the type with `twins` (4 N,)."""
    # Samples do not matter here.
    return _system(tuple(twins.tolist()), Layout(layout.along_arc, layout.along_strut, 1))


@kept(KEPT_BYTES)
def _system(key: tuple[int, ...], layout: Layout) -> System:
    twins = np.array(key, dtype=np.intp)
    net = net_of(twins, layout)
    curves = _curves(twins, net, layout)
    corners = np.unique(net.number[:, [0, 1, -2, -1]][:, :, :2])
    conditions = _at_corners(curves, net)
    known = slice(net.rim, net.rim + net.given)
    basis, particular = _solutions(conditions[:, corners], -conditions[:, known])
    total = net.given + basis.shape[1]
    points = np.zeros((net.rim + net.given, total + sum(c.own * len(c.curve) for c in curves)))
    points[known, : net.given] = np.eye(net.given)
    points[corners, : net.given], points[corners, net.given : total] = particular, basis
    for each in curves:
        each.fill(points, total)
        total += each.own * len(each.curve)
    _, first = np.unique(net.number.reshape(-1), return_index=True)
    return System(
        net,
        first[known],
        net.number.reshape(len(twins), -1)[:, layout.rim],
        np.ascontiguousarray(points[: net.rim, : net.given].T),
        np.ascontiguousarray(points[: net.rim, net.given :].T),
        basis.shape[1],
    )


def _curves(twins: Ints, net: Net, layout: Layout) -> list[_Curves]:
    """Return the spokes and the arcs of a type by their kinds."""
    sides = np.arange(len(twins))
    following = (sides & ~3) | ((sides + 1) & 3)
    number, valence = net.number, valences(twins)
    once = sides[sides < twins]
    pieces = layout.along_arc, layout.along_strut
    spokes = _by_kind(
        (number[:, -1, :], number[:, -2, :], number[following, 1, :]),
        np.stack([valence[following], np.full(len(sides), 4)], axis=1),
        lambda starts, ends: Kind(pieces[1], pieces[0], starts, ends, is_spoke=True),
    )
    arcs = _by_kind(
        (number[once, :, 0], number[once, :, 1], number[twins[once], ::-1, 1]),
        np.stack([valence[once], valence[following][once]], axis=1),
        lambda starts, ends: Kind(pieces[0], pieces[1], starts, ends, is_spoke=False),
    )
    return spokes + arcs


def _by_kind(
    rows: tuple[Ints, Ints, Ints], valence: Ints, kind: Callable[[int, int], Kind]
) -> list[_Curves]:
    """Return curves by their kinds.

    Parameters
    ----------
    rows : three (c, n) intp, the numbers of the curves' points and of those on either side
    valence : (c, 2) intp, how many patches meet at the curves' starts and ends
    kind : what makes a kind of these two
    """
    distinct, which = np.unique(valence, axis=0, return_inverse=True)
    which = which.reshape(-1)
    return [
        _Curves(kind(*pair), *(row[which == place] for row in rows))
        for place, pair in enumerate(distinct.tolist())
    ]


def _at_corners(curves: Sequence[_Curves], net: Net) -> Floats:
    """Return the conditions on the numbers of ends of curves, (conditions, rim + given)."""
    parts = []
    for each in curves:
        of_ends = each.solved.conditions  # (p, 8)
        size, count = len(each.curve) * len(of_ends), net.rim + net.given
        first = count * np.arange(size).reshape(len(each.curve), -1, 1)
        half = np.split(np.broadcast_to(of_ends, (len(each.curve), *of_ends.shape)), 2, axis=2)
        columns = [row[:, None, AT_ENDS] for row in (each.curve, each.left, each.right)]
        places = first + np.concatenate(columns, axis=2)  # (c, p, 12)
        values = np.concatenate([half[0], half[1], half[1]], axis=2)
        parts.append(sums_by_row(values, places, size * count).reshape(size, count))
    return np.concatenate(parts)


def _solutions(matrix: Floats, right: Floats) -> tuple[Floats, Floats]:
    """Return a null-space basis (n, k) of `matrix` (m, n), and x (n, g) with matrix x = right.

    `right` (m, g) must have solutions where the rows depend on each other.
    """
    q, r, order = qr(matrix.T, pivoting=True)
    sizes = np.abs(np.diagonal(r))
    rank = int((sizes > RANK * sizes[0]).sum())
    lower = solve_triangular(r[:rank, :rank], right[order[:rank]], trans="T")
    return np.ascontiguousarray(q[:, rank:]), q[:, :rank] @ lower
