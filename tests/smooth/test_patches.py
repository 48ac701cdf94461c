"""G1 patches: their joins, their shape, and the parts of a mesh that are solved together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scaffold_cad.base.arrays import Floats
from scaffold_cad.brep.bernstein import bernstein, elevation, gram, product, thin_plate
from scaffold_cad.brep.beziermesh import BezierMesh
from scaffold_cad.errors import MeshError, OptionError
from scaffold_cad.lattice import tile
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.products.breps import to_brep
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.smooth import (
    Caps,
    Deviation,
    Patches,
    catmull_clark,
    deviation,
    limit,
    smooth_mesh,
    smooth_patches,
)
from scaffold_cad.smooth.accuracy import limit_distances, normal_jumps
from scaffold_cad.smooth.alike import alike_parts
from scaffold_cad.smooth.connectivity import NO_CREASES, Connectivity
from tests.meshes import CUBE as CUBE_MESH
from tests.skeletons import (
    BCC_STAR,
    JACK,
    NAMED,
    RING,
    STRUT,
    TAPER,
    TETRAPOD,
    TREFOIL,
    TRIPOD,
    ZIGZAG,
    star,
)
from tests.strategies import skeletons

ROUNDING = 1e-9
"""Angle between normals that agree, rad."""


@pytest.mark.parametrize("name", NAMED)
@pytest.mark.parametrize(("caps", "collars"), [("round", True), ("flat", True), ("round", False)])
def test_patches_join_smoothly_and_none_is_folded(name: str, caps: Caps, collars: bool) -> None:
    scaffold = build_scaffold(NAMED[name], collars=collars)
    patches = smooth_patches(scaffold, caps=caps)
    assert len(patches.bezier.quads) == len(patches.control.mesh.quads)
    found = deviation(patches, scaffold)
    assert found.normal_jump < ROUNDING
    assert len(found.turned) == 0
    fine = smooth_mesh(scaffold, 3, caps).mesh.signed_volume
    assert patches.bezier.signed_volume == pytest.approx(fine, rel=0.02 if collars else 0.05)


@settings(max_examples=10)
@given(skeletons(max_nodes=8), st.booleans())
def test_patches_of_any_skeleton_join_smoothly(skeleton: Skeleton, collars: bool) -> None:
    patches = smooth_patches(build_scaffold(skeleton, collars=collars))
    assert normal_jumps(patches).max() < 1e-7
    patches.bezier.mesh.check_closed()


@pytest.mark.parametrize("degree", [4, 5])
def test_split_patches_join_smoothly_and_lie_closer_to_the_limit(degree: int) -> None:
    scaffold = build_scaffold(JACK, collars=True)
    whole, split = smooth_patches(scaffold), smooth_patches(scaffold, degree, split=1)
    assert split.bezier.degree == degree
    assert np.array_equal(split.quad_of_patch, np.repeat(whole.quad_of_patch, 4))
    assert normal_jumps(split).max() < ROUNDING
    assert len(split.turned) == 0
    if degree == 5:
        assert limit_distances(split).max() < 0.5 * limit_distances(whole).max()


def test_rings_are_split_too() -> None:
    scaffold = build_scaffold(RING)
    patches = smooth_patches(scaffold, split=1)
    assert len(patches.bezier.quads) == 4 * len(scaffold.mesh.quads)
    found = deviation(patches, scaffold)
    assert found.normal_jump < ROUNDING
    assert found.radius_range == pytest.approx((1, 1), abs=0.025)


def test_regular_patches_are_the_limit_itself() -> None:
    patches = smooth_patches(build_scaffold(TREFOIL))
    points, normals = patches.sampled(9)
    fine = catmull_clark(patches.control.mesh, 3)
    surface = limit(fine.mesh)
    corners = fine.mesh.quads[0]  # at the first corner of the first quad
    assert points[0, [0, 1, 1, 0], [0, 0, 1, 1]] == pytest.approx(surface.points[corners])
    assert normals[0, [0, 1, 1, 0], [0, 0, 1, 1]] == pytest.approx(surface.normals[corners])
    assert limit_distances(patches).max() < 1e-3


def test_patches_keep_close_to_the_limit() -> None:
    for skeleton in (TRIPOD, JACK, BCC_STAR):
        patches = smooth_patches(build_scaffold(skeleton, collars=True))
        assert limit_distances(patches).max() < 0.1  # struts of radius 1


def test_collared_struts_of_patches_have_the_asked_radius() -> None:
    scaffold = build_scaffold(TETRAPOD.scaled(2.0).with_radii(1.0), collars=True)
    for caps in ("round", "flat"):
        radii = deviation(smooth_patches(scaffold, caps=caps), scaffold).strut_radii
        assert radii[:, 1] == pytest.approx(np.ones(4), rel=0.005)
        assert radii[:, [0, 2]] == pytest.approx(np.ones((4, 2)), rel=0.02)


@pytest.mark.parametrize(("cell", "around"), [("bcc", 0.02), ("octet", 0.025)])
@pytest.mark.parametrize("caps", ["round", "flat"])
def test_struts_of_lattices_have_the_asked_radius(cell: str, around: float, caps: Caps) -> None:
    scaffold = build_scaffold(tile(cell, 20.0, 1, radius=1.0), fit="enclose", collars=True)
    found = deviation(smooth_patches(scaffold, caps=caps), scaffold)
    assert found.strut_radii[:, 1] == pytest.approx(np.ones(len(found.strut_radii)), rel=0.005)
    assert found.radius_range == pytest.approx((1, 1), abs=around)


def test_quads_are_cut_where_patches_would_fold() -> None:
    long = Skeleton(
        30 * np.vstack([[0, 0, 0], BCC_STAR.directions[::2]]), BCC_STAR.edges, BCC_STAR.radii
    )
    scaffold = build_scaffold(long)
    plain = smooth_patches(scaffold, split=0)
    assert len(plain.turned) > 0
    patches = smooth_patches(scaffold)
    assert len(patches.turned) == 0
    assert len(patches.bezier.quads) == 4 * len(plain.bezier.quads)
    assert normal_jumps(patches).max() < ROUNDING


def test_patches_that_turn_over_all_the_same_are_logged(caplog: pytest.LogCaptureFixture) -> None:
    nodes = [[0, 0, 0], [10, 0, 0], [10, 1, 0.2], [0, 1.2, 0.4], [5, 5, 5]]
    overlapping = Skeleton(nodes, [[0, 1], [1, 2], [2, 3], [3, 0], [0, 4]], 1.0)
    patches = smooth_patches(build_scaffold(overlapping))
    quad = patches.quad_of_patch[patches.turned[0]]
    assert f"patches turn over, that on quad {quad} first; collars or" in caplog.text
    assert len(patches.bezier.quads) == len(patches.control.mesh.quads)


def test_the_deviation_tells_what_is_wrong() -> None:
    scaffold = build_scaffold(TRIPOD, collars=True)
    patches = smooth_patches(scaffold)

    def found_with(points: Floats) -> Deviation:
        bezier = BezierMesh(patches.bezier.quads, points)
        return deviation(replace(patches, bezier=bezier), scaffold)

    right = patches.bezier.control_points
    dented, folded = right.copy(), right.copy()
    dented[0, 1:-1, 1:-1] += 0.5
    found = found_with(dented)
    assert found.normal_jump > 0.1
    assert found.limit_distance > found_with(right).limit_distance + 0.1
    assert len(found.turned) == 0
    # Its inner points turned by half a turn.
    folded[5, 1:-1, 1:-1] = folded[5, -2:0:-1, -2:0:-1]
    assert found_with(folded).turned.tolist() == [5]
    thick = found_with(1.5 * right - 0.5 * right.mean(axis=(0, 1, 2)))
    assert thick.radius_range[1] > 1.4
    assert f"radii in mid-strut: {thick.radius_range[0]:.3f} to" in str(thick)


def radii_about_axes(patches: Patches, scaffold: Scaffold) -> Floats:
    """Return least, mean and greatest distance of mid-strut sections from the axes, (m, 3), mm."""
    points, _ = patches.sampled(17)
    strut = scaffold.edge_of_quad[patches.quad_of_patch]
    found = []
    for edge, (start, end) in enumerate(scaffold.skeleton.nodes[scaffold.skeleton.edges]):
        axis = (end - start) / np.linalg.norm(end - start)
        grids = points[strut == edge] - (start + end) / 2
        lines = np.concatenate([grids.reshape(-1, 17, 3), grids.swapaxes(1, 2).reshape(-1, 17, 3)])
        pieces = np.stack([lines[:, :-1], lines[:, 1:]], axis=2).reshape(-1, 2, 3)
        rise = (pieces[:, 1] - pieces[:, 0]) @ axis
        along = np.abs(rise) > 0.5 * np.linalg.norm(pieces[:, 1] - pieces[:, 0], axis=1)
        pieces, rise = pieces[along], rise[along]
        share = -(pieces[:, 0] @ axis) / rise
        met = (share >= 0) & (share <= 1)
        places = pieces[met, 0] + share[met, None] * (pieces[met, 1] - pieces[met, 0])
        distance = np.linalg.norm(places - np.outer(places @ axis, axis), axis=1)
        found.append((distance.min(), distance.mean(), distance.max()))
    return np.array(found)


@pytest.mark.parametrize("seed", [0, 3, 4, 5])
def test_radii_of_struts_are_those_about_their_axes(seed: int) -> None:
    ways = np.random.default_rng(seed).standard_normal((4, 3))
    tips = 20 * ways / np.linalg.norm(ways, axis=1, keepdims=True)
    scaffold = build_scaffold(star(tips.tolist()), collars=True)
    patches = smooth_patches(scaffold)
    found = deviation(patches, scaffold).strut_radii
    wanted = radii_about_axes(patches, scaffold)
    assert found[:, 1] == pytest.approx(wanted[:, 1], rel=0.002)
    assert found == pytest.approx(wanted, rel=0.006)


def test_no_radius_is_found_where_no_surface_reaches() -> None:
    scaffold = build_scaffold(STRUT)
    found = deviation(smooth_patches(scaffold), scaffold)
    nowhere = replace(found, strut_radii=np.full((1, 3), np.nan), strut_offsets=np.full(1, np.nan))
    assert np.isnan(nowhere.radius_range).all()
    assert np.isnan(nowhere.greatest_offset)


def test_the_deviation_tells_how_far_axes_are_off_centre() -> None:
    scaffold = build_scaffold(TAPER)
    patches = smooth_patches(scaffold)
    found = deviation(patches, scaffold)
    assert found.greatest_offset < 1e-6
    assert "axes in mid-strut: 0.000 radii off centre at most" in str(found)
    aside = np.array([0.3, 0.4, 0.0])
    bezier = BezierMesh(patches.bezier.quads, patches.bezier.control_points + aside)
    moved = deviation(replace(patches, bezier=bezier), scaffold)
    assert moved.strut_offsets == pytest.approx([0.5], abs=1e-6)
    assert moved.greatest_offset == pytest.approx(0.5 / 1.5, abs=1e-6)
    assert moved.strut_radii == pytest.approx(found.strut_radii, abs=1e-6)


def test_the_deviation_tells_how_far_a_ring_is_from_its_polygon() -> None:
    scaffold = build_scaffold(RING)
    # A cubic spline passes the middle of a side at 1/24 of its turn at a corner.
    turn = 2 * RING.lengths[0] * np.sin(np.pi / 12)
    offsets = deviation(smooth_patches(scaffold), scaffold).strut_offsets
    assert offsets == pytest.approx(np.full(12, turn / 24), rel=0.1)


@pytest.mark.parametrize("collars", [True, False])
def test_axes_are_central_in_the_struts_between_bends(collars: bool) -> None:
    scaffold = build_scaffold(ZIGZAG, collars=collars)
    assert deviation(smooth_patches(scaffold), scaffold).greatest_offset < 0.05


@pytest.mark.parametrize("split", [0, 1, None])
def test_patches_that_turn_over_are_logged_however_they_are_cut(
    split: int | None, caplog: pytest.LogCaptureFixture
) -> None:
    nodes = [[0, 0, 0], [10, 0, 0], [10, 1, 0.2], [0, 1.2, 0.4], [5, 5, 5]]
    overlapping = Skeleton(nodes, [[0, 1], [1, 2], [2, 3], [3, 0], [0, 4]], 1.0)
    patches = smooth_patches(build_scaffold(overlapping), split=split)
    assert caplog.text.count(f"{len(patches.turned)} patches turn over") == 1


@pytest.mark.parametrize("split", [0, 1])
def test_flat_caps_lie_in_a_plane_within_their_creases(split: int) -> None:
    patches = smooth_patches(build_scaffold(STRUT), split=split, caps="flat")
    caps = patches.bezier.control_points[patches.is_flat]
    assert len(caps) == 2 * 4**split
    assert caps[..., 0] == pytest.approx(np.round(caps[..., 0] / 10) * 10, abs=1e-12)
    assert np.hypot(caps[..., 1], caps[..., 2]).max() < 1.1
    assert (np.abs(patches.bezier.plane_normals).sum(axis=1) > 0.5).tolist() == (
        patches.is_flat.tolist()
    )
    solid = patches.bezier.signed_volume
    assert solid == pytest.approx(10 * np.pi, rel=0.01)


def test_the_brep_of_patches_is_one_valid_solid() -> None:
    for caps in ("round", "flat"):
        patches = smooth_patches(build_scaffold(TRIPOD, collars=True), caps=caps)
        solid = to_brep(patches.bezier)
        assert solid.is_valid
        assert solid.volume == pytest.approx(patches.bezier.signed_volume, rel=1e-6)


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
