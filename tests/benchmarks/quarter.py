"""The numbers of the quintic quarter circle: `python -m tests.benchmarks.quarter` makes them.

Of the curves with the ends and the end tangents of the quarter circle, symmetric in its middle,
that one is printed whose greatest distance from the circle is least: its distance has the same
size, with signs in turn, at as many places as there are unknowns (Remez's exchange).
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.struts.blending.quarter import DEGREE

AT = np.linspace(0.0, 0.5, 2001)
"""Half of the curve: the other is its mirror image."""

BEGIN, PLACES = (0.319, 0.873, 0.630), (0.06, 0.18, 0.33, 0.5)
"""Numbers near those wanted, and places near those of the greatest distances."""

SCALE = 1e-9
"""Distances are solved for in these radii."""

EXCHANGES = 6


def distances(numbers: Floats, at: Floats) -> Floats:
    """Return how far points of the curve with three free numbers are outside, in `SCALE`."""
    a, b, c = numbers
    controls = np.array([[1.0, 0.0], [1.0, a], [b, c], [c, b], [a, 1.0], [0.0, 1.0]])
    distance: Floats = (np.linalg.norm(bernstein(DEGREE, at) @ controls, axis=1) - 1) / SCALE
    return distance


def best() -> tuple[Floats, float]:
    """Return the three free numbers of the best curve, and its greatest distance in radii."""
    unknowns, places = np.array([*BEGIN, 1.0]), np.array(PLACES)
    signs = np.array([1.0, -1.0, 1.0, -1.0])
    for _ in range(EXCHANGES):
        for _ in range(EXCHANGES):  # Newton's steps for the same size at all places
            numbers, size = unknowns[:3], unknowns[3]
            lack = distances(numbers, places) - signs * size
            steps = 1e-6 * np.eye(3)
            slopes = [
                (distances(numbers + step, places) - distances(numbers - step, places)) / 2e-6
                for step in steps
            ]
            unknowns = unknowns - np.linalg.solve(np.column_stack([*slopes, -signs]), lack)
        away = np.abs(distances(unknowns[:3], AT))
        parts = np.split(np.arange(len(AT)), np.searchsorted(AT, (places[1:] + places[:-1]) / 2))
        places = np.array([AT[part[np.argmax(away[part])]] for part in parts])
    return unknowns[:3], float(away.max()) * SCALE


def main() -> None:
    numbers, distance = best()
    print(f"free numbers {', '.join(map(repr, numbers.tolist()))}; distance at most {distance:.4g}")


if __name__ == "__main__":
    main()
