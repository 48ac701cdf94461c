"""Nodes made where struts cross, or end on others, within a tolerance."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Edges, Floats, Ints, Points, Radii
from scaffold_cad.base.boxes import overlapping_boxes
from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.base.vectors import length
from scaffold_cad.skeleton.repair import RepairedGraph, repaired
from scaffold_cad.skeleton.splitting import split_at


def joined_graph(
    nodes: Points, edges: Edges, radii: Radii, edge_radii: Floats, tolerance: float
) -> RepairedGraph:
    """Return the graph with nodes where edges cross, or end on others, within `tolerance`, mm.

    Nodes closer than that become one, edges are split at the nodes that lie on them, and then
    where they cross, halfway between the two.

    Raises
    ------
    SkeletonError
        If no edge is left.
    """
    graph = repaired(nodes, edges, radii, edge_radii, weld_distance=tolerance, split_contacts=True)
    first, second, places = crossings(graph.nodes, graph.edges, tolerance)
    if len(places) == 0:
        return graph
    made = len(graph.nodes) + np.arange(len(places))
    points = np.concatenate([graph.nodes, places])
    pieces, widths, _, _ = split_at(
        points,
        graph.edges,
        graph.edge_radii,
        np.concatenate([first, second]),
        np.concatenate([made, made]),
    )
    sizes = np.concatenate([graph.radii, np.full(len(places), np.nan)])
    return repaired(points, pieces, sizes, widths, weld_distance=tolerance)


def crossings(nodes: Points, edges: Edges, tolerance: float) -> tuple[Ints, Ints, Points]:
    """Return the pairs of edges that cross within `tolerance` between their ends, and where.

    Returns
    -------
    (k,) and (k,) intp, the edges; (k, 3) float64, the points halfway between them, mm
    """
    start, end = nodes[edges[:, 0]], nodes[edges[:, 1]]
    low, high = np.minimum(start, end) - tolerance, np.maximum(start, end) + tolerance
    firsts, seconds, places = [_NO_EDGES], [_NO_EDGES], [np.zeros((0, 3))]
    for i, j in overlapping_boxes(low, high):
        a, b = nearest_on_segments(start[i], end[i], start[j], end[j])
        near = length(a - b) <= tolerance
        for point, k in ((a, i), (b, j)):  # at an end it is a contact, not a crossing
            near &= length(point - start[k]) > tolerance
            near &= length(point - end[k]) > tolerance
        firsts.append(i[near])
        seconds.append(j[near])
        places.append((a[near] + b[near]) / 2)
    first, second = np.concatenate(firsts), np.concatenate(seconds)
    order = np.lexsort([second, first])
    return first[order], second[order], np.concatenate(places)[order]


_NO_EDGES = np.zeros(0, dtype=np.intp)
