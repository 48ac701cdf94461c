"""Sampled fields: exact for linear functions, nearest outside, errors named."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.base.fields import Field, PointField
from scaffold_cad.errors import OptionError

BOUNDS = np.array([[-1.0, 0.0, 2.0], [3.0, 5.0, 4.0]])


def plane(points: Points) -> Floats:
    values: Floats = 1.0 + points @ np.array([0.3, -0.2, 0.5])
    return values


def sampled_plane() -> Field:
    axes = [np.linspace(BOUNDS[0, k], BOUNDS[1, k], count) for k, count in enumerate((4, 3, 5))]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    return Field(plane(grid), BOUNDS)


@given(st.integers(0, 2**32 - 1))
def test_a_linear_function_comes_back_exactly_between_the_samples(seed: int) -> None:
    points = np.random.default_rng(seed).uniform(BOUNDS[0], BOUNDS[1], (20, 3))
    np.testing.assert_allclose(sampled_plane()(points), plane(points))


def test_outside_the_grid_the_nearest_place_counts() -> None:
    points = np.array([[-9.0, 2.0, 3.0], [9.0, 9.0, 9.0]])
    np.testing.assert_allclose(
        sampled_plane()(points), plane(np.clip(points, BOUNDS[0], BOUNDS[1]))
    )


def test_a_field_of_one_layer_is_the_same_at_all_heights() -> None:
    field = Field(np.arange(6.0).reshape(3, 2, 1), [[0, 0, 0], [2, 1, 0]])
    assert field([[1.5, 0.5, 7.0]]).tolist() == [3.5]
    assert Field([[[2.0]]], np.zeros((2, 3)))([[1.0, 2.0, 3.0]] * 2).tolist() == [2.0, 2.0]


def test_scattered_numbers_are_linear_between_points_and_nearest_outside() -> None:
    points = np.random.default_rng(0).uniform(BOUNDS[0], BOUNDS[1], (300, 3))
    field = PointField(points, plane(points))
    middles = points.reshape(-1, 3, 3).mean(axis=1)
    np.testing.assert_allclose(field(middles), plane(middles))
    far = np.array([[100.0, 2.0, 3.0]])
    nearest = points[np.linalg.norm(points - far, axis=1).argmin()]
    assert field(far) == pytest.approx(plane(nearest))


def test_points_in_a_plane_or_too_few_give_the_nearest_value() -> None:
    field = PointField([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]], np.arange(5.0))
    assert field([[1.9, 1.1, 4.0], [0.1, 0.2, -3.0]]).tolist() == [4.0, 0.0]
    assert PointField([[0, 0, 0]], [3.0])([[1.0, 1.0, 1.0]]).tolist() == [3.0]


@pytest.mark.parametrize(
    ("values", "bounds", "message"),
    [
        (np.zeros((2, 2)), BOUNDS, r"shape \(2, 2\); need \(i, j, k\)"),
        ([[[1.0, np.nan]]], BOUNDS, r"the field is nan at \[0, 0, 1\]; need finite"),
        (np.zeros((2, 2, 2)), BOUNDS[::-1], "need the first below the second"),
        (np.zeros((2, 2, 2)), BOUNDS[0], "need two corners, mm"),
    ],
)
def test_wrong_grids_are_refused_by_name(values: Floats, bounds: Floats, message: str) -> None:
    with pytest.raises(OptionError, match=message):
        Field(values, bounds)


def test_wrong_points_are_refused_by_name() -> None:
    with pytest.raises(OptionError, match="need one per point"):
        PointField([[0, 0, 0]], [1.0, 2.0])
    with pytest.raises(OptionError, match=r"the field is inf at \[1.0, 0.0, 0.0\] mm"):
        PointField([[0, 0, 0], [1, 0, 0]], [1.0, np.inf])
    twice = [[1, 2, 3], [0, 0, 0], [1, 2, 3]]
    with pytest.raises(OptionError, match=r"field is 4 and 6 at \[1, 2, 3\] mm; need one value a"):
        PointField(twice, [4.0, 5.0, 6.0])
    assert PointField(twice, [4.0, 5.0, 4.0])([[1.0, 2.0, 3.0]]).tolist() == [4.0]
