"""RawSkeleton: what a file holds, before any repair."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.arrays import (
    Edges,
    Floats,
    Frozen,
    Points,
    as_edges,
    as_floats,
    check_believable,
)
from scaffold_cad.base.positions import equal_positions
from scaffold_cad.base.summaries import counted, radii_text, size_text
from scaffold_cad.errors import SkeletonError
from scaffold_cad.io._loading import RawLoading


@checks_keywords()
@dataclass(frozen=True, eq=False)
class RawSkeleton(Frozen):
    """A graph as a file holds it: perhaps with faults, perhaps without radii.

    The constructor refuses what no repair could use: arrays that do not fit each other, indices
    out of range, and numbers beyond `LARGEST_COORDINATE`.
    """

    nodes: Points
    """Node positions, shape (n, 3), mm; NaN where the file gives a node none."""
    edges: Edges
    """Node pairs, shape (m, 2), all in 0..n-1."""
    radii: Floats | None
    """Radius of each node, shape (n,), mm, or None if the file holds no radii of nodes."""
    edge_radii: Floats | None
    """Radius of each edge at both ends, shape (m, 2), mm, nan where the file gives none; None if
    the file holds no radii of edges."""
    left_out: tuple[str, ...]
    """What the file holds beside that a skeleton does not keep, in words."""
    flat_ends: int
    """How many ends of beams are flat where others are balls: ends of skeletons have no shape."""
    loading: RawLoading | None
    """What holds and loads the nodes; None if the file holds nothing of it."""
    unit: str | None
    """Unit that the file names, whose lengths are mm here; None if it names none."""
    usual_unit: str | None
    """Unit that files of the format have by custom, whose numbers are taken as mm; None for
    formats in mm and for those without a custom."""

    def __init__(
        self,
        nodes: ArrayLike,
        edges: ArrayLike,
        radii: ArrayLike | None = None,
        edge_radii: ArrayLike | None = None,
        left_out: Iterable[str] = (),
        unit: str | None = None,
        usual_unit: str | None = None,
        loading: RawLoading | None = None,
        flat_ends: int = 0,
    ) -> None:
        points = as_floats(nodes, "nodes")
        if points.ndim != 2 or points.shape[1] != 3:
            raise SkeletonError(f"nodes have shape {points.shape}; need (n, 3)")
        check_believable(points, "is at")
        pairs = as_edges(edges, "edges", count=len(points))
        self._keep(
            nodes=points,
            edges=pairs,
            radii=None if radii is None else _as_raw_radii(radii, count=len(points)),
            edge_radii=None if edge_radii is None else _as_raw_edge_radii(edge_radii, len(pairs)),
            left_out=tuple(left_out),
            flat_ends=flat_ends,
            unit=unit,
            usual_unit=usual_unit,
            loading=loading,
        )

    def __str__(self) -> str:
        counts = f"{counted(len(self.nodes), 'node')}, {counted(len(self.edges), 'edge')}"
        radii = "no radii" if self.radii is None else radii_text(self.radii)
        return f"RawSkeleton: {counts}, {size_text(self.nodes)}, {radii}"

    def scaled(self, factor: float) -> RawSkeleton:
        """Return the graph with positions and radii multiplied by `factor`.

        Raises
        ------
        SkeletonError
            If a number is beyond `LARGEST_COORDINATE` then.
        """
        sizes = (self.radii, self.edge_radii)
        radii, edge_radii = (None if one is None else one * factor for one in sizes)
        return RawSkeleton(
            self.nodes * factor,
            self.edges,
            radii,
            edge_radii,
            self.left_out,
            self.unit,
            self.usual_unit,
            None if self.loading is None else self.loading.scaled(factor),
            self.flat_ends,
        )

    @property
    def beyond_skeleton(self) -> list[str]:
        """In words what the file holds that a skeleton does not keep, flat ends too."""
        flat = f"{counted(self.flat_ends, 'flat end')} of beams"
        return [*self.left_out, flat] if self.flat_ends else [*self.left_out]

    @property
    def has_radii(self) -> bool:
        """Whether the file holds radii, of nodes or of edges."""
        return self.radii is not None or self.edge_radii is not None


def _as_raw_edge_radii(values: ArrayLike, count: int) -> Floats:
    radii = as_floats(values, "edge_radii")
    if radii.shape == (count,):
        radii = np.stack([radii, radii], axis=1)
    if radii.shape != (count, 2):
        raise SkeletonError(f"edge_radii have shape {radii.shape}; need ({count}, 2), two per edge")
    check_believable(radii, "of an edge has radii")
    return radii


def _as_raw_radii(values: ArrayLike, count: int) -> Floats:
    radii = as_floats(values, "radii")
    if radii.shape != (count,):
        raise SkeletonError(f"radii have shape {radii.shape}; need ({count},), one per node")
    check_believable(radii, "has radius")
    return radii


def joined_polylines(polylines: Sequence[Points], unit: str | None = None) -> RawSkeleton:
    """Return polylines, each (k, 3), as a graph; they join where they have equal points.

    Parameters
    ----------
    unit : that the file names
    """
    points = np.concatenate([np.zeros((0, 3)), *polylines])
    node, first = equal_positions(points)
    ends = np.cumsum([len(line) for line in polylines if len(line)], dtype=np.intp) - 1
    starts = np.delete(np.arange(len(points)), ends)
    edges = np.stack([node[starts], node[starts + 1]], axis=1)
    return RawSkeleton(points[first], edges, unit=unit)
