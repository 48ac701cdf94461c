"""G1 patches: their joins, their shape, and the parts of a mesh that are solved together."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scaffold_cad.brep.bernstein import bernstein, elevation, gram, product, thin_plate
from scaffold_cad.brep.g1 import smooth_patches
from scaffold_cad.brep.g1.alike import alike_parts
from scaffold_cad.errors import MeshError, OptionError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.subdivision.connectivity import NO_CREASES, Connectivity
from scaffold_cad.products.breps import to_brep
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton
from tests.meshes import CUBE as CUBE_MESH
from tests.patches import limit_distances, normal_jumps
from tests.skeletons import BCC_STAR, JACK, RING, TRIPOD
from tests.strategies import skeletons

ROUNDING = 1e-9
"""Angle between normals that agree, rad."""


@settings(max_examples=10)
@given(skeletons(max_nodes=8), st.booleans())
def test_patches_of_any_skeleton_join_smoothly(skeleton: Skeleton, collars: bool) -> None:
    patches = smooth_patches(build_scaffold(skeleton, collars=collars).mesh)
    assert normal_jumps(patches).max() < 1e-7
    patches.bezier.mesh.check_closed()


@pytest.mark.parametrize("degree", [4, 5])
def test_split_patches_join_smoothly_and_lie_closer_to_the_limit(degree: int) -> None:
    scaffold = build_scaffold(JACK, collars=True).mesh
    whole, split = smooth_patches(scaffold), smooth_patches(scaffold, degree, split=1)
    assert split.bezier.degree == degree
    assert np.array_equal(split.quad_of_patch, np.repeat(whole.quad_of_patch, 4))
    assert normal_jumps(split).max() < ROUNDING
    assert len(split.turned) == 0
    if degree == 5:
        assert limit_distances(split).max() < 0.5 * limit_distances(whole).max()


def test_quads_are_cut_where_patches_would_fold() -> None:
    long = Skeleton(
        60 * np.vstack([[0, 0, 0], BCC_STAR.directions[::2]]), BCC_STAR.edges, BCC_STAR.radii
    )
    scaffold = build_scaffold(long).mesh
    plain = smooth_patches(scaffold, split=0)
    assert len(plain.turned) > 0
    patches = smooth_patches(scaffold)
    assert len(patches.turned) == 0
    assert len(patches.bezier.quads) == 4 * len(plain.bezier.quads)
    assert normal_jumps(patches).max() < ROUNDING


def test_a_mesh_without_a_skeleton_becomes_patches_too() -> None:
    patches = smooth_patches(CUBE_MESH)
    assert normal_jumps(patches).max() < ROUNDING
    points, _ = patches.sampled(5)
    radius = np.linalg.norm(points, axis=3)
    assert (radius.min(), radius.max()) == pytest.approx((0.84, 0.87), abs=0.03)
    assert np.array_equal(patches.quad_of_patch, np.arange(6))
    assert len(smooth_patches(CUBE_MESH, degree=4).bezier.quads) == 4 * 6


def test_patches_turn_and_grow_with_their_mesh() -> None:
    turn = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    mesh = build_scaffold(BCC_STAR, collars=True).mesh
    here = smooth_patches(mesh).bezier.control_points
    there = smooth_patches(mesh.moved(3 * mesh.vertices @ turn.T + [1, 2, 3])).bezier
    assert there.control_points == pytest.approx(3 * here @ turn.T + [1, 2, 3], abs=1e-9)


def test_parts_that_are_alike_are_found_whatever_their_numbers() -> None:
    tripod = build_scaffold(TRIPOD).mesh
    jack = build_scaffold(JACK).mesh
    generator = np.random.default_rng(3)
    vertices, quads, count = [], [], 0
    for mesh in (tripod, jack, tripod, tripod):
        names = generator.permutation(len(mesh.vertices))
        rows = generator.permutation(len(mesh.quads))
        turned = [np.roll(row, generator.integers(4)) for row in names[mesh.quads[rows]]]
        quads.append(np.stack(turned) + count)
        vertices.append(mesh.vertices[np.argsort(names)])
        count += len(names)
    both = QuadMesh(np.concatenate(vertices), np.concatenate(quads))
    connectivity = Connectivity.of(both, NO_CREASES)
    marks = connectivity.valence[both.quads].reshape(-1)
    parts = alike_parts(np.arange(len(both.quads)), connectivity.twin, marks)
    sizes = sorted(part.sides.shape for part in parts)
    assert sizes == sorted([(1, len(jack.quads)), (3, len(tripod.quads))])
    alike = max(parts, key=lambda part: len(part.sides))
    starts = connectivity.quads.reshape(-1)[alike.sides]
    assert np.array_equal(
        connectivity.valence[starts], np.broadcast_to(connectivity.valence[starts[0]], starts.shape)
    )

    # And they are solved as each would be on its own.
    whole = smooth_patches(both).bezier.control_points
    alone = smooth_patches(tripod).bezier.control_points
    assert np.sort(whole[alike.sides[0] >> 2].reshape(-1)) == pytest.approx(
        np.sort(alone.reshape(-1)), abs=1e-9
    )


def test_a_different_mark_makes_parts_unlike() -> None:
    ring = build_scaffold(RING).mesh
    twin = Connectivity.of(ring, NO_CREASES).twin
    both = np.concatenate([twin, twin + len(twin)])
    marks = np.zeros(len(both), dtype=np.intp)
    quads = np.arange(2 * len(ring.quads))
    assert len(alike_parts(quads, both, marks)) == 1
    marks[0] = 1
    assert len(alike_parts(quads, both, marks)) == 2


def test_bernstein_matrices_agree_with_the_polynomials() -> None:
    generator = np.random.default_rng(1)
    at = np.linspace(0, 1, 7)
    cubic = generator.random(4)
    values = bernstein(3, at) @ cubic
    assert bernstein(5, at) @ elevation(3, 5) @ cubic == pytest.approx(values)
    factor = generator.random((1, 3))
    assert bernstein(5, at) @ product(factor, 3)[0] @ cubic == pytest.approx(
        bernstein(2, at) @ factor[0] * values
    )
    step = 1e-5
    slopes = (bernstein(3, at + step) - bernstein(3, at - step)) / (2 * step)
    assert bernstein(3, at, 1) == pytest.approx(slopes, abs=1e-8)
    assert gram(3, 0).sum() == pytest.approx(1)  # they add up to 1
    linear = np.add.outer(np.arange(4), 2.0 * np.arange(4)).reshape(-1)
    assert thin_plate(3) @ linear == pytest.approx(np.zeros(16), abs=1e-9)
    # u² has the second derivative 2, u v the mixed one 1.
    square = np.outer([0, 0, 1], np.ones(3)).reshape(-1)
    assert square @ thin_plate(2) @ square == pytest.approx(4)
    saddle = np.outer([0, 0.5, 1], [0, 0.5, 1]).reshape(-1)
    assert saddle @ thin_plate(2) @ saddle == pytest.approx(2)


def test_bad_arguments_are_named() -> None:
    with pytest.raises(OptionError, match="degree is 3; need 4 or 5"):
        smooth_patches(CUBE_MESH, degree=3)
    with pytest.raises(OptionError, match=r"degree is 5\.0; need a whole number"):
        smooth_patches(CUBE_MESH, degree=5.0)  # type: ignore[arg-type]
    with pytest.raises(OptionError, match="degree is '5'; need a whole number"):
        smooth_patches(CUBE_MESH, degree="5")  # type: ignore[arg-type]
    with pytest.raises(OptionError, match="degree is 4 and split 0; need split 1 or more"):
        smooth_patches(CUBE_MESH, degree=4, split=0)
    with pytest.raises(OptionError, match="split is -1; need 0 or more"):
        smooth_patches(CUBE_MESH, split=-1)
    with pytest.raises(MeshError, match="belongs to one quad only"):
        smooth_patches(QuadMesh(CUBE_MESH.vertices, CUBE_MESH.quads[:5]))


def test_the_brep_of_patches_is_one_valid_solid() -> None:
    patches = smooth_patches(build_scaffold(TRIPOD, collars=True).mesh)
    solid = to_brep(patches)
    assert solid.is_valid
    assert solid.volume == pytest.approx(patches.bezier.signed_volume, rel=1e-6)


def test_patches_that_turn_over_all_the_same_are_logged(caplog: pytest.LogCaptureFixture) -> None:
    nodes = [[0, 0, 0], [10, 0, 0], [10, 1, 0.2], [0, 1.2, 0.4], [5, 5, 5]]
    overlapping = Skeleton(nodes, [[0, 1], [1, 2], [2, 3], [3, 0], [0, 4]], 1.0)
    patches = smooth_patches(build_scaffold(overlapping).mesh)
    quad = patches.quad_of_patch[patches.turned[0]]
    assert f" over, that on quad {quad} first; a finer mesh" in caplog.text
