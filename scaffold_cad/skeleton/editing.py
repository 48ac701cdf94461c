"""What makes a new skeleton of one: united, turned, mirrored, moved, cut in pieces or to a region.

`Skeleton` has these as its methods.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, TypeVar, get_args, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import (
    as_count,
    as_direction,
    as_number,
    as_real,
    as_vector,
    check_choice,
    described,
)
from scaffold_cad.base.arrays import Edges, Floats, Ints, Points, Radii
from scaffold_cad.base.placements import (
    BoxLike,
    DirectionLike,
    PositionLike,
    numbers_of,
    origin_of,
    placement_of,
    side_of,
)
from scaffold_cad.base.ranges import steps
from scaffold_cad.base.regions import BoxRegion, ImplicitRegion, Keep, Region
from scaffold_cad.base.vectors import mirror, rotate, rotated, shortest_turns
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.skeleton.cutting import cut_at, drawn_together, inside
from scaffold_cad.skeleton.repair import radii_left, repaired

if TYPE_CHECKING:
    from build123d import Location, Plane

SHORTEST_FRACTION = 1e-3
"""Length below which the rest of a cut edge is given up, as a fraction of the mean length."""

MARGIN = 1.0
"""How far beyond a skeleton a function is taken for a region, mm."""

_Edited = TypeVar("_Edited", bound="Editing")


@runtime_checkable
class HasDistance(Protocol):
    """Anything that knows how far points are from its surface."""

    def signed_distance(self, points: Points) -> ArrayLike:
        """Return distances (n,) of points (n, 3), negative inside, mm."""


CutRegion: TypeAlias = "Region | HasDistance | Callable[[Points], ArrayLike] | BoxLike | Plane"
"""A region, a box, a function that is negative inside, or an object with such a one."""


class Editing(ABC):
    """Methods that return a new skeleton; what they are called on stays as it is."""

    nodes: Points
    edges: Edges
    radii: Radii
    edge_radii: Floats

    @abstractmethod
    def _like(
        self: _Edited, nodes: ArrayLike, edges: ArrayLike, radii: ArrayLike, edge_radii: ArrayLike
    ) -> _Edited:
        """Return a skeleton of these arrays."""

    def __add__(self: _Edited, other: Any) -> _Edited:
        """Return both as one; nodes at the same place are welded, edges that both have are one.

        Nodes within 1e-7 of the diagonal are at the same place. A welded node has the larger of
        both radii.
        """
        if not isinstance(other, Editing):
            return NotImplemented
        if len(self.edges) == 0 or len(other.edges) == 0:
            return self._like(*_columns(self if len(self.edges) else other))
        graph = repaired(
            np.concatenate([self.nodes, other.nodes]),
            np.concatenate([self.edges, other.edges + len(self.nodes)]),
            np.concatenate([self.radii, other.radii]),
            np.concatenate([self.edge_radii, other.edge_radii]),
        )
        return self._like(graph.nodes, graph.edges, graph.radii, graph.edge_radii)

    def __radd__(self: _Edited, other: Any) -> _Edited:
        """Return the skeleton itself for 0, from which `sum` begins."""
        return self if isinstance(other, int) and other == 0 else NotImplemented

    def __rmul__(self: _Edited, place: Any) -> _Edited:
        """Return the skeleton moved by a Plane or Location, as build123d moves its shapes."""
        return NotImplemented if placement_of(place) is None else self.moved_by(place)

    def moved_by(self: _Edited, offset: PositionLike | Plane | Location) -> _Edited:
        """Return the skeleton moved by `offset`, three numbers or a Vector, mm.

        A Location or Plane of build123d turns it too: `Pos(9, 0, 0) * strut`.

        >>> from scaffold_cad import Skeleton
        >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
        >>> (strut + strut.moved_by([9, 0, 0])).nodes[:, 0].tolist()
        [0.0, 9.0, 18.0]
        """
        placement = placement_of(offset)
        if placement is None:
            return self._at(self.nodes + as_vector(offset, "offset"))
        return self._at(self.nodes @ placement[:, :3].T + placement[:, 3])

    def turned(
        self: _Edited,
        angle: float,
        axis: DirectionLike = (0.0, 0.0, 1.0),
        about: PositionLike | None = None,
    ) -> _Edited:
        """Return the skeleton turned by `angle` (rad) around an axis through a point (mm).

        The turn is counter-clockwise seen from the axis's tip. Without a point the axis is where an
        Axis of build123d is, and else through the origin.
        """
        place = as_vector(origin_of(axis) if about is None else about, "about")
        turn = np.asarray(_finite(angle, "angle"))
        return self._at(place + rotate(self.nodes - place, as_direction(axis, "axis"), turn))

    def mirrored(
        self: _Edited, normal: DirectionLike, about: PositionLike | None = None
    ) -> _Edited:
        """Return the mirror image in the plane with a normal through a point (mm).

        A Plane of build123d has both; else the plane goes through the origin without a point.
        """
        place = as_vector(origin_of(normal) if about is None else about, "about")
        return self._at(place + mirror(self.nodes - place, as_direction(normal, "normal")))

    def oriented(self: _Edited, up: DirectionLike) -> _Edited:
        """Return the skeleton turned so that `up` points along z, its lowest ball on z = 0.

        Take for `up` the best direction that `check_printability` reports.
        """
        direction = as_direction(up, "up")
        turn = shortest_turns(direction[None], np.array([[0.0, 0.0, 1.0]]))
        nodes = rotated(self.nodes, np.repeat(turn, len(self.nodes), axis=0))
        low = float((nodes[:, 2] - self.radii).min(initial=np.inf))
        return self._at(nodes - [0.0, 0.0, low] if len(nodes) else nodes)

    def subdivided(
        self: _Edited, count: int | None = None, *, longest: float | None = None
    ) -> _Edited:
        """Return the skeleton with each edge in equal pieces; radii change evenly along it.

        Parameters
        ----------
        count : pieces of each edge, ≥ 1
        longest : in place of a count: as few pieces as make none longer than this, mm
        """
        if (count is None) == (longest is None):
            raise OptionError("need either a count of pieces or their longest length")
        ends = self.nodes[self.edges]
        spans = np.sqrt(((ends[:, 1] - ends[:, 0]) ** 2).sum(axis=1))
        if count is not None:
            pieces = np.full(len(spans), as_count(count, "count of pieces", least=1))
        else:
            limit = as_number(longest, "longest length")
            pieces = np.maximum(np.ceil(spans / limit * (1 - 1e-12)), 1).astype(np.intp)
        edge = np.repeat(np.arange(len(spans)), pieces - 1)
        step = steps(pieces - 1)
        cut = cut_at(self.nodes, self.edges, edge, (step + 1) / pieces[edge])
        edge_radii = self._radii_along(cut.source, cut.along)
        new = self._radii_at(edge, (step + 1) / pieces[edge])
        return self._like(cut.nodes, cut.edges, np.concatenate([self.radii, new]), edge_radii)

    def cut(
        self: _Edited, region: CutRegion, *, keep: Keep = "clip", shortest: float | None = None
    ) -> _Edited:
        """Return the part of the skeleton in a region, its surface included.

        `scaffold_cad.cut` takes build123d solids and meshes too.

        Parameters
        ----------
        region : a box (its lowest and highest corner, mm); a function of positions (n, 3) that
            returns signed distances (n,), negative inside; an object with such a method
            `signed_distance`; a Plane, of which the side counts that its z axis points to; or a
            region
        keep : "clip" cuts edges at the surface, where they get a new node; "whole" keeps those
            whole that have their middle in the region
        shortest : pieces of cut edges shorter than this are shrunk to a node on the surface, mm;
            by default 1/1000 of the mean length of edges

        Raises
        ------
        OptionError
            If `region` is not one of these.
        SkeletonError
            If nothing is left.
        """
        check_choice(keep, "keep", get_args(Keep))
        space = self._as_region(region)
        if keep == "whole":
            middles = self.nodes[self.edges].mean(axis=1)
            kept = np.flatnonzero(space.contains(middles))
            edges, edge_radii = self.edges[kept], self.edge_radii[kept]
            radii = radii_left(self.radii, (self.edges, self.edge_radii), (edges, edge_radii))
            return self._tidy(self.nodes, edges, radii, edge_radii)
        pieces = inside(self.nodes, self.edges, space)
        old = len(self.nodes)
        edge_radii = self._radii_along(pieces.source, pieces.along)
        radii = np.concatenate([self.radii, np.zeros(len(pieces.nodes) - old)])  # 0 at new nodes
        radii = radii_left(radii, (self.edges, self.edge_radii), (pieces.edges, edge_radii))
        ends = pieces.edges.reshape(-1)
        is_new = ends >= old
        radii[ends[is_new]] = edge_radii.reshape(-1)[is_new]
        on_surface = np.arange(len(pieces.nodes)) >= old
        spans = self.nodes[self.edges[:, 1]] - self.nodes[self.edges[:, 0]]
        limit = SHORTEST_FRACTION * float(np.sqrt((spans**2).sum(axis=1)).mean())
        if shortest is not None:
            limit = as_number(shortest, "shortest length", or_zero=True)
        short = on_surface[pieces.edges].any(axis=1) & (pieces.lengths < limit)
        nodes, label = drawn_together(pieces.nodes, pieces.edges, short, on_surface)
        largest = np.zeros(len(nodes))
        np.maximum.at(largest, label, radii)
        return self._tidy(nodes, label[pieces.edges[~short]], largest, edge_radii[~short])

    def _at(self: _Edited, nodes: ArrayLike) -> _Edited:
        return self._like(nodes, self.edges, self.radii, self.edge_radii)

    def _radii_at(self, edge: Ints, along: Floats) -> Floats:
        """Return the radius of edges at places along them, both (k,), shape (k,), mm."""
        start, end = self.edge_radii[edge].T
        radii: Floats = start + along * (end - start)
        return radii

    def _radii_along(self, edge: Ints, along: Floats) -> Floats:
        """Return the radius of edges at both ends of their pieces, (p, 2), mm."""
        return np.stack([self._radii_at(edge, column) for column in along.T], axis=1)

    def _as_region(self, region: CutRegion) -> Region:
        if isinstance(region, Region):
            return region
        region = side_of(numbers_of(region))
        if isinstance(region, list | tuple | np.ndarray):
            return BoxRegion(region)
        function = region.signed_distance if isinstance(region, HasDistance) else region
        if not callable(function):
            raise OptionError(
                f"the region is {described(region)}; need a box, or a function that is "
                "negative inside (scaffold_cad.cut takes solids and meshes)"
            )
        low, high = self.nodes.min(axis=0) - MARGIN, self.nodes.max(axis=0) + MARGIN
        return ImplicitRegion(function, [low, high])

    def _tidy(
        self: _Edited, nodes: Points, edges: Edges, radii: Floats, edge_radii: Floats
    ) -> _Edited:
        """Return edges without the nodes that none reaches, and without repeated ones."""
        if len(edges) == 0:
            low, high = self.nodes.min(axis=0).tolist(), self.nodes.max(axis=0).tolist()
            raise SkeletonError(
                f"no edge of the skeleton from {low} to {high} mm is in the region; need one"
            )
        used, ends = np.unique(edges, return_inverse=True)
        graph = repaired(
            nodes[used], ends.reshape(-1, 2), radii[used], edge_radii, weld_distance=0.0
        )
        return self._like(graph.nodes, graph.edges, graph.radii, graph.edge_radii)


def _columns(skeleton: Editing) -> tuple[Points, Edges, Radii, Floats]:
    return skeleton.nodes, skeleton.edges, skeleton.radii, skeleton.edge_radii


def _finite(value: float, name: str) -> float:
    number = as_real(value, name)
    if not np.isfinite(number):
        raise OptionError(f"{name} is {number:g}; need a finite number, rad")
    return number
