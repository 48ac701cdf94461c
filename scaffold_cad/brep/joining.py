"""Analytic B-reps put together: several in one, as the inside of a hollow part and its outside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.brep.analytic import AnalyticBrep, Axes, BrepEdges, BrepFaces, Surface


@dataclass(frozen=True, eq=False)
class PlaneRings(Frozen):
    """Plane faces between an outer circle and an inner one, which are edges of two B-reps."""

    origin: Points
    """Shape (r, 3), mm."""
    normal: UnitVectors
    """Outward, shape (r, 3)."""
    x: UnitVectors
    """Across it, shape (r, 3)."""
    edges: Ints
    """The edges around, in the first B-rep and in the second, shape (r, 2)."""
    forward: Bools
    """Whether they are used along or against their direction, shape (r, 2)."""
    shell: Ints
    """Shell of each, shape (r,)."""
    name: Ints
    """Name of each among those of the first B-rep, shape (r,)."""


def hollow(
    outer: AnalyticBrep, inner: AnalyticBrep, rings: PlaneRings, open_: Bools
) -> AnalyticBrep:
    """Return a B-rep with another one as its inside.

    Parameters
    ----------
    inner : has as many shells, shell s inside shell s of `outer`
    rings : plane faces that join both where the inside is open
    open_ : whether the inside of each shell is open, so that both are one shell, shape (s,)
    """
    counts = np.array([outer.edges.counts, inner.edges.counts])  # (2, 3)
    numbers = [_edge_numbers(counts, part) for part in (0, 1)]
    shells = len(outer.solid)
    own = np.where(open_, np.arange(shells), shells + np.cumsum(~open_) - 1)
    used = [numbers[part][faces.edge] for part, faces in enumerate((outer.faces, inner.faces))]
    ring_edges = np.stack([numbers[k][rings.edges[:, k]] for k in (0, 1)], axis=1)
    parts = [
        _Rows.of(outer.faces, used[0], outer.faces.outward, outer.faces.shell, 0),
        _Rows.of(
            inner.faces, used[1], ~inner.faces.outward, own[inner.faces.shell], len(outer.names)
        ),
        _Rows.rings(rings, ring_edges),
    ]
    return AnalyticBrep(
        np.concatenate([outer.vertices, inner.vertices]),
        _joined_edges(outer.edges, inner.edges, len(outer.vertices)),
        _joined_faces(parts, outer.faces, inner.faces, rings),
        np.concatenate([outer.solid, np.flatnonzero(~open_)]),
        (*outer.names, *(f"{name} inside" for name in inner.names)),
    )


def _edge_numbers(counts: Ints, part: int) -> Ints:
    """Return the new number of each edge of a part: lines first, then circles, then splines."""
    start = np.concatenate([[0], np.cumsum(counts.sum(axis=0))[:-1]])
    if part:
        start = start + counts[0]
    return np.concatenate([start[kind] + np.arange(counts[part, kind]) for kind in range(3)])


def _joined_edges(outer: BrepEdges, inner: BrepEdges, vertices: int) -> BrepEdges:
    cuts = [np.cumsum(edges.counts)[:2] for edges in (outer, inner)]
    rows = [np.split(outer.ends, cuts[0]), np.split(inner.ends + vertices, cuts[1])]
    ends = np.concatenate([part[kind] for kind in range(3) for part in rows])
    return BrepEdges(
        ends,
        _joined_axes([outer.circles, inner.circles]),
        np.concatenate([outer.radii, inner.radii]),
        np.concatenate([outer.angles, inner.angles]),
        (*outer.curves, *inner.curves),
    )


def _joined_axes(axes: Sequence[Axes]) -> Axes:
    return Axes(
        np.concatenate([each.origin for each in axes]),
        np.concatenate([each.z for each in axes]),
        np.concatenate([each.x for each in axes]),
    )


@dataclass(frozen=True, eq=False)
class _Rows(Frozen):
    """Faces, their loops and the uses of edges in these, each face's together."""

    kinds: Ints
    loop_count: Ints
    """Loops of each face, shape (f,)."""
    use_count: Ints
    """Uses of each loop, shape (l,)."""
    edge: Ints
    forward: Bools
    parameters: Floats
    outward: Bools
    shell: Ints
    name: Ints

    @staticmethod
    def of(faces: BrepFaces, edge: Ints, outward: Bools, shell: Ints, first_name: int) -> _Rows:
        return _Rows(
            faces.kinds,
            np.diff(faces.loops),
            np.diff(faces.uses),
            edge,
            faces.forward,
            faces.parameters,
            outward,
            shell,
            faces.name + first_name,
        )

    @staticmethod
    def rings(rings: PlaneRings, edges: Ints) -> _Rows:
        count = len(rings.origin)
        return _Rows(
            np.full(count, Surface.PLANE, dtype=np.intp),
            np.full(count, 2, dtype=np.intp),
            np.ones(2 * count, dtype=np.intp),
            edges.reshape(-1),
            rings.forward.reshape(-1),
            np.full((2 * count, 2, 2), np.nan),
            np.ones(count, dtype=np.bool_),
            rings.shell,
            rings.name,
        )


def _joined_faces(
    parts: list[_Rows], outer: BrepFaces, inner: BrepFaces, rings: PlaneRings
) -> BrepFaces:
    """Return the faces of all parts in the order of their kinds."""
    kinds = np.concatenate([part.kinds for part in parts])
    order = np.argsort(kinds, kind="stable")
    loop_count = np.concatenate([part.loop_count for part in parts])
    use_count = np.concatenate([part.use_count for part in parts])
    loops = _rows_of(loop_count, order)
    uses = _rows_of(use_count, loops)
    ring_axes = Axes(rings.origin, rings.normal, rings.x)
    axes = _joined_axes([outer.axes, inner.axes, ring_axes])
    sizes = np.concatenate([outer.sizes, inner.sizes, np.zeros((len(rings.origin), 2))])
    analytic = np.concatenate([part.kinds[part.kinds != Surface.SPLINE] for part in parts])
    placed = np.argsort(analytic, kind="stable")
    return BrepFaces(
        kinds[order],
        Axes(axes.origin[placed], axes.z[placed], axes.x[placed]),
        sizes[placed],
        (*outer.patches, *inner.patches),
        np.concatenate([part.outward for part in parts])[order],
        np.concatenate([[0], np.cumsum(loop_count[order])]),
        np.concatenate([[0], np.cumsum(use_count[loops])]),
        np.concatenate([part.edge for part in parts])[uses],
        np.concatenate([part.forward for part in parts])[uses],
        np.concatenate([part.parameters for part in parts])[uses],
        np.concatenate([part.shell for part in parts])[order],
        np.concatenate([part.name for part in parts])[order],
    )


def _rows_of(counts: Ints, order: Ints) -> Ints:
    """Return the rows of owners with `counts` rows each, the owners in another order."""
    starts = np.cumsum(counts) - counts
    chosen = counts[order]
    first = np.repeat(starts[order] - (np.cumsum(chosen) - chosen), chosen)
    return first + np.arange(len(first))
