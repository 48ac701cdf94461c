"""How finely the patches of nodes are sampled: as their surface bends.

Where patches are long, or turn fast, as at the tips of narrow forks, they have more samples than
their share of the polygons of struts: more around the struts, more between arcs and collars, or
both. It depends on the shape of a node alone, so equal nodes are sampled alike, and struts that are
made like others are sampled as these are.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints
from scaffold_cad.base.blocks import CACHE, cut
from scaffold_cad.base.vectors import dot
from scaffold_cad.struts.blending.blend import Solved
from scaffold_cad.struts.meshes.rings import Grid, around_struts, graded, quarter_parameters
from scaffold_cad.struts.model import BlendedNodes, RoundStruts

AROUND, AHEAD = 5.3, 2.0
"""How far chords are from the surface at most, around struts and along them, over the same of the
polygons of struts. With these the lattices of `named_cells` have at most 1.06 times the triangles
that they had without."""

OF_WALL = 1.0
"""The same over the wall of hollow struts, where that is less."""

MOST = 4.0
"""How many times finer than their share patches are at most, either way."""

FEWEST = 2.0
"""How many intervals patches have at least, either way: with one, patches of 4 sides fold."""

PROBES = 8
"""Samples around a quarter of a strut, and from its arc to its collar, that chords are taken of:
every other one is the middle of a chord. They are those of 16 sides."""

PLACE_BYTES = 256
"""What a sample takes while that is done."""


@dataclass(frozen=True, eq=False)
class Fineness(Frozen):
    """How the patches of all nodes are sampled."""

    steps: Ints
    """Intervals of the arcs of each node, shape (n,); 0 at nodes without a blend.

    Crowded nodes have their share of the polygons' sides: they become fields.
    """
    levels: Ints
    """Intervals from the arcs to the collars of each node, shape (n,); 0 where it has no blend."""
    sides: int
    """Points of the rings at the collars, a multiple of 4."""

    @staticmethod
    def of(struts: RoundStruts, sides: int) -> Fineness:
        """Return how the nodes of struts are sampled between polygons of `sides` sides."""
        struts = struts.first
        count = len(struts.runs.nodes)
        steps, levels = np.zeros((2, count), dtype=np.intp)
        wall = struts.options.wall or np.inf
        for group in struts.blended:
            around, ahead = np.ones((2, len(group.nodes)))
            sound = np.flatnonzero(~struts.crowded[group.nodes])  # others become fields
            if len(sound):
                around[sound], ahead[sound] = _finer(group[sound], sides, wall)
            steps[group.nodes] = np.ceil(np.maximum(FEWEST, sides / 4 * around) - 1e-9)
            levels[group.nodes] = np.ceil(max(FEWEST, sides / 4) * ahead - 1e-9)
        return Fineness(steps, levels, sides)

    def parts(self, groups: Iterable[BlendedNodes]) -> Iterator[tuple[BlendedNodes, Grid]]:
        """Yield the nodes of groups that are sampled alike, and how."""
        for group in groups:
            pairs = np.stack([self.steps[group.nodes], self.levels[group.nodes]], axis=1)
            kinds, kind_of = np.unique(pairs, axis=0, return_inverse=True)
            for kind, (steps, levels) in enumerate(kinds.tolist()):
                rows = np.flatnonzero(kind_of.reshape(-1) == kind)
                some = group if len(kinds) == 1 else group[rows]
                yield some, Grid(steps, levels, self.sides)


def _finer(group: BlendedNodes, sides: int, wall: float) -> tuple[Floats, Floats]:
    """Return how many times finer than their share nodes are sampled, around and along, (M,)."""
    originals = group.originals
    used, which = np.unique(originals.which[group.shape_of], return_inverse=True)
    shapes = originals.skins.shapes[used]
    unit = (1 - np.cos(np.pi / sides)) * shapes.collar_radii  # (U, N), mm
    most = np.minimum(np.array([AROUND, AHEAD])[:, None, None] * unit, OF_WALL * wall)
    over = (_chords(shapes) * unit / most).max(axis=2)  # (2, U)
    around, ahead = np.clip(np.sqrt(over), 1.0, MOST)[:, which.reshape(-1)]
    return around, ahead


def _chords(shapes: Solved) -> Floats:
    """Return how far chords of 16 sides are from blends, over the same of polygons, (2, U, N).

    First those around struts, then those along them.
    """
    found = np.zeros((2, *shapes.collar_radii.shape))
    u, v = quarter_parameters(PROBES), graded(PROBES)
    size = 4 * PROBES * (PROBES + 1) * shapes.collar_radii.shape[1]
    for part in cut(np.arange(len(shapes)), size * PLACE_BYTES, CACHE):
        points, normals = around_struts(shapes[part], u, v)  # (U, N, levels + 1, sides, 3)
        here, there = points[:, :, :, ::2], np.roll(points[:, :, :, ::2], -1, axis=3)
        around = dot(points[:, :, :, 1::2] - (here + there) / 2, normals[:, :, :, 1::2])
        low, high = points[:, :, :-1:2], points[:, :, 2::2]
        ahead = dot(points[:, :, 1::2] - (low + high) / 2, normals[:, :, 1::2])
        found[:, part] = [np.abs(each).max(axis=(2, 3)) for each in (around, ahead)]
    return np.asarray(found / ((1 - np.cos(np.pi / (2 * PROBES))) * shapes.collar_radii))
