"""Rotation-minimizing frames: orthonormal, along the curve, and turning no more than they must."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scaffold_cad.base.frames import (
    accumulate,
    double_reflection,
    multiply,
    rotation_minimizing_frames,
    turn,
)
from scaffold_cad.base.vectors import normalize
from scaffold_cad.errors import OptionError
from tests.strategies import directions


def helix(count: int, turns: float = 1.0, pitch: float = 3.0) -> np.ndarray:
    angle = np.linspace(0.0, 2 * np.pi * turns, count)
    return np.column_stack([5 * np.cos(angle), 5 * np.sin(angle), pitch * angle / (2 * np.pi)])


def test_frames_are_orthonormal_right_handed_and_along_the_polyline() -> None:
    frames = rotation_minimizing_frames(helix(30))
    np.testing.assert_allclose(
        frames @ np.swapaxes(frames, 1, 2), np.broadcast_to(np.eye(3), (30, 3, 3)), atol=1e-12
    )
    np.testing.assert_allclose(np.linalg.det(frames), 1.0, atol=1e-12)
    chords = normalize(np.diff(helix(30), axis=0))
    assert (np.einsum("ij,ij->i", frames[:-1, 2], chords) > 0.99).all()


def test_frames_of_a_plane_curve_keep_the_normal_of_the_plane() -> None:
    angle = np.linspace(0.0, 5.0, 17)
    points = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(17)]) * angle[:, None]
    frames = rotation_minimizing_frames(points[1:], np.array([0.0, 0.0, 1.0]))
    np.testing.assert_allclose(frames[:, 0], np.tile([0.0, 0.0, 1.0], (16, 1)), atol=1e-12)


def test_a_helix_turns_its_frame_by_its_total_torsion() -> None:
    # Do Carmo, Differential Geometry of Curves and Surfaces, section 1-5: torsion b / (a² + b²).
    pitch = 3.0
    a, b = 5.0, pitch / (2 * np.pi)
    torsion_angle = 2 * np.pi * b / np.hypot(a, b)
    count = 4001
    frames = rotation_minimizing_frames(helix(count, pitch=pitch), np.array([-1.0, 0.0, 0.0]))
    normal = np.array([-1.0, 0.0, 0.0])  # of the helix, the same after a full turn
    x, y = frames[-1, 0], frames[-1, 1]
    turned = np.arctan2(normal @ y, normal @ x)
    assert turned == pytest.approx(np.remainder(torsion_angle + np.pi, 2 * np.pi) - np.pi, abs=1e-3)


@given(directions(), directions(), directions())
def test_a_step_turns_its_first_tangent_to_its_second(
    chord: np.ndarray, start: np.ndarray, end: np.ndarray
) -> None:
    # Tangents at the ends of a step point along the chord, however little.
    start, end = (normalize(chord + 0.9 * v) for v in (start, end))
    step = double_reflection(chord[None], start[None], end[None])
    np.testing.assert_allclose(np.linalg.norm(step, axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(turn(step, start[None])[0], end, atol=1e-9)


@given(st.lists(st.integers(1, 9), min_size=1, max_size=5), st.integers(0, 2**32 - 1))
def test_accumulated_steps_are_the_running_products_of_each_polyline(
    lengths: list[int], seed: int
) -> None:
    steps = normalize_rows(np.random.default_rng(seed).normal(size=(sum(lengths), 4)))
    position = np.concatenate([np.arange(length) for length in lengths])
    total = accumulate(steps, position)
    for k, place in enumerate(position):
        expected = steps[k : k + 1]
        if place:
            expected = multiply(expected, total[k - 1 : k])
        np.testing.assert_allclose(total[k : k + 1], expected, atol=1e-12)


def test_frames_go_on_where_the_polyline_turns_back_on_itself() -> None:
    frames = rotation_minimizing_frames([[0, 0, 0], [1, 0, 0], [0, 0, 0], [0, 0, 2]])
    np.testing.assert_allclose(frames[:2, 2], [[1, 0, 0], [1, 0, 0]], atol=1e-15)
    np.testing.assert_allclose(frames[3, 2], [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(frames @ np.swapaxes(frames, 1, 2), [np.eye(3)] * 4, atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(frames), 1.0, atol=1e-12)


@given(st.lists(st.sampled_from([*np.eye(3), *-np.eye(3)]), min_size=1, max_size=12))
def test_frames_along_steps_of_a_grid_are_right_handed_and_along_it(steps: list[Any]) -> None:
    points = np.cumsum([np.zeros(3), *steps], axis=0)
    frames = rotation_minimizing_frames(points)
    np.testing.assert_allclose(
        frames @ np.swapaxes(frames, 1, 2), np.broadcast_to(np.eye(3), frames.shape), atol=1e-8
    )
    np.testing.assert_allclose(np.linalg.det(frames), 1.0, atol=1e-8)
    assert (np.einsum("ij,ij->i", frames[1:, 2], steps) > 0.7).all()


@pytest.mark.parametrize(
    ("points", "first_x", "message"),
    [
        ([], None, "the polyline has 0 points; need 2 or more"),
        ([[0, 0, 0]], None, "the polyline has 1 point; need 2 or more"),
        ([0, 1, 2], None, r"points has shape \(3,\); need \(n, 3\)"),
        ("line", None, "points is not an array of numbers"),
        ([[0, 0, 0], [0, 0, np.nan]], None, r"points\[1\] is .*; need finite numbers"),
        ([[0, 0, 0], [1, 0, 0], [1, 0, 0]], None, r"points 1 and 2 are both at \[1.0, 0.0, 0.0\]"),
        ([[0, 0, 0], [1, 0, 0]], [1, 2], "first_x is .*; need a direction, three"),
        ([[0, 0, 0], [1, 0, 0]], "x", "first_x is 'x'; need a direction"),
        ([[0, 0, 0], [1, 0, 0]], [2, 0, 0], "as the polyline's start; need one across it"),
        ([[0, 0, 0], [1, 0, 0]], [0, 0, 0], "first_x is .*; need a direction"),
    ],
)
def test_what_is_no_polyline_is_refused(points: Any, first_x: Any, message: str) -> None:
    with pytest.raises(OptionError, match=message):
        rotation_minimizing_frames(points, first_x)


def test_lists_of_whole_numbers_are_a_polyline() -> None:
    frames = rotation_minimizing_frames([[0, 0, 0], [0, 0, 3], [0, 0, 7]], [2, 0, 1])
    np.testing.assert_allclose(frames, np.broadcast_to(np.eye(3), (3, 3, 3)), atol=1e-15)


def normalize_rows(rows: np.ndarray) -> np.ndarray:
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)
