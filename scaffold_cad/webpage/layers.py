"""What there is to see of a skeleton, a scaffold and a solid, as layers with a legend."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.summaries import counted
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.scaffold.stars import worst_clearance
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.webpage.scene import Dots, Layer, Lines, Part, Surface

INK, GRAY, SAND, BLUE, CRIMSON = "#2b2f36", "#8c96a1", "#e8b765", "#8ca8cc", "#c8102e"

VALENCIES = {
    3: "#2f6fd0",
    4: "#1f9d6b",
    5: "#8a6fd1",
    6: "#e08a00",
    7: "#00a3b4",
    8: "#c2569b",
    9: "#7a5230",
    10: "#4b5fa5",
    11: "#a3a300",
    12: "#0b6e4f",
    13: "#3d1f5c",
}
"""Color of branch points by valency; the last one stands for all higher ones too."""


MANY_EDGES = 2000
"""Edges of a skeleton from which on they no more shine through surfaces: they would hide them."""


@dataclass(frozen=True, eq=False)
class ShownLayer:
    """A layer, and what a page says of it."""

    layer: Layer
    label: str
    legend: tuple[tuple[str, str], ...] = ()
    """A color and what it means, a row each."""
    is_place: bool = False
    """Whether it marks one place, to be looked at by a click on the legend."""


def skeleton_layer(skeleton: Skeleton) -> ShownLayer:
    """Return the edges of a skeleton and its nodes, branch points colored by valency."""
    few = len(skeleton.edges) < MANY_EDGES
    parts: list[Part] = [Lines(skeleton.nodes, skeleton.edges, INK, width=2.5, through=few)]
    legend = []
    size = 11.0 if few else 7.0  # pixels
    others = np.flatnonzero(skeleton.valency < 3)
    if len(others):
        parts.append(Dots(skeleton.nodes[others], GRAY, 0.6 * size))
        legend.append((GRAY, counted(len(others), "joint or extremity", "joints and extremities")))
    highest = max(VALENCIES)
    kinds = np.minimum(skeleton.valency, highest)
    for valency, color in VALENCIES.items():
        nodes = np.flatnonzero(kinds == valency)
        if len(nodes):
            more = " or more" if valency == highest else ""
            parts.append(Dots(skeleton.nodes[nodes], color, size))
            legend.append((color, f"{len(nodes)} of valency {valency}{more}"))
    return ShownLayer(Layer("skeleton", tuple(parts)), "skeleton", tuple(legend))


def quads_layer(mesh: QuadMesh, name: str) -> ShownLayer:
    """Return a quad mesh that one can see into: its edges, and its faces as if of glass."""
    parts = (Lines(mesh.vertices, mesh.edges, INK), Surface(mesh, SAND, 0.4))
    return ShownLayer(Layer(name, parts), f"{name}, {counted(len(mesh.quads), 'quad')}")


def solid_layer(mesh: QuadMesh | TriangleMesh, *, shown: bool) -> ShownLayer:
    """Return the surface of a solid; `shown` tells whether it is seen at first."""
    label = f"solid, {counted(len(mesh.triangles), 'triangle')}"
    return ShownLayer(Layer("solid", (Surface(mesh, BLUE),), shown), label)


def worst_layer(scaffold: Scaffold) -> ShownLayer | None:
    """Return the mark of the smallest relative clearance, or None without a branch point."""
    worst = worst_clearance(scaffold.skeleton, scaffold.clearance)
    if worst is None:
        return None
    skeleton = scaffold.skeleton
    start = skeleton.nodes[worst.node]
    end = start + 0.5 * skeleton.lengths[worst.edge] * skeleton.directions[worst.half_edge]
    parts = (
        Lines(np.array([start, end]), np.array([[0, 1]]), CRIMSON, width=5.0, through=True),
        Dots(start[None], CRIMSON, 17.0),
    )
    meaning = (
        f"{np.degrees(worst.clearance):.1f}° between edge {worst.edge} and the side of its quad "
        f"at node {worst.node}: {worst.relative:.3f} of half the angle to the nearest edge"
    )
    return ShownLayer(
        Layer("worst", parts), "worst clearance", ((CRIMSON, meaning),), is_place=True
    )
