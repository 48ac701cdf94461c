"""Gaps between struts without a common node: pairs whose surfaces come close to each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points
from scaffold_cad.base.boxes import overlapping_boxes
from scaffold_cad.base.vectors import dot, normalize
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.printability.frusta import Frusta, between_balls, between_flat_ends
from scaffold_cad.skeleton import Skeleton

AROUND = 1.5
"""Distance from a node up to which triangles are of its end, in radii: corners of squares are."""
OFF = 0.02
"""Distance of a flat end's triangles from its node, in radii: files round coordinates."""
FACING = 0.7
"""Least cosine of a flat end's normal to the strut: curves end beside the line of their nodes."""


@dataclass(frozen=True, eq=False)
class Gaps:
    """Pairs of struts without a common node that come closer than a limit."""

    first: Ints
    second: Ints
    """The struts of each pair, shapes (p,)."""
    widths: Floats
    """Room between their surfaces, 0 or less where they overlap, shape (p,), mm."""
    places: Points
    """The middle of the gap, shape (p, 3), mm."""


def free_ends(skeleton: Skeleton) -> Bools:
    """Return which ends of struts are at nodes that nothing else is at, (m, 2)."""
    free: Bools = skeleton.valency[skeleton.edges] == 1
    return free


def flat_ends(skeleton: Skeleton, mesh: TriangleMesh) -> Bools:
    """Return which extremities have triangles of the mesh across the node, facing away, (m, 2)."""
    flat = free_ends(skeleton)
    edges, ends = np.nonzero(flat)  # (k,) each
    if len(edges) == 0:
        return flat
    nodes, radii = skeleton.nodes[skeleton.edges[edges]], skeleton.edge_radii[edges, ends]
    rows = np.arange(len(edges))
    tips = nodes[rows, ends]  # (k, 3)
    outward = normalize(tips - nodes[rows, 1 - ends])
    corners = mesh.vertices[mesh.triangles]  # (t, 3, 3)
    distances, nearest = map(np.asarray, KDTree(tips).query(corners.mean(axis=1)))
    some = np.flatnonzero(distances <= AROUND * radii[nearest])
    first, second, third = np.moveaxis(corners[some], 1, 0)
    tip = nearest[some]
    normals = normalize(np.cross(second - first, third - first))
    across = np.abs(dot(normals, first - tips[tip])) <= OFF * radii[tip]
    there = tip[across & (dot(normals, outward[tip]) > FACING)]
    flat[edges, ends] = np.bincount(there, minlength=len(edges)) > 0
    return flat


def narrow_gaps(skeleton: Skeleton, limit: float, flat: Bools) -> Gaps:
    """Return the pairs of struts whose round surfaces come closer than `limit`, mm.

    A strut's radius goes evenly from that of its one node to that of its other. An end that is
    not flat is a ball.

    Parameters
    ----------
    flat : (m, 2) which ends are flat
    """
    start, end = np.moveaxis(skeleton.nodes[skeleton.edges], 1, 0)
    reach = skeleton.edge_radii.max(axis=1)[:, None] + limit / 2
    blocks = [
        _gaps_of(skeleton, i, j, limit, flat)
        for i, j in overlapping_boxes(
            np.minimum(start, end) - reach, np.maximum(start, end) + reach
        )
    ]
    if not blocks:
        none = np.zeros(0, dtype=np.intp)
        return Gaps(none, none, np.zeros(0), np.zeros((0, 3)))
    return Gaps(
        np.concatenate([block.first for block in blocks]),
        np.concatenate([block.second for block in blocks]),
        np.concatenate([block.widths for block in blocks]),
        np.concatenate([block.places for block in blocks]),
    )


def _gaps_of(skeleton: Skeleton, i: Ints, j: Ints, limit: float, flat: Bools) -> Gaps:
    """Return those of the pairs i, j that are gaps narrower than `limit`."""
    ends = skeleton.edges
    apart = (ends[i][:, :, None] != ends[j][:, None, :]).all(axis=(1, 2))
    i, j = i[apart], j[apart]
    widths, places = between_balls(Frusta.of(skeleton, i), Frusta.of(skeleton, j))
    # Balls at the ends hold what is flat there: pairs that they keep apart are apart.
    near = widths < limit
    i, j, widths, places = i[near], j[near], widths[near], places[near]
    some = np.flatnonzero(flat[i].any(axis=1) | flat[j].any(axis=1))
    a, b = (Frusta.of(skeleton, k[some]) for k in (i, j))
    widths[some], places[some] = between_flat_ends(a, b, flat[i[some]], flat[j[some]], places[some])
    near = widths < limit
    return Gaps(i[near], j[near], widths[near], places[near])
