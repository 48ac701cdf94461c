"""What goes into the blends of nodes, and what comes out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, UnitVectors
from scaffold_cad.errors import OptionError
from scaffold_cad.partition import Partitions
from scaffold_cad.struts.blending.copies import Views
from scaffold_cad.struts.blending.layouts import Layout

TOO_DEEP = 0.1
"""Depth inside a strut, over its radius, of a surface that is not the one asked for."""
TOO_FAR = 0.5
"""Distance outside the filleted union, over the least radius, of such a surface."""


@dataclass(frozen=True, eq=False)
class Stars(Frozen):
    """M branch points of one valency N ≥ 2, everything relative to the node."""

    directions: UnitVectors
    """Direction of each strut, unit vectors, shape (M, N, 3)."""
    radii: Floats
    """Radius of each strut in the plane across it through the node, mm, shape (M, N)."""
    slopes: Floats
    """Growth of each strut's radius along it, mm per mm, shape (M, N)."""
    blends: Floats
    """Fillet radius ρ that is asked for, mm, > 0, shape (M,)."""
    balls: Floats
    """Radius of the node's ball, mm, 0 for none, shape (M,)."""
    most: Floats
    """Greatest collar distance that there is room for, mm, shape (M, N)."""
    vertices: UnitVectors
    """Vertices of the node's partition, unit vectors, shape (M, N + 2, 3)."""
    quads: Ints
    """Vertices of the quad around each strut, counter-clockwise from outside, (M, N, 4)."""

    @classmethod
    def of(
        cls,
        partitions: Partitions,
        *,
        radii: ArrayLike,
        blends: ArrayLike,
        slopes: ArrayLike = 0.0,
        balls: ArrayLike = 0.0,
        most: ArrayLike = np.inf,
    ) -> Stars:
        """Return the stars of `partitions` with numbers for all, or one per node or strut.

        Raises
        ------
        OptionError
            If a radius or a blend is not a finite number > 0, a slope is not finite, a ball is
            negative, or `most` is not > 0; the node is named.
        """
        nodes, struts = partitions.directions.shape[:2]

        def wide(values: ArrayLike, name: str, *shape: int) -> Floats:
            try:
                return np.array(np.broadcast_to(np.asarray(values, dtype=np.float64), shape))
            except ValueError:
                raise OptionError(f"{name} does not fit; need numbers of shape {shape}") from None

        stars = cls(
            partitions.directions,
            wide(radii, "radii", nodes, struts),
            wide(slopes, "slopes", nodes, struts),
            wide(blends, "blends", nodes),
            wide(balls, "balls", nodes),
            wide(most, "most", nodes, struts),
            partitions.vertices,
            partitions.quads,
        )
        for name, least in (("radii", 0.0), ("blends", 0.0), ("most", 0.0)):
            _check(getattr(stars, name), name, getattr(stars, name) > least, "> 0")
        _check(stars.balls, "balls", np.isfinite(stars.balls) & (stars.balls >= 0), "≥ 0")
        for name in ("radii", "blends", "slopes"):
            _check(getattr(stars, name), name, np.isfinite(getattr(stars, name)), "finite")
        return stars

    def __len__(self) -> int:
        return len(self.directions)

    def __getitem__(self, item: Ints) -> Stars:
        return Stars(*(getattr(self, field.name)[item] for field in fields(self)))

    @property
    def views(self) -> Views:
        """How nodes are looked at so that turned copies of each other are alike."""
        room = np.where(np.isfinite(self.most), self.most, 0.0)
        lengths = (self.radii + 0.01 * room) / self.radii.mean(axis=1, keepdims=True)
        # Any weights do that differ where struts do.
        return Views.of(self.directions, lengths + 0.7 * self.slopes)

    def seen(self, views: Views) -> Stars:
        """Return the stars as they are seen in `views`."""
        return Stars(
            views.by_number(views.seen(self.directions)),
            views.by_number(self.radii),
            views.by_number(self.slopes),
            self.blends,
            self.balls,
            views.by_number(self.most),
            views.seen(self.vertices),
            views.by_number(self.quads),
        )


def _check(values: Floats, name: str, good: Bools, need: str) -> None:
    bad = np.argwhere(~good)
    if len(bad):
        found = values[tuple(bad[0])]
        raise OptionError(f"{name} of node {bad[0][0]} has {found:g}; need a number {need}")


@dataclass(frozen=True, eq=False)
class Solved(Frozen):
    """U blends with patches of one layout."""

    layout: Layout
    """How patches are cut into polynomial pieces."""
    control: Floats
    """Control points, relative to the node, mm, shape (U, 4 N, n_u, n_v, 3).

    Patch 4 i + k lies between arc k of quad i (v = 0) and quarter k of collar i (v = 1).
    """
    vertices: UnitVectors
    """Vertices of the partition as they were moved, shape (U, N + 2, 3)."""
    collar_distances: Floats
    """Distance of each collar from the node, mm, shape (U, N)."""
    collar_radii: Floats
    """Radius of each collar, mm, shape (U, N)."""
    collar_corners: UnitVectors
    """Unit vectors across each strut to the starts of its collar's quarters, (U, N, 4, 3)."""
    rho: Floats
    """Fillet radius that had room, mm, shape (U,)."""
    has_room: Bools
    """Whether collars are as near as asked for, and the wall as thick, shape (U,)."""
    is_star_shaped: Bools
    """Whether the surface is proved to be star-shaped around the node, shape (U,)."""
    solid_angle: Floats
    """What the surface and its discs cover of the sphere of directions, sr, shape (U,)."""
    least_cosine: Floats
    """Least cosine between the normal and the direction from the node at samples, (U,)."""
    misfit: Floats
    """Greatest distance of samples from the filleted union, over the least radius, (U,)."""
    bulge: Floats
    """Greatest distance of samples outside it, over the least radius, shape (U,)."""
    depth: Floats
    """Greatest depth of samples inside a strut or the ball, over its radius, shape (U,)."""

    def __len__(self) -> int:
        return len(self.control)

    def __getitem__(self, item: Ints) -> Solved:
        rest = fields(self)[1:]
        return Solved(self.layout, *(getattr(self, field.name)[item] for field in rest))

    def meant(self, views: Views) -> Solved:
        """Return the blends of which these are as they are seen in `views`, (U) both."""
        count, struts = self.collar_radii.shape
        by_strut = self.control.reshape(count, struts, 4, *self.control.shape[2:])
        return replace(
            self,
            control=views.meant(views.by_strut(by_strut)).reshape(self.control.shape),
            vertices=views.meant(self.vertices),
            collar_distances=views.by_strut(self.collar_distances),
            collar_radii=views.by_strut(self.collar_radii),
            collar_corners=views.meant(views.by_strut(self.collar_corners)),
        )

    @staticmethod
    def joined(parts: Sequence[Solved]) -> Solved:
        """Return `parts` with as many pieces a patch one after another."""
        rest = fields(parts[0])[1:]
        return Solved(
            parts[0].layout,
            *(np.concatenate([getattr(part, field.name) for part in parts]) for field in rest),
        )

    @property
    def proved(self) -> Bools:
        """Whether each blend is proved to be free of folds, shape (U,)."""
        covered = np.abs(self.solid_angle - 4 * np.pi) < 1.0
        return np.asarray(self.is_star_shaped & covered)

    @property
    def sound(self) -> Bools:
        """Whether each blend is proved, has room and is near to what was asked for, shape (U,)."""
        near = (self.depth <= TOO_DEEP) & (self.bulge <= TOO_FAR)
        return np.asarray(self.proved & self.has_room & near)

    @property
    def reach(self) -> Floats:
        """Greatest distance of a control point from the node, mm, shape (U,).

        The surface lies within it.
        """
        square = np.einsum("upabx,upabx->upab", self.control, self.control)
        return np.asarray(np.sqrt(square.max(axis=(1, 2, 3))))


def best_by_layout(
    found: Sequence[Solved], which: Ints, place: Ints
) -> Iterator[tuple[Ints, Solved]]:
    """Yield the nodes whose best blends have patches of as many pieces, and these blends.

    Parameters
    ----------
    found : blends of some of the nodes, as often as was tried
    which : (U,) which of these has the best blend of a node, -1 for none
    place : (U,) place in it
    """
    pieces = [each.layout.pieces for each in found]
    for layout in dict.fromkeys(pieces):
        trials = [number for number, other in enumerate(pieces) if other == layout]
        rows = [np.flatnonzero(which == number) for number in trials]
        parts = [found[number][place[row]] for number, row in zip(trials, rows, strict=True)]
        nodes = np.concatenate(rows)
        order = np.argsort(nodes)
        if len(nodes):
            yield nodes[order], Solved.joined(parts)[order]


@dataclass(frozen=True, eq=False)
class Skins(Frozen):
    """The surfaces of U nodes of one valency, and the struts that they join."""

    shapes: Solved
    quads: Ints
    """Corners of the quad around each strut, shape (U, N, 4)."""
    axes: UnitVectors
    """Direction of each strut, shape (U, N, 3)."""
    slopes: Floats
    """Growth of each strut's radius along it, shape (U, N)."""

    def __len__(self) -> int:
        return len(self.shapes)

    def __getitem__(self, rows: Ints) -> Skins:
        return Skins(self.shapes[rows], self.quads[rows], self.axes[rows], self.slopes[rows])


@dataclass(frozen=True, eq=False)
class Originals(Frozen):
    """Nodes as they were solved, and of which of them U blends are turned copies."""

    skins: Skins
    """K nodes as they are seen in their views."""
    which: Ints
    """Which of them each blend is a copy of, shape (U,)."""
    views: Views
    """The views, U, in which each is seen as that node."""

    def __getitem__(self, rows: Ints) -> Originals:
        return Originals(self.skins, self.which[rows], self.views[rows])

    def turned(self) -> Solved:
        """Return the U copies."""
        return self.skins.shapes[self.which].meant(self.views)


@dataclass(frozen=True, eq=False)
class Blends(Frozen):
    """The blends of m nodes of one valency and one layout. Equal nodes share a blend."""

    stars: Stars
    """The nodes."""
    nodes: Ints
    """Number of each among the nodes that were asked for, shape (m,)."""
    shape_of: Ints
    """Blend of each node, shape (m,), in 0..U-1."""
    twins: Ints
    """Patch that shares the arc of each one, run along the other way, shape (U, 4 N)."""
    shapes: Solved
    """The blends."""
    originals: Originals
    """What they are turned copies of."""

    @property
    def control(self) -> Floats:
        """Control points of each blend, shape (U, 4 N, n_u, n_v, 3)."""
        return self.shapes.control

    @property
    def layout(self) -> Layout:
        """How patches are cut into polynomial pieces."""
        return self.shapes.layout

    @property
    def axes(self) -> UnitVectors:
        """Directions of the struts of each blend, shape (U, N, 3)."""
        first = np.unique(self.shape_of, return_index=True)[1]
        return np.asarray(self.stars.directions[first])

    @property
    def bounds(self) -> Floats:
        """Cylinders that hold the patches of each strut, shape (U, N, 3), mm.

        Least and greatest height of a control point along the strut, from the node, and the
        greatest distance from the axis: a patch lies among its control points.
        """
        points = self.control.reshape(len(self.shapes), self.axes.shape[1], -1, 3)
        height = np.einsum("uipx,uix->uip", points, self.axes)
        across = points - height[..., None] * self.axes[:, :, None]
        widest = np.sqrt(np.einsum("uipx,uipx->uip", across, across).max(axis=2))
        return np.stack([height.min(axis=2), height.max(axis=2), widest], axis=2)

    @property
    def proved(self) -> Bools:
        """Whether the blend of each node is proved to be free of folds, shape (m,)."""
        return np.asarray(self.shapes.proved[self.shape_of])
