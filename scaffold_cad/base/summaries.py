"""Short texts that sum up what an object holds: counts, size, range of radii."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Points


def counted(count: int, noun: str, plural: str = "") -> str:
    """Return a count with its noun.

    >>> counted(1, "edge"), counted(2, "edge"), counted(2, "vertex", "vertices")
    ('1 edge', '2 edges', '2 vertices')
    """
    return f"{count} {noun if count == 1 else plural or noun + 's'}"


def size_text(points: Points) -> str:
    """Return the size of the box around `points` (n, 3), mm.

    >>> size_text(np.array([[0.0, 0.0, 0.0], [9.0, 4.0, 0.5]]))
    '9 x 4 x 0.5 mm'
    """
    size = np.ptp(points, axis=0) if len(points) else np.zeros(3)
    return " x ".join(f"{extent:.6g}" for extent in size) + " mm"


def range_text(values: Floats, unit: str = "mm") -> str:
    """Return the least and the greatest of `values` (n,), with n ≥ 1, once if they are equal.

    >>> range_text(np.array([2.0, 0.5, 1.0])), range_text(np.array([0.5, 0.5]))
    ('0.5 to 2 mm', '0.5 mm')
    """
    both = dict.fromkeys(f"{value:.6g}" for value in (values.min(), values.max()))
    return f"{' to '.join(both)} {unit}"


def radii_text(radii: Floats) -> str:
    """Return the range of `radii` (n,) or (m, 2), mm, as it ends the text of a skeleton.

    >>> radii_text(np.array([1.0, 1.0])), radii_text(np.array([2.0, 0.5]))
    ('radius 1 mm', 'radii 0.5 to 2 mm')
    """
    if radii.size == 0:
        return "no radii"
    if radii.min() == radii.max():
        return f"radius {radii.flat[0]:.6g} mm"
    return f"radii {range_text(radii)}"
