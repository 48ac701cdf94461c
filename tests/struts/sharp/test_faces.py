"""B-reps of sharp nodes: against OCCT's own union, valid, and as STEP files hold them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from build123d import Cylinder, Face, GeomType, Plane, Shape, Solid, import_step
from OCP.BRepAdaptor import BRepAdaptor_Surface

from scaffold_cad import Skeleton, round_struts, tile, to_brep, write
from scaffold_cad.base.arrays import Floats
from scaffold_cad.errors import BrepError
from scaffold_cad.struts.breps.faces import brep_of_struts
from tests.struts.sharp.nodes import BEND, LENGTH, NODES, node, random_node
from tests.struts.stars import CUBIC, TRIPOD


def fused(skeleton: Skeleton) -> Shape:
    """Return the union of a node's cylinders, cones and ball by OCCT."""
    near, far = skeleton.edge_radii.T
    slopes = (far - near) / LENGTH
    ball = max((near / np.hypot(1.0, slopes)).max(), skeleton.radii[0] if near.max() < 2 else 0)
    if slopes.any():
        ball = (near / np.hypot(1.0, slopes)).max()
    made: Shape = Solid.make_sphere(ball, angle1=-90)
    # From the last to the first: in the other order OCCT loses a strut of the body-centered node.
    rows = zip(skeleton.nodes[:0:-1], near[::-1], slopes[::-1], strict=True)
    for tip, radius, slope in rows:
        low = -radius * slope / (1 + slope**2)
        plane = Plane(tuple(low * tip / LENGTH), z_dir=tuple(tip))
        ends = radius + slope * low, radius + slope * LENGTH
        if slope:
            made = made.fuse(Solid.make_cone(*ends, LENGTH - low, plane))
        else:
            made = made.fuse(Solid.make_cylinder(radius, LENGTH, plane))
    return made


@pytest.mark.parametrize("name", NODES)
def test_a_node_has_the_volume_and_area_of_the_union_by_occt(name: str, tmp_path: Path) -> None:
    struts = round_struts(NODES[name], nodes="sharp")
    solid = to_brep(struts)
    assert solid.is_valid
    union = fused(NODES[name])
    assert solid.volume == pytest.approx(union.volume, rel=5e-6)
    assert solid.area == pytest.approx(union.area, rel=1e-4)
    write(struts, tmp_path / "node.step")
    read = import_step(tmp_path / "node.step")
    assert read.is_valid
    # OCCT traces circles on spheres to 1e-5 when it reads a file.
    assert read.volume == pytest.approx(solid.volume, rel=1e-5)
    assert len(read.faces()) == len(solid.faces())


def test_balls_at_the_ends_of_cones_touch_them(tmp_path: Path) -> None:
    skeleton = node(TRIPOD, 1.0, [0.1, -0.05, 0.02])
    flat = to_brep(round_struts(skeleton, nodes="sharp", ends="flat"))
    write(round_struts(skeleton, nodes="sharp", ends="round"), tmp_path / "node.step")
    read = import_step(tmp_path / "node.step")
    near, far = skeleton.edge_radii.T
    growth = (far - near) / LENGTH
    size = far * np.hypot(1.0, growth)
    height = size + far * growth
    caps = np.pi * height**2 * (3 * size - height) / 3
    assert read.is_valid
    assert read.volume == pytest.approx(flat.volume + caps.sum(), rel=1e-6)


@pytest.mark.parametrize("kind", range(18))
def test_random_nodes_are_valid_in_step_files(kind: int, tmp_path: Path) -> None:
    struts = round_struts(random_node(kind), nodes="sharp")
    solid = to_brep(struts)
    write(struts, tmp_path / "node.step")
    read = import_step(tmp_path / "node.step")
    assert solid.is_valid
    assert read.is_valid
    assert read.volume == pytest.approx(solid.volume, rel=1e-6)


def radius_of(face: Face) -> float:
    return float(BRepAdaptor_Surface(face.wrapped).Cylinder().Radius())


def test_struts_are_one_cylinder_each_of_their_radius(tmp_path: Path) -> None:
    write(round_struts(NODES["thin tee"], nodes="sharp"), tmp_path / "tee.step")
    cylinders = import_step(tmp_path / "tee.step").faces().filter_by(GeomType.CYLINDER)
    np.testing.assert_allclose(sorted(map(radius_of, cylinders)), [0.6, 1, 1], rtol=1e-9)


@pytest.mark.parametrize(
    ("name", "entity", "count"),
    [
        ("tetrahedral", "ELLIPSE(", 6),
        ("thin tee", "B_SPLINE_CURVE_WITH_KNOTS(", 2),
        ("ball", "SPHERICAL_SURFACE(", 1),
        ("cones", "CONICAL_SURFACE(", 3),
    ],
)
def test_step_files_hold_edges_and_faces_as_what_they_are(
    name: str, entity: str, count: int, tmp_path: Path
) -> None:
    write(round_struts(NODES[name], nodes="sharp"), tmp_path / "node.step")
    assert (tmp_path / "node.step").read_text().count(entity) >= count


def test_a_mitred_bend_is_two_cylinders_and_one_ellipse() -> None:
    struts = round_struts(BEND, nodes="sharp")
    solid = to_brep(struts)
    assert solid.is_valid
    assert len(solid.faces()) == 4
    # Around a plane of symmetry cylinders of a length to the axis' corner have their own volume.
    assert solid.volume == pytest.approx(2 * np.pi * LENGTH, rel=1e-9)


@pytest.mark.parametrize("ends", ["open", "flat", "round"])
@pytest.mark.parametrize("name", ["corner", "thin tee", "cubic"])
def test_hollow_nodes_are_what_is_between_two_unions(name: str, ends: str) -> None:
    struts = round_struts(NODES[name], nodes="sharp", wall=0.2, ends=ends)  # type: ignore[arg-type]
    solid = to_brep(struts)
    assert solid.is_valid
    assert struts.inner is not None
    whole = to_brep(round_struts(NODES[name], nodes="sharp", ends="flat"))
    if ends == "open":
        thin = node(NODES[name].nodes[1:], NODES[name].edge_radii[:, 0] - 0.2)
        inside = to_brep(round_struts(thin, nodes="sharp"))
        assert solid.volume == pytest.approx(whole.volume - inside.volume, rel=1e-6)


def test_a_lattice_is_closed_and_named() -> None:
    struts = round_struts(tile("bcc", 10, (2, 2, 2), radius=0.8), nodes="sharp")
    faces = brep_of_struts(struts)
    faces.check_closed()
    assert len(set(faces.face_names)) >= len(struts.runs.edges)
    assert to_brep(struts).is_valid


@pytest.mark.parametrize("apart", [1e-6, 1e-5, 1e-4, 1e-3])
def test_struts_of_nearly_the_same_radius_meet_in_splines(apart: float) -> None:
    same, near = (
        to_brep(round_struts(node(TRIPOD).with_edge_radii(radii), nodes="sharp"))
        for radii in (np.ones(3), np.array([1.0, 1.0 + apart, 1.0 - apart]))
    )
    assert near.is_valid
    assert near.volume == pytest.approx(same.volume, rel=3 * apart)


def test_struts_without_room_are_refused_by_name() -> None:
    narrow = node(np.array([[1, 0, 0], [1, 0.02, 0], [0, 0, 1]]))
    with pytest.raises(BrepError, match="3 of 3 struts overlap others or their nodes"):
        to_brep(round_struts(narrow, nodes="sharp"))


@pytest.mark.parametrize(
    ("ways", "ball"), [(CUBIC, 1.6), (TRIPOD, 1.6), (CUBIC, 3.0), (TRIPOD, None)]
)
def test_balls_are_one_face_that_can_be_drilled(ways: Floats, ball: float | None) -> None:
    struts = round_struts(node(ways, ball=ball), nodes="ball" if ball else "sharp")
    solid, tool = to_brep(struts), Plane((0.5, -0.35, 0.1), z_dir=(1, 2, 3)) * Cylinder(0.2, 30)
    assert len(solid.faces().filter_by(GeomType.SPHERE)) == 1
    drilled, bored = solid - tool, to_brep(struts) & tool
    assert drilled.is_valid
    assert drilled.volume + bored.volume == pytest.approx(solid.volume, rel=1e-5)


def test_a_ball_shows_one_triangle_at_a_corner() -> None:
    solid = to_brep(round_struts(node(TRIPOD), nodes="sharp"))
    (ball,) = solid.faces().filter_by(GeomType.SPHERE)
    assert ball.area == pytest.approx(4 * np.pi / 8, rel=1e-6)
