"""SleeveMesh: the quads of a scaffold, split so that struts keep the volume of their patches.

A twisted quad is a bilinear patch in B-reps, which is halfway between its two triangulations. All
four quads of a twisted sleeve are twisted the same way, and the shorter diagonals of all of them
lie on one side of their patches: struts of triangles were up to an eighth thicker or thinner than
those of patches. So some quads of such sleeves are split along their longer diagonal.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points, Quads
from scaffold_cad.base.blocks import CACHE, blocks
from scaffold_cad.base.vectors import length, triple
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.scaffold.embedding import STAR_CENTERS

UNBALANCED = 0.002
"""Most that the volume of a sleeve of triangles may differ from that of its patches, as a part of
it: with less, every quad is split along its shorter diagonal."""

IN_SIGHT = 1e-6
"""Least volume between a point of the axis and a triangle that it sees, as a part of the largest of
those of the sleeve: what is less is rounding."""

FIRST = 1e6
"""How much more a part of a sleeve's volume counts than a part of the lengths of its diagonals."""

TURNS = np.array(list(product([0.0, 1.0], repeat=4)))
"""Ways to turn the diagonals of four quads, that of no turn first, shape (16, 4)."""

SLEEVE_BYTES = 4096
"""What a sleeve takes where its diagonals are chosen."""


@dataclass(frozen=True, eq=False)
class SleeveMesh(QuadMesh):
    """The quads of a scaffold: four a sleeve, and those that close it."""

    sleeves: Ints
    """Vertices of the sections at both ends of each sleeve, shape (m', 2, 4); the first 4 m' quads
    are theirs, in this order."""
    axes: Points
    """Both ends of the axis of each sleeve, shape (m', 2, 3), mm."""

    def __init__(self, vertices: Points, quads: Quads, sleeves: Ints, axes: Points) -> None:
        QuadMesh.__init__(self, vertices, quads)
        self._keep(sleeves=sleeves, axes=axes)

    def __str__(self) -> str:
        return QuadMesh.__str__(self)

    @cached_property
    def fans(self) -> Quads:
        """The quads, each from a corner of the diagonal that `triangles` splits it along, (f, 4).

        Of all ways to split a sleeve that keep its volume, the one of the shortest diagonals is
        taken; where none does, the best. Quads that could then not be seen from all of the axis
        stay as they are: what was star-shaped around a point of it still is.
        """
        fans = QuadMesh(self.vertices, self.quads).fans.copy()
        quads = fans[: 4 * len(self.sleeves)].reshape(-1, 4, 4)
        for some in blocks(len(quads), SLEEVE_BYTES, CACHE):
            corners = self.vertices[quads[some]]  # (k, 4, 4, 3)
            excess = _excess(corners)  # (k, 4)
            volume = _volumes(self.vertices[self.sleeves[some]])
            off = np.flatnonzero((np.abs(excess.sum(axis=1)) > UNBALANCED * volume) & (volume > 0))
            if len(off):
                rows = some.start + off
                allowed = _in_sight(corners[off], self.axes[rows])
                best = _best_turn(corners[off], excess[off] / volume[off, None], allowed)
                turned = TURNS[best] > 0  # (o, 4)
                turns = np.roll(quads[rows], 1, axis=2)
                quads[rows] = np.where(turned[:, :, None], turns, quads[rows])
        return fans


def _in_sight(corners: Points, axes: Points) -> Bools:
    """Return whether each quad may be split the other way, (k, 4).

    So it may if the sleeve is star-shaped around a point of its axis, and stays so: of several
    such points that with most quads to turn.
    """
    ends = []  # how far inside of each triangle both ends of the axis are: linear in between
    for end in (0, 1):
        a, b, c, d = np.moveaxis(corners - axes[:, None, None, end], 2, 0)  # each (k, 4, 3)
        ends.append(np.stack([triple(a, b, c), triple(a, c, d), triple(b, c, d), triple(b, d, a)]))
    least = IN_SIGHT * np.abs(ends).max(axis=(0, 1, 3))[:, None]  # (k, 1)
    allowed = np.zeros(corners.shape[:2], dtype=np.bool_)
    for fraction in STAR_CENTERS:
        inside = (1 - fraction) * ends[0] + fraction * ends[1] > least  # (4, k, 4)
        turned = inside[:2].all(axis=(0, 2))[:, None] & inside[2] & inside[3]
        more = turned.sum(axis=1) > allowed.sum(axis=1)
        allowed[more] = turned[more]
    return allowed


def _best_turn(corners: Points, excess: Floats, allowed: Bools) -> Ints:
    """Return the row of `TURNS` for each sleeve, (k,).

    Parameters
    ----------
    excess : (k, 4), as a part of the sleeve's volume
    allowed : (k, 4), whether a quad may be turned
    """
    along, across = (length(corners[:, :, k + 2] - corners[:, :, k]) for k in (0, 1))  # (k, 4)
    longer = (across - along) @ TURNS.T / along.sum(axis=1)[:, None]  # (k, 16)
    off = np.abs(excess @ (1.0 - 2.0 * TURNS.T))
    off = np.maximum(off - UNBALANCED, 0.0)
    off[~allowed @ TURNS.T > 0] = np.inf
    # Rounded: sleeves that are alike but for rounding are split alike.
    best: Ints = np.argmin(FIRST * off.round(6) + longer.round(6), axis=1)
    return best


def _excess(corners: Points) -> Floats:
    """Return by how much two triangles of each quad (..., 4, 3) hold more than its patch, mm³."""
    a, b, c, d = np.moveaxis(corners, -2, 0)
    excess: Floats = triple(c - a, b - a, d - a) / 12.0
    return excess


def _volumes(rings: Points) -> Floats:
    """Return about the volume of sleeves between two sections, (m', 2, 4, 3), in mm³."""
    areas = length(np.cross(rings[:, :, 2] - rings[:, :, 0], rings[:, :, 3] - rings[:, :, 1])) / 2
    middles = rings.mean(axis=2)
    volumes: Floats = areas.mean(axis=1) * length(middles[:, 1] - middles[:, 0])
    return volumes
