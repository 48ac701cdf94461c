"""Tests of how far blends are from what they are fitted to."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.base.arrays import Floats
from scaffold_cad.struts.blending import depths
from scaffold_cad.struts.blending.distances import Union
from scaffold_cad.struts.blending.layouts import Layout


def one_patch(point: Floats) -> Floats:
    """Return the control points (3, 1, 4, 6, 6) of patches that are all at one point."""
    return np.broadcast_to(point[:, None, None, None, None], (3, 1, 4, 6, 6)).copy()


@pytest.mark.parametrize(("height", "bulge", "depth"), [(2.5, 0.5, 0.0), (1.5, 0.0, 0.25)])
def test_points_are_off_by_their_distance_from_the_strut(
    height: float, bulge: float, depth: float
) -> None:
    along_x = Union(
        np.array([[[1.0]], [[0.0]], [[0.0]]]),
        np.array([[2.0]]),
        np.zeros((1, 1)),
        np.zeros(1),
        np.array([0.5]),
    )
    off = depths.misfit(along_x, one_patch(np.array([3.0, height, 0.0])), Layout(1, 1, 5))
    assert off.distance == pytest.approx(0.5)
    assert off.bulge == pytest.approx(bulge)
    assert off.depth == pytest.approx(depth)


def test_peaks_between_lines_of_a_grid_are_found() -> None:
    x, y = np.meshgrid(np.arange(8.0), np.arange(6.0), indexing="ij")
    tops = [(3.3, 2.4), (6.0, 4.0)]
    values = [
        np.maximum(1 + k - 0.1 * (x - a) ** 2 - 0.1 * (y - b) ** 2, 0.0)
        for k, (a, b) in enumerate(tops)
    ]
    grids = np.stack([np.stack([values[0], 0 * x]), np.stack([values[0], values[1]])])
    assert depths._highest(grids) == pytest.approx([1.0, 2.0])
