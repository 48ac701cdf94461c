"""Struts that pass each other without touching, and came to be one in a field: they are named."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from itertools import product

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points, place_text
from scaffold_cad.base.blocks import blocks
from scaffold_cad.base.segments import distance_to_side, nearest_on_segments
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.vectors import dot, length
from scaffold_cad.lattice.boxgrid import BoxGrid
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.clusters.spans import Spans, radii_at
from scaffold_cad.struts.apart import EXACT, Slack, crossings, meeting
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.pieces import Pieces, capsules
from scaffold_cad.struts.runs import Runs

AROUND = 2.0
"""Length of a way between struts that are one body where they are near, over the distance of their
axes at which they are united."""

CLOSED = 2.0 - 2.0**0.5
"""Gap between two struts that a fillet closes, over its radius ρ: there ρ = √2 (ρ - gap / 2)."""

BEYOND = 1e-3
"""How far beyond both axes the way between them begins, in its length: one may end flat there."""

PLACES = 9
"""How many places of a span are looked at, whether it is near another there."""

PAIR_BYTES = 200
"""What a place and a run take where they are looked at."""

TRIANGLE_BYTES = 256
"""What a triangle takes where it is looked at."""

_log = logging.getLogger(__name__)


def near_runs(struts: RoundStruts, slack: Slack = EXACT) -> Edges:
    """Return the pairs of runs that are not known to keep apart, each once, (p, 2), ascending."""
    return crossings(
        struts.runs,
        struts.blended,
        struts.curves,
        struts.collar,
        struts.options.ends,
        struts.crowded,
        slack,
        sharp=struts.sharp,
    ).runs


def among(pairs: Edges, others: Edges, count: int) -> Bools:
    """Return which pairs of `count` runs, (p, 2), each ascending, are among others (q, 2), (p,)."""
    keys, known = (some[:, 0] * count + some[:, 1] for some in (pairs, others))
    return np.isin(keys, known)


def tell_united(struts: RoundStruts, spans: Spans, fillets: Floats, mesh: TriangleMesh) -> None:
    """Warn of struts that keep apart, but are one body in a mesh: fillets of fields close the gap.

    Those that a short way along struts joins do not count: they are one body where they are near.

    Parameters
    ----------
    spans : stretches of runs that are in fields
    fillets : (n,) fillet radius of each node, mm
    mesh : triangles near the surface, those of fields as they are
    """
    if len(spans) == 0:
        return
    runs, curves = struts.runs, struts.curves
    start, end = _axes(runs, spans)
    radius = np.maximum(*(radii_at(runs, spans.run, bound) for bound in (spans.low, spans.high)))
    gap = CLOSED * fillets[runs.edges[spans.run]].min(axis=1)
    pieces = capsules(start, end, radius + gap / 2, runs.edges[spans.run], spans.run)
    i, j = meeting(pieces, np.zeros(len(spans))).T
    pairs = np.sort(spans.run[np.stack([i, j], axis=1)], axis=1)
    of_curve = np.full(len(runs.edges), -1)
    of_curve[curves.run[curves.pieces]] = curves.curve_of_piece
    first, second = of_curve[pairs].T
    other = (first < 0) | (first != second)
    other &= ~among(pairs, near_runs(struts), len(runs.edges))
    near, on_one, on_other = _near_each_other(runs, spans, pieces, i[other], j[other])
    closed = _are_within(mesh, on_one, on_other)
    left, here = np.unique(near[closed], axis=0, return_index=True)
    if len(left) == 0:
        return
    edges = [int((runs.run_of_edge == run).argmax()) for run in left[0]]
    _log.warning(
        "%s united, though they do not touch: edges %d and %d, near %s%s; "
        "need more room between them, more sides, or a smaller blend",
        counted(len(left), "pair of struts is", "pairs of struts are"),
        *edges,
        place_text((on_one + on_other)[closed][here[0]] / 2),
        ", first" if len(left) > 1 else "",
    )


def _axes(runs: Runs, spans: Spans) -> tuple[Points, Points]:
    """Return where the axes of spans begin and end, both (s, 3)."""
    tail, ahead = runs.nodes[runs.edges[spans.run, 0]], runs.directions[2 * spans.run]
    start, end = (tail + bound[:, None] * ahead for bound in (spans.low, spans.high))
    return start, end


def _near_each_other(
    runs: Runs, spans: Spans, pieces: Pieces, i: Ints, j: Ints
) -> tuple[Edges, Points, Points]:
    """Return pairs of runs that are near where nothing joins them, and where, nearest first.

    They are of shapes (p, 2), (p, 3) and (p, 3), on both axes; a pair may come more than once.

    Parameters
    ----------
    pieces : of spans, thicker than these by half of what is closed between two of them
    i, j : (q,) spans that meet so
    """
    start, end = _axes(runs, spans)
    on_i, on_j = _places(start[i], end[i], start[j], end[j])
    reach = (pieces.radius[i] + pieces.radius[j])[:, None]
    apart = length(on_i - on_j)
    tail = runs.nodes[runs.edges[spans.run, 0]]
    along_i, along_j = length(on_i - tail[i, None]), length(on_j - tail[j, None])
    longest = AROUND * float(reach.max(initial=0.0))
    ways = _ways(runs, spans.run[i], spans.run[j], along_i, along_j, longest)
    row, place = np.nonzero((apart < reach) & (ways >= AROUND * reach))
    order = np.argsort(apart[row, place], kind="stable")
    row, place = row[order], place[order]
    pairs = np.sort(spans.run[np.stack([i, j], axis=1)[row]], axis=1)
    on_one, on_other = on_i[row, place], on_j[row, place]
    free = ~_in_another(runs, (on_one + on_other) / 2, pairs)
    return pairs[free], on_one[free], on_other[free]


def _are_within(mesh: TriangleMesh, start: Points, end: Points) -> Bools:
    """Return which ways between places on axes (k, 3) stay inside of a mesh, (k,)."""
    free = np.ones(len(start), dtype=np.bool_)
    if len(free) == 0:
        return free
    more = BEYOND * (end - start)
    start, end = start - more, end + more
    for corners, row in _close(mesh, start, end):
        spokes = corners - start[row, None]  # (p, 3, 3)
        ahead = end[row] - start[row]
        normal = np.cross(spokes[:, 1] - spokes[:, 0], spokes[:, 2] - spokes[:, 0])
        height = dot(spokes[:, 0], normal)
        facing = (height > 0) != (height > dot(ahead, normal))
        around = dot(np.cross(spokes, np.roll(spokes, -1, axis=1)), ahead[:, None])  # (p, 3)
        over = (around >= 0).all(axis=1) | (around <= 0).all(axis=1)
        free[row[facing & over]] = False
    return free


def _close(mesh: TriangleMesh, start: Points, end: Points) -> Iterator[tuple[Floats, Ints]]:
    """Yield triangles and ways (k, 3) close to each other: corners (p, 3, 3) and ways (p,).

    Most triangles are small and not near any way: a corner of theirs tells.
    """
    ways = np.stack([start, end, end], axis=1)  # triangles without area
    small = float(length(end - start).mean())
    near, around = BoxGrid(ways), BoxGrid(ways, margin=small)
    is_around = np.append(~around.is_empty.reshape(-1), False)  # the last for those in no cell
    for rows in blocks(len(mesh.triangles), TRIANGLE_BYTES):
        a, b, c = (mesh.vertices[corner] for corner in mesh.triangles[rows].T)  # (t, 3) each
        low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
        close = is_around[around.cell_of(a)] | (high - low > small).any(axis=1)
        corners = np.stack([a[close], b[close], c[close]], axis=1)
        for triangle, row in near.near(low[close], high[close]):
            yield corners[triangle], row


def _in_another(runs: Runs, places: Points, pairs: Edges) -> Bools:
    """Return which of some places (q, 3) are inside of another run than two, (q, 2), shape (q,)."""
    start, end = np.moveaxis(runs.nodes[runs.edges], 1, 0)
    found = np.zeros(len(places), dtype=np.bool_)
    for part in blocks(len(places), PAIR_BYTES * len(start)):
        own = places[part, None]
        within: Bools = distance_to_side(start - own, end - own) < runs.radii.min(axis=1)  # (q, k)
        np.put_along_axis(within, pairs[part], values=False, axis=1)
        found[part] = within.any(axis=1)
    return found


def _places(
    start_a: Points, end_a: Points, start_b: Points, end_b: Points
) -> tuple[Points, Points]:
    """Return places on the first of pairs of segments, and those of the second nearest to them.

    The nearest of all come first. Both are of shape (p, k, 3).
    """
    nearest = nearest_on_segments(start_a, end_a, start_b, end_b)
    share = np.linspace(0.0, 1.0, PLACES)[:, None]
    on_a = (1.0 - share) * start_a[:, None] + share * end_a[:, None]
    flat = on_a.reshape(-1, 3)
    ends = (np.repeat(end, PLACES, axis=0) for end in (start_b, end_b))
    on_b = nearest_on_segments(flat, flat, *ends)[1].reshape(on_a.shape)
    first, second = (
        np.concatenate([near[:, None], on], axis=1)
        for near, on in zip(nearest, (on_a, on_b), strict=True)
    )
    return first, second


def _ways(
    runs: Runs, first: Ints, second: Ints, on_first: Floats, on_second: Floats, limit: float
) -> Floats:
    """Return the lengths of ways along runs between places on two of them, (p, k), mm.

    Infinite where it is longer than `limit`.

    Parameters
    ----------
    first, second : (p,) runs
    on_first, on_second : (p, k) places, from the first nodes of the runs, mm
    """
    count, ends = len(runs.nodes), runs.edges
    both = np.concatenate([ends, ends[:, ::-1]]).T
    lengths = csr_array((np.tile(runs.lengths, 2), (both[0], both[1])), shape=(count, count))
    ways = np.empty(on_first.shape)
    for part in blocks(len(first), 16 * count):
        start, row = np.unique(ends[first[part]], return_inverse=True)
        far = dijkstra(lengths, indices=start, limit=limit)  # (s, n)
        away = far[row.reshape(-1, 2, 1), ends[second[part]][:, None]]  # (p, 2, 2)
        found = np.full(on_first[part].shape, np.inf)
        for one, other in product((0, 1), repeat=2):
            to_one = np.abs(on_first[part] - one * runs.lengths[first[part], None])
            to_other = np.abs(on_second[part] - other * runs.lengths[second[part], None])
            found = np.minimum(found, to_one + away[:, one, other, None] + to_other)
        ways[part] = found
    return ways
