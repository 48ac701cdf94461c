"""Segments that meet boxes."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.segments import meet_box


def test_segments_that_meet_a_box_are_those_with_a_sample_in_it() -> None:
    random = np.random.default_rng(5)
    start, end = random.uniform(-2.0, 3.0, (2, 400, 3))
    along = np.linspace(0.0, 1.0, 2001)[:, None, None]
    samples = start + along * (end - start)  # (2001, 400, 3)
    inside = ((samples >= 0.0) & (samples <= 1.0)).all(axis=2).any(axis=0)
    np.testing.assert_array_equal(meet_box(start, end, np.zeros(3), np.ones(3)), inside)


def test_segments_in_faces_and_points_meet_a_box() -> None:
    start = np.array(
        [[1.0, -1, 0.5], [1.0 + 1e-9, -1, 0.5], [0.5, 0.5, 0.5], [2.0, 2, 2], [1, 1, 1]]
    )
    end = np.array([[1.0, 2, 0.5], [1.0 + 1e-9, 2, 0.5], [0.5, 0.5, 0.5], [2.0, 2, 2], [3, 3, 3]])
    met = meet_box(start, end, np.zeros(3), np.ones(3))
    assert met.tolist() == [True, False, True, False, True]
