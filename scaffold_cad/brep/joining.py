"""Analytic B-reps put together: several in one, as the inside of a hollow part and its outside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.topology import component_labels
from scaffold_cad.brep.analytic import AnalyticBrep, Axes, BrepEdges, BrepFaces, Surface, Traces


@dataclass(frozen=True, eq=False)
class PlaneRings(Frozen):
    """Plane faces with a hole, whose two loops are a circle of one B-rep and edges of another."""

    origin: Points
    """Shape (r, 3), mm."""
    normal: UnitVectors
    """Outward, shape (r, 3)."""
    x: UnitVectors
    """Across it, shape (r, 3)."""
    edges: Ints
    """The edges around: one of the first B-rep, then the loop in the second, shape (r, 1 + s)."""
    forward: Bools
    """Whether they are used along or against their direction, shape (r, 1 + s)."""
    swapped: Bools
    """Whether the loop in the second B-rep is the larger one, shape (r,)."""
    shell: Ints
    """Shell of each, shape (r,)."""
    name: Ints
    """Name of each among those of both, shape (r,)."""

    @staticmethod
    def none() -> PlaneRings:
        """Return no rings."""
        rows, pairs, numbers = np.empty((0, 3)), np.empty((0, 2), np.intp), np.empty(0, np.intp)
        flags = np.empty(0, dtype=np.bool_)
        return PlaneRings(rows, rows, rows, pairs, pairs.astype(np.bool_), flags, numbers, numbers)


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
    shells = len(outer.solid)
    own = np.where(open_, np.arange(shells), shells + np.cumsum(~open_) - 1)
    solids = np.concatenate([outer.solid, np.flatnonzero(~open_)])
    inside = turned(inner)
    return _joined(outer, inside, rings, inside.faces.outward, own, solids)


def extended(body: AnalyticBrep, parts: AnalyticBrep, rings: PlaneRings) -> AnalyticBrep:
    """Return open shells with further faces, which plane rings join to them.

    Parameters
    ----------
    body : open at circles
    parts : has as many shells, whose faces become those of the shells of `body`
    rings : plane faces that join both
    """
    own = np.arange(len(body.solid))
    return _joined(body, parts, rings, parts.faces.outward, own, body.solid)


def turned(brep: AnalyticBrep) -> AnalyticBrep:
    """Return the same seen from inside, as its names say too."""
    names = tuple(f"{name} inside" for name in brep.names)
    return replace(brep, faces=replace(brep.faces, outward=~brep.faces.outward), names=names)


def _joined(
    first: AnalyticBrep,
    second: AnalyticBrep,
    rings: PlaneRings,
    outward: Bools,
    shells: Ints,
    solids: Ints,
) -> AnalyticBrep:
    """Return two B-reps in one.

    Parameters
    ----------
    outward : whether the normals of the second one's surfaces point out of the whole
    shells : (s,) shell of the whole that each shell of the second one becomes
    solids : solid of each shell of the whole
    """
    numbers = edge_numbers(first, second)
    used = [numbers[part][faces.edge] for part, faces in enumerate((first.faces, second.faces))]
    edges = rings.edges
    ring_edges = np.hstack([numbers[0][edges[:, :1]], numbers[1][edges[:, 1:]]])
    parts = [
        _Rows.of(first.faces, used[0], first.faces.outward, first.faces.shell, 0),
        _Rows.of(second.faces, used[1], outward, shells[second.faces.shell], len(first.names)),
        _Rows.rings(rings, ring_edges),
    ]
    return AnalyticBrep(
        np.concatenate([first.vertices, second.vertices]),
        _joined_edges(first.edges, second.edges, len(first.vertices)),
        _joined_faces(parts, first.faces, second.faces, rings),
        solids,
        (*first.names, *second.names),
        np.concatenate([first.slacks, second.slacks]),
    )


def edge_numbers(first: AnalyticBrep, second: AnalyticBrep) -> tuple[Ints, Ints]:
    """Return the new number of each edge of two B-reps when they are joined."""
    counts = np.array([first.edges.counts, second.edges.counts])  # (2, 3)
    return _edge_numbers(counts, 0), _edge_numbers(counts, 1)


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
        np.concatenate([outer.lesser_radii, inner.lesser_radii]),
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
        count, around = edges.shape
        swapped = rings.swapped[:, None]
        edges = np.where(swapped, np.roll(edges, -1, axis=1), edges)
        forward = np.where(swapped, np.roll(rings.forward, -1, axis=1), rings.forward)
        uses = np.where(swapped, [around - 1, 1], [1, around - 1])
        return _Rows(
            np.full(count, Surface.PLANE, dtype=np.intp),
            np.full(count, 2, dtype=np.intp),
            uses.reshape(-1),
            edges.reshape(-1),
            forward.reshape(-1),
            np.full((edges.size, 2, 2), np.nan),
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
        _joined_traces(outer, inner, uses),
    )


def _joined_traces(outer: BrepFaces, inner: BrepFaces, uses: Ints) -> tuple[Traces, ...]:
    """Return the traces of both parts, where `uses` has the old number of each use."""
    number = np.empty(len(uses), dtype=np.intp)
    number[uses] = np.arange(len(uses))
    first = [(table, table.use) for table in outer.traces]
    second = [(table, table.use + len(outer.edge)) for table in inner.traces]
    return tuple(replace(table, use=number[own]) for table, own in first + second)


def _rows_of(counts: Ints, order: Ints) -> Ints:
    """Return the rows of owners with `counts` rows each, the owners in another order."""
    starts = np.cumsum(counts) - counts
    chosen = counts[order]
    first = np.repeat(starts[order] - (np.cumsum(chosen) - chosen), chosen)
    return first + np.arange(len(first))


def by_edges(brep: AnalyticBrep) -> AnalyticBrep:
    """Return the same with a shell, and a solid, for all faces that edges connect."""
    faces = brep.faces
    links = np.stack([faces.face_of_use, len(faces.kinds) + faces.edge], axis=1)
    labels = component_labels(links, len(faces.kinds) + len(brep.edges.ends))
    _, shell = np.unique(labels[: len(faces.kinds)], return_inverse=True)
    shell = shell.reshape(-1)
    return replace(brep, faces=replace(faces, shell=shell), solid=np.arange(shell.max() + 1))


def with_voids(brep: AnalyticBrep, void: Bools) -> AnalyticBrep:
    """Return the same with some of its shells (s,) as voids in the others, each a solid.

    A void is in that of the solids whose box holds its own that has the nearest vertex. Whole
    circles reach beyond their vertex, and straight struts have no others.
    """
    order = np.argsort(void, kind="stable")
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    faces, bodies = brep.faces, int((~void).sum())
    shell = rank[faces.shell]
    of_use = shell[faces.face_of_use]
    low, high = np.full((2, len(void), 3), np.inf)
    ends = brep.vertices[brep.edges.ends[faces.edge]]  # (u, 2, 3)
    lows, highs = _boxes(brep)
    np.minimum.at(low, of_use, lows[faces.edge])
    np.minimum.at(high, of_use, -highs[faces.edge])
    solid = np.arange(len(void))
    for each in range(bodies, len(void)):
        holds = (low[:bodies] <= low[each]).all(axis=1) & (high[:bodies] <= high[each]).all(axis=1)
        around = np.isin(of_use, np.flatnonzero(holds) if holds.any() else np.arange(bodies))
        distance, nearest = map(np.asarray, cKDTree(ends[around, 0]).query(ends[of_use == each, 0]))
        solid[each] = of_use[around][nearest[distance.argmin()]]
    return replace(brep, faces=replace(faces, shell=shell), solid=solid)


def _boxes(brep: AnalyticBrep) -> tuple[Points, Points]:
    """Return the boxes of the ends of edges and of whole circles, low and high, both (e, 3)."""
    edges = brep.edges
    ends = brep.vertices[edges.ends]
    low, high = ends.min(axis=1), ends.max(axis=1)
    lines, count, _ = edges.counts
    start, end = edges.ends[lines : lines + count].T
    whole = np.flatnonzero(start == end)
    center, axis = edges.circles.origin[whole], edges.circles.z[whole]
    reach = edges.radii[whole, None] * np.sqrt((1.0 - axis**2).clip(0.0))
    low[lines + whole], high[lines + whole] = center - reach, center + reach
    return low, high
