"""Contours on grids are closed, leave the inside to their left, and have its area."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import Layer
from scaffold_cad.base.arrays import Floats
from scaffold_cad.layers.contours import contours, keys_of, unpacked
from scaffold_cad.layers.uniting import united

CELL = 0.05
FIRST = np.array([-100, -100])
PLACES = np.stack(np.meshgrid(np.arange(1, 200), np.arange(1, 200), indexing="ij"), axis=-1)
X, Y = np.moveaxis((PLACES + FIRST) * CELL, -1, 0)


def found(values: Floats, level: int = 3) -> Layer:
    places = PLACES.reshape(-1, 2)
    loops = contours(keys_of(np.full(len(places), level), places), values.reshape(-1), CELL, FIRST)
    assert (loops.levels == level).all()
    return Layer(0.0, 0.0, loops.points, loops.offsets)


def test_keys_are_unpacked() -> None:
    places = np.array([[1, 7], [2**21, 3]])
    levels, again = unpacked(keys_of(np.array([0, 9]), places))
    assert levels.tolist() == [0, 9]
    np.testing.assert_array_equal(again, places)


def test_a_disc_has_its_area_and_a_hole_is_clockwise() -> None:
    disc = np.hypot(X, Y) - 3
    assert found(disc).area == pytest.approx(9 * np.pi, rel=1e-4)
    ring = np.maximum(disc, 1 - np.hypot(X - 0.5, Y))
    assert sorted(np.sign(found(ring).areas)) == [-1, 1]
    assert found(ring).area == pytest.approx(8 * np.pi, rel=1e-4)


@pytest.mark.parametrize("seed", range(4))
def test_contours_of_anything_do_not_cross(seed: int) -> None:
    layer = found(np.random.default_rng(seed).normal(size=X.shape))
    assert len(layer.loops) > 1000
    assert united(layer.loops).area() == pytest.approx(layer.area, rel=1e-6)


def test_points_that_are_not_known_are_outside() -> None:
    assert found(np.full(X.shape, -1.0)).area == pytest.approx((199 * CELL) ** 2, rel=1e-3)
    assert len(found(np.full(X.shape, 1.0)).loops) == 0
