"""A page that shows which struts are loaded how much, and how the skeleton bends."""

from __future__ import annotations

from os import PathLike

import numpy as np

from scaffold_cad.base.arguments import as_path, check_kind, checks_keywords
from scaffold_cad.base.files import check_page, replacing
from scaffold_cad.base.summaries import counted
from scaffold_cad.mechanics.beams import BeamSolution
from scaffold_cad.webpage.layers import GRAY, ShownLayer
from scaffold_cad.webpage.page import layers_page
from scaffold_cad.webpage.scene import Dots, Layer, Lines, Part

CLASSES = (
    (0.25, "#3b6fb6"),
    (0.5, "#3f9d8f"),
    (0.75, "#a5b83c"),
    (1.0, "#e39b27"),
    (np.inf, "#c8102e"),
)
"""Upper limits of utilization and their colors; above 1 a strut is overloaded."""

SUPPORT, LOAD = "#5b3a8c", "#111111"

BEND = 0.1
"""Largest displacement that is drawn, in diagonals of the skeleton."""


@checks_keywords()
def write_strength_page(solution: BeamSolution, path: str | PathLike[str]) -> None:
    """Write a page, .html, that shows the struts colored by utilization.

    Other layers show the skeleton bent, with displacements enlarged, its supports and its loads.

    Raises
    ------
    OptionError
        If it is not a solution of a beam model.
    FormatError
        If the file cannot be written.
    """
    check_kind(solution, BeamSolution)
    place = as_path(path)
    check_page(place)
    text = strength_page(solution, place.stem)
    with replacing(place) as fresh:
        fresh.write_text(text, encoding="utf-8")


def strength_page(solution: BeamSolution, title: str) -> str:
    """Return the page of `write_strength_page`."""
    summary = (
        f"{1000 * solution.mass:.4g} g, largest stress {solution.stresses.max():.4g} MPa, "
        f"utilization {solution.utilization.max():.3g}, "
        f"displacement {solution.largest_displacement:.4g} mm"
    )
    layers = [_used_layer(solution), _bent_layer(solution), *_node_layers(solution)]
    return layers_page(title, summary, layers)


def _used_layer(solution: BeamSolution) -> ShownLayer:
    """Return the struts in classes of utilization, thicker ones as thicker lines."""
    skeleton, used = solution.model.skeleton, solution.utilization
    radius = solution.model.edge_radii.mean(axis=1)
    thick = np.clip(np.round(4.0 * radius / radius.max()), 1, 4).astype(np.intp)
    kind = np.searchsorted([limit for limit, _ in CLASSES], used)
    parts: list[Part] = []
    legend, low = [], 0.0
    for number, (high, color) in enumerate(CLASSES):
        rows = np.flatnonzero(kind == number)
        for width in np.unique(thick[rows]).tolist():
            pairs = skeleton.edges[rows[thick[rows] == width]]
            parts.append(Lines(skeleton.nodes, pairs, color, width=1.5 * width))
        name = f"{low:g} to {high:g}" if np.isfinite(high) else f"above {low:g}: overloaded"
        legend.append((color, f"{counted(len(rows), 'strut')}, {name}"))
        low = high
    return ShownLayer(Layer("utilization", tuple(parts)), "utilization", tuple(legend))


def _bent_layer(solution: BeamSolution) -> ShownLayer:
    """Return the skeleton with its displacements enlarged, straight from node to node."""
    skeleton = solution.model.skeleton
    diagonal = float(np.linalg.norm(np.ptp(skeleton.nodes, axis=0)))
    largest = solution.largest_displacement
    scale = BEND * diagonal / largest if largest > 0 else 1.0
    bent = Lines(solution.deformed(scale).nodes, skeleton.edges, GRAY, width=1.0)
    return ShownLayer(Layer("bent", (bent,), False), f"bent, {scale:.3g} times as far")


def _node_layers(solution: BeamSolution) -> list[ShownLayer]:
    model = solution.model
    layers = []
    for name, marked, color in (
        ("supports", model.fixed.any(axis=1), SUPPORT),
        ("loads", model.forces.any(axis=1), LOAD),
    ):
        nodes = np.flatnonzero(marked)
        if len(nodes):
            dots = Dots(model.skeleton.nodes[nodes], color, 8.0)
            legend = ((color, counted(len(nodes), "node")),)
            layers.append(ShownLayer(Layer(name, (dots,)), name, legend))
    return layers
