"""Graphs whose edges have radii, and graphs whose nodes have names."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Sequence
from pathlib import Path

import numpy as np

from scaffold_cad.errors import FormatError
from scaffold_cad.io._loading import PLANAR, Gathered
from scaffold_cad.io._raw import RawSkeleton


def radius_of_area(area: float) -> float:
    """Return the radius of the circle of an area; NaN for none, and less than 0 as the area is."""
    return math.copysign(math.sqrt(abs(area) / math.pi), area) if area else math.nan


def _shown(name: Hashable) -> str:
    """Return a name as the file has it: of a pair, such as an instance and a node, the latter."""
    return f"{name[-1] if isinstance(name, tuple) else name!r:.80}"


class NamedGraph:
    """Nodes and edges gathered one by one, under the names that a file has for them."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._number: dict[Hashable, int] = {}
        self._points: list[Sequence[float]] = []
        self._dimension = 3
        self._radii: list[float] = []
        self._edges: list[tuple[int, int]] = []
        self._edge_radii: list[tuple[float, float]] = []
        self._gathered = Gathered()

    def __len__(self) -> int:
        return len(self._points)

    def __contains__(self, name: Hashable) -> bool:
        return name in self._number

    def add_node(
        self, name: Hashable, point: Sequence[float], radius: float = math.nan, where: str = ""
    ) -> None:
        """Add a node; `point` is x, y, z or x, y; `where` is its place in the file.

        Raises
        ------
        FormatError
            If the name is taken, or some nodes have a z and others have none.
        """
        if name in self._number:
            raise self._error(where, f"node {_shown(name)} is there already", "each name once")
        if self._points and len(point) != self._dimension:
            raise self._error(
                where,
                f"node {_shown(name)} has {len(point)} coordinates, those before {self._dimension}",
                "x, y and z of all, or x and y",
            )
        self._dimension = len(point)
        self._number[name] = len(self._points)
        self._points.append([*point, 0.0][:3])
        self._radii.append(radius)

    def add_edge(
        self,
        start: Hashable,
        end: Hashable,
        radius: float | tuple[float, float] = math.nan,
        where: str = "",
    ) -> None:
        """Add an edge between two nodes that are there already.

        Raises
        ------
        FormatError
            If one of them is not.
        """
        for name in (start, end):
            if name not in self._number:
                found = f"an edge has the end {_shown(name)}"
                raise self._error(where, found, "a node of the file")
        self._edges.append((self._number[start], self._number[end]))
        self._edge_radii.append(radius if isinstance(radius, tuple) else (radius, radius))

    def hold(
        self, name: Hashable, freedoms: Iterable[int], value: float = 0.0, where: str = ""
    ) -> None:
        """Hold freedoms 0..5 of a node, or move them by `value`, mm and rad.

        Raises
        ------
        FormatError
            If the node is not there.
        """
        self._gathered.hold(self._of(name, "a support", where), freedoms, value)

    def pull(self, name: Hashable, freedom: int, value: float, where: str = "") -> None:
        """Add a force along, or a moment about, an axis of a node, N and N mm.

        Raises
        ------
        FormatError
            If the node is not there.
        """
        self._gathered.pull(self._of(name, "a load", where), freedom, value)

    def hold_in_plane(self) -> None:
        """Hold what keeps all nodes in the plane of x and y."""
        for node in range(len(self)):
            self._gathered.hold(node, PLANAR)

    def _of(self, name: Hashable, what: str, where: str) -> int:
        if name not in self._number:
            raise self._error(where, f"{what} is on node {_shown(name)}", "a node of the file")
        return self._number[name]

    def skeleton(
        self, scale: float = 1.0, unit: str | None = None, usual_unit: str | None = None
    ) -> RawSkeleton:
        """Return the graph, its lengths times `scale`; for the units see `RawSkeleton`."""
        points = np.reshape(np.asarray(self._points, dtype=np.float64), (-1, 3)) * scale
        edges = np.reshape(np.asarray(self._edges, dtype=np.intp), (-1, 2))
        radii = np.asarray(self._radii, dtype=np.float64) * scale
        of_edges = np.reshape(np.asarray(self._edge_radii, dtype=np.float64), (-1, 2)) * scale
        of_nodes = None if np.isnan(radii).all() else radii
        of_members = None if np.isnan(of_edges).all() else of_edges
        return RawSkeleton(
            points,
            edges,
            of_nodes,
            of_members,
            unit=unit,
            usual_unit=usual_unit,
            loading=self._gathered.loading(len(points)),
        )

    def _error(self, where: str, found: str, needed: str) -> FormatError:
        place = f"{self._path}, {where}" if where else str(self._path)
        return FormatError(f"{place}: {found}; need {needed}")
