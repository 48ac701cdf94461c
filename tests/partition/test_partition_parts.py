"""The parts a partition is made with: certificate, triangulation, matching, quads, relaxation."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from scaffold_cad.base.arrays import Ints, UnitVectors
from scaffold_cad.base.vectors import normalize
from scaffold_cad.partition import Partitions, certify, partition_sphere, partition_spheres
from scaffold_cad.partition.arcs import arc_counts, arcs_of, is_closed
from scaffold_cad.partition.certificate import arc_normals
from scaffold_cad.partition.delaunay import FEW, Triangulations, triangulations
from scaffold_cad.partition.dual import edges_of
from scaffold_cad.partition.lune import lune_partitions
from scaffold_cad.partition.matching import good_matchings
from scaffold_cad.partition.multigraph import quadrangulations
from scaffold_cad.partition.relax import relaxed
from scaffold_cad.partition.star import distinct_stars, nearest_angles, unique_rows
from tests.validation.partition_certificate import failures
from tests.validation.star_families import FAMILIES, drawn

CUBE = np.array(list(product([-1.0, 1.0], repeat=3))) / np.sqrt(3)
"""Corners of the cube, numbered in binary."""
CUBE_FACES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)
CUBE_DIRECTIONS = np.array(
    [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]], dtype=float
)


def random_stars(count: int, valency: int) -> UnitVectors:
    return drawn("uniform", np.random.default_rng(valency), count, valency)


def proved(directions: UnitVectors, vertices: UnitVectors, quads: Ints) -> bool:
    return bool(certify(directions[None], vertices[None], quads[None]).valid[0])


# The certificate


def test_the_cube_is_certified_with_an_eighth_of_a_turn_to_each_side() -> None:
    found = certify(CUBE_DIRECTIONS[None], CUBE[None], CUBE_FACES[None])
    assert found.valid.all()
    np.testing.assert_allclose(found.clearance, np.pi / 4)


def test_quads_the_wrong_way_round_have_no_certificate() -> None:
    assert not proved(CUBE_DIRECTIONS, CUBE, CUBE_FACES[:, ::-1])


def test_a_direction_outside_its_quad_has_no_certificate_and_a_negative_clearance() -> None:
    moved = CUBE_DIRECTIONS.copy()
    moved[0] = normalize(np.array([-1.0, 1.1, 0.0]))
    found = certify(moved[None], CUBE[None], CUBE_FACES[None])
    assert not found.valid[0]
    assert found.clearance[0, 0] < 0


def test_swapped_directions_have_no_certificate() -> None:
    assert not proved(CUBE_DIRECTIONS[[1, 0, 2, 3, 4, 5]], CUBE, CUBE_FACES)


def test_a_vertex_in_a_wrong_place_has_no_certificate() -> None:
    bent = CUBE.copy()
    bent[0] = -bent[0]
    assert not proved(CUBE_DIRECTIONS, bent, CUBE_FACES)


def test_vertices_that_coincide_have_no_certificate() -> None:
    merged = CUBE.copy()
    merged[0] = merged[1]
    assert not proved(CUBE_DIRECTIONS, merged, CUBE_FACES)


def test_lunes_that_go_around_twice_have_no_certificate() -> None:
    # Every determinant is positive, and every arc shared: only the areas tell.
    longitude = np.arange(5) * (4 * np.pi / 5)
    star = np.stack([np.cos(longitude), np.sin(longitude), np.zeros(5)], axis=1)
    between = longitude + 2 * np.pi / 5
    equator = np.stack([np.cos(between), np.sin(between), np.zeros(5)], axis=1)
    vertices = np.vstack([equator, [[0, 0, 1], [0, 0, -1]]])
    place = np.arange(5)
    quads = np.stack([np.full(5, 5), (place - 1) % 5, np.full(5, 6), place], axis=1)
    found = certify(star[None], vertices[None], quads[None])
    assert (found.clearance > 0).all()
    assert is_closed(quads[None]).all()
    assert not found.valid[0]


def test_quads_that_do_not_close_have_no_certificate() -> None:
    open_ = CUBE_FACES.copy()
    open_[0] = [0, 1, 7, 2]
    assert not is_closed(open_[None])[0]
    assert not proved(CUBE_DIRECTIONS, CUBE, open_)


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("method", ["dual", "insertion", "lune"])
def test_certified_partitions_pass_an_independent_check(family: str, method: str) -> None:
    random = np.random.default_rng(0)
    for valency in (3, 4, 6, 10, 17):
        partitions = partition_spheres(drawn(family, random, 4, valency), method)
        assert not failures(partitions, random).any()


def test_the_independent_check_sees_faults() -> None:
    random = np.random.default_rng(0)
    good = partition_spheres(random_stars(6, 7))
    bent = good.vertices.copy()
    bent[:3, 0] = -bent[:3, 0]
    opened = good.quads.copy()
    opened[3, 0] = opened[3, 1]
    swapped = good.directions.copy()
    swapped[4, :2] = swapped[4, [1, 0]]
    broken = Partitions(swapped, bent, opened, good.clearance, good.methods)
    assert failures(broken, random).tolist() == [True] * 5 + [False]


# Arcs


def test_arcs_lie_between_the_quads_they_name() -> None:
    arcs = arcs_of(CUBE_FACES[None])
    assert arcs.starts.shape == (1, 12)
    for start, end, left, right in zip(
        arcs.starts[0], arcs.ends[0], arcs.left[0], arcs.right[0], strict=True
    ):
        spanned = np.cross(CUBE[start], CUBE[end])
        assert spanned @ CUBE_DIRECTIONS[left] > 0
        assert spanned @ CUBE_DIRECTIONS[right] < 0
    np.testing.assert_array_equal(arc_counts(CUBE_FACES[None]), np.full((1, 8), 3))


# Distinct stars


def test_stars_are_grouped_whatever_the_order_of_their_directions() -> None:
    stars = random_stars(3, 5)
    groups = distinct_stars(np.stack([stars[0], stars[1], stars[0][::-1], stars[2], stars[1]]))
    np.testing.assert_array_equal(groups.first, [0, 1, 3])
    np.testing.assert_array_equal(groups.group, [0, 1, 0, 2, 1])


def test_equal_rows_are_found_in_order_of_their_first() -> None:
    first, group = unique_rows(np.array([[5, 1], [2, 2], [5, 1], [1, 5], [2, 2]]))
    np.testing.assert_array_equal(first, [0, 1, 3])
    np.testing.assert_array_equal(group, [0, 1, 0, 2, 1])


# Triangulations


@pytest.mark.parametrize("family", ["uniform", "hemispherical", "paired", "narrow"])
@pytest.mark.parametrize("valency", [4, 6, 11, FEW + 3])
def test_triangulations_are_the_hulls_seen_from_outside(family: str, valency: int) -> None:
    stars = drawn(family, np.random.default_rng(0), 5, valency)
    meshes, found = triangulations(stars)
    np.testing.assert_array_equal(found, np.arange(5))
    for star, triangles, centers in zip(stars, meshes.triangles, meshes.centers, strict=True):
        hull = ConvexHull(star)
        assert {frozenset(t) for t in triangles.tolist()} == {
            frozenset(t) for t in hull.simplices.tolist()
        }
        # No direction lies in the cap that a triangle cuts off.
        heights = star @ centers.T
        edges = heights[triangles.T, np.arange(len(triangles))]
        assert (heights.max(axis=0) < edges.min(axis=0) + 1e-9).all()
    tails, heads, twins = meshes.tails, meshes.heads, meshes.twins
    np.testing.assert_array_equal(np.take_along_axis(tails, twins, axis=1), heads)


@pytest.mark.parametrize("family", ["coplanar", "flattened"])
def test_flat_stars_have_triangulations_too(family: str) -> None:
    _, found = triangulations(drawn(family, np.random.default_rng(0), 20, 9))
    assert len(found) == 20


def test_facets_with_four_corners_are_cut_in_two() -> None:
    meshes, _ = triangulations(CUBE[None])
    assert meshes.triangles.shape == (1, 12, 3)
    axes = np.sort(np.abs(meshes.centers[0]), axis=1)
    np.testing.assert_allclose(axes, np.tile([0, 0, 1], (12, 1)), atol=1e-9)


# Matchings


def edge_ends(meshes: Triangulations) -> Ints:
    half_edges = edges_of(meshes)
    return np.stack(
        [np.take_along_axis(each, half_edges, axis=1) for each in (meshes.tails, meshes.heads)],
        axis=2,
    )


def all_matchings(ends: Ints, valency: int) -> Ints:
    """Return every way of taking each edge 0, 1 or 2 times with four at each direction."""
    found: list[list[int]] = []

    def extend(taken: list[int], missing: list[int]) -> None:
        if len(taken) == len(ends):
            if not any(missing):
                found.append(taken)
            return
        i, j = ends[len(taken)]
        for times in range(min(2, missing[i], missing[j]) + 1):
            rest = missing.copy()
            rest[i] -= times
            rest[j] -= times
            extend([*taken, times], rest)

    extend([], [4] * valency)
    return np.array(found)


@pytest.mark.parametrize("valency", [4, 5, 6])
def test_the_search_finds_the_best_matching(valency: int) -> None:
    meshes, _ = triangulations(random_stars(6, valency))
    ends = edge_ends(meshes)
    random = np.random.default_rng(0)
    first = random.uniform(0, 2, ends.shape[:2])
    second = random.uniform(-1, 0, ends.shape[:2])
    _, gains = good_matchings(ends, first, second, valency, 6, 400)
    for star in range(6):
        every = all_matchings(ends[star], valency)
        values = (every > 0) @ first[star] + (every > 1) @ second[star]
        assert gains[star, 0] == pytest.approx(values.max())


@pytest.mark.parametrize("valency", [4, 8, 15])
def test_matchings_are_different_complete_and_in_order(valency: int) -> None:
    meshes, _ = triangulations(random_stars(5, valency))
    ends = edge_ends(meshes)
    gain = np.random.default_rng(0).uniform(0, 1, ends.shape[:2])
    choices, gains = good_matchings(ends, gain, gain - 1, valency, 6, 600)
    assert (np.diff(gains, axis=1) <= 0).all()
    for star in range(5):
        assert len(np.unique(choices[star], axis=0)) == 6
        for taken, value in zip(choices[star], gains[star], strict=True):
            degrees = np.zeros(valency)
            np.add.at(degrees, ends[star], taken[:, None])
            np.testing.assert_array_equal(degrees, 4)
            expected = ((taken > 0) * gain[star] + (taken > 1) * (gain[star] - 1)).sum()
            assert value == pytest.approx(expected)


# Quads from multigraphs


def test_the_octahedron_is_the_dual_of_the_cube() -> None:
    meshes, _ = triangulations(CUBE_DIRECTIONS[None])
    found, kept = quadrangulations(meshes, CUBE_DIRECTIONS[None], np.ones((1, 24), dtype=int))
    assert len(kept) == 1
    assert proved(CUBE_DIRECTIONS, found.vertices[0], found.quads[0])
    np.testing.assert_allclose(np.abs(found.vertices), 1 / np.sqrt(3))


def test_multigraphs_in_two_pieces_have_no_dual() -> None:
    meshes, _ = triangulations(CUBE_DIRECTIONS[None])
    # Twice around each of two opposite triangles.
    one = set(meshes.triangles[0, 0].tolist())
    pieces = [
        2 * ((tail in one) == (head in one))
        for tail, head in zip(meshes.tails[0], meshes.heads[0], strict=True)
    ]
    _, kept = quadrangulations(meshes, CUBE_DIRECTIONS[None], np.array([pieces]))
    assert len(kept) == 0


# Relaxation


@pytest.mark.parametrize(("flow", "newton"), [(30, 0), (0, 15), (30, 15)])
def test_relaxation_never_lowers_the_lowest_ratio(flow: int, newton: int) -> None:
    stars = random_stars(10, 7)
    reach = nearest_angles(stars) / 2
    vertices, quads = lune_partitions(stars)
    _, before = relaxed(stars, reach, quads, vertices)
    moved, after = relaxed(stars, reach, quads, vertices, flow=flow, newton=newton)
    assert (after >= before).all()
    assert np.median(after) > np.median(before) + 0.05
    assert certify(stars, moved, quads).valid.all()
    np.testing.assert_allclose(np.linalg.norm(moved, axis=2), 1)


def test_the_ratio_is_that_of_the_clearance() -> None:
    stars = random_stars(10, 5)
    reach = nearest_angles(stars) / 2
    vertices, quads = lune_partitions(stars)
    _, lowest = relaxed(stars, reach, quads, vertices)
    clearance = certify(stars, vertices, quads).clearance
    expected = (np.sin(clearance) / np.sin(reach)).min(axis=1)
    np.testing.assert_allclose(np.minimum(lowest, 0.8), np.minimum(expected, 0.8))


def test_a_displaced_cube_returns() -> None:
    random = np.random.default_rng(0)
    displaced = normalize(CUBE + 0.3 * random.normal(size=CUBE.shape))
    reach = np.full((1, 6), np.pi / 4)
    vertices, lowest = relaxed(
        CUBE_DIRECTIONS[None], reach, CUBE_FACES[None], displaced[None], flow=50, newton=20
    )
    assert lowest[0] == pytest.approx(1, abs=1e-4)
    np.testing.assert_allclose(vertices[0], CUBE, atol=1e-3)


@pytest.mark.parametrize(("step", "is_known"), [(1e-5, True), (1e-7, False), (0.0, False)])
def test_arcs_too_short_for_a_sure_normal_have_none(step: float, is_known: bool) -> None:
    near = [np.cos(step), np.sin(step), 0.0]
    corners = np.array([[[1.0, 0, 0], near, [0, 1, 0], [0, 0, 1]]])
    normals = arc_normals(corners)
    assert np.isfinite(normals[0, 0]).all() == is_known
    assert np.isfinite(normals[0, 1:]).all()


def test_partitions_with_vertices_nearly_at_one_place_are_not_certified() -> None:
    lune = partition_sphere(np.array([[1.0, 0, 0], [-0.5, 0.8, 0], [-0.5, -0.8, 0]]))
    assert certify(lune.directions[None], lune.vertices[None], lune.quads[None]).valid.all()
    vertices = lune.vertices.copy()
    a, b = lune.quads[0, :2]
    vertices[b] = vertices[a] + 1e-8 * (vertices[b] - vertices[a])
    vertices /= np.linalg.norm(vertices, axis=1)[:, None]
    assert not certify(lune.directions[None], vertices[None], lune.quads[None]).valid.any()
