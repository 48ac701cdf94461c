from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.solid.field import field_struts
from scaffold_cad.solid.field.struts import FieldStruts
from scaffold_cad.solid.field.union import Lists, filleted_union, values


def field_at(struts: FieldStruts, points: np.ndarray) -> np.ndarray:
    count = len(struts.ends)
    union = filleted_union(struts, np.zeros(3), np.zeros(count))
    lists = Lists(np.array([0, count]), np.arange(count))
    return values(union, points, np.zeros(len(points), dtype=np.intp), lists)


def test_where_one_strut_is_near_the_field_is_its_distance_over_the_blend() -> None:
    struts = field_struts([[[0, 0, 0], [10, 0, 0]]], 1.0, blend=0.5)
    points = np.array([[5, 2.0, 0], [5, 0, 0.25], [-3, 0, 0], [13, 0, 4]])
    assert field_at(struts, points) == pytest.approx([2, -1.5, 4, 8])


def test_a_cone_has_its_radii_in_the_planes_of_flat_ends() -> None:
    struts = field_struts([[[0, 0, 0], [10, 0, 0]]], [[3.0, 1.0]], flat=True)
    points = np.array([[1e-9, 3, 0], [10 - 1e-9, 0, 1], [5, 0, 2]])
    assert field_at(struts, points) == pytest.approx(0, abs=1e-6)
    assert field_at(struts, np.array([[-0.9, 0, 0]])) == pytest.approx([0.9 / 0.3])


def test_a_round_end_is_a_ball_tangent_to_the_cone() -> None:
    struts = field_struts([[[0, 0, 0], [4, 0, 0]]], [[4.0, 1.0]], blend=1.0)
    # the cone falls by 3 in 4: its tangent ball at the start has the radius 4 * 0.8
    assert field_at(struts, np.array([[-3.2, 0, 0]])) == pytest.approx([0.0])
    assert field_at(struts, np.array([[4 + 0.8, 0, 0]])) == pytest.approx([0.0])


def test_at_right_angles_the_fillet_is_that_of_a_rolling_ball() -> None:
    # two balls so large that they are nearly planes, whose normals are x and y
    far = 1e3
    struts = field_struts(
        [], [], balls=[[-far, 0, 0], [0, -far, 0]], ball_radii=far, ball_blend=2.0
    )
    angle = np.radians([10, 30, 45, 80])
    touched = 2 - 2 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    touched[:, 2] = 0
    assert field_at(struts, touched) == pytest.approx(0, abs=5e-3)


def test_order_does_not_matter_and_the_union_is_never_cut() -> None:
    rng = np.random.default_rng(0)
    ends, points = rng.normal(size=(9, 2, 3)), rng.normal(size=(2000, 3))
    field = field_at(field_struts(ends, 0.3), points)
    assert field == pytest.approx(field_at(field_struts(ends[::-1], 0.3), points))
    alone = np.min([field_at(field_struts(ends[i : i + 1], 0.3), points) for i in range(9)], axis=0)
    assert (field <= alone + 1e-12).all()
    assert (field < alone - 0.01).any()


def test_distances_to_flat_cones_grow_by_a_mm_a_mm_at_most() -> None:
    rng = np.random.default_rng(0)
    for _ in range(60):
        ends = [[[0, 0, 0], [rng.uniform(0.5, 4), 0, 0]]]
        flat = [rng.random(2) < 0.7]
        struts = field_struts(ends, [rng.uniform(0.1, 1, 2)], flat=flat)
        union = filleted_union(struts, np.zeros(3), np.zeros(1))
        points = rng.uniform(-2, 5, (2000, 3)) * [1, 0.5, 0.5]
        moved = points + rng.normal(size=points.shape) * rng.choice([1e-3, 0.1, 1])
        which = np.zeros(len(points), dtype=np.intp)
        step = union.distances(points, which)[0] - union.distances(moved, which)[0]
        assert (np.abs(step) <= np.linalg.norm(points - moved, axis=1) + 1e-9).all()


def test_beyond_a_flat_cone_its_rim_is_nearest() -> None:
    struts = field_struts([[[0, 0, 0], [2, 0, 0]]], [[1.0, 0.5]], flat=True)
    union = filleted_union(struts, np.zeros(3), np.zeros(1))
    points = np.array([[2.3, 0.9, 0.0], [-1.0, 0.0, 1.5], [3.0, 0.0, 0.2], [-0.1, 1.4, 0.0]])
    rims = [np.hypot(0.3, 0.4), np.hypot(1, 0.5), 1.0, np.hypot(0.1, 0.4)]
    found, _ = union.distances(points, np.zeros(4, dtype=np.intp))
    assert found == pytest.approx(np.array(rims), rel=1e-12)
