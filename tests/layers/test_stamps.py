"""Polygons of a few cells repeated for many."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.base.arrays import Floats, Ints
from scaffold_cad.layers.stamps import Stamp

SQUARE = np.array([[0.2, 0.1], [0.6, 0.1], [0.6, 0.5], [0.2, 0.5]])


def squares(columns: int, rows: int, sides: Floats) -> tuple[Floats, Ints]:
    """Return a square in each cell, larger at the border."""
    corners = []
    for i in range(columns):
        for j in range(rows):
            at_border = i in (0, columns - 1) or j in (0, rows - 1)
            corners.append((1.5 if at_border else 1.0) * SQUARE + np.array([i, j]) @ sides)
    return np.concatenate(corners), 4 * np.arange(len(corners) + 1)


@pytest.mark.parametrize("counts", [(7, 7), (9, 7), (12, 30)])
@pytest.mark.parametrize("sides", [np.eye(2), np.array([[1.0, 0.0], [0.4, 1.1]])])
def test_what_is_inside_is_repeated_and_the_border_kept(
    counts: tuple[int, int], sides: Floats
) -> None:
    stamp = Stamp(np.zeros(2), sides, np.array([7, 7]), np.array(counts), 1)
    found = stamp.repeated(*squares(7, 7, sides))
    assert found is not None
    points, offsets = found
    wanted, _ = squares(*counts, sides)
    assert np.diff(offsets).tolist() == [4] * (counts[0] * counts[1])

    def ordered(corners: Floats) -> Floats:
        first = np.round(corners.reshape(-1, 8), 9)
        return first[np.lexsort(first.T)]

    assert ordered(points) == pytest.approx(ordered(wanted))


def test_polygons_on_the_border_of_a_cell_are_repeated_too() -> None:
    around = np.array([[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]])
    nodes = np.array([[i, j] for i in range(8) for j in range(8)], dtype=float)
    points = (around + nodes[:, None]).reshape(-1, 2)
    stamp = Stamp(np.zeros(2), np.eye(2), np.array([7, 7]), np.array([20, 11]), 1)
    found = stamp.repeated(points, 4 * np.arange(65))
    assert found is not None
    centers = found[0].reshape(-1, 4, 2).mean(axis=1)
    assert len(centers) == len(np.unique(np.round(centers, 6), axis=0)) == 21 * 12


def test_a_polygon_over_many_cells_is_not_repeated() -> None:
    bar = np.array([[0, 0.4], [7, 0.4], [7, 0.6], [0, 0.6]])
    stamp = Stamp(np.zeros(2), np.eye(2), np.array([7, 7]), np.array([20, 7]), 1)
    assert stamp.repeated(bar, np.array([0, 4])) is None


def test_nothing_stays_nothing() -> None:
    stamp = Stamp(np.zeros(2), np.eye(2), np.array([7, 7]), np.array([20, 7]), 1)
    found = stamp.repeated(np.zeros((0, 2)), np.array([0]))
    assert found is not None
    assert found[1].tolist() == [0]
