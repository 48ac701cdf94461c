"""Hypothesis strategies: directions, stars of directions, and skeletons that can be scaffolded."""

from __future__ import annotations

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

from scaffold_cad.base.arrays import Edges, Floats, Points, UnitVectors
from scaffold_cad.base.vectors import normalize
from scaffold_cad.errors import SkeletonError
from scaffold_cad.skeleton import Skeleton, check_skeleton

SPACING = 10.0
"""Distance of the grid points about which nodes are drawn, mm."""

_JITTER = st.floats(-0.3 * SPACING, 0.3 * SPACING, allow_nan=False, width=32)
_STEPS = st.integers(-4, 4)


@st.composite
def directions(draw: st.DrawFn) -> UnitVectors:
    """Draw a unit vector, shape (3,): along a lattice direction, or any."""
    steps = draw(st.tuples(_STEPS, _STEPS, _STEPS).filter(any))
    vector = SPACING * np.asarray(steps, dtype=np.float64)
    if draw(st.booleans()):
        vector += draw(st.tuples(_JITTER, _JITTER, _JITTER))
    return normalize(vector)


@st.composite
def stars(
    draw: st.DrawFn, min_valency: int = 3, max_valency: int = 10, least_angle: float = 0.1
) -> UnitVectors:
    """Draw distinct unit vectors, no two closer than `least_angle` (rad), shape (n, 3)."""
    count = draw(st.integers(min_valency, max_valency))
    rows = np.stack([draw(directions()) for _ in range(count)])
    assume(_least_angle(rows) >= least_angle)
    return rows


@st.composite
def graphs(draw: st.DrawFn, max_nodes: int = 16) -> tuple[int, Edges]:
    """Draw a simple graph without isolated nodes: how many nodes it has, and its edges (m, 2).

    It is made of trees and rings, some joined by further edges: one component or several.
    """
    parts = draw(st.lists(st.tuples(st.booleans(), st.integers(2, 7)), min_size=1, max_size=4))
    count = 0
    edges: set[tuple[int, int]] = set()
    for closed, size in parts:
        if count + size > max_nodes:
            break
        if closed and size > 2:
            edges |= {(count + k, count + k + 1) for k in range(size - 1)}
            edges.add((count, count + size - 1))
        else:
            edges |= {(count + draw(st.integers(0, k - 1)), count + k) for k in range(1, size)}
        count += size
    nodes = st.integers(0, count - 1)
    for a, b in draw(st.lists(st.tuples(nodes, nodes), max_size=4)):
        if a != b:
            edges.add((min(a, b), max(a, b)))
    order = draw(st.permutations(sorted(edges)))
    flips = [draw(st.booleans()) for _ in order]
    rows = [(b, a) if flip else (a, b) for (a, b), flip in zip(order, flips, strict=True)]
    return count, np.asarray(rows, dtype=np.intp)


@st.composite
def skeletons(draw: st.DrawFn, max_nodes: int = 16, least_angle: float = 0.1) -> Skeleton:
    """Draw a valid skeleton: trees, rings and loops, in one component or several.

    Nodes are at least 4 mm apart, edges at a node at least `least_angle` (rad); about half of
    the skeletons have all nodes on a grid, and so coplanar and opposite edges. Edges that share
    no node may cross.
    """
    count, edges = draw(graphs(max_nodes))
    nodes = draw(positions(count))
    radii = draw(_radii(count))
    skeleton = Skeleton(nodes, edges, radii)
    try:
        check_skeleton(skeleton)
    except SkeletonError:
        assume(False)
    for row in np.split(skeleton.incidence.half_edges, skeleton.incidence.offsets[1:-1]):
        assume(_least_angle(skeleton.directions[row]) >= least_angle)
    return skeleton


@st.composite
def hinged_stars(draw: st.DrawFn) -> Skeleton:
    """Draw a thick branch point with thin arms, some of which fold back at a thin joint."""
    ways = draw(stars(max_valency=5, least_angle=0.3))
    thin = st.floats(0.02, 0.5)
    thick = draw(st.floats(0.5, 2.0))
    lengths = st.floats(2.0, 7.0)
    nodes, edges, radii = [np.zeros(3)], [], [thick]
    for way in ways:
        nodes.append(draw(lengths) * way)
        edges.append((0, len(nodes) - 1))
        radii.append(thick * draw(thin))
        if draw(st.booleans()):
            across = normalize(np.cross(way, draw(directions())))
            assume(across.any())
            angle = draw(st.floats(0.1, 1.2))
            nodes.append(nodes[-1] + draw(lengths) * (np.sin(angle) * across - np.cos(angle) * way))
            edges.append((len(nodes) - 2, len(nodes) - 1))
            radii.append(thick * draw(thin))
    return Skeleton(np.array(nodes), np.array(edges), np.array(radii))


@st.composite
def positions(draw: st.DrawFn, count: int) -> Points:
    """Draw distinct positions at least 4 mm apart, shape (count, 3)."""
    steps = st.tuples(_STEPS, _STEPS, _STEPS)
    places = draw(st.lists(steps, min_size=count, max_size=count, unique=True))
    nodes = SPACING * np.asarray(places, dtype=np.float64)
    if draw(st.booleans()):
        nodes += draw(
            st.lists(st.tuples(_JITTER, _JITTER, _JITTER), min_size=count, max_size=count)
        )
    return nodes


@st.composite
def _radii(draw: st.DrawFn, count: int) -> Floats:
    radius = st.floats(0.125, 3.0, allow_nan=False, width=32)
    if draw(st.booleans()):
        return np.full(count, draw(radius))
    return np.asarray(draw(st.lists(radius, min_size=count, max_size=count)), dtype=np.float64)


def _least_angle(rows: UnitVectors) -> float:
    """Return the least angle between two of `rows`, rad; π for a single one."""
    cosines = np.clip(rows @ rows.T, -1.0, 1.0)[np.triu_indices(len(rows), 1)]
    return float(np.arccos(cosines.max(initial=-1.0)))
