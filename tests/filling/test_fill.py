"""Filled regions: clipped exactly, kept whole, inside of boxes, functions and meshes."""

from __future__ import annotations

from types import SimpleNamespace

import build123d as bd
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.base.regions import Keep
from scaffold_cad.base.vectors import rotate
from scaffold_cad.errors import MeshError, OptionError, SkeletonError
from scaffold_cad.filling import fill, lattice_part
from scaffold_cad.filling.innercell import solid_density
from scaffold_cad.lattice import CylinderMap, UnitCell, cells, tile, unit_cell
from scaffold_cad.lattice.meshregion import MeshRegion
from scaffold_cad.lattice.struts import Struts
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.skeleton import Skeleton, check_skeleton

BOX = np.array([[-5.0, 2.0, 1.0], [35.0, 32.0, 21.0]])
"""A box of 4 × 3 × 2 cells of 10 mm."""


def box_distance(points: Points) -> Floats:
    """Return the signed distance of `points` to the surface of `BOX`."""
    beyond = np.maximum(BOX[0] - points, points - BOX[1])
    outside = np.linalg.norm(np.maximum(beyond, 0), axis=1)
    return outside + np.minimum(beyond.max(axis=1), 0)


def box_mesh(box: Floats = BOX) -> TriangleMesh:
    mesh = trimesh.creation.box(bounds=box)
    return TriangleMesh(mesh.vertices, mesh.faces)


def sphere_mesh(radius: float, subdivisions: int = 2) -> TriangleMesh:
    mesh = trimesh.creation.icosphere(subdivisions, radius)
    return TriangleMesh(mesh.vertices, mesh.faces)


def joined(*meshes: TriangleMesh) -> TriangleMesh:
    counts = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    return TriangleMesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([m.triangles + k for m, k in zip(meshes, counts, strict=False)]),
    )


def turned_inside_out(mesh: TriangleMesh) -> TriangleMesh:
    return TriangleMesh(mesh.vertices, mesh.triangles[:, ::-1])


REGIONS = {
    "box": (BOX, None),
    "function": (box_distance, BOX),
    "mesh": (box_mesh(), None),
}
in_each_way = pytest.mark.parametrize("way", REGIONS)
places = st.tuples(*[st.integers(-999, 999).map(lambda k: k / 64)] * 3)


def fill_box(way: str, cell: str | UnitCell, size: ArrayLike, **options: object) -> Skeleton:
    region, bounds = REGIONS[way]
    return fill(region, cell, size, 0.4, bounds=bounds, **options)  # type: ignore[arg-type]


@in_each_way
@pytest.mark.parametrize("keep", ["clip", "whole"])
@pytest.mark.parametrize("name", [name for name, cell in cells().items() if not cell.is_net])
def test_a_region_of_whole_cells_is_filled_like_a_block(way: str, keep: str, name: str) -> None:
    # Struts on the surface included, none of them cut by the edges of the mesh.
    size = np.array([10.0, 10.0, 10.0])
    block = tile(name, size, (4, 3, 2), radius=0.4)
    filled = fill_box(way, name, size, keep=keep)
    assert len(filled.nodes) == len(block.nodes)
    assert len(filled.edges) == len(block.edges)
    np.testing.assert_allclose(filled.nodes, block.nodes + BOX[0])


@in_each_way
@pytest.mark.parametrize("name", cells())
@given(origin=places)
@settings(max_examples=4)
def test_a_box_of_whole_cells_holds_their_strut_length_wherever_they_begin(
    way: str, name: str, origin: tuple[float, float, float]
) -> None:
    struts = unit_cell(name).strut_lengths(np.full(3, 10.0))
    filled = fill_box(way, name, np.full(3, 10.0), origin=origin, shortest=0.0, crumbs=True)
    # Struts that lie in a face of the box count on both sides.
    low, high = BOX
    middles = filled.nodes[filled.edges].mean(axis=1)
    faces = (np.abs(middles - low) < 1e-4) | (np.abs(middles - high) < 1e-4)
    share = 0.5 ** faces.sum(axis=1)
    # A function tells nothing of what is shorter than 1/64 of a strut.
    accuracy = 2e-3 if way == "function" else 1e-5
    assert (share * filled.lengths).sum() == pytest.approx(24 * struts.sum(), rel=accuracy)


def test_cells_may_be_turned() -> None:
    turned = fill(BOX, "bcc", 5.0, 0.3, axes=[[1, 1, 0], [-1, 1, 0], [0, 0, 1]], origin=(0.1, 0, 3))
    check_skeleton(turned)
    assert box_distance(turned.nodes).max() < 1e-9
    density = unit_cell("bcc").strut_lengths(np.full(3, 5.0)).sum() / 125
    assert turned.lengths.sum() == pytest.approx(density * 24000, rel=0.02)
    along = np.abs(turned.directions[::2] @ np.array([[1, 1, 0], [-1, 1, 0], [0, 0, 1]]).T)
    np.testing.assert_allclose(
        along, [[np.sqrt(2 / 3), np.sqrt(2 / 3), np.sqrt(1 / 3)]] * len(along)
    )


def test_cells_may_stand_on_a_map() -> None:
    pipe = CylinderMap(20, 40, 6)
    half = fill([[-30, -30, 5], [30, 0, 30]], "bcc", 4.0, 0.3, on=pipe)
    check_skeleton(half)
    assert half.nodes[:, 1].max() <= 1e-9
    assert np.hypot(*half.nodes[:, :2].T).min() > 19
    whole = tile("bcc", 4.0, radius=0.3, on=pipe).lengths.sum()
    assert half.lengths.sum() == pytest.approx(whole * 25 / 80, rel=0.02)
    with pytest.raises(OptionError, match="origin or axes are given with a map"):
        fill(BOX, "bcc", 4.0, 0.3, on=pipe, origin=(0, 0, 0))
    with pytest.raises(OptionError, match="a function without a map"):
        fill(BOX, "bcc", lambda points: points[:, 0], 0.3)


@pytest.mark.parametrize("name", ["bcc", "sc", "octet"])
@pytest.mark.parametrize("keep", ["clip", "whole"])
def test_a_tube_is_filled_to_its_walls_by_cells_on_its_map(name: str, keep: Keep) -> None:
    wall = CylinderMap(10, 12, 4)
    tube = bd.Pos(0, 0, 6) * (bd.Cylinder(14, 12) - bd.Cylinder(10, 12))
    whole = tile(name, 4.0, radius=0.3, on=wall)
    filled = fill(tube, name, 4.0, 0.3, on=wall, keep=keep)
    assert len(filled.edges) == len(whole.edges)
    assert filled.lengths.sum() == pytest.approx(whole.lengths.sum())


def test_struts_on_a_map_are_cut_where_a_part_ends() -> None:
    wall = CylinderMap(10, 12, 4)
    ring = bd.Pos(0, 0, 3) * (bd.Cylinder(14, 6) - bd.Cylinder(10, 6))
    half = fill(ring, "sc", 4.0, 0.3, on=wall)
    rails = 2 * 19 * 6.0  # along the axis, at the inner and the outer wall
    spokes = 2 * 19 * 4.0  # at heights 0 and 4; the third row is cut off
    rings = 2 * 2 * 19 * (10 + 14) * np.sin(np.pi / 19)
    assert half.lengths.sum() == pytest.approx(rails + spokes + rings)
    assert half.nodes[half.extremities, 2] == pytest.approx(np.full(2 * 19, 6.0))


@in_each_way
def test_struts_are_cut_at_the_surface_exactly(way: str) -> None:
    filled = fill_box(way, "bcc", 8.0, origin=(0.3, 0.1, -0.2))
    check_skeleton(filled)
    new = filled.nodes[filled.extremities]
    assert len(new) > 100
    np.testing.assert_allclose(box_distance(new), 0.0, atol=1e-9)
    assert box_distance(filled.nodes).max() < 1e-9


@given(origin=places, size=st.floats(4, 15), name=st.sampled_from(["bcc", "octet", "kelvin"]))
@settings(max_examples=15)
def test_a_box_and_its_mesh_are_filled_alike(
    origin: tuple[float, float, float], size: float, name: str
) -> None:
    one, other = (fill_box(way, name, size, origin=origin) for way in ("box", "mesh"))
    assert len(other.edges) == len(one.edges)
    # Rounding decides whether a piece of about the least length is drawn to a point.
    assert other.lengths.sum() == pytest.approx(one.lengths.sum(), rel=1e-4)


@in_each_way
def test_whole_struts_have_their_middle_in_the_region(way: str) -> None:
    # Nodes of the lattice keep their places, and no strut gets shorter.
    filled = fill_box(way, "bcc", 8.0, origin=(0.3, 0.1, -0.2), keep="whole")
    np.testing.assert_allclose(filled.lengths, 4 * np.sqrt(3))
    middles = filled.nodes[filled.edges].mean(axis=1)
    assert box_distance(middles).max() <= 0 < box_distance(filled.nodes).max()
    # Middles lie 2 mm beyond a corner and every 4 mm from there.
    low, high = (BOX - (2.3, 2.1, 1.8)) / 4
    assert len(filled.edges) == (np.floor(high) - np.ceil(low) + 1).prod()


@in_each_way
def test_dangling_struts_go_if_asked(way: str) -> None:
    all_of_it = fill_box(way, "kelvin", 8.0, origin=(0.3, 0.1, -0.2))
    trimmed = fill_box(way, "kelvin", 8.0, origin=(0.3, 0.1, -0.2), dangling=False)
    assert len(all_of_it.extremities) > 0
    assert len(trimmed.extremities) == 0
    assert 0 < len(trimmed.edges) < len(all_of_it.edges)
    assert trimmed.loop_count == all_of_it.loop_count


@in_each_way
def test_short_pieces_of_cut_struts_become_nodes_on_the_surface(way: str) -> None:
    # Nodes at x = 34.9 are 0.1 mm inside a face that struts along x are cut at.
    origin = (BOX[1, 0] - 0.1, 0.37, 0.41)
    long = fill_box(way, "sc", 8.0, origin=origin, shortest=0.0)
    short = fill_box(way, "sc", 8.0, origin=origin, shortest=0.5)
    stubs = (long.lengths < 0.5).sum()
    assert stubs > 5
    assert len(short.edges) == len(long.edges) - stubs
    assert short.lengths.min() > 0.5
    assert (np.abs(short.nodes[:, 0] - BOX[1, 0]) < 1e-9).sum() == stubs
    check_skeleton(short)


def test_a_radius_may_depend_on_the_place() -> None:
    filled = fill(BOX, "bcc", 8.0, lambda points: 1 + points[:, 2] / 100)
    np.testing.assert_allclose(filled.radii, 1 + filled.nodes[:, 2] / 100)


# ---------------------------------------------------------------------------------------------
# Functions
# ---------------------------------------------------------------------------------------------


def test_a_ball_is_cut_at_its_radius() -> None:
    bounds = np.array([[-20.0] * 3, [20.0] * 3])
    ball = fill(lambda p: np.linalg.norm(p, axis=1) - 20, "octet", 7.0, 0.4, bounds=bounds)
    check_skeleton(ball)
    reach = np.linalg.norm(ball.nodes, axis=1)
    on_surface = np.abs(reach - 20) < 1e-9
    assert set(ball.extremities) <= set(np.flatnonzero(on_surface))
    assert reach.max() < 20 + 1e-9
    density = unit_cell("octet").motif.strut_lengths(np.full(3, 7.0)).sum() / 7.0**3
    assert ball.lengths.sum() == pytest.approx(density * 4 / 3 * np.pi * 20**3, rel=0.03)


def test_a_wall_thinner_than_a_strut_is_found() -> None:
    # A plate of 1 mm crossed by struts of 10 mm: both ends of each are outside.
    def plate(points: Points) -> Floats:
        return np.abs(points[:, 2] - 4.0) - 0.5

    bounds = np.array([[0.0, 0.0, 0.0], [30.0, 30.0, 10.0]])
    cut = fill(plate, "sc", 10.0, 0.2, bounds=bounds)
    assert len(cut.edges) == 16
    np.testing.assert_allclose(cut.lengths, 1.0)
    np.testing.assert_allclose(np.unique(cut.nodes[:, 2].round(9)), [3.5, 4.5])


def test_a_function_needs_bounds_and_numbers() -> None:
    with pytest.raises(OptionError, match="function without bounds; need a box around it"):
        fill(box_distance, "bcc", 5.0, 0.3)
    with pytest.raises(OptionError, match=r"function returned shape \(\) for points \(\d+, 3\)"):
        fill(lambda points: 1.0, "bcc", 5.0, 0.3, bounds=BOX)
    with pytest.raises(OptionError, match=r"function is nan at \[.*\] mm; need a number"):
        fill(lambda points: np.full(len(points), np.nan), "bcc", 5.0, 0.3, bounds=BOX)


# ---------------------------------------------------------------------------------------------
# Meshes
# ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("subdivisions", [0, 2, 4])
def test_points_in_a_convex_mesh_are_those_behind_all_its_faces(subdivisions: int) -> None:
    mesh = sphere_mesh(10.0, subdivisions)
    points = np.random.default_rng(1).uniform(-12, 12, (1000, 3))
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    heights = points @ normals.T - np.einsum("ti,ti->t", corners[:, 0], normals)
    assert np.array_equal(MeshRegion(mesh).contains(points), heights.max(axis=1) <= 0)


def test_points_on_the_surface_are_in_the_region() -> None:
    mesh = sphere_mesh(10.0)
    corners = mesh.vertices[mesh.triangles]
    for points in (corners.mean(axis=1), corners[:, :2].mean(axis=1), mesh.vertices):
        assert MeshRegion(mesh).contains(points).all()
        assert not MeshRegion(mesh).contains(points * 1.001).any()


def test_points_within_the_tolerance_of_the_surface_are_in_the_region() -> None:
    region = MeshRegion(box_mesh())
    middle = BOX.mean(axis=0)
    for axis in range(3):
        for side in range(2):
            points = np.tile(middle, (2, 1))
            out = 2 * side - 1
            points[:, axis] = BOX[side, axis] + out * region.tolerance * np.array([0.9, 1.1])
            assert region.contains(points).tolist() == [True, False]


def test_points_beyond_an_edge_are_as_far_off_as_they_are_from_it() -> None:
    region = MeshRegion(box_mesh(), 0.1)
    corner = BOX[1]
    off = np.array([[0.07, 0.07, 0.0], [0.05, 0.05, 0.05], [0.08, 0.08, 0.0], [0.06, 0.06, 0.06]])
    assert region.contains(corner + off).tolist() == [True, True, False, False]


def test_a_cavity_is_outside_and_overlapping_parts_are_inside() -> None:
    hollow = joined(sphere_mesh(10.0), turned_inside_out(sphere_mesh(5.0)))
    twofold = joined(sphere_mesh(10.0), sphere_mesh(5.0))
    points = np.array([[1.0, 1.5, 2.0], [4.0, 5.0, 3.0], [8.0, 8.0, 1.0]])
    assert MeshRegion(hollow).contains(points).tolist() == [False, True, False]
    assert MeshRegion(twofold).contains(points).tolist() == [True, True, False]


def test_struts_in_a_hollow_mesh_end_at_both_surfaces() -> None:
    hollow = joined(sphere_mesh(20.0, 3), turned_inside_out(sphere_mesh(10.0, 3)))
    shell = fill(hollow, "bcc", 6.0, 0.3, origin=(0.1, 0.2, 0.3))
    reach = np.linalg.norm(shell.nodes[shell.extremities], axis=1)
    inner = np.abs(reach - 10) < 0.2
    outer = np.abs(reach - 20) < 0.2
    assert inner.any()
    assert outer.any()
    assert (inner | outer).all()
    check_skeleton(shell)


@given(
    axis=st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda a: np.linalg.norm(a) > 0.1),
    angle=st.floats(0, np.pi),
)
@settings(max_examples=15)
def test_a_turned_box_holds_no_node_beyond_its_faces(
    axis: tuple[float, float, float], angle: float
) -> None:
    unit = np.array(axis) / np.linalg.norm(axis)
    mesh = box_mesh()
    turned = TriangleMesh(rotate(mesh.vertices, unit, np.asarray(angle)), mesh.triangles)
    filled = fill(turned, "bcc", 6.0, 0.3)
    back = rotate(filled.nodes, unit, np.asarray(-angle))
    # What lies within a millionth of the size of a face counts as in it, beside an edge of both.
    assert box_distance(back).max() < 3e-4
    assert np.abs(box_distance(back[filled.extremities])).max() < 3e-4
    density = unit_cell("bcc").motif.strut_lengths(np.full(3, 6.0)).sum() / 6.0**3
    assert filled.lengths.sum() == pytest.approx(density * 24000, rel=0.05)


def test_meshes_of_other_libraries_are_regions() -> None:
    from_faces = trimesh.creation.box(bounds=BOX)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    corners = [[x, y, z] for x in BOX[:, 0] for y in BOX[:, 1] for z in BOX[:, 2]]
    expected = fill(BOX, "bcc", 9.0, 0.3)
    for mesh in (from_faces, QuadMesh(np.array(corners), np.array(quads))):
        filled = fill(mesh, "bcc", 9.0, 0.3)
        assert len(filled.edges) == len(expected.edges)
        assert filled.lengths.sum() == pytest.approx(expected.lengths.sum())


def test_triangles_with_vertices_of_their_own_are_welded() -> None:
    mesh = box_mesh()
    soup = SimpleNamespace(
        vertices=mesh.vertices[mesh.triangles].reshape(-1, 3),
        triangles=np.arange(3 * len(mesh.triangles)).reshape(-1, 3),
    )
    assert len(fill(soup, "bcc", 10.0, 0.3).edges) == 8 * 24


def test_solids_and_builders_of_build123d_are_regions() -> None:
    build123d = pytest.importorskip("build123d")
    with build123d.BuildPart() as builder:
        build123d.Box(20, 20, 20, align=build123d.Align.MIN)
    in_box = fill([[0, 0, 0], [20, 20, 20]], "bcc", 8.0, 0.5)
    for region in (builder, builder.part):
        in_part = fill(region, "bcc", 8.0, 0.5)
        assert len(in_part.edges) == len(in_box.edges)
        assert in_part.lengths.sum() == pytest.approx(in_box.lengths.sum())
    with pytest.raises(OptionError, match="the BuildPart holds no shape yet; need one"):
        fill(build123d.BuildPart(), "bcc", 8.0, 0.5)


def test_an_inside_out_mesh_is_filled_inside_and_said(caplog: pytest.LogCaptureFixture) -> None:
    expected = fill(box_mesh(), "bcc", 8.0, 0.3)
    filled = fill(turned_inside_out(box_mesh()), "bcc", 8.0, 0.3)
    np.testing.assert_allclose(filled.lengths.sum(), expected.lengths.sum())
    assert "the body is inside out, as at" in caplog.text


def test_a_shell_that_crosses_itself_is_named_with_the_place(
    caplog: pytest.LogCaptureFixture,
) -> None:
    ball = trimesh.creation.icosphere(subdivisions=2, radius=15.0)
    pushed = ball.vertices.copy()
    pushed[0] *= -1.5  # through the other side
    fill(TriangleMesh(pushed, ball.faces), "bcc", 8.0, 0.3)
    assert "the body crosses itself near [" in caplog.text
    caplog.clear()
    overlapping = joined(box_mesh(), box_mesh(BOX + np.array([7.0, 5.0, 3.0])))
    fill(overlapping, "bcc", 8.0, 0.3)
    assert "crosses itself" not in caplog.text


def test_bodies_that_touch_along_an_edge_are_filled() -> None:
    one, other = (trimesh.creation.box(bounds=[[k, k, 0], [k + 20, k + 20, 20]]) for k in (0, 20))
    both = joined(*(TriangleMesh(mesh.vertices, mesh.faces) for mesh in (one, other)))
    soup = SimpleNamespace(
        vertices=both.vertices[both.triangles].reshape(-1, 3),
        triangles=np.arange(both.triangles.size).reshape(-1, 3),
    )
    filled = fill(soup, "sc", 10.0, 0.3)
    expected = 2 * (3 * 2 * 9) * 10 - 20  # the shared edge once
    assert filled.lengths.sum() == pytest.approx(expected)


def test_loose_crumbs_are_left_out_and_counted(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    bounds = [[-20, -20, -20], [20, 20, 20]]
    ball, origin = (lambda p: np.linalg.norm(p, axis=1) - 20), (0.2, 0.9, 0.5)
    kept = fill(ball, "bcc", 7.0, 0.4, bounds=bounds, origin=origin, crumbs=True)
    filled = fill(ball, "bcc", 7.0, 0.4, bounds=bounds, origin=origin)
    assert kept.component_count > filled.component_count == 1
    assert f"{kept.component_count - 1} loose crumbs of" in caplog.text
    assert filled.lengths.sum() > 0.98 * kept.lengths.sum()


def test_a_region_smaller_than_a_cell_is_said(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    fill([[0, 0, 0], [3, 20, 20]], "bcc", 8.0, 0.3)
    assert "the region, 3 x 20 x 20 mm, is smaller than a cell of 'bcc'" in caplog.text
    assert "along x" in caplog.text
    caplog.clear()
    fill([[0, 0, 0], [3, 3, 3]], "bcc", 8.0, 0.3)
    assert [record.levelname for record in caplog.records] == ["WARNING"]
    caplog.clear()
    lattice_part(trimesh.creation.box((3, 3, 3)), "bcc", 8.0, 0.6, skin=0.5)
    assert "the region, 3 x 3 x 3 mm, is smaller than a cell of 'bcc'" in caplog.text


def test_an_open_mesh_is_refused() -> None:
    mesh = box_mesh()
    with pytest.raises(MeshError, match=r"no triangle runs along the edge from \[.*\] mm"):
        fill(TriangleMesh(mesh.vertices, mesh.triangles[1:]), "bcc", 10.0, 0.3)


# ---------------------------------------------------------------------------------------------
# What is refused
# ---------------------------------------------------------------------------------------------


def test_a_region_without_struts_is_refused() -> None:
    with pytest.raises(SkeletonError, match=r"no strut of unit cell 'bcc' of size \[10.0, 10.0"):
        fill([[1, 2, 0.1], [1.5, 2.5, 0.2]], "bcc", 10.0, 0.3, origin=(0, 0, 0))
    with pytest.raises(SkeletonError, match="is left in the region from"):
        fill(BOX, "bcc", 40.0, 0.3, dangling=False)


@pytest.mark.parametrize(
    ("region", "options", "message"),
    [
        (BOX, {"keep": "half"}, "keep is 'half'; need one of clip, whole"),
        (BOX, {"shortest": -1.0}, "shortest length is -1 mm; need >= 0"),
        (BOX, {"origin": (0, 0)}, r"origin is \[0.0, 0.0\] mm; need three finite numbers"),
        (BOX, {"bounds": BOX}, "bounds are given for a region that has its own"),
        (BOX[::-1], {}, r"box is from \[35.0, .* need the first below the second"),
        (BOX[0], {}, r"box has shape \(3,\); need \(2, 3\)"),
        (SimpleNamespace(vertices=BOX), {}, "the region is a SimpleNamespace; need a box"),
        ("abc", {}, "the region is 'abc'; need a box, a function, a triangle mesh"),
        (None, {}, "the region is None; need a box"),
        ([["a"] * 3, ["b"] * 3], {}, "box is not an array of numbers: it holds text, a"),
        (
            SimpleNamespace(vertices=list, faces=list),
            {},
            "the region is a SimpleNamespace; need a box",
        ),
    ],
)
def test_arguments_out_of_range_are_refused(
    region: object, options: dict[str, object], message: str
) -> None:
    with pytest.raises(OptionError, match=message):
        fill(region, "bcc", 10.0, 0.3, **options)  # type: ignore[arg-type]


# ---------------------------------------------------------------------------------------------
# Struts
# ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [1e-6, 1e-30, 1e-320, (1.0, 1.0, 1e-9)])
def test_cells_too_small_for_the_region_are_refused_before_memory_is_taken(
    size: float | tuple[float, ...],
) -> None:
    for region in ([[0, 0, 0], [10, 10, 10]], trimesh.creation.icosphere(1, 10.0)):
        with pytest.raises(OptionError, match=r"x .* cells of 'bcc' have .*; need at most 1e\+08"):
            fill(region, "bcc", size, 0.1)


def test_collapsed_struts_end_where_a_fixed_node_is() -> None:
    nodes = np.array([[0.0, 0, 0], [1, 0, 0], [3, 0, 0], [9, 0, 0]])
    struts = Struts(nodes, np.array([[0, 1], [1, 2], [2, 3]]))
    short = np.array([True, True, False])
    fixed = np.array([False, False, True, False])
    assert struts.collapsed(short, fixed).nodes.tolist() == [[3, 0, 0], [9, 0, 0]]
    free = struts.collapsed(short, np.zeros(4, dtype=bool))
    np.testing.assert_allclose(free.nodes, [[4 / 3, 0, 0], [9, 0, 0]])
    assert free.edges.tolist() == [[0, 1]]


def test_dangling_chains_go_all_along() -> None:
    nodes = np.random.default_rng(0).uniform(size=(6, 3))
    edges = np.array([[0, 1], [1, 2], [2, 0], [2, 3], [3, 4], [4, 5]])
    assert Struts(nodes, edges).without_dangling().edges.tolist() == [[0, 1], [1, 2], [2, 0]]


def test_struts_that_fill_the_region_are_said(caplog: pytest.LogCaptureFixture) -> None:
    box = [[0, 0, 0], [10, 10, 10]]
    fill(box, "bcc", 5.0, 1.5)
    assert caplog.messages == []
    fill(box, "bcc", 5.0, 2.6)
    (message,) = caplog.messages
    assert message.endswith("fill the region: a radius of 2.6 mm is too large for its cells")
    assert solid_density(unit_cell("bcc"), np.full(3, 5.0), 2.6) > 0.99
