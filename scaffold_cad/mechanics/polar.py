"""Polar plots of Young's modulus: points, and a picture of the three planes of the axes."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arguments import as_count, check_choice, checks_keywords
from scaffold_cad.base.arrays import Floats
from scaffold_cad.mechanics.cells import Homogenized

PLANES = {"xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
"""Axes of each plane: the first is at angle 0."""

COLORS = {"xy": "#c0392b", "xz": "#2471a3", "yz": "#239b56"}


@checks_keywords()
def young_polar(law: Homogenized, plane: str = "xy", count: int = 180) -> Floats:
    """Return Young's modulus around a plane as points of its polar plot, (count, 2), MPa.

    Parameters
    ----------
    plane : "xy", "xz" or "yz"
    count : points of the full turn, the first along the first axis

    Raises
    ------
    OptionError
        If the plane is not one of these or there are fewer than 3 points.

    Examples
    --------
    >>> from scaffold_cad.mechanics import homogenized
    >>> young_polar(homogenized("bcc", 0.05, "steel"), "xz", count=90).shape
    (90, 2)
    """
    check_choice(plane, "plane", PLANES)
    angle = 2.0 * np.pi * np.arange(as_count(count, "count", 3)) / count
    flat = np.stack([np.cos(angle), np.sin(angle)], axis=1)  # (c, 2)
    directions = np.zeros((count, 3))
    directions[:, PLANES[plane]] = flat
    points: Floats = law.young(directions)[:, None] * flat
    return points


@checks_keywords()
def polar_picture(law: Homogenized, size: int = 320) -> str:
    """Return an SVG picture of Young's modulus in the three planes of the axes.

    Parameters
    ----------
    size : width and height, pixels
    """
    lines = {plane: young_polar(law, plane) for plane in PLANES}
    largest = max(float(np.hypot(*points.T).max()) for points in lines.values())
    middle, unit = size / 2.0, 0.42 * size / largest
    rings = "".join(
        f'<circle cx="{middle:g}" cy="{middle:g}" r="{0.42 * size * k / 4:.1f}" '
        'fill="none" stroke="#ddd"/>'
        for k in range(1, 5)
    )
    curves = "".join(
        f'<polygon points="{_pairs(middle + points * [unit, -unit])}" fill="none" '
        f'stroke="{COLORS[plane]}" stroke-width="1.5"><title>{plane}</title></polygon>'
        for plane, points in lines.items()
    )
    names = "".join(
        f'<text x="8" y="{18 + 15 * k}" fill="{COLORS[plane]}">{plane}</text>'
        for k, plane in enumerate(PLANES)
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size} {size}" width="{size}" '
        f'height="{size}" font-family="sans-serif" font-size="12">{rings}{curves}{names}'
        f'<text x="8" y="{size - 8}">{law.cell.name}, outer ring {largest:.4g} MPa</text></svg>'
    )


def _pairs(points: Floats) -> str:
    return " ".join(f"{x:.2f},{y:.2f}" for x, y in points.tolist())
