"""Part objects: volumes in every mode of build123d, places of joints, labels, and what is refused.

The bar is a prism of 2 x 2 x 40 mm from the origin along x; 15 mm of it are in a cube of 30 mm
around the origin.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import build123d as bd
import numpy as np
import pytest
import trimesh

from scaffold_cad.brep import tessellated
from scaffold_cad.errors import BrepError, MeshError, OptionError, SkeletonError
from scaffold_cad.filling import fill
from scaffold_cad.filling.models import Section
from scaffold_cad.lattice import CylinderMap
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.parts import (
    LatticeBox,
    LatticeFill,
    RoundStrutsSolid,
    ScaffoldSolid,
    StrutFrame,
    lattice_part,
    to_mesh_shape,
)
from scaffold_cad.products.facets import facets_of
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import to_solid
from scaffold_cad.solid.manifolds import to_manifold
from scaffold_cad.solid.thicken import frame_scaffold
from scaffold_cad.struts import round_struts
from tests.meshes import CUBE
from tests.skeletons import CROSS, JACK, RING, STICK_FIGURE, TAPER, TRIPOD, TWO_STRUTS, star

TURNED = [[1, 1, 0], [-1, 1, 0], [0, 0, 1]]
"""Directions of cells turned by 45° around z."""

BAR = Skeleton([[0, 0, 0], [40, 0, 0]], [[0, 1]], 1.0)
"""A square strut of 2 x 2 x 40 mm along x."""

BAR_VOLUME = 4 * 40
CUBE_VOLUME = 30.0**3
IN_CUBE = 4 * 15  # mm³ of the bar in the cube

CLOSE = Skeleton([[0, 0, 0], [20, 0, 0], [10, -8, 0.5], [10, 8, 0.5]], [[0, 1], [2, 3]], 1.0)
"""Two struts that run through each other."""


def place_of(joint: bd.RigidJoint) -> tuple[list[float], list[float]]:
    """Where a joint is, and its z axis."""
    plane = bd.Plane(joint.location)
    return list(plane.origin), list(plane.z_dir)


def assert_joint(joint: bd.RigidJoint, origin: object, z: object) -> None:
    at, along = place_of(joint)
    assert at == pytest.approx(origin, abs=1e-9)
    assert along == pytest.approx(z, abs=1e-9)


# --- volumes in every mode ---


def test_part_has_the_volume_of_the_scaffold() -> None:
    assert ScaffoldSolid(BAR).volume == pytest.approx(BAR_VOLUME)
    part = ScaffoldSolid(STICK_FIGURE, collars=True)
    assert part.volume == pytest.approx(
        build_scaffold(STICK_FIGURE, collars=True).mesh.signed_volume
    )
    assert part.is_valid
    assert len(part.solids()) == 1


def test_a_union_with_a_triangle_without_area_has_no_brep() -> None:
    # The middle of a side of the cube is a corner of its own, and one triangle lies in the side.
    a, b = CUBE.triangles[0, :2].tolist()
    middle = len(CUBE.vertices)
    split = [[a, middle, CUBE.triangles[0, 2]], [middle, b, CUBE.triangles[0, 2]], [a, b, middle]]
    triangles = np.concatenate([split, CUBE.triangles[1:]])
    vertices = np.concatenate([CUBE.vertices, CUBE.vertices[[a, b]].mean(axis=0)[None]])
    TriangleMesh(vertices, triangles).check_closed()
    with pytest.raises(BrepError, match=rf"triangle 2 with vertices \[{a}, {b}, {middle}\] has no"):
        facets_of(TriangleMesh(vertices, triangles))


def test_builder_adds() -> None:
    with bd.BuildPart() as builder:
        bd.Box(30, 30, 30)
        ScaffoldSolid(BAR)
    assert builder.part.volume == pytest.approx(CUBE_VOLUME + BAR_VOLUME - IN_CUBE)


def test_builder_subtracts() -> None:
    with bd.BuildPart() as builder:
        bd.Box(30, 30, 30)
        ScaffoldSolid(BAR, mode=bd.Mode.SUBTRACT)
    assert builder.part.volume == pytest.approx(CUBE_VOLUME - IN_CUBE)


def test_builder_intersects() -> None:
    with bd.BuildPart() as builder:
        bd.Box(30, 30, 30)
        ScaffoldSolid(BAR, mode=bd.Mode.INTERSECT)
    assert builder.part.volume == pytest.approx(IN_CUBE)


def test_builder_leaves_private_parts_out() -> None:
    with bd.BuildPart() as builder:
        bd.Box(30, 30, 30)
        part = ScaffoldSolid(BAR, mode=bd.Mode.PRIVATE)
    assert builder.part.volume == pytest.approx(CUBE_VOLUME)
    assert part.volume == pytest.approx(BAR_VOLUME)


def test_first_part_of_a_builder_is_taken() -> None:
    with bd.BuildPart() as builder:
        ScaffoldSolid(BAR)
    assert builder.part.volume == pytest.approx(BAR_VOLUME)


def test_parts_go_to_the_locations_of_the_builder() -> None:
    with bd.BuildPart() as builder:
        bd.Box(30, 30, 30)
        with bd.Locations((0, 0, 10), (0, 0, -10), (0, 10, 100)):
            ScaffoldSolid(BAR)
    assert builder.part.volume == pytest.approx(CUBE_VOLUME + 3 * BAR_VOLUME - 2 * IN_CUBE)


def test_algebra_adds_subtracts_and_intersects() -> None:
    box, bar = bd.Box(30, 30, 30), bd.Pos(0, 5, 0) * ScaffoldSolid(BAR)
    assert (box + bar).volume == pytest.approx(CUBE_VOLUME + BAR_VOLUME - IN_CUBE)
    assert (box - bar).volume == pytest.approx(CUBE_VOLUME - IN_CUBE)
    assert (bar - box).volume == pytest.approx(BAR_VOLUME - IN_CUBE)
    assert (box & bar).volume == pytest.approx(IN_CUBE)


def test_tripod_and_its_mirror_image_are_united() -> None:
    part = ScaffoldSolid(TRIPOD)
    both = part + bd.Pos(40, 0, 0) * part
    assert both.volume == pytest.approx(2 * part.volume)


# --- rotation, alignment, place, joints ---


def test_rotation_turns_part_and_joints() -> None:
    part = ScaffoldSolid(BAR, rotation=(0, 0, 90))
    assert tuple(part.bounding_box().max) == pytest.approx((1, 40, 1), abs=1e-6)
    assert_joint(part.joints["extremity 0"], [0, 0, 0], [0, -1, 0])
    assert_joint(part.joints["extremity 1"], [0, 40, 0], [0, 1, 0])


def test_alignment_moves_part_and_joints() -> None:
    part = ScaffoldSolid(BAR, align=(bd.Align.MAX, bd.Align.MIN, bd.Align.CENTER))
    box = part.bounding_box()
    assert tuple(box.min) == pytest.approx((-40, 0, -1), abs=1e-6)
    assert tuple(box.max) == pytest.approx((0, 2, 1), abs=1e-6)
    assert_joint(part.joints["extremity 1"], [0, 1, 0], [1, 0, 0])


def test_rotation_comes_after_alignment() -> None:
    part = ScaffoldSolid(BAR, rotation=(0, 90, 0), align=bd.Align.MIN)
    assert_joint(part.joints["extremity 0"], [1, 1, 0], [0, 0, 1])


def test_joints_follow_the_algebra_and_single_locations() -> None:
    moved = bd.Pos(1, 2, 3) * bd.Rot(0, 0, 180) * ScaffoldSolid(BAR)
    assert_joint(moved.joints["extremity 1"], [-39, 2, 3], [-1, 0, 0])
    with bd.BuildPart(), bd.Locations((0, 0, 10)):
        placed = ScaffoldSolid(BAR)
    assert_joint(placed.joints["extremity 1"], [40, 0, 10], [1, 0, 0])


@pytest.mark.parametrize("part", [ScaffoldSolid, RoundStrutsSolid])
def test_every_extremity_has_a_joint_that_leaves_its_strut(part: type) -> None:
    made = part(STICK_FIGURE)
    extremities = STICK_FIGURE.extremities.tolist()
    assert sorted(made.joints) == sorted(f"extremity {node}" for node in extremities)
    for node in extremities:
        (edge,) = np.flatnonzero((STICK_FIGURE.edges == node).any(axis=1))
        other = STICK_FIGURE.edges[edge].sum() - node
        span = STICK_FIGURE.nodes[node] - STICK_FIGURE.nodes[other]
        assert_joint(
            made.joints[f"extremity {node}"],
            STICK_FIGURE.nodes[node],
            span / np.linalg.norm(span),
        )


def test_x_of_a_joint_points_to_the_middle_of_a_side_of_the_cap() -> None:
    part = ScaffoldSolid(STICK_FIGURE)
    for joint in part.joints.values():
        at = bd.Plane(joint.location)
        caps = [face for face in part.faces() if (face.center() - at.origin).length < 1e-6]
        (cap,) = caps
        middles = [(edge @ 0.5 - at.origin).normalized() for edge in cap.edges()]
        assert max(middle.dot(at.x_dir) for middle in middles) == pytest.approx(1.0)


@pytest.mark.parametrize("tips", [[], [[0, 0, 40]], [[0, 0, 40], [9, 5, -40]]])
def test_joints_of_round_struts_are_level_whatever_meets_at_their_node(tips: list) -> None:
    arms = [[40, 40, 0], [-40, 40, 0], [-40, -40, 9], [40, -40, -20]]
    edges = [[0, k + 1] for k in range(4 + len(tips))]
    part = RoundStrutsSolid(Skeleton([[0, 0, 0], *arms, *tips], edges, 4.0))
    for k in range(1, 5):
        at = bd.Plane(part.joints[f"extremity {k}"].location)
        assert abs(at.x_dir.Z) < 1e-12
        assert at.y_dir.Z > 0.9
    if tips:
        upright = bd.Plane(part.joints["extremity 5"].location)
        assert tuple(upright.x_dir) == pytest.approx((1, 0, 0))


def test_joint_connects_another_part_to_the_end_of_a_strut() -> None:
    bar = bd.Pos(5, 5, 5) * ScaffoldSolid(BAR)
    plate = bd.Box(10, 10, 2)
    bd.RigidJoint("back", plate, bd.Location((0, 0, -1)))
    bar.joints["extremity 1"].connect_to(plate.joints["back"])
    assert tuple(plate.bounding_box().min) == pytest.approx((45, 0, 0), abs=1e-6)
    assert (bar + plate).volume == pytest.approx(BAR_VOLUME + 200)


def test_parts_without_extremities_have_no_joints() -> None:
    assert ScaffoldSolid(RING).joints == {}
    assert ScaffoldSolid(BAR, with_joints=False).joints == {}


def test_label_and_color_are_the_parts() -> None:
    part = ScaffoldSolid(TRIPOD, label="tripod", color=bd.Color("red"))
    moved = bd.Pos(0, 0, 9) * part
    for one in (part, moved):
        assert one.label == "tripod"
        assert tuple(one.color) == pytest.approx((1, 0, 0, 1))
    assert (ScaffoldSolid(TRIPOD).label, ScaffoldSolid(TRIPOD).color) == ("", None)


def test_copies_keep_the_skeleton() -> None:
    part = ScaffoldSolid(TRIPOD)
    assert part.skeleton is TRIPOD
    moved = (bd.Pos(1, 0, 0) * part).skeleton
    assert moved.nodes.tolist() == TRIPOD.nodes.tolist()
    assert moved.edges.tolist() == TRIPOD.edges.tolist()


def test_step_file_of_an_assembly_keeps_labels(tmp_path: Path) -> None:
    part = ScaffoldSolid(TRIPOD, label="tripod")
    frame = bd.Pos(30, 0, 0) * StrutFrame(TRIPOD, 0.5, label="frame")
    path = tmp_path / "assembly.step"
    assert bd.export_step(bd.Compound(label="both", children=[part, frame]), path)
    read = bd.import_step(path)
    assert {child.label for child in read.children} == {"tripod", "frame"}
    assert sum(solid.volume for solid in read.solids()) == pytest.approx(part.volume + frame.volume)


def test_several_components_are_several_solids_of_one_part() -> None:
    part = ScaffoldSolid(TWO_STRUTS)
    assert len(part.solids()) == 2
    assert part.volume == pytest.approx(2 * 40)
    assert len(part.joints) == 4


def test_options_of_the_scaffold_are_passed_on_or_refused() -> None:
    by_area = ScaffoldSolid(BAR, section="area")
    assert by_area.volume == pytest.approx(np.pi * 40)
    assert ScaffoldSolid(build_scaffold(BAR, section="area")).volume == pytest.approx(np.pi * 40)
    with pytest.raises(OptionError, match=r"collars given for a Scaffold that is made"):
        ScaffoldSolid(build_scaffold(BAR), collars=True)
    with pytest.raises(SkeletonError, match="the skeleton has no edges"):
        ScaffoldSolid(Skeleton([[0, 0, 0]], [], 1.0))


def test_round_part_is_a_cylinder_or_a_cone() -> None:
    part = RoundStrutsSolid(TAPER.with_radii(1.5))
    assert part.volume == pytest.approx(np.pi * 1.5**2 * 10, rel=1e-9)
    assert part.is_valid
    thick, thin = TAPER.radii
    cone = np.pi * 10 * (thick**2 + thick * thin + thin**2) / 3
    assert RoundStrutsSolid(TAPER).volume == pytest.approx(cone, rel=1e-9)
    ball = RoundStrutsSolid(TAPER.with_radii(1.5), ends="round")
    assert ball.volume == pytest.approx(np.pi * 1.5**2 * 10 + 4 / 3 * np.pi * 1.5**3, rel=1e-9)


def test_joints_of_round_ends_are_in_the_middle_of_their_last_circle() -> None:
    part = RoundStrutsSolid(BAR, ends="round")
    assert_joint(part.joints["extremity 1"], [40, 0, 0], [1, 0, 0])


def test_options_of_round_struts_are_passed_on_or_refused() -> None:
    made = round_struts(BAR, ends="round")
    assert RoundStrutsSolid(made).volume == pytest.approx(
        RoundStrutsSolid(BAR, ends="round").volume
    )
    with pytest.raises(OptionError, match="ends given for a RoundStruts that is made; need a Sk"):
        RoundStrutsSolid(made, ends="flat")


def test_round_parts_are_cut_out_of_others() -> None:
    with bd.BuildPart() as builder:
        bd.Box(20, 20, 4)
        RoundStrutsSolid(JACK, mode=bd.Mode.SUBTRACT)
    shared = bd.Box(20, 20, 4) & RoundStrutsSolid(JACK)
    assert 4 * np.pi * 9 < shared.volume < 400  # four round struts and a node
    assert builder.part.volume == pytest.approx(20 * 20 * 4 - shared.volume)


def test_frames_of_skeletons_scaffolds_and_meshes() -> None:
    frame = StrutFrame(CROSS, 0.5)
    assert frame.volume == pytest.approx(frame_scaffold(CROSS, 0.5).mesh.signed_volume)
    assert len(frame.joints) == 4
    scaffold = build_scaffold(CROSS)
    cage = StrutFrame(scaffold, 0.1)
    assert cage.volume == pytest.approx(frame_scaffold(scaffold, 0.1).mesh.signed_volume)
    assert_joint(cage.joints["extremity 1"], [10, 0, 0], [1, 0, 0])
    crate = StrutFrame(CUBE, 0.05, section="round")
    assert crate.is_valid
    assert crate.joints == {}


def test_frames_and_lattices_take_the_options_of_round_struts() -> None:
    hollow = StrutFrame(CROSS, 0.5, section="round", nodes="sharp", wall=0.2, ends="open")
    struts = round_struts(CROSS.with_radii(0.5), nodes="sharp", wall=0.2, ends="open")
    assert hollow.is_valid
    assert hollow.volume == pytest.approx(RoundStrutsSolid(struts).volume)
    sharp, blended = (
        LatticeBox("bcc", 8.0, 8, 8, 8, radius=0.8, section="round", nodes=nodes)
        for nodes in ("sharp", "blend")
    )
    assert sharp.is_valid
    assert 0.9 * blended.volume < sharp.volume < 0.995 * blended.volume  # of one node
    core = LatticeFill(bd.Box(20, 20, 20), "bcc", 10.0, 0.8, keep="whole", section="round", blend=1)
    assert (
        core.volume
        > 1.02
        * LatticeFill(
            bd.Box(20, 20, 20), "bcc", 10.0, 0.8, keep="whole", section="round", nodes="sharp"
        ).volume
    )


def test_options_of_round_struts_reach_trimmed_boxes_and_skins() -> None:
    sharp, blended = (
        LatticeBox("bcc", 8.0, 8, 8, 8, radius=0.8, section="round", trim=True, nodes=nodes).volume
        for nodes in ("sharp", "blend")
    )
    assert 0.9 * blended < sharp < 0.99 * blended
    cube = bd.Box(16, 16, 16)
    sharp, blended = (
        LatticeFill(cube, "bcc", 8.0, 0.8, skin=1.5, section="round", nodes=nodes).volume
        for nodes in ("sharp", "blend")
    )
    assert 0.9 * blended < sharp < 0.999 * blended


def test_options_of_round_struts_are_refused_for_square_ones() -> None:
    with pytest.raises(OptionError, match=r"nodes given with section='square'; need .*round'"):
        StrutFrame(CROSS, 0.5, nodes="sharp")
    with pytest.raises(OptionError, match=r"blend given with sides=4, square struts; need sides=8"):
        lattice_part(bd.Box(20, 20, 20), "bcc", 10.0, 1.0, blend=0.3)


# --- lattices ---


@pytest.mark.parametrize(
    ("align", "low"),
    [
        (bd.Align.CENTER, (-10, -10, -5)),
        (bd.Align.MIN, (0, 0, 0)),
        ((bd.Align.MAX, bd.Align.CENTER, bd.Align.MIN), (-20, -10, 0)),
        (None, (0, 0, 0)),
    ],
)
def test_lattice_box_fills_the_box_that_build123d_makes(align: object, low: object) -> None:
    lattice = LatticeBox("sc", 10.0, 20, 20, 10, 0.5, align=align)
    assert lattice.skeleton.nodes.min(axis=0) == pytest.approx(low)
    assert np.ptp(lattice.skeleton.nodes, axis=0) == pytest.approx((20, 20, 10))
    beyond = (np.array(tuple(lattice.bounding_box().size)) - [20, 20, 10]) / 2
    assert beyond == pytest.approx([beyond[0]] * 3, abs=1e-6)  # evenly, by the radius or more
    assert 0.5 <= beyond[0] < 1.5
    assert lattice.is_valid


def test_lattice_box_is_added_under_locations() -> None:
    lattice = LatticeBox("bcc", 10.0, 10, 10, 10, 0.6)
    with bd.BuildPart() as builder, bd.GridLocations(30, 0, 2, 1):
        LatticeBox("bcc", 10.0, 10, 10, 10, 0.6)
    assert builder.part.volume == pytest.approx(2 * lattice.volume)


def test_lattice_box_grows_and_is_round_if_asked() -> None:
    lattice = LatticeBox(
        "bcc", 10.0, 10, 10, 10, lambda p: 0.5 + 0.02 * (p[:, 2] + 5), section="round"
    )
    assert lattice.is_valid
    radii = lattice.skeleton.radii
    assert (radii.min(), radii.max()) == pytest.approx((0.5, 0.7))


@pytest.mark.parametrize(
    ("cell", "size", "axes"),
    [
        ("bcc", 10.0, None),
        ("octet", 20.0, None),
        ("kelvin", 10.0, [[1, 1, 0], [-1, 1, 0], [0, 0, 1]]),
    ],
)
def test_a_trimmed_lattice_measures_as_its_box(cell: str, size: float, axes: object) -> None:
    lattice = LatticeBox(cell, size, 20, 20, 10, 1.0, trim=True, axes=axes)
    box = lattice.bounding_box()
    np.testing.assert_allclose(tuple(box.size), (20, 20, 10), atol=1e-6)
    assert lattice.is_valid
    assert len(lattice.solids()) == 1
    flush = [face for face in lattice.faces() if abs(face.normal_at().Z) > 1 - 1e-9]
    assert sum(face.area for face in flush) > 4


def test_lattices_may_be_turned_and_put_on_maps() -> None:
    pipe = CylinderMap(10, 12, 4)
    around = LatticeFill(bd.Box(60, 60, 24), "bcc", 4.0, 0.3, on=pipe)
    assert around.bounding_box().size.X > 2 * 13.9
    turned = LatticeBox("bcc", 8.0, 20, 20, 10, 0.5, axes=TURNED, overlaps="unite")
    along = turned.skeleton.directions @ np.array([0, 0, 1])
    assert np.isclose(np.abs(along), 1 / np.sqrt(3)).mean() > 0.9


@pytest.mark.parametrize("side", [0.0, -1.0, np.nan])
def test_lattice_box_without_a_size_is_refused(side: float) -> None:
    with pytest.raises(OptionError, match=r"width is .* mm; need > 0"):
        LatticeBox("bcc", 5.0, 10, side, 10, 0.5)


def test_lattice_fills_a_part_where_it_is() -> None:
    body = bd.Pos(100, 0, 0) * bd.Box(20, 20, 10)
    lattice = LatticeFill(body, "bcc", 10.0, 0.6)
    assert lattice.skeleton.nodes.min(axis=0) == pytest.approx((90, -10, -5))
    assert lattice.volume == pytest.approx(LatticeBox("bcc", 10.0, 20, 20, 10, 0.6).volume)
    assert LatticeFill([[0, 0, 0], [20, 20, 10]], "bcc", 10.0, 0.6).volume == pytest.approx(
        lattice.volume
    )


def test_filled_part_is_trimmed_by_an_intersection() -> None:
    body = bd.Box(10, 10, 10)
    lattice = LatticeFill(body, "bcc", 10.0, 0.6)
    trimmed = lattice & body
    assert trimmed.volume < lattice.volume
    assert tuple(trimmed.bounding_box().max) == pytest.approx((5, 5, 5), abs=1e-5)
    assert (body - lattice).volume == pytest.approx(body.volume - trimmed.volume, rel=1e-6)


BALL = bd.Sphere(11)
"""Cuts struts at any place."""


@pytest.mark.parametrize("section", ["square", "round"])
def test_stubs_that_overlap_are_left_out(section: Section) -> None:
    lattice = LatticeFill(BALL, "octet", 9.0, 0.5, section=section)
    assert lattice.is_valid
    every = fill(tessellated(BALL), "octet", 9.0, 0.5)
    assert len(every.edges) - 70 < len(lattice.skeleton.edges) < len(every.edges)
    inner = every.valency[every.edges].min(axis=1) > 1
    ends = {tuple(np.round(end, 6)) for end in every.nodes[every.edges[inner]].mean(axis=1)}
    left = lattice.skeleton.nodes[lattice.skeleton.edges].mean(axis=1)
    assert ends <= {tuple(np.round(end, 6)) for end in left}  # no strut within goes


def test_stubs_that_overlap_are_kept_if_asked() -> None:
    with pytest.raises(BrepError, match=r"of 240 struts overlap others"):
        LatticeFill(BALL, "octet", 9.0, 0.5, drop_stubs=False)
    small = bd.Sphere(8)
    united = LatticeFill(small, "octet", 9.0, 0.5, overlaps="unite")
    assert len(united.skeleton.edges) == len(fill(tessellated(small), "octet", 9.0, 0.5).edges)
    assert united.is_valid


def test_stubs_left_out_are_counted_in_a_warning(caplog: pytest.LogCaptureFixture) -> None:
    every = len(fill(tessellated(BALL), "octet", 9.0, 0.5).edges)
    sections: tuple[Section, ...] = ("square", "round")
    for section in sections:
        caplog.clear()
        left = len(LatticeFill(BALL, "octet", 9.0, 0.5, section=section).skeleton.edges)
        (record,) = caplog.records
        assert record.levelname == "WARNING"
        assert f"{every - left} of {every} struts left out, with free ends" in record.message


def test_lattices_of_which_more_than_a_fifth_are_stubs_are_refused() -> None:
    with pytest.raises(BrepError, match=r"61 of 125 struts end free .*need a fifth at most.*whole"):
        LatticeBox("bcc", 10.0, 21, 21, 21, 1.2)
    with pytest.raises(BrepError, match=r'keep="whole" .*, dangling=False for no loose ends'):
        LatticeFill(bd.Sphere(12.5), "octet", 8, 0.5)
    whole = LatticeFill(bd.Sphere(12.5), "octet", 8, 0.5, keep="whole")
    bound = LatticeFill(bd.Sphere(12.5), "octet", 8, 0.5, dangling=False)
    assert bound.volume < whole.volume


def test_round_struts_that_just_touch_are_refused() -> None:
    away = 1.98 * np.array([0.0, np.cos(np.radians(20)), np.sin(np.radians(20))])
    nodes = np.array([[0.0, 0, 0], [20, 0, 0], away, [20 + away[0], *away[1:]]])
    close = Skeleton(nodes, [[0, 1], [2, 3]], 1.0)
    with pytest.raises(BrepError, match=r"2 of 2 struts overlap others .* \(edges 0, 1;"):
        RoundStrutsSolid(close)
    apart = close.moved(close.nodes + np.array([[0.0], [0.0], [0.02], [0.02]]) * away)
    assert RoundStrutsSolid(apart).volume == pytest.approx(2 * np.pi * 20, rel=1e-9)


def test_struts_within_that_overlap_are_refused_all_the_same() -> None:
    with pytest.raises(BrepError, match=r"struts overlap others"):
        LatticeBox("octet", 5.0, 10, 10, 10, 1.5)


def test_lattice_joints_are_made_if_asked() -> None:
    lattice = LatticeBox("diamond", 10.0, 10, 10, 10, 0.5, with_joints=True)
    assert len(lattice.joints) == len(lattice.skeleton.extremities) > 0
    assert LatticeBox("diamond", 10.0, 10, 10, 10, 0.5).joints == {}


# --- struts that overlap ---


def test_struts_that_overlap_are_refused_with_what_to_do() -> None:
    with pytest.raises(
        BrepError, match=r"2 of 2 struts overlap others .*\(edges 0, 1; .*overlaps='unite'.*a mesh"
    ):
        ScaffoldSolid(CLOSE)


def test_struts_that_overlap_are_united_if_asked() -> None:
    part = ScaffoldSolid(CLOSE, overlaps="unite")
    assert part.volume == pytest.approx(to_solid(build_scaffold(CLOSE)).volume())
    assert part.is_valid
    assert len(part.solids()) == 1
    (solid,) = part.solids()
    assert solid.is_manifold
    assert (bd.Box(60, 60, 60) - part).volume == pytest.approx(60**3 - part.volume)
    assert len(part.joints) == 4


def test_round_struts_are_facets_where_they_overlap_and_cylinders_beside() -> None:
    part = RoundStrutsSolid(CLOSE, overlaps="unite")
    assert part.volume == pytest.approx(to_solid(round_struts(CLOSE)).volume(), rel=0.005)
    assert part.is_valid
    kinds = {face.geom_type for face in part.faces()}
    assert kinds == {bd.GeomType.PLANE, bd.GeomType.CYLINDER}


def test_unions_of_several_parts_are_several_solids() -> None:
    twice = Skeleton(
        np.concatenate([CLOSE.nodes, CLOSE.nodes + np.array([0, 0, 50])]),
        np.concatenate([CLOSE.edges, CLOSE.edges + 4]),
        1.0,
    )
    part = ScaffoldSolid(twice, overlaps="unite")
    assert len(part.solids()) == 2
    assert part.volume == pytest.approx(2 * ScaffoldSolid(CLOSE, overlaps="unite").volume)


def test_unions_of_too_many_triangles_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scaffold_cad.products.facets.MOST_FACETS", 20)
    with pytest.raises(BrepError, match=r"has \d+ plane facets; need 20 or less .*to_mesh_shape"):
        ScaffoldSolid(CLOSE, overlaps="unite")


def test_errors_name_the_first_few_of_many_struts() -> None:
    directions = np.random.default_rng(1).standard_normal((12, 3)).tolist()
    with pytest.raises(BrepError, match=r"\(edges \d+, \d+, \d+, \d+, \d+, \.\.\.;"):
        ScaffoldSolid(star(directions, radius=2.0))


# --- meshes as shapes ---


@pytest.mark.parametrize(
    "mesh_of",
    [to_manifold, lambda mesh: mesh, lambda mesh: TriangleMesh(mesh.vertices, mesh.triangles)],
    ids=["manifold", "quads", "triangles"],
)
def test_mesh_shape_is_written_as_the_mesh_that_it_is(
    mesh_of: Callable[[QuadMesh], object], tmp_path: Path
) -> None:
    assert_written_whole(to_mesh_shape(mesh_of(CUBE)), tmp_path, CUBE.signed_volume)


def test_mesh_shape_of_a_scaffold_is_the_union_of_its_struts(tmp_path: Path) -> None:
    scaffold = build_scaffold(CLOSE)
    assert_written_whole(to_mesh_shape(scaffold), tmp_path, to_solid(scaffold).volume())


def assert_written_whole(shape: bd.Face, folder: Path, volume: float) -> None:
    assert isinstance(shape, bd.Face)
    path = folder / "mesh.stl"
    assert bd.export_stl(shape, path)
    read = trimesh.load_mesh(path)
    assert read.is_watertight
    assert read.volume == pytest.approx(volume, rel=1e-5)


def test_mesh_shape_keeps_its_triangles_wherever_it_goes() -> None:
    part = lattice_part(bd.Box(20, 20, 20), "bcc", 6.0, 0.5, skin=1.0)
    shape = bd.Pos(0, 0, 100) * to_mesh_shape(part)
    points, triangles = shape.tessellate(0.01)
    assert len(triangles) == part.num_tri()
    assert min(point.Z for point in points) == pytest.approx(90)


def test_mesh_shape_of_nothing_is_refused() -> None:
    empty = TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.intp))
    with pytest.raises(MeshError, match=r"the TriangleMesh has no triangles; need at least one"):
        to_mesh_shape(empty)
    with pytest.raises(OptionError, match=r"the body is 'bracket'; need a build123d solid"):
        to_mesh_shape("bracket")


# --- the package ---


def test_package_is_imported_without_build123d() -> None:
    program = (
        "import sys, scaffold_cad.parts; print({'build123d', 'OCP'} & set(sys.modules), "
        "'LatticeBox' in dir(scaffold_cad.parts)); "
        "from scaffold_cad.parts import LatticeBox; print('build123d' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout.split() == ["set()", "True", "True"], done.stderr


def test_unknown_part_is_no_attribute() -> None:
    import scaffold_cad.parts

    with pytest.raises(AttributeError, match="no attribute 'Bracket'"):
        _ = scaffold_cad.parts.Bracket


def test_lattice_box_is_the_scaffold_of_a_filled_box() -> None:
    skeleton = fill([[-5, -5, -5], [5, 5, 5]], "octet", 10.0, 0.5)
    lattice = LatticeBox("octet", 10.0, 10, 10, 10, 0.5)
    assert lattice.volume == pytest.approx(
        build_scaffold(skeleton, collars=True).mesh.signed_volume
    )
