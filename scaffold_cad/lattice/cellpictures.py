"""Unit cells drawn as SVG: what is near is dark and thick."""

from __future__ import annotations

from html import escape

import numpy as np

from scaffold_cad.base.arrays import Edges, Floats, Points
from scaffold_cad.base.vectors import normalize

SIZE = 220
"""Width and height of a drawing, pixels."""

RIGHT, TOWARDS = np.array([-0.866, 0.5, 0.0]), normalize(np.array([0.5, 0.866, 0.45]))
"""Directions to the right and toward the viewer; z goes up."""

BOX = [(a, b) for a in range(8) for b in range(8) if b > a and (a ^ b) in (1, 2, 4)]
"""Edges of a cube whose corners are numbered by x, y and z, a bit each."""


def graph_picture(
    name: str, nodes: Points, edges: Edges, proportions: Floats, axes: Floats | None = None
) -> str:
    """Return an SVG picture of a graph in its box.

    Parameters
    ----------
    nodes : (n, 3) in the unit cube
    edges : (m, 2)
    proportions : (3,) of the box
    axes : (3, 3) unit directions of its sides, rows; by default along x, y and z
    """
    up = np.cross(TOWARDS, RIGHT)
    corners = (np.arange(8)[:, None] >> np.arange(3) & 1) - 0.5
    points = np.concatenate([corners, nodes - 0.5]) * proportions
    if axes is not None:
        points = points @ axes
    lines = np.concatenate([BOX, edges + 8])
    seen = points @ np.stack([RIGHT, -up, TOWARDS], axis=1)  # (p, 3): right, down, near
    places = SIZE / 2 + seen[:, :2] * 0.44 * SIZE / np.abs(seen[:8, :2]).max()
    depth = seen[lines, 2].mean(axis=1)
    near = (depth - depth.min()) / max(np.ptp(depth), 1e-9)

    drawn = []
    for k in np.argsort(depth, kind="stable").tolist():
        a, b = lines[k]
        (x1, y1), (x2, y2) = places[[a, b]].tolist()
        if k < len(BOX):
            style = 'stroke="#c8c8c8" stroke-width="1"'
        else:
            gray, width = round(150 - 125 * near[k]), 2.5 + 4 * near[k]
            style = f'stroke="rgb({gray},{gray},{gray + 30})" stroke-width="{width:.1f}"'
        drawn.append(f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" {style}/>')
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{SIZE}" height="{SIZE}" '
        f'viewBox="0 0 {SIZE} {SIZE}" stroke-linecap="round" role="img">'
        f"<title>{escape(name)}</title>{''.join(drawn)}</svg>"
    )
