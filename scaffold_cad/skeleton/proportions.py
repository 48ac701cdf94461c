"""How thick struts are, compared with their length."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from scaffold_cad.base.arrays import Floats
from scaffold_cad.base.summaries import counted
from scaffold_cad.skeleton.skeleton import Skeleton


def thicker_than_long(skeleton: Skeleton) -> str:
    """Return what to tell of most edges being on paths thicker than long, or an empty text."""
    radii, lengths = skeleton.edge_radii.min(axis=1), _path_lengths(skeleton)  # (m,) both
    thick = int((radii > lengths).sum())
    if 2 * thick <= len(radii):
        return ""
    return (
        f"{thick} of {counted(len(radii), 'edge')} thicker than long (middle radius "
        f"{np.median(radii):g} mm, length between branch points {np.median(lengths):g} mm)"
    )


def _path_lengths(skeleton: Skeleton) -> Floats:
    """Return the length of each edge's path through joints, (m,): curves are many short edges."""
    count = len(skeleton.edges)
    node = skeleton.edges.ravel()  # (2 m,)
    order = np.argsort(node, kind="stable")
    at_joints = order[skeleton.valency[node[order]] == 2]  # two ends a joint, side by side
    first, second = at_joints.reshape(-1, 2).T // 2
    links = coo_array((np.ones(len(first)), (first, second)), shape=(count, count))
    path = connected_components(links, directed=False)[1]
    totals: Floats = np.bincount(path, weights=skeleton.lengths).astype(np.float64)
    return totals[path]
