"""Graphs of networkx as skeletons, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from scaffold_cad.base.arguments import check_kind, checks_keywords
from scaffold_cad.base.arrays import as_floats
from scaffold_cad.base.backends import need
from scaffold_cad.base.radii import Radius, radii_at
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.skeleton import Skeleton


@checks_keywords()
def skeleton_from_networkx(
    graph: Any, radius: Radius | None = None, *, position: str = "pos", radii: str = "radius"
) -> Skeleton:
    """Return a networkx graph as a skeleton, not repaired; nodes and edges keep their order.

    Directions, keys and weights of edges are ignored; parallel edges become one. Edges may have
    radii of their own: ``radius``, or ``radii`` (at the edge's first and second node, mm).

    Parameters
    ----------
    graph : a networkx Graph, DiGraph, MultiGraph or MultiDiGraph
    radius : mm, > 0; one number or a function of positions (n, 3) that returns radii (n,), instead
        of what the graph holds
    position : name of the nodes' attribute that is (x, y, z), or (x, y) for z = 0, mm
    radii : name of the nodes' attribute that is the radius, mm

    Raises
    ------
    SkeletonError
        If a node has no position or no radius, or not what a `Skeleton` takes.
    OptionError
        If `graph` is not a networkx graph, or a name of an attribute is not text.
    """
    if not isinstance(getattr(graph, "nodes", None), Mapping):
        check_kind(graph, "networkx Graph")
    for name, value in (("position", position), ("radii", radii)):
        if not isinstance(value, str):
            raise OptionError(f"{name} is {value!r:.80}; need the name of an attribute of nodes")
    number = {node: k for k, node in enumerate(graph.nodes)}
    points = [_position(node, data.get(position), position) for node, data in graph.nodes.items()]
    if radius is None:
        lost = next((n for n, data in graph.nodes.items() if radii not in data), None)
        if lost is not None:
            raise SkeletonError(f"node {lost!r} has no {radii!r}; need one, or radius= for all")
    nodes = np.reshape(np.asarray(points, dtype=np.float64), (-1, 3))
    of_nodes = (
        radii_at(nodes, radius)
        if radius is not None
        else as_floats([d[radii] for d in graph.nodes.values()], "radii")
    )
    pairs: dict[tuple[int, int], list[float]] = {}
    for a, b, data in graph.edges(data=True):
        pair = number[a], number[b]
        pairs.setdefault(_ordered(*pair), _edge_radii(a, b, data, pair[0] > pair[1]))
    edges = np.reshape(np.asarray([*pairs], dtype=np.intp), (-1, 2))
    sizes = np.broadcast_to(of_nodes, len(points))
    struts = np.reshape([*pairs.values()], (-1, 2))
    if radius is not None:
        struts = np.full_like(struts, np.nan)
    struts = np.where(np.isnan(struts), sizes[edges], struts)
    return Skeleton(nodes, edges, sizes, struts)


@checks_keywords()
def skeleton_to_networkx(
    skeleton: Skeleton, *, position: str = "pos", radii: str = "radius"
) -> Any:
    """Return a skeleton as a networkx Graph; nodes are numbered, edges have a ``length``, mm.

    Where struts have radii of their own, edges have them as ``radii``, lower node first.

    Raises
    ------
    MissingBackendError
        If networkx is not installed.
    """
    need("networkx", "a networkx graph")
    import networkx

    if position == radii:
        raise OptionError(f"position and radii are both {position!r}; need two names")
    graph = networkx.Graph()
    rows = zip(skeleton.nodes.tolist(), skeleton.radii.tolist(), strict=True)
    graph.add_nodes_from(
        (k, {position: tuple(place), radii: r}) for k, (place, r) in enumerate(rows)
    )
    for (a, b), length in zip(skeleton.edges.tolist(), skeleton.lengths.tolist(), strict=True):
        graph.add_edge(a, b, length=length)
    if skeleton.has_member_radii:
        for (a, b), (near, far) in zip(
            skeleton.edges.tolist(), skeleton.edge_radii.tolist(), strict=True
        ):
            graph.edges[a, b]["radii"] = (near, far) if a < b else (far, near)
    return graph


def _edge_radii(a: Any, b: Any, data: Mapping[str, Any], swapped: bool) -> list[float]:
    """Return the radii of an edge at its lower and its higher node, nan where it has none."""
    given = data.get("radii", data.get("radius", np.nan))
    try:
        near, far = np.broadcast_to(np.asarray(given, dtype=np.float64), 2).tolist()
    except (TypeError, ValueError):
        raise SkeletonError(
            f"edge {a!r} to {b!r} has radii {given!r}; need one number or two, mm"
        ) from None
    return [far, near] if swapped else [near, far]


def _position(node: Any, value: Any, name: str) -> list[float]:
    try:
        point = [float(x) for x in value]
    except (TypeError, ValueError):
        point = []
    if len(point) not in (2, 3):
        raise SkeletonError(f"node {node!r} has {value!r} as {name!r}; need (x, y, z) in mm")
    return [*point, 0.0][:3]


def _ordered(a: int, b: int) -> tuple[int, int]:
    return (a, b) if a <= b else (b, a)
