from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.errors import OptionError
from scaffold_cad.solid.field.lattice import (
    lattice_over,
    least_cells,
    representable_size,
    steps_on_edges,
)


@pytest.mark.parametrize(("size", "m"), [(1.0, 1.0), (0.9, 0.875), (0.6, 0.5), (13.9, 12.0)])
def test_cell_sizes_are_small_multiples_of_powers_of_two(size: float, m: float) -> None:
    assert representable_size(size, power=False) == m


def test_far_away_cell_sizes_are_powers_of_two() -> None:
    assert representable_size(0.9, power=True) == 0.5


@pytest.mark.parametrize("place", [[0.0, 0, 0], [76000.0, 5, -3], [-1e6, 2e6, 7]])
def test_vertices_at_the_steps_of_grid_edges_are_32_bit_numbers(place: list[float]) -> None:
    low = np.array(place)
    lattice = lattice_over(low, low + 50 * float(least_cells(low[None])[0]) + 1.0, 0.9, power=True)
    rng = np.random.default_rng(0)
    start = 4 * rng.integers(0, 8, size=(100, 3))
    end = start + rng.choice([-1, 1], size=(100, 3)) * [[1, 1, 0]]
    scale = 2.0 ** steps_on_edges(lattice, start, end)
    t = np.round(0.3 * scale) / scale
    points = lattice.origin + lattice.places(start) + t[:, None] * lattice.places(end - start)
    assert (points.astype(np.float32) == points).all()


def test_too_many_cells_a_side_are_refused() -> None:
    with pytest.raises(OptionError, match=r"are 1\.02e\+09 per side; need at most 524288"):
        lattice_over(np.zeros(3), np.full(3, 1e6), 1e-3, power=False)
