"""Parts with a lattice inside: within the body, with a wall as thick as asked, and whole."""

from __future__ import annotations

import build123d as bd
import numpy as np
import pytest
import trimesh

from scaffold_cad.errors import MeshError, OptionError, SkeletonError
from scaffold_cad.filling.flush import flush_box
from scaffold_cad.lattice.meshregion import MeshRegion
from scaffold_cad.mesh.insets import inset
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.parts import lattice_part
from scaffold_cad.printability.triangletopology import TriangleTopology
from scaffold_cad.solid.manifolds import manifold_triangles, to_manifold
from tests.meshes import CUBE

BOX = trimesh.creation.box((30.0, 20.0, 10.0))
BALL = trimesh.creation.icosphere(3, 15.0)


def as_mesh(mesh: trimesh.Trimesh) -> TriangleMesh:
    return TriangleMesh(mesh.vertices, mesh.faces)


@pytest.mark.parametrize("body", [BOX, BALL, bd.Solid.make_cylinder(10.0, 16.0)])
def test_part_with_a_skin_is_the_body_with_voids(body: object) -> None:
    part = lattice_part(body, "bcc", 6.0, 0.5, skin=1.0)
    solid = body.volume  # type: ignore[attr-defined]
    assert 0.2 * solid < part.volume() < 0.9 * solid
    assert len(self_intersections(manifold_triangles(part))) == 0
    shells = sorted(shell.volume() for shell in part.decompose())
    assert shells[-1] == pytest.approx(solid, rel=0.01)  # nothing pierces the skin
    assert all(volume < 0 for volume in shells[:-1])


def test_wall_is_as_thick_as_asked() -> None:
    part = lattice_part(BOX, "bcc", 6.0, 0.5, skin=1.5)
    vertices = manifold_triangles(part).vertices
    depth = (BOX.extents / 2 - np.abs(vertices)).min(axis=1)
    on_surface = depth < 1e-6
    assert on_surface.sum() == 8
    assert depth[~on_surface].min() == pytest.approx(1.5, abs=1e-6)


def test_part_without_a_skin_is_the_lattice_cut_at_the_surface() -> None:
    part = lattice_part(BALL, "octet", 8.0, 0.6)
    vertices = manifold_triangles(part).vertices
    assert np.linalg.norm(vertices, axis=1).max() <= 15.0 + 1e-6
    assert part.volume() < 0.5 * BALL.volume
    assert len(part.decompose()) == 1


def test_struts_may_be_round() -> None:
    part = lattice_part(BOX, "bcc", 9.0, 0.8, skin=1.0, sides=8)
    assert len(self_intersections(manifold_triangles(part))) == 0


def test_bodies_that_turn_too_sharply_get_a_skin_too() -> None:
    needle = trimesh.creation.cone(radius=8.0, height=24.0, sections=24)
    part = lattice_part(needle, "bcc", 5.0, 0.4, skin=1.0)
    assert part.volume() < needle.volume
    assert len(self_intersections(manifold_triangles(part))) == 0


def test_inset_of_a_box_is_a_smaller_box() -> None:
    inner = inset(as_mesh(BOX), 2.0)
    assert inner is not None
    assert inner.signed_volume == pytest.approx(26 * 16 * 6)


def test_inset_keeps_the_wall_beside_edges_that_point_inwards() -> None:
    arm = bd.Box(30, 10, 10, align=bd.Align.MIN)
    corner = arm + bd.Box(10, 10, 30, align=bd.Align.MIN)
    part = lattice_part(corner, "sc", 7.0, 0.5, skin=1.0)
    points = np.random.default_rng(3).random((4000, 3)) * [30.0, 10.0, 30.0]
    void = MeshRegion(manifold_triangles(part))
    body_depth = np.maximum(
        np.minimum.reduce([points[:, 0], 30 - points[:, 0], points[:, 2], 10 - points[:, 2]]),
        np.minimum.reduce([points[:, 0], 10 - points[:, 0], points[:, 2], 30 - points[:, 2]]),
    )
    sides = np.minimum(points[:, 1], 10 - points[:, 1])
    wall = (np.minimum(body_depth, sides) > 0) & (np.minimum(body_depth, sides) < 0.99)
    wall &= ~((points[:, 0] < 11) & (points[:, 2] < 11))  # within, both arms are the body
    assert wall.sum() > 100
    assert void.contains(points[wall]).all()


def test_no_inset_is_found_where_the_body_is_too_thin() -> None:
    assert inset(as_mesh(BOX), 6.0) is None


def test_a_skin_that_fills_the_body_is_refused() -> None:
    with pytest.raises(OptionError, match=r"skin is 6 mm, which fills the body; need less"):
        lattice_part(BOX, "bcc", 6.0, 0.5, skin=6.0)


@pytest.mark.parametrize("skin", [0.0, -1.0, np.nan])
def test_a_skin_without_thickness_is_refused(skin: float) -> None:
    with pytest.raises(OptionError, match=r"skin is .* mm; need > 0, or None"):
        lattice_part(BOX, "bcc", 6.0, 0.5, skin=skin)


def test_what_is_no_body_is_refused() -> None:
    with pytest.raises(OptionError, match=r"the body is 'bracket'; need a build123d solid"):
        lattice_part("bracket", "bcc", 6.0, 0.5)


def test_an_open_mesh_is_refused() -> None:
    mesh = as_mesh(BOX)
    with pytest.raises(MeshError, match=r"no triangle runs along the edge"):
        lattice_part(TriangleMesh(mesh.vertices, mesh.triangles[1:]), "bcc", 6.0, 0.5)


def test_a_body_that_crosses_itself_is_named_at_once_with_the_place() -> None:
    strip = trimesh.creation.extrude_triangulation(
        [[0, 0], [20, 0], [20, 10], [0, 10]], [[0, 1, 2], [0, 2, 3]], 10.0
    )
    bent = strip.vertices.copy()
    bent[(bent[:, 0] > 19) & (bent[:, 2] > 9), 2] = -5.0  # the top dives through the floor
    with pytest.raises(MeshError, match=r"the body crosses itself near \[.*\] mm; need a surface"):
        lattice_part(TriangleMesh(bent, strip.faces), "bcc", 5.0, 0.4)


def test_parts_of_a_body_that_overlap_are_united(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    other = BOX.copy().apply_translation([10.0, 5.0, 0.0])
    both = trimesh.util.concatenate([BOX, other])
    part = lattice_part(both, "sc", 6.0, 0.5, skin=1.0)
    shells = sorted(shell.volume() for shell in part.decompose())
    assert shells[-1] == pytest.approx(2 * 6000 - 20 * 15 * 10, rel=1e-6)
    assert "2 parts of the body overlap or touch; they are united" in caplog.text


def test_bodies_that_touch_along_an_edge_are_taken() -> None:
    one, other = (trimesh.creation.box(bounds=[[k, k, 0], [k + 20, k + 20, 20]]) for k in (0, 20))
    both = trimesh.util.concatenate([one, other])
    both.merge_vertices()
    part = lattice_part(both, "bcc", 8.0, 0.6)
    assert part.volume() < 2 * 8000
    assert part.bounding_box() == pytest.approx((0, 0, 0, 40, 40, 20), abs=1e-6)


def test_an_inside_out_body_is_turned(caplog: pytest.LogCaptureFixture) -> None:
    mesh = as_mesh(BOX)
    part = lattice_part(TriangleMesh(mesh.vertices, mesh.triangles[:, ::-1]), "bcc", 6.0, 0.5)
    assert 0 < part.volume() < 6000
    assert "inside out" in caplog.text


def test_struts_that_fill_the_body_are_said(caplog: pytest.LogCaptureFixture) -> None:
    part = lattice_part(BOX, "octet", 5.0, 1.9)
    assert part.volume() > 0.97 * BOX.volume
    assert "the struts fill the body" in caplog.text
    assert "they are too thick for their cells" in caplog.text


def test_a_body_between_the_nodes_has_no_struts_in_it() -> None:
    with pytest.raises(SkeletonError, match=r"no strut has a node in the body from"):
        lattice_part(BALL, "bcc", [400.0, 400.0, 400.0], 0.5)


def test_quad_meshes_are_bodies() -> None:
    assert to_manifold(CUBE).volume() > lattice_part(CUBE, "bcc", 0.5, 0.03, skin=0.1).volume()


def test_walls_have_no_sliver_that_files_lose() -> None:
    part = lattice_part(bd.Sphere(15.0), "octet", 8.0, 0.6, skin=1.0)
    mesh = manifold_triangles(part)
    rounded = TriangleMesh(mesh.vertices.astype(np.float32), mesh.triangles)
    assert len(TriangleTopology(rounded).flat) == 0
    assert len(self_intersections(rounded)) == 0


def test_parts_of_a_body_that_overlap_between_flush_faces_are_united(
    caplog: pytest.LogCaptureFixture,
) -> None:
    caplog.set_level("INFO")
    boxes = bd.Compound([bd.Box(10, 10, 10), bd.Pos(5, 0, 0) * bd.Box(10, 10, 10)])
    one = bd.Pos(2.5, 0, 0) * bd.Box(15, 10, 10)
    found, wanted = (lattice_part(body, "bcc", 5.0, 0.4, skin=1.0) for body in (boxes, one))
    assert "2 parts of the body overlap or touch; they are united" in caplog.text
    assert found.volume() == pytest.approx(wanted.volume(), rel=1e-6)
    touching = bd.Compound([bd.Box(10, 10, 10), bd.Pos(10, 2, 3) * bd.Box(10, 10, 10)])
    shells = lattice_part(touching, "bcc", 5.0, 0.4, skin=1.0).decompose()
    assert sum(shell.volume() > 0 for shell in shells) == 1
    caplog.clear()
    apart = bd.Compound([bd.Box(10, 10, 10), bd.Pos(11, 0, 0) * bd.Box(10, 10, 10)])
    shells = lattice_part(apart, "bcc", 5.0, 0.4, skin=1.0).decompose()
    assert sum(shell.volume() > 0 for shell in shells) == 2
    assert "united" not in caplog.text


def test_parts_of_a_body_that_share_a_face_are_united() -> None:
    shared = bd.Compound([bd.Box(10, 10, 10), bd.Pos(10, 0, 0) * bd.Box(10, 10, 10)])
    one = bd.Pos(5, 0, 0) * bd.Box(20, 10, 10)
    found, wanted = (lattice_part(body, "bcc", 5.0, 0.4, skin=1.0) for body in (shared, one))
    assert found.volume() == pytest.approx(wanted.volume(), rel=1e-6)


def test_boxes_of_flush_struts_have_the_section_that_is_asked_for() -> None:
    box = [[0, 0, 0], [20, 20, 10]]
    square, rounded = (flush_box(box, "bcc", 10, 1, section=one) for one in ("square", "round"))
    assert square.volume() == pytest.approx(flush_box(box, "bcc", 10, 1).volume())
    assert rounded.volume() == pytest.approx(flush_box(box, "bcc", 10, 1, sides=16).volume())
    assert 0.7 < rounded.volume() / square.volume() < 0.85  # π/4, and the nodes
    with pytest.raises(OptionError, match="sides is 8 for section='square'"):
        flush_box(box, "bcc", 10, 1, section="square", sides=8)


@pytest.mark.parametrize("side", [19.8, 20.3])
def test_struts_beside_a_flush_box_have_their_part_in_it(side: float) -> None:
    box = np.array([[0.0] * 3, [side] * 3])
    flush = flush_box(box, "sc", 10.0, 0.8, sides=32)
    read = as_trimesh(manifold_triangles(flush))
    np.testing.assert_allclose(read.bounds, box, rtol=0, atol=1e-9)
    assert read.is_watertight
    assert read.body_count == 1
    # Cylinders around all lines of the lattice, of which those at 20 mm are outside of the first.
    steps = (np.arange(200) + 0.5) * side / 200
    squares = (steps - 10.0 * np.round(steps / 10.0)) ** 2
    x, y, z = squares[:, None, None], squares[:, None], squares
    inside = (x + y < 0.64) | (y + z < 0.64) | (z + x < 0.64)
    plain = float(inside.mean()) * side**3
    assert 0.98 * plain < read.volume < 1.03 * plain  # the grid is 1 % off; fillets


def as_trimesh(mesh: TriangleMesh) -> trimesh.Trimesh:
    return trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
