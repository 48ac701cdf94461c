"""Star-shaped bodies save time and change nothing: the exact test is the oracle."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scaffold_cad.smooth import smooth_mesh

from scaffold_cad.base.arrays import Points, Quads
from scaffold_cad.lattice import tile
from scaffold_cad.mesh.intersections import bodies, intersections_of_bodies, self_intersections
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import roundstruts
from tests.meshes import CUBE
from tests.skeletons import CUBE as CUBE_SKELETON
from tests.skeletons import STICK_FIGURE
from tests.strategies import skeletons

Cut = tuple[QuadMesh, NDArray[np.intp], NDArray[np.float64]]


def cut(skeleton: Skeleton, *, levels: int = 1, collars: bool = True) -> Cut:
    """Return a smooth surface, the body of each of its quads, and the centers of the bodies."""
    scaffold = build_scaffold(skeleton, collars=collars)
    surface = smooth_mesh(scaffold, levels)
    return surface.mesh, *roundstruts._bodies(scaffold, surface)


def left_to_the_exact_test(monkeypatch: pytest.MonkeyPatch, case: Cut) -> tuple[int, int]:
    """Return how many triangles are left to the exact test, and how many pairs are found."""
    count = 0

    def counted(mesh: bodies.QuadMesh) -> NDArray[np.intp]:
        nonlocal count
        count += len(mesh.triangles)
        return self_intersections(mesh)

    with monkeypatch.context() as patch:
        patch.setattr(bodies, "self_intersections", counted)
        found = intersections_of_bodies(*case)
    return count, len(found)


@pytest.mark.parametrize("levels", [1, 2])
@pytest.mark.parametrize("cell", ["bcc_sc", "octet", "kelvin", "cuboctahedron"])
def test_lattice_of_collared_struts_needs_no_exact_test(
    monkeypatch: pytest.MonkeyPatch, cell: str, levels: int
) -> None:
    case = cut(tile(cell, 10.0, 2, radius=0.4), levels=levels)
    assert len(self_intersections(case[0])) == 0
    assert left_to_the_exact_test(monkeypatch, case) == (0, 0)


def test_only_what_is_in_doubt_is_tested(monkeypatch: pytest.MonkeyPatch) -> None:
    # Two struts cross, and a lattice far away does not.
    far = tile("octet", 10.0, 1, radius=0.4)
    struts = np.array([[-9, 0, 40], [9, 0, 40], [0, -9, 40.5], [0, 9, 40.5]], dtype=np.float64)
    count = len(far.nodes)
    skeleton = Skeleton(
        np.concatenate([far.nodes, struts]),
        np.concatenate([far.edges, [[count, count + 1], [count + 2, count + 3]]]),
        0.4,
    )
    case = cut(skeleton)
    expected = self_intersections(case[0])
    assert len(expected) > 0
    np.testing.assert_array_equal(intersections_of_bodies(*case), expected)
    tested, _ = left_to_the_exact_test(monkeypatch, case)
    assert 0 < tested < 0.1 * len(case[0].triangles)


@given(skeletons(), st.booleans(), st.floats(0.1, 3.0))
def test_pairs_are_those_of_the_exact_test(
    skeleton: Skeleton, collars: bool, thickness: float
) -> None:
    case = cut(skeleton.with_radii(thickness * skeleton.radii), collars=collars)
    np.testing.assert_array_equal(intersections_of_bodies(*case), self_intersections(case[0]))


@given(st.data(), st.floats(0.0, 2.0), st.integers(0, 2**32 - 1))
def test_no_crossing_is_missed_in_a_surface_that_was_shaken(
    data: st.DataObject, amount: float, seed: int
) -> None:
    mesh, body, centers = cut(data.draw(st.sampled_from([CUBE_SKELETON, STICK_FIGURE])))
    random = np.random.default_rng(seed)
    moved = random.random(len(mesh.vertices)) < data.draw(st.sampled_from([0.02, 0.2, 1.0]))
    offsets = amount * random.standard_normal(mesh.vertices.shape)
    shaken = mesh.moved(mesh.vertices + moved[:, None] * offsets)
    np.testing.assert_array_equal(
        intersections_of_bodies(shaken, body, centers), self_intersections(shaken)
    )


@given(st.data(), st.floats(0.3, 12.0))
def test_no_crossing_of_swollen_bodies_is_missed(data: st.DataObject, factor: float) -> None:
    mesh, body, centers = cut(data.draw(st.sampled_from([CUBE_SKELETON, STICK_FIGURE])))
    one = data.draw(st.sampled_from(np.unique(body).tolist()))
    own = np.setdiff1d(mesh.quads[body == one], mesh.quads[body != one])
    along = np.array(data.draw(st.tuples(*[st.sampled_from([0.0, 1.0])] * 3)))
    vertices = mesh.vertices.copy()
    vertices[own] += (factor - 1) * along * (vertices[own] - centers[one])
    swollen = mesh.moved(vertices)
    np.testing.assert_array_equal(
        intersections_of_bodies(swollen, body, centers), self_intersections(swollen)
    )


def turned(profile: list[tuple[float, float]]) -> tuple[Points, Quads]:
    """Return the vertices and quads of a square profile of (radius, height), open at its ends."""
    square = np.array([[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]], dtype=np.float64)
    rows = np.array([radius * square + [0, 0, height] for radius, height in profile])
    number = np.arange(4 * len(profile)).reshape(-1, 4)
    below, above = number[:-1], number[1:]
    after = np.roll(number, -1, axis=1)
    quads = np.stack([below, after[:-1], after[1:], above], axis=2)
    return rows.reshape(-1, 3), quads.reshape(-1, 4)


def test_bodies_that_both_bulge_over_their_ring() -> None:
    # Each is star-shaped. The skirt of the upper one dips into the lid of the lower one.
    vertices, sides = turned([(3, -3), (3, 0.8), (1, 1), (3, 0.5), (3, 3)])
    mesh = QuadMesh(vertices, np.concatenate([sides, [[3, 2, 1, 0], [16, 17, 18, 19]]]))
    body = np.array([0] * 8 + [1] * 8 + [0, 1])
    expected = self_intersections(mesh)
    assert len(expected) > 0
    found = intersections_of_bodies(mesh, body, np.array([[0, 0, -1], [0, 0, 1.6]]))
    np.testing.assert_array_equal(found, expected)


def test_surface_that_goes_twice_around_its_center() -> None:
    turns = 4 * np.pi / 5 * np.arange(5)
    ring = np.stack([np.cos(turns), np.sin(turns), np.zeros(5)], axis=1)
    mesh = QuadMesh(
        np.concatenate([ring, [[0, 0, 3], [0, 0, -3]]]),
        [[5, k, 6, (k + 1) % 5] for k in range(5)],
    )
    expected = self_intersections(mesh)
    assert len(expected) > 0
    found = intersections_of_bodies(mesh, np.zeros(5, dtype=np.intp), np.zeros((1, 3)))
    np.testing.assert_array_equal(found, expected)


@given(st.integers(0, 2**32 - 1), st.integers(1, 60), st.floats(0.0, 3.0))
def test_any_cut_and_any_centres_will_do(seed: int, count: int, amount: float) -> None:
    mesh, body, centers = cut(CUBE_SKELETON)
    random = np.random.default_rng(seed)
    other = random.integers(0, count, len(centers))[body]
    shaken = mesh.moved(mesh.vertices + amount * random.standard_normal(mesh.vertices.shape))
    where = random.choice(shaken.vertices, count)
    np.testing.assert_array_equal(
        intersections_of_bodies(shaken, other, where), self_intersections(shaken)
    )


def test_one_body_is_enough() -> None:
    whole = np.zeros(len(CUBE.quads), dtype=np.intp)
    assert len(intersections_of_bodies(CUBE, whole, CUBE.vertices[:1])) == 0
    center = CUBE.vertices.mean(axis=0, keepdims=True)
    assert len(intersections_of_bodies(CUBE, whole, center)) == 0


@given(st.integers(-6, 6), st.integers(-6, 6))
def test_scale_and_place_do_not_matter(scale: int, offset: int) -> None:
    mesh, body, centers = cut(STICK_FIGURE)
    shift = 10.0**offset
    moved = mesh.moved(10.0**scale * mesh.vertices + shift)
    assume(len(np.unique(moved.vertices, axis=0)) == len(moved.vertices))
    np.testing.assert_array_equal(
        intersections_of_bodies(moved, body, 10.0**scale * centers + shift),
        self_intersections(moved),
    )
