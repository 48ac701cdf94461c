"""Struts that pass each other without touching, and came to be one in a field: they are named."""

from __future__ import annotations

import logging

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from scaffold_cad.base.arrays import Bools, Edges, Floats, place_text
from scaffold_cad.base.blocks import blocks
from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.base.summaries import counted
from scaffold_cad.solid.clusters.spans import Spans, radii_at
from scaffold_cad.struts.apart import EXACT, Slack, crossings, meeting
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.pieces import capsules
from scaffold_cad.struts.runs import Runs

AROUND = 2.0
"""Length of a way between struts that are one body where they are near, over the distance of their
axes at which they are united."""

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


def tell_united(struts: RoundStruts, spans: Spans, fillets: Floats) -> None:
    """Warn of struts that keep apart, but not by more than the fillet of the field they are in.

    Those that a short way along struts joins do not count: they are one body where they are near.

    Parameters
    ----------
    spans : stretches of runs that are in fields
    fillets : (n,) fillet radius of each node, mm
    """
    if len(spans) == 0:
        return
    runs, curves = struts.runs, struts.curves
    tail, ahead = runs.nodes[runs.edges[spans.run, 0]], runs.directions[2 * spans.run]
    start, end = (tail + bound[:, None] * ahead for bound in (spans.low, spans.high))
    radius = np.maximum(*(radii_at(runs, spans.run, bound) for bound in (spans.low, spans.high)))
    gap = fillets[runs.edges[spans.run]].min(axis=1)
    pieces = capsules(start, end, radius + gap / 2, runs.edges[spans.run], spans.run)
    i, j = meeting(pieces, np.zeros(len(spans))).T
    pairs = np.sort(spans.run[np.stack([i, j], axis=1)], axis=1)
    a, b = nearest_on_segments(start[i], end[i], start[j], end[j])
    order = np.unique(pairs, axis=0, return_index=True)[1]
    of_curve = np.full(len(runs.edges), -1)
    of_curve[curves.run[curves.pieces]] = curves.curve_of_piece
    first, second = of_curve[pairs[order]].T
    order = order[(first < 0) | (first != second)]
    order = order[~among(pairs[order], near_runs(struts), len(runs.edges))]
    order = order[~_joined(runs, pairs[order], (pieces.radius[i] + pieces.radius[j])[order])]
    left = pairs[order]
    if len(left) == 0:
        return
    here = order[0]
    edges = [int((runs.run_of_edge == run).argmax()) for run in left[0]]
    _log.warning(
        "%s each other without touching, and are united: edges %d and %d, near %s%s; "
        "need more room between them, more sides, or a smaller blend",
        counted(len(left), "pair of struts passes", "pairs of struts pass"),
        *edges,
        place_text((a[here] + b[here]) / 2),
        ", first" if len(left) > 1 else "",
    )


def _joined(runs: Runs, pairs: Edges, reach: Floats) -> Bools:
    """Return whether a way shorter than `AROUND` times `reach` (p,) joins pairs (p, 2), (p,)."""
    count, ends = len(runs.nodes), runs.edges
    both = np.concatenate([ends, ends[:, ::-1]]).T
    ways = csr_array((np.tile(runs.lengths, 2), (both[0], both[1])), shape=(count, count))
    found = np.zeros(len(pairs), dtype=np.bool_)
    for part in blocks(len(pairs), 16 * count):
        start, row = np.unique(ends[pairs[part, 0]], return_inverse=True)
        far = dijkstra(ways, indices=start, limit=AROUND * reach[part].max())  # (s, n)
        away = far[row.reshape(-1, 2, 1), ends[pairs[part, 1]][:, None]]  # (p, 2, 2)
        found[part] = away.min(axis=(1, 2)) < AROUND * reach[part]
    return found
