"""Partitions of the sphere: what every one keeps, and what each option does."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scaffold_cad.base.arrays import UnitVectors
from scaffold_cad.base.vectors import normalize
from scaffold_cad.errors import OptionError, PartitionError
from scaffold_cad.partition import Partition, certify, partition_sphere, partition_spheres
from scaffold_cad.partition.arcs import arc_counts, arcs_of
from scaffold_cad.partition.star import DistinctStars
from tests.strategies import stars
from tests.validation.star_families import FAMILIES, drawn

METHODS = ["dual", "insertion", "lune"]

STEPS = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3), axis=-1).reshape(-1, 3)
"""Steps to the 26 neighbors of a cell, and 0."""
SIMPLE_CUBIC, OCTET, BCC = (STEPS[np.abs(STEPS).sum(axis=1) == n] for n in (1, 2, 3))
DIAMOND = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
CELLS = {"simple cubic": SIMPLE_CUBIC, "octet": OCTET, "bcc": BCC, "diamond": DIAMOND}
TRIPOD = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1]])
TEE = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0]])
CROSS = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])
HALF_SPACE = STEPS[(STEPS[:, 2] >= 0) & STEPS.any(axis=1)]
"""17 directions, 8 of them on one great circle: every kind of degenerate hull at once."""


def random_star(valency: int, seed: int = 0) -> UnitVectors:
    return normalize(np.random.default_rng(seed).normal(size=(valency, 3)))


def is_certified(partition: Partition) -> bool:
    found = certify(partition.directions[None], partition.vertices[None], partition.quads[None])
    return bool(found.valid[0])


def met_pairs(partition: Partition) -> set[tuple[int, int]]:
    """Return the pairs of directions whose quads share an arc."""
    arcs = arcs_of(partition.quads[None])
    pairs = np.sort(np.stack([arcs.left[0], arcs.right[0]], axis=1), axis=1)
    return {(i, j) for i, j in pairs.tolist()}


@given(stars(max_valency=14, least_angle=0.01), st.sampled_from(METHODS))
def test_every_star_has_a_certified_partition(star: UnitVectors, method: str) -> None:
    partition = partition_sphere(star, method)
    assert partition.quads.shape == (len(star), 4)
    assert partition.vertices.shape == (len(star) + 2, 3)
    assert is_certified(partition)
    assert 0 < partition.relative_clearance <= 1 + 1e-9


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("valency", [3, 4, 5, 9, 16])
def test_hard_stars_are_certified_by_the_default_method_itself(family: str, valency: int) -> None:
    partitions = partition_spheres(drawn(family, np.random.default_rng(valency), 4, valency))
    assert certify(partitions.directions, partitions.vertices, partitions.quads).valid.all()
    assert set(partitions.methods) == {"dual"}


@pytest.mark.parametrize("name", CELLS)
def test_cells_of_lattices_get_the_best_partition_there_is(name: str) -> None:
    partition = partition_sphere(CELLS[name])
    assert partition.relative_clearance > 0.9999
    assert arc_counts(partition.quads[None]).max() <= 4


def test_simple_cubic_gives_the_cube() -> None:
    partition = partition_sphere(SIMPLE_CUBIC)
    np.testing.assert_allclose(np.abs(partition.vertices), 1 / np.sqrt(3), atol=1e-9)


def test_octet_gives_the_rhombic_dodecahedron() -> None:
    partition = partition_sphere(OCTET)
    largest = np.abs(partition.vertices).max(axis=1)
    on_axis, on_diagonal = np.isclose(largest, 1), np.isclose(largest, 1 / np.sqrt(3))
    assert (on_axis.sum(), on_diagonal.sum()) == (6, 8)


@pytest.mark.parametrize("star", [TRIPOD, TEE, CROSS, random_star(3), random_star(4)])
def test_bisectors_are_reached_where_they_can_be(star: UnitVectors) -> None:
    assert partition_sphere(star).relative_clearance == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(("valency", "least"), [(6, 0.99), (8, 0.97), (12, 0.93), (20, 0.9)])
def test_random_stars_get_good_partitions(valency: int, least: float) -> None:
    random = np.random.default_rng(valency)
    clearance = partition_spheres(drawn("uniform", random, 30, valency)).relative_clearance
    assert np.median(clearance) > least
    assert clearance.min() > 0.6


def test_a_hull_full_of_degenerate_facets_gets_a_good_partition() -> None:
    assert partition_sphere(HALF_SPACE).relative_clearance > 0.9


def test_twenty_even_directions_get_a_good_partition() -> None:
    grid = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3), axis=-1).reshape(-1, 3)
    star = grid[np.isin(np.abs(grid).sum(axis=1), (2, 3))]  # those of fbcc
    assert partition_sphere(star).relative_clearance > 0.95


def test_a_hundred_directions_are_partitioned() -> None:
    partition = partition_sphere(random_star(100))
    assert is_certified(partition)
    assert partition.relative_clearance > 0.5


@pytest.mark.parametrize("valency", [3, 4, 7, 12])
@pytest.mark.parametrize("method", METHODS)
def test_directions_a_hundredth_of_a_degree_apart_are_kept_apart(valency: int, method: str) -> None:
    star = random_star(valency)
    angle = np.radians(0.0101)
    beside = normalize(np.cross(star[0], star[-1]))
    star[1] = np.cos(angle) * star[0] + np.sin(angle) * beside
    assert is_certified(partition_sphere(star, method))


def test_arcs_are_long_enough_to_make_quads() -> None:
    partitions = partition_spheres(drawn("uniform", np.random.default_rng(1), 30, 8))
    arcs = arcs_of(partitions.quads)
    row = np.arange(30)[:, None]
    spans = partitions.vertices[row, arcs.starts] - partitions.vertices[row, arcs.ends]
    shortest = np.linalg.norm(spans, axis=2).min(axis=1)
    assert (shortest > 0.1 * partitions.clearance.min(axis=1)).all()


@settings(max_examples=15)
@given(stars(max_valency=10), st.integers(0, 99))
def test_the_order_of_directions_does_not_matter(star: UnitVectors, seed: int) -> None:
    order = np.random.default_rng(seed).permutation(len(star))
    partition, reordered = partition_sphere(star), partition_sphere(star[order])
    np.testing.assert_array_equal(reordered.vertices, partition.vertices)
    np.testing.assert_array_equal(reordered.quads, partition.quads[order])


@pytest.mark.parametrize("valency", [3, 4, 5, 8, 12])
def test_partitions_turn_with_their_stars(valency: int) -> None:
    star = random_star(valency)
    rotation, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    rotation *= np.linalg.det(rotation)
    partition, turned = partition_sphere(star), partition_sphere(star @ rotation)
    centers = partition.vertices[partition.quads].mean(axis=1) @ rotation
    np.testing.assert_allclose(
        turned.vertices[turned.quads].mean(axis=1), centers, rtol=0, atol=1e-3
    )


def test_length_of_directions_does_not_matter() -> None:
    star = random_star(6)
    scaled = star * np.array([1e-200, 1e-3, 1, 7, 1e9, 1e200])[:, None]
    np.testing.assert_allclose(
        partition_sphere(scaled).vertices, partition_sphere(star).vertices, atol=1e-6
    )


def test_repeated_stars_share_their_vertices_in_any_order_of_directions() -> None:
    random = np.random.default_rng(3)
    distinct = drawn("uniform", random, 3, 7)
    pick = random.integers(3, size=50)
    order = random.permuted(np.tile(np.arange(7), (50, 1)), axis=1)
    repeated = distinct[pick[:, None], order]
    partitions = partition_spheres(repeated + 1e-9 * random.normal(size=repeated.shape))
    alone = partition_spheres(distinct)
    np.testing.assert_allclose(partitions.vertices, alone.vertices[pick], atol=1e-6)
    np.testing.assert_array_equal(partitions.quads, alone.quads[pick[:, None], order])
    assert certify(partitions.directions, partitions.vertices, partitions.quads).valid.all()


def test_stars_grouped_by_mistake_are_partitioned_on_their_own(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def one_group(stars: UnitVectors) -> DistinctStars:
        everyone = np.zeros(len(stars), dtype=np.intp)
        return DistinctStars(everyone[:1], everyone, np.tile(np.arange(6), (len(stars), 1)))

    unlike = drawn("uniform", np.random.default_rng(0), 4, 6)
    monkeypatch.setattr("scaffold_cad.partition.sphere.distinct_stars", one_group)
    partitions = partition_spheres(unlike)
    assert certify(partitions.directions, partitions.vertices, partitions.quads).valid.all()
    assert np.median(partitions.relative_clearance) > 0.9


def test_a_star_does_not_depend_on_the_others() -> None:
    many = drawn("clustered", np.random.default_rng(4), 12, 9)
    together = partition_spheres(many)
    alone = [partition_sphere(star) for star in many]
    np.testing.assert_array_equal(together.vertices, [each.vertices for each in alone])
    np.testing.assert_array_equal(together[5].quads, alone[5].quads)


def test_no_stars_give_no_partitions() -> None:
    partitions = partition_spheres(np.zeros((0, 5, 3)))
    assert len(partitions) == 0
    assert partitions.vertices.shape == (0, 7, 3)


def test_arrays_are_read_only() -> None:
    partition = partition_sphere(TRIPOD)
    for array in (partition.directions, partition.vertices, partition.quads, partition.clearance):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_input_is_left_alone() -> None:
    star = 5.0 * TRIPOD
    partition_sphere(star)
    np.testing.assert_array_equal(star, 5.0 * TRIPOD)


def test_lunes_meet_at_two_poles() -> None:
    partition = partition_sphere(random_star(7), "lune")
    assert partition.method == "lune"
    assert sorted(arc_counts(partition.quads[None])[0]) == [2] * 7 + [7] * 2


def test_insertion_without_a_certificate_is_replaced_by_lunes() -> None:
    partitions = partition_spheres(drawn("uniform", np.random.default_rng(0), 40, 16), "insertion")
    assert set(partitions.methods) == {"insertion", "lune"}
    assert certify(partitions.directions, partitions.vertices, partitions.quads).valid.all()


@pytest.mark.parametrize(
    ("directions", "message"),
    [
        (np.eye(2, 3), "a star has 2 directions; need at least 3"),
        (np.eye(3, 2), "directions have shape"),
        ([[1, 0, 0], [0, 1, 0], [0, 0, 0]], "direction 2 of star 0 has length 0; need > 0"),
        ([[1, 0, 0], [0, np.nan, 0], [0, 0, 1]], r"direction 1 of star 0 is \[0.0, nan, 0.0\]"),
        ([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1e-4, 0]], "directions 0 and 3 .* 0.00573°"),
        ([["a", 0, 0], [0, 1, 0], [0, 0, 1]], "directions is not an array of numbers"),
    ],
)
def test_bad_directions_are_refused(directions: object, message: str) -> None:
    with pytest.raises(PartitionError, match=message):
        partition_sphere(directions)  # type: ignore[arg-type]


def test_the_star_with_directions_too_close_is_named() -> None:
    many = drawn("uniform", np.random.default_rng(0), 5, 4)
    many[3, 2] = many[3, 0] + 1e-5
    with pytest.raises(PartitionError, match="directions 0 and 2 of star 3"):
        partition_spheres(many)


def test_unknown_methods_are_refused() -> None:
    with pytest.raises(OptionError, match="method is 'voronoi'; need one of dual, insertion, lune"):
        partition_sphere(TRIPOD, "voronoi")


# Known quads for other directions


@pytest.mark.parametrize("family", ["uniform", "hemispherical", "paired"])
@pytest.mark.parametrize("valency", [3, 4, 6, 11])
def test_moved_directions_keep_their_quads(family: str, valency: int) -> None:
    random = np.random.default_rng(valency)
    before = partition_spheres(drawn(family, random, 8, valency))
    moves = 0.1 * before.clearance[..., None] * random.normal(size=before.directions.shape)
    moved = before.directions + moves
    after = partition_spheres(moved, like=before.quads, near=before.vertices)
    np.testing.assert_array_equal(after.quads, before.quads)
    assert set(after.methods) == {"like"}
    assert certify(after.directions, after.vertices, after.quads).valid.all()


def test_quads_alone_are_enough_to_place_vertices() -> None:
    before = partition_spheres(drawn("uniform", np.random.default_rng(0), 20, 9))
    after = partition_spheres(before.directions, like=before.quads)
    np.testing.assert_array_equal(after.quads, before.quads)
    assert certify(after.directions, after.vertices, after.quads).valid.all()
    assert np.median(after.relative_clearance) > 0.97


def test_equal_stars_with_unlike_quads_are_told_apart() -> None:
    star = random_star(6)
    dual, lune = partition_sphere(star), partition_sphere(star, "lune")
    both = partition_spheres(
        [star, star, star], like=np.stack([dual.quads, lune.quads, dual.quads])
    )
    np.testing.assert_array_equal(both.quads[1], lune.quads)
    np.testing.assert_array_equal(both.vertices[0], both.vertices[2])


def test_quads_that_cannot_hold_the_directions_are_refused() -> None:
    star = random_star(8)
    before = partition_sphere(star)
    swapped = star[[3, 1, 2, 0, 7, 5, 6, 4]]
    with pytest.raises(PartitionError, match=r"no certified vertices found .* star 1 is to keep"):
        partition_spheres([star, swapped], like=np.stack([before.quads, before.quads]))


@pytest.mark.parametrize(
    ("quads", "message"),
    [
        (np.zeros((1, 4, 4), dtype=int), "quads of star 0 in like do not close up on 6 vertices"),
        (np.full((1, 4, 4), 9), "quads of star 0 in like do not close up on 6 vertices"),
        (np.zeros((1, 3, 4), dtype=int), r"like has shape \(1, 3, 4\)"),
        (np.full((1, 4, 4), 0.5), "like holds 0.5; need whole numbers"),
    ],
)
def test_models_that_are_no_partitions_are_refused(quads: object, message: str) -> None:
    with pytest.raises(PartitionError, match=message):
        partition_spheres([CROSS], like=quads)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("quads", "message"),
    [
        ([[[0, 1], [2]]], "like is not an array of indices"),
        ("quads", "like holds 'quads'; need whole numbers"),
    ],
)
def test_quads_that_are_no_numbers_are_refused(quads: Any, message: str) -> None:
    with pytest.raises(PartitionError, match=message):
        partition_spheres([CROSS], like=quads)


@pytest.mark.parametrize("near", ["x", [[0, 1], [2]], [1j]])
def test_vertices_to_stay_near_to_that_are_no_numbers_are_refused(near: Any) -> None:
    quads = partition_spheres([CROSS]).quads
    with pytest.raises(PartitionError, match="near is not an array of numbers"):
        partition_spheres([CROSS], like=quads, near=near)
    with pytest.raises(OptionError, match="near is given without like"):
        partition_spheres([CROSS], near=near)


def test_vertices_to_stay_near_to_must_fit_the_quads() -> None:
    quads = partition_sphere(CROSS).quads[None]
    with pytest.raises(PartitionError, match=r"near has shape \(1, 5, 3\); need \(1, 6, 3\)"):
        partition_spheres([CROSS], like=quads, near=np.zeros((1, 5, 3)))


# Chosen neighbors


@pytest.mark.parametrize("valency", [3, 4, 5, 7])
def test_any_two_directions_can_be_made_neighbors(valency: int) -> None:
    star = random_star(valency)
    for i in range(valency):
        for j in range(i):
            partition = partition_sphere(star, neighbors=[(i, j)])
            assert (j, i) in met_pairs(partition)
            assert is_certified(partition)


def test_several_pairs_of_neighbors_are_kept() -> None:
    star = random_star(8)
    wanted = sorted(met_pairs(partition_sphere(star)))[:4]
    partition = partition_sphere(star, neighbors=wanted)
    assert set(wanted) <= met_pairs(partition)


def test_opposite_directions_of_a_coplanar_star_can_be_neighbors() -> None:
    assert (0, 1) not in met_pairs(partition_sphere(CROSS))
    partition = partition_sphere(CROSS, neighbors=[(0, 1)])
    assert (0, 1) in met_pairs(partition)
    assert is_certified(partition)


def test_no_neighbors_ask_for_nothing() -> None:
    star = random_star(6)
    partition = partition_sphere(star, neighbors=[])
    assert partition.relative_clearance == pytest.approx(
        partition_sphere(star).relative_clearance, abs=0.02
    )


@pytest.mark.parametrize(
    ("neighbors", "message"),
    [
        ([(0, 6)], "neighbors 0 and 6 are not two directions; need two of 0 to 5"),
        ([(2, 2)], "neighbors 2 and 2 are not two"),
        ([(0, 1, 2)], r"neighbors has shape \(1, 3\); need \(k, 2\)"),
        ([(0, 1), (2,)], "neighbors is not an array of indices"),
        ([("a", "b")], "neighbors holds 'a'; need whole numbers"),
        ([(0, k) for k in range(1, 6)], "direction 0 is to have 5 neighbors"),
    ],
)
def test_impossible_neighbors_are_refused(neighbors: object, message: str) -> None:
    with pytest.raises(PartitionError, match=message):
        partition_sphere(SIMPLE_CUBIC, neighbors=neighbors)  # type: ignore[arg-type]


def test_neighbors_that_no_plane_graph_has_are_refused() -> None:
    everyone = [(i, j) for i in range(5) for j in range(i)]
    with pytest.raises(PartitionError, match=r"directions \d and \d cannot be neighbors"):
        partition_sphere(random_star(5), neighbors=everyone)


def test_neighbors_need_the_dual_method() -> None:
    with pytest.raises(OptionError, match="method is 'lune'; need 'dual' to choose neighbors"):
        partition_sphere(CROSS, "lune", neighbors=[(0, 1)])
