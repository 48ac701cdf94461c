"""Short arcs between struts that part late: where they end, and what they are for."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.vectors import angle_between
from scaffold_cad.partition import partition_spheres
from scaffold_cad.partition.certificate import certify
from scaffold_cad.struts import blends
from scaffold_cad.struts.blending.crotches import half_length, with_short_arcs
from scaffold_cad.struts.blending.evenness import even
from tests.struts.stars import random_stars, stars_of


def _forked(degrees: float, count: int) -> np.ndarray:
    """Return stars of three struts, two of which are `degrees` apart, (count, 3, 3)."""
    rng = np.random.default_rng(2)
    half = np.radians(degrees / 2)
    third = random_stars(40 * count, 2, 0, rng)[:, 0]
    third = third[third[:, 0] < 0.5][:count]  # 60° and more from both
    pair = np.array([[np.cos(half), side * np.sin(half), 0] for side in (-1, 1)])
    return np.concatenate([np.tile(pair, (count, 1, 1)), third[:, None]], axis=1)


def test_the_arc_in_a_crotch_is_short_and_its_partition_certified() -> None:
    made = partition_spheres(_forked(20, 20))
    vertices = even(made.directions, made.vertices, made.quads, 0.3)
    assert certify(made.directions, vertices, made.quads).valid.all()
    crotch = np.broadcast_to([1.0, 0, 0], vertices.shape)
    nearest = np.sort(angle_between(vertices, crotch), axis=1)[:, :2]  # the two ends of the arc
    assert np.quantile(nearest, 0.75) < np.radians(4.1)


def test_arcs_grow_with_the_angle_between_the_struts() -> None:
    half = half_length(np.radians([10, 20, 45, 90]))
    np.testing.assert_allclose(half, np.radians([4, 4, 45, 45]))


def test_arcs_between_struts_that_part_early_are_as_they_are() -> None:
    made = partition_spheres(random_stars(20, 4, 45, np.random.default_rng(3)))
    vertices = with_short_arcs(made.directions, made.vertices, made.quads)
    np.testing.assert_array_equal(vertices, made.vertices)


def test_forks_of_twenty_degrees_are_sound() -> None:
    groups = blends(stars_of(_forked(20, 20)))
    sound = sum(int(group.shapes.sound[group.shape_of].sum()) for group in groups)
    assert sound >= 19  # with long arcs 8
