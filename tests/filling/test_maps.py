"""Lattices on build123d faces and on meshes."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from build123d import (
    Axis,
    Box,
    Circle,
    Cylinder,
    Face,
    GeomType,
    Pos,
    Rectangle,
    Rot,
    Sphere,
    Vector,
)

from scaffold_cad import (
    QuadMesh,
    build_scaffold,
    check_skeleton,
    lattice_on,
    tile,
    to_solid,
)
from scaffold_cad.base.arrays import Floats
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.filling import between_faces, face_map, mesh_map
from scaffold_cad.lattice.maps.quads import QuadSurface
from scaffold_cad.lattice.struts import leading_on
from scaffold_cad.skeleton import Skeleton


def cylinder_face(radius: float, height: float) -> Face:
    return Cylinder(radius, height).faces().filter_by(GeomType.CYLINDER)[0]


def wave(height: float = 0.0) -> Face:
    rows = [
        [Vector(x, y, height + 3 * np.sin(x / 6) * np.cos(y / 7)) for y in range(0, 41, 8)]
        for x in range(0, 61, 6)
    ]
    return Face.make_surface_from_array_of_points(rows)


def distances_from_axis(skeleton: Skeleton) -> Floats:
    x, y, _ = skeleton.nodes.T
    return np.hypot(x, y)


def test_cells_on_a_pipe_close_and_stand_outside_it() -> None:
    sleeve = tile("octet", 3.0, radius=0.2, on=face_map(cylinder_face(10, 30), 3.0))
    check_skeleton(sleeve)
    away = distances_from_axis(sleeve)
    assert away.min() == pytest.approx(10)
    assert away.max() == pytest.approx(13)
    assert len(sleeve.extremities) == 0
    angles = np.sort(np.arctan2(sleeve.nodes[:, 1], sleeve.nodes[:, 0]))
    assert np.diff(angles).max() < 0.2


def test_a_trimmed_face_is_filled_to_its_borders() -> None:
    plate = Box(40, 30, 5) - Pos(8, 3, 0) * Cylinder(5, 9)
    top = plate.faces().sort_by(Axis.Z)[-1]
    lattice = tile("bcc", 2.0, radius=0.2, on=face_map(top, 4.0))
    check_skeleton(lattice)
    from_hole = np.hypot(lattice.nodes[:, 0] - 8, lattice.nodes[:, 1] - 3)
    assert from_hole.min() == pytest.approx(5, abs=2e-3)  # the border is a polygon
    assert np.abs(lattice.nodes[:, 2] - 4.5).max() <= 2 + 1e-9
    # The share of struts that the hole takes is that of its area.
    whole = tile("bcc", 2.0, radius=0.2, on=face_map(Box(40, 30, 5).faces().sort_by(Axis.Z)[-1], 4))
    share = lattice.lengths.sum() / whole.lengths.sum()
    assert share == pytest.approx(1 - np.pi * 25 / 1200, rel=0.01)


def test_struts_that_end_free_at_a_border_go_if_asked() -> None:
    plate = Box(40, 30, 5) - Pos(8, 3, 0) * Cylinder(5, 9)
    mapping = face_map(plate.faces().sort_by(Axis.Z)[-1], 4.0)
    all_of_it = tile("kelvin", 4.0, radius=0.2, on=mapping)
    trimmed = tile("kelvin", 4.0, radius=0.2, on=mapping, dangling=False)
    assert len(trimmed.extremities) == 0 < len(all_of_it.extremities)
    assert trimmed.loop_count == all_of_it.loop_count


def test_a_pipe_with_a_hole_in_its_wall_is_trimmed_and_closed() -> None:
    pipe = Cylinder(10, 30) - Rot(90, 0, 0) * Cylinder(4, 40)
    face = max(pipe.faces().filter_by(GeomType.CYLINDER), key=lambda one: one.area)
    lattice = tile("kelvin", 2.5, radius=0.2, on=face_map(face, 2.5))
    check_skeleton(lattice)
    assert lattice.component_count == 1
    inner = lattice.nodes[distances_from_axis(lattice) < 10 + 1e-6]
    assert np.hypot(inner[:, 0], inner[:, 2]).min() > 3.98


def test_the_poles_of_a_sphere_are_single_nodes() -> None:
    lattice = tile("sc", 3.0, radius=0.2, on=face_map(Sphere(10).faces()[0], 2.0))
    check_skeleton(lattice)
    at_pole = (np.abs(lattice.nodes[:, :2]) < 1e-3).all(axis=1)
    np.testing.assert_allclose(np.sort(lattice.nodes[at_pole, 2]), [-12, -10, 10, 12], atol=1e-6)


def test_a_thickness_that_varies_over_a_free_face_is_followed() -> None:
    mapping = face_map(wave(), lambda points: 2 + points[:, 0] / 30, 1.0)
    sole = lattice_on(mapping, "bcc", radius=0.1, size=4.0)
    check_skeleton(sole.skeleton)
    assert sole.largest_stretch < 2.5
    assert build_scaffold(sole.skeleton, collars=True).embedding().certified
    face = wave()
    near = [face.distance_to(Vector(*node)) for node in sole.skeleton.nodes[::23]]
    assert min(near) > 1 - 1e-3
    assert max(near) < 5.01


def test_cells_between_two_faces_end_on_both() -> None:
    lower, upper = wave(), Rot(0, 0, 180) * Pos(-60, -40, 8) * wave()
    mapping = between_faces(lower, upper)
    lattice = tile("sc", counts=(6, 4, 2), radius=0.3, on=mapping)
    check_skeleton(lattice)
    gaps = np.array(
        [[face.distance_to(Vector(*node)) for face in (lower, upper)] for node in lattice.nodes]
    )
    on_one, on_other = (gaps < 1e-6).sum(axis=0)
    assert on_one == on_other == 7 * 5
    uprights = lattice.lengths[np.abs(lattice.directions[::2, 2]) > 0.9]
    assert uprights.max() < 8  # not crosswise


def test_cells_between_two_pipes_close() -> None:
    mapping = between_faces(cylinder_face(10, 30), cylinder_face(14, 30))
    lattice = tile("octet", 4.0, radius=0.3, on=mapping)
    check_skeleton(lattice)
    assert len(lattice.extremities) == 0
    solid = to_solid(build_scaffold(lattice, collars=True))
    assert len(solid.decompose()) == 1
    with pytest.raises(OptionError, match="need both to close, or none"):
        between_faces(cylinder_face(10, 30), wave())


def test_faces_whose_seams_are_elsewhere_are_matched() -> None:
    turned = Rot(0, 0, 77) * Cylinder(14, 30)
    outer = turned.faces().filter_by(GeomType.CYLINDER)[0]
    lattice = tile(
        "sc", counts=(24, 4, 1), radius=0.3, on=between_faces(cylinder_face(10, 30), outer)
    )
    check_skeleton(lattice)
    radial = lattice.lengths[np.ptp(distances_from_axis(lattice)[lattice.edges], axis=1) > 1]
    assert len(radial) == 24 * 5
    np.testing.assert_allclose(radial, 4.0, atol=1e-3)


def test_a_triangle_mesh_is_made_anew_in_quads() -> None:
    ball = trimesh.creation.icosphere(3, 15.0)
    shell = tile("bcc", counts=1, radius=0.25, on=mesh_map(ball, 2.5, size=2.5))
    check_skeleton(shell)
    away = np.linalg.norm(shell.nodes, axis=1)
    assert 14.5 < away.min() < away.max() < 17.6
    assert shell.component_count == 1
    assert len(shell.extremities) == 0


def test_quads_are_as_large_as_a_function_of_position_asks() -> None:
    ball = trimesh.creation.icosphere(3, 20.0)
    graded = mesh_map(ball, 2.0, size=lambda points: 3.0 + points[:, 2] / 10.0)
    corners = graded.surface.vertices[graded.surface.quads]  # (f, 4, 3)
    across = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    height = corners[:, :, 2].mean(axis=1)
    ratio = np.sqrt(np.linalg.norm(across, axis=1) / 2) / (3.0 + height / 10.0)
    assert ratio.mean() == pytest.approx(1.0, abs=0.1)
    assert ratio.std() < 0.2
    low, high = ratio[height < -10].mean(), ratio[height > 10].mean()
    assert low == pytest.approx(high, rel=0.1)  # where sizes are 1.5 and 4.5 mm
    lattice = tile("bcc", counts=1, radius=0.1, on=graded)
    check_skeleton(lattice)
    assert lattice.component_count == 1
    with pytest.raises(OptionError, match="the cell size is -1 mm at"):
        mesh_map(ball, 2.0, size=lambda points: np.full(len(points), -1.0))


@pytest.mark.parametrize("thickness", [1.0, -0.5])
def test_layers_on_parts_with_sharp_edges_lean_where_cells_would_fold(thickness: float) -> None:
    corner = Box(20, 10, 10) + Pos(-5, 0, 10) * Box(10, 10, 10)
    layer = mesh_map(corner, thickness, size=1.5)
    lattice = tile("bcc", counts=1, radius=0.1, on=layer)
    check_skeleton(lattice)
    assert lattice.component_count == 1
    leaned = layer.surface
    straight = QuadSurface.of(QuadMesh(leaned.vertices, leaned.quads))
    turned = np.flatnonzero((leaned.normals * straight.normals).sum(axis=1) < 1 - 1e-9)
    assert len(turned) < len(leaned.normals) / 2  # the others rise along the normals


def test_quads_are_taken_as_they_are() -> None:
    quads = QuadMesh([[0, 0, 0], [9, 0, 0], [9, 9, 0], [0, 9, 0]], [[0, 1, 2, 3]])
    lattice = tile("sc", counts=(3, 3, 1), radius=0.3, on=mesh_map(quads, 3.0))
    assert len(lattice.nodes) == 4 * 4 * 2


def test_a_sketch_of_one_face_stands_for_it() -> None:
    sketch = Rectangle(20, 10) - Circle(2)
    of_sketch = tile("bcc", 5.0, radius=0.5, on=face_map(sketch, 5.0))
    of_face = tile("bcc", 5.0, radius=0.5, on=face_map(sketch.faces()[0], 5.0))
    np.testing.assert_array_equal(of_sketch.nodes, of_face.nodes)


def test_a_layer_without_thickness_is_told_with_the_place() -> None:
    floor = Rectangle(20, 10)
    with pytest.raises(SkeletonError, match="and nowhere of thickness 0"):
        tile("bcc", 5.0, radius=0.5, on=face_map(floor, lambda points: points[:, 0]))


def test_what_cannot_be_is_refused_by_name() -> None:
    with pytest.raises(OptionError, match="the Box has 6 faces; need one Face, such as"):
        face_map(Box(1, 1, 1), 1.0)
    with pytest.raises(OptionError, match="got an array of shape"):
        between_faces(np.zeros((3, 3)), Rectangle(2, 2))
    with pytest.raises(OptionError, match="size of the quads"):
        mesh_map(trimesh.creation.icosphere(1, 5.0), 1.0)
    bore = (Box(20, 20, 5) - Cylinder(4, 9)).faces().filter_by(GeomType.CYLINDER)[0]
    with pytest.raises(SkeletonError, match="the map folds cell"):
        tile("bcc", 1.0, radius=0.1, on=face_map(bore, 5.0))


@pytest.mark.parametrize("size", [0.8, 1.4])
def test_layers_inside_blocks_with_holes_fold_no_cell(size: float) -> None:
    block = Box(20, 20, 10) - Cylinder(4, 10)
    lattice = tile("bcc", counts=1, radius=0.05, on=mesh_map(block, -0.5, size=size))
    assert lattice.component_count == 1
    x, y, z = lattice.nodes.T
    assert np.hypot(x, y).min() > 3.98  # none is in the hole
    assert np.abs([x, y]).max() < 10.001
    assert np.abs(z).max() < 5.001


def middles(skeleton: Skeleton) -> Floats:
    """Return the middle of each strut, sorted, rounded."""
    places = skeleton.nodes[skeleton.edges].mean(axis=1).round(6) + 0.0
    return np.unique(places, axis=0)


@pytest.mark.parametrize("cell", ["triangular_prism", "weaire_phelan", "bcc"])
def test_nets_stay_in_a_layer_that_closes(cell: str) -> None:
    mapping = face_map(cylinder_face(20, 24), 8.0)
    away = distances_from_axis(lattice_on(mapping, cell, 0.3, counts=(14, 3, 2)).skeleton)
    # A chord is inside the circle by less than a cell's bow.
    assert away.min() > 20 * np.cos(np.pi / 14) - 1e-9
    assert away.max() < 28 + 1e-9
    height = lattice_on(mapping, cell, 0.3, counts=(14, 3, 2)).skeleton.nodes[:, 2]
    assert np.abs(height).max() == pytest.approx(12)


@pytest.mark.parametrize("cell", ["triangular_prism", "weaire_phelan", "bcc", "diamond"])
@pytest.mark.parametrize("dangling", [True, False])
def test_a_hole_changes_no_strut_at_the_seam(cell: str, dangling: bool) -> None:
    pierced = (Cylinder(20, 24) - Pos(-20, 0, 0) * Sphere(3)).faces()
    faces = [cylinder_face(20, 24), pierced.filter_by(GeomType.CYLINDER)[0]]
    whole, trimmed = (
        lattice_on(face_map(face, 8.0), cell, 0.3, counts=(14, 3, 2), dangling=dangling).skeleton
        for face in faces
    )
    if not dangling:  # of a face that is not trimmed they all stay: take those that lead on
        whole = Skeleton(whole.nodes, whole.edges[leading_on(whole.edges)], 0.3)
    front = [places[places[:, 0] > 5] for places in map(middles, (whole, trimmed))]
    np.testing.assert_allclose(*front, atol=2e-6)
