"""Sections of cones and balls: areas as in closed form, corners on the surface."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scaffold_cad.layers.rounds import Balls, Cones


def cone(tip: list[float], radii: tuple[float, float]) -> Cones:
    return Cones(np.zeros((1, 3)), np.array([tip], dtype=float), np.array([radii], dtype=float))


def areas(points: np.ndarray) -> np.ndarray:
    x, y = np.moveaxis(points, -1, 0)
    return (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1) / 2


def volume(shape: Cones | Balls, sides: int, layers: int = 2000) -> float:
    low, high = (float(end[0]) for end in shape.extents())
    heights = low + (high - low) * (np.arange(layers) + 0.5) / layers
    points = shape.loops(heights, sides).points.reshape(-1, sides, 2)
    assert (areas(points) >= 0).all()
    return float(areas(points).sum() * (high - low) / layers)


def test_a_section_across_a_cylinder_has_the_area_of_its_circle() -> None:
    points = cone([0, 0, 9], (2.0, 2.0)).loops(np.array([1.0, 9.0]), 8).points.reshape(2, 8, 2)
    assert areas(points) == pytest.approx(4 * np.pi)


def test_a_slanting_section_of_a_cylinder_is_an_ellipse_of_its_area() -> None:
    points = cone([30, 40, 50], (2.0, 2.0)).loops(np.array([25.0]), 12).points.reshape(1, 12, 2)
    assert areas(points) == pytest.approx(4 * np.pi * np.sqrt(2))
    middle = points[0] - [15, 20]
    along = middle @ [0.6, 0.8]
    across = middle @ [-0.8, 0.6]
    # The axis is at 45°: the ellipse is √2 times as long as it is wide.
    assert along**2 / 2 + across**2 == pytest.approx((along**2 / 2 + across**2).mean())


def test_a_level_cylinder_has_rectangles_for_sections() -> None:
    loops = cone([9, 0, 0], (2.0, 2.0)).loops(np.array([-1.0, 0.0, 1.0]), 8)
    points = loops.points.reshape(3, 8, 2)
    assert areas(points) == pytest.approx(9 * 2 * np.sqrt(4 - np.array([1.0, 0.0, 1.0])))
    assert np.ptp(points[:, :, 0], axis=1) == pytest.approx(9)


def test_a_section_along_a_generator_of_a_cone_is_found() -> None:
    # The highest generator of this cone is level: cut it just below.
    slope = 0.1
    tip = [9.0, 0.0, -9 * slope / np.sqrt(1 - slope**2)]
    length = np.linalg.norm(tip)
    level = cone(tip, (1.0, 1.0 + slope * length))
    _, high = level.extents()
    points = level.loops(high - 1e-6, 16).points.reshape(-1, 16, 2)
    assert (areas(points) >= 0).all()
    assert np.isfinite(points).all()


@given(
    st.tuples(*[st.floats(-9, 9)] * 3).filter(lambda tip: np.linalg.norm(tip) > 1),
    st.floats(0.3, 2.0),
    st.floats(0.3, 2.0),
)
def test_sections_add_up_to_the_volume_of_any_cone(
    tip: tuple[float, float, float], near: float, far: float
) -> None:
    exact = np.pi / 3 * float(np.linalg.norm(tip)) * (near**2 + near * far + far**2)
    coarse, fine = (volume(cone(list(tip), (near, far)), sides) / exact - 1 for sides in (16, 64))
    assert abs(coarse) < 0.02
    assert abs(fine) < 0.002


@given(st.tuples(*[st.floats(-9, 9)] * 3).filter(lambda tip: np.linalg.norm(tip) > 1))
def test_corners_of_sections_are_at_the_cylinder(tip: tuple[float, float, float]) -> None:
    shape = cone(list(tip), (1.0, 1.0))
    low, high = (float(end[0]) for end in shape.extents())
    height = low + 0.37 * (high - low)
    points = shape.loops(np.array([height]), 64).points
    places = np.concatenate([points, np.full((64, 1), height)], axis=1)
    axis = np.array(tip) / np.linalg.norm(tip)
    along = places @ axis
    away = np.linalg.norm(places - along[:, None] * axis, axis=1)
    # Polygons of equal area reach beyond their circle by a little.
    assert away.max() < 1.001
    assert along.min() > -0.01 - 0.001 * float(np.linalg.norm(tip))


def test_sections_of_a_ball_add_up_to_its_volume() -> None:
    ball = Balls(np.array([[1.0, 2.0, 3.0]]), np.array([2.0]))
    assert volume(ball, 8) == pytest.approx(4 / 3 * np.pi * 8, rel=1e-6)


def test_what_is_not_at_a_height_has_no_section_there() -> None:
    loops = cone([0, 0, 9], (2.0, 2.0)).loops(np.array([-1.0, 0.0, 9.5]), 8)
    assert len(loops.levels) == 0
