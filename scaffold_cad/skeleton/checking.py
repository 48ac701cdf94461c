"""check_skeleton(): whether a skeleton can be scaffolded; whether files can hold its struts."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arguments import check_kind, checks_keywords
from scaffold_cad.base.arrays import place_text
from scaffold_cad.base.positions import single_steps
from scaffold_cad.errors import MeshError, SkeletonError
from scaffold_cad.skeleton.overlaps import overlapping_half_edges
from scaffold_cad.skeleton.repair import LEAST_LENGTH, LEAST_RADIUS
from scaffold_cad.skeleton.skeleton import Skeleton

LEAST_STEPS = 2.0
"""Least radius in steps of 32-bit coordinates: a surface is moved by half a step."""


@checks_keywords()
def check_skeleton(skeleton: Skeleton) -> None:
    """Raise unless `skeleton` can be scaffolded.

    Raises
    ------
    OptionError
        If it is not a skeleton.
    SkeletonError
        For the first of: no edge, a self-loop, an isolated node, coincident nodes, an edge too
        short for its direction to be computed, a repeated edge, a radius too small for the
        rounding of coordinates, two edges that leave a node within 0.01° of each other.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, check_skeleton
    >>> lonely = Skeleton([[0, 0, 0], [9, 0, 0], [5, 5, 5]], [[0, 1]], 1.0)
    >>> check_skeleton(lonely)  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    scaffold_cad.errors.SkeletonError: node 2 at [5, 5, 5] mm has no edge; ...
    """
    check_kind(skeleton, Skeleton)
    nodes, edges = skeleton.nodes, skeleton.edges
    hint = "use Skeleton.cleaned() to repair it"
    if len(edges) == 0:
        raise SkeletonError("the skeleton has no edges; need at least one")
    loops = np.flatnonzero(edges[:, 0] == edges[:, 1])
    if len(loops):
        edge, node = loops[0], edges[loops[0], 0]
        raise SkeletonError(
            f"edge {edge} joins node {node} at {place_text(nodes[node])} to itself; need two nodes "
            f"({hint})"
        )
    isolated = np.flatnonzero(skeleton.valency == 0)
    if len(isolated):
        at = place_text(nodes[isolated[0]])
        raise SkeletonError(f"node {isolated[0]} at {at} has no edge; need at least one ({hint})")
    for first, second in _equal_rows(nodes):
        place = place_text(nodes[second])
        raise SkeletonError(
            f"nodes {first} and {second} are both at {place}; need distinct places ({hint})"
        )
    middles = nodes[edges].mean(axis=1)
    short = np.flatnonzero(skeleton.lengths < LEAST_LENGTH)
    if len(short):
        found = skeleton.lengths[short[0]]
        raise SkeletonError(
            f"edge {short[0]} near {place_text(middles[short[0]])} is {found:g} mm long; need at "
            f"least {LEAST_LENGTH:g} ({hint})"
        )
    for first, second in _equal_rows(np.sort(edges, axis=1)):
        pair = edges[second].tolist()
        raise SkeletonError(
            f"edges {first} and {second} near {place_text(middles[first])} both join nodes {pair}; "
            f"need each edge once ({hint})"
        )
    least = LEAST_RADIUS * float(np.abs(nodes).max())
    for what, sizes, places in (
        ("node", skeleton.radii, nodes),
        ("edge", skeleton.edge_radii.min(axis=1), middles),
    ):
        thin = np.flatnonzero(sizes < least)
        if len(thin):
            raise SkeletonError(
                f"{what} {thin[0]} near {place_text(places[thin[0]])} has radius "
                f"{sizes[thin[0]]:g} mm; need {least:g} mm or more this far from the "
                "origin, for rounding"
            )
    overlaps = overlapping_half_edges(nodes, edges)
    if len(overlaps):
        node = edges.reshape(-1)[overlaps[0, 0]]
        first, second = (overlaps[0] >> 1).tolist()
        raise SkeletonError(
            f"edges {first} and {second} leave node {node} at "
            f"{place_text(nodes[node])} in the same direction; "
            f"need more than 0.01 degrees between them ({hint})"
        )


def check_single_precision(skeleton: Skeleton, least: float = LEAST_STEPS) -> None:
    """Raise unless 32-bit coordinates, as meshes in files have them, can hold all struts.

    Parameters
    ----------
    least : least radius, in steps of these coordinates where the strut is

    Raises
    ------
    MeshError
        If a strut is too thin for how far from the origin it is; the worst one is named.

    Examples
    --------
    >>> from scaffold_cad import Skeleton
    >>> check_single_precision(Skeleton([[0, 0, 0], [9e6, 0, 0]], [[0, 1]], 2.0))
    >>> thin = Skeleton([[0, 0, 0], [9e6, 0, 0]], [[0, 1]], 1.0)
    >>> check_single_precision(thin)  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    scaffold_cad.errors.MeshError: edge 0 near [4.5e+06, 0, 0] mm has radius 1 mm, where ...
    """
    ends = skeleton.nodes[skeleton.edges]  # (m, 2, 3)
    needed = least * single_steps(ends).max(axis=1)  # (m,)
    radii = skeleton.edge_radii.min(axis=1)
    if (radii >= needed).all():
        return
    edge = int(np.argmin(radii / needed))
    near = place_text(ends[edge].mean(axis=0))
    raise MeshError(
        f"edge {edge} near {near} has radius {radii[edge]:g} mm, where 32-bit coordinates, as "
        f"meshes in files have them, are {needed[edge] / least:g} mm apart; need "
        f"{needed[edge]:g} mm or more, a place nearer to the origin, or STEP"
    )


def _equal_rows(rows: np.ndarray) -> list[tuple[int, int]]:
    """Return the first two equal rows of `rows`, if any, as a list of at most one pair."""
    order = np.lexsort(rows.T[::-1])
    same = (rows[order[1:]] == rows[order[:-1]]).all(axis=1)
    if not same.any():
        return []
    at = int(np.argmax(same))
    first, second = sorted((int(order[at]), int(order[at + 1])))
    return [(first, second)]
