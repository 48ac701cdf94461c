"""What callers may pass: a wrong kind of object and what is not a number are refused by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import scaffold_cad as sc
from scaffold_cad import io, mechanics, tiles
from scaffold_cad.base.arguments import as_count, as_direction, as_number, check_kind
from scaffold_cad.errors import FormatError, OptionError, ScaffoldCadError, SkeletonError
from scaffold_cad.lattice import measured_density, unit_cell
from scaffold_cad.parts import LatticeBox, LatticeFill, RoundStrutsSolid, ScaffoldSolid, StrutFrame
from tests.meshes import CUBE
from tests.skeletons import STRUT, TRIPOD

FEET = mechanics.Support([1, 2, 3])
BOX = [[0, 0, 0], [10, 10, 10]]
SCAFFOLD = sc.build_scaffold(TRIPOD)
STRUTS = sc.round_struts(TRIPOD)
MAKES_ONE = r"like is a Skeleton; need a Scaffold: build_scaffold\(skeleton\) makes one"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: sc.to_solid(TRIPOD), r"build_scaffold\(\w+\) makes one or round_s"),
        (lambda: sc.solidified(TRIPOD), "got a Skeleton; need a Scaffold or a RoundStruts: build"),
        (lambda: sc.solidified(CUBE), "got a QuadMesh; need a Scaffold or a RoundStruts"),
        (lambda: sc.round_struts(SCAFFOLD), "got a Scaffold; need a Skeleton: scaffold.skele"),
        (lambda: sc.round_struts(None), "got None; need a Skeleton"),
        (lambda: sc.smooth_patches(TRIPOD), "got a Skeleton; need a QuadMesh: build_scaffold"),
        (lambda: sc.smooth_patches(SCAFFOLD), "got a Scaffold; need a QuadMesh: scaffold.mesh"),
        (lambda: sc.to_brep(TRIPOD), "got a Skeleton; need a Scaffold or a RoundStruts or"),
        (lambda: sc.to_brep(None, smooth=True), "got None; need a Scaffold"),
        (lambda: sc.to_trimesh(TRIPOD), r"need a RoundStruts .* shape: round_struts\(skeleton\) "),
        (lambda: sc.to_trimesh(SCAFFOLD, sides=8), r"sides is for round struts; need round_struts"),
        (lambda: sc.self_intersections(TRIPOD), "got a Skeleton; need a TriangleMesh or a QuadM"),
        (lambda: sc.catmull_clark(SCAFFOLD), "got a Scaffold; need a QuadMesh: scaffold.mesh is"),
        (lambda: sc.build_scaffold(None), "got None; need a Skeleton"),
        (lambda: sc.build_scaffold(SCAFFOLD), "got a Scaffold; need a Skeleton: scaffold.skele"),
        (lambda: sc.build_scaffold(TRIPOD, like=TRIPOD), MAKES_ONE),
        (lambda: sc.build_scaffold(TRIPOD, method=[]), r"method is a list; need one of dual"),
        (lambda: sc.check_skeleton(TRIPOD.cleaned()), "got a Cleaning; .*: cleaning.skeleton is"),
        (lambda: ScaffoldSolid(None), "got None; need a Skeleton or a Scaffold"),
        (lambda: ScaffoldSolid(CUBE), "got a QuadMesh; need a Skeleton or a Scaffold"),
        (lambda: RoundStrutsSolid(CUBE), "got a QuadMesh; need a Skeleton or a RoundStruts"),
        (lambda: StrutFrame("x", 1.0), "got 'x'; need a Scaffold or a QuadMesh or a Skeleton"),
        (lambda: sc.thicken(None, 1.0), "got None; need a Scaffold or a QuadMesh or a Skeleton"),
        (lambda: sc.frame_scaffold(3, 1.0), "got 3; need a Scaffold"),
        (lambda: sc.BeamLattice(None), "got None; need a Skeleton"),
        (lambda: sc.mapped(SCAFFOLD, np.asarray), "got a Scaffold; need a Skeleton"),
        (lambda: sc.register_cell("bcc"), "got 'bcc'; need a UnitCell"),
        (
            lambda: sc.tile(None, 8.0, 2, radius=1.0),
            "cell is None; need a UnitCell or a name of one",
        ),
        (lambda: sc.project(sc.catmull_clark(CUBE), None), "need a QuadMesh: subdivision.mesh"),
        (lambda: sc.project(CUBE, TRIPOD), r"need a Conv.*: ConvolutionField\(skeleton\) is one"),
        (lambda: unit_cell(None), "got None; need a str"),
        (lambda: sc.fill(BOX, TRIPOD, 8.0, 1.0), "cell is a Skeleton; need a UnitCell or a name"),
        (lambda: LatticeFill(None, "bcc", 8.0, 1.0), "the region is None; need a box"),
    ],
)
def test_a_wrong_kind_of_object_is_refused(call: Callable[[], object], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        call()


@pytest.mark.parametrize(
    ("call", "name", "meant"),
    [
        (lambda: sc.build_scaffold(TRIPOD, fit="enclos"), "fit", "enclose"),
        (lambda: sc.build_scaffold(TRIPOD, section="aera"), "section", "area"),
        (lambda: sc.build_scaffold(TRIPOD, method="duall"), "method", "dual"),
        (lambda: sc.partition_sphere(np.eye(3), method="lun"), "method", "lune"),
        (lambda: sc.round_struts(TRIPOD, ends="rund"), "ends", "round"),
        (lambda: sc.round_struts(TRIPOD, joints="curv"), "joints", "curve"),
        (lambda: sc.round_struts(TRIPOD, bend="torsu"), "bend", "torus"),
        (lambda: sc.round_struts(TRIPOD, nodes="bal"), "nodes", "ball"),
        (lambda: sc.to_brep(SCAFFOLD, kind="sold"), "kind", "solid"),
        (lambda: sc.to_brep(SCAFFOLD, overlaps="unit"), "overlaps", "unite"),
        (lambda: sc.write(SCAFFOLD, "a.stl", overlaps="alow"), "overlaps", "allow"),
        (lambda: sc.write(SCAFFOLD, "a.step", overlaps="refus"), "overlaps", "refuse"),
        (lambda: ScaffoldSolid(TRIPOD, overlaps="unit"), "overlaps", "unite"),
        (lambda: LatticeBox("bcc", 9, 9, 9, 9, 1, section="rund"), "section", "round"),
        (lambda: LatticeBox("bcc", 9, 9, 9, 9, 1, keep="hole"), "keep", "whole"),
        (lambda: sc.lattice_part(BOX, "bcc", 9, 1, section="sqare"), "section", "square"),
        (lambda: sc.fill(BOX, "bcc", 9, 1, keep="clp"), "keep", "clip"),
        (lambda: sc.fill(BOX, "bc", 9, 1), "unit cell", "bcc"),
        (lambda: sc.voronoi_foam(9, BOX, 1, keep="clp"), "keep", "clip"),
        (lambda: sc.ConvolutionField(TRIPOD, kernel="cauchi"), "kernel", "cauchy"),
        (lambda: sc.BeamLattice(TRIPOD, caps="but"), "caps", "butt"),
        (lambda: sc.PeriodicLattice("bcc", 9, 2, 1, ends="flt"), "ends", "flat"),
        (lambda: sc.check_printability(TRIPOD, "slss"), "process", "sls"),
        (lambda: sc.check_printability(TRIPOD, "sls", material="pa13"), "material", "pa12"),
        (lambda: mechanics.homogenized("bcc", 1, "steal"), "material", "steel"),
        (lambda: mechanics.Support([0], "pined"), "fixed", "pinned"),
        (lambda: tiles.Check("slm"), "process", "sls"),
        (lambda: io.register_writer(".a", radii="member"), "radii", "members"),
    ],
)
def test_a_misspelled_value_gets_the_right_one(
    call: Callable[[], object], name: str, meant: str
) -> None:
    with pytest.raises(OptionError, match=rf"^{name} is .*; need .*; did you mean '{meant}'\?$"):
        call()


@pytest.mark.parametrize(
    "call",
    [
        lambda: sc.write(SCAFFOLD, "a.stpe"),
        lambda: sc.write_layers(sc.slices(sc.round_struts(TRIPOD), thickness=1), "a.clii"),
        lambda: mechanics.write_hexahedra(mechanics.hexahedra(SCAFFOLD), "a.vtuu"),
        lambda: mechanics.write_beams(mechanics.beam_model(TRIPOD, "steel", FEET), "a.inpp"),
        lambda: io.read_field("a.vtuu"),
    ],
)
def test_a_misspelled_suffix_gets_the_right_one(call: Callable[[], object]) -> None:
    with pytest.raises(FormatError, match=r"need one of \.\w+, .*; did you mean '\.\w+'\?$"):
        call()


ONE_NUMBER = r"need a number, or a function of positions \(n, 3\) that returns radii \(n,\)"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: sc.tile("bcc", 8.0, 2, radius="1"), f"radius is '1'; {ONE_NUMBER}"),
        (lambda: sc.tile("bcc", 8.0, 2, radius=None), f"radius is None; {ONE_NUMBER}"),
        (
            lambda: sc.tile("bcc", 8.0, 2, radius=np.ones(35)),
            rf"radius is an array of shape \(35,\); {ONE_NUMBER}",
        ),
        (
            lambda: sc.tile("bcc", 8.0, 2, radius=lambda points: "thick"),
            "what the function radius returned is not an array of numbers: it holds text",
        ),
        (lambda: sc.tile("bcc", "abc", 2, radius=1.0), "cell size in mm is not an array of num"),
        (lambda: sc.tile("bcc", None, 2, radius=1.0), "cell size in mm is None; need one number"),
        (lambda: sc.tile("bcc", 8.0, None, radius=1.0), "counts are None; need three whole"),
        (lambda: sc.fill(BOX, "bcc", "abc", 1.0), "cell size in mm is not an array of numbers"),
        (lambda: sc.fill("abc", "bcc", 8.0, 1.0), "the region is 'abc'; need a box"),
        (lambda: sc.fill(BOX, "bcc", 8.0, 1.0, origin="abc"), "origin is not an array of numbers"),
        (lambda: sc.fill(BOX, "bcc", 8.0, 1.0, shortest="x"), "shortest length is 'x'; need a num"),
        (lambda: sc.voronoi_foam(2.5, BOX, 1.0), r"count is 2\.5; need a whole number"),
        (lambda: sc.voronoi_foam(9, BOX, 1.0, seed=None), "seed is None; need a whole number"),
        (lambda: sc.voronoi_foam(9, BOX, 1.0, regularity="x"), "regularity is 'x'; need a number"),
        (lambda: sc.delaunay_foam(9, "abc", 1.0), "the region is 'abc'; need a box"),
        (lambda: LatticeBox("bcc", 5.0, 9, "x", 9, 0.5), "width is 'x'; need a number"),
        (lambda: sc.lattice_part(CUBE, "bcc", "x", 0.1), "cell size in mm is not an array of num"),
        (lambda: sc.lattice_part(CUBE, "bcc", 1, 0.1, skin="1"), "skin is '1'; need a number"),
        (lambda: sc.relative_density("sc", 5.0, "1"), "radius is '1'; need a number"),
        (lambda: sc.solve_radius("sc", 5.0, "x"), "relative density is 'x'; need a number"),
        (lambda: sc.solve_radius("sc", [5.0, {}], 0.1), "cell size in mm is not an array of num"),
        (lambda: measured_density("sc", 5.0, None, float), "radius is None; need a number"),
        (lambda: sc.thicken(STRUT, "1"), "radius is '1'; need a number"),
        (lambda: STRUT.scaled("2"), "scale factor is '2'; need a number"),
        (lambda: STRUT.scaled([1, 2, 3]), r"scale factor is \[1, 2, 3\]; need a number"),
        (lambda: STRUT.simplified(None), "simplification tolerance is None; need a number"),
        (lambda: STRUT.cleaned(weld_distance="x"), "weld distance is 'x'; need a number"),
        (lambda: sc.catmull_clark(CUBE, None), "levels is None; need a whole number"),
        (lambda: sc.catmull_clark(CUBE, 2.5), r"levels is 2\.5; need a whole number"),
        (lambda: sc.catmull_clark(CUBE, -1), "levels is -1; need 0 or more"),
        (lambda: sc.catmull_clark(CUBE, True), "levels is True; need a whole number"),
        (lambda: sc.catmull_clark(CUBE, np.inf), "levels is inf; need a whole number"),
        (lambda: sc.smooth_patches(CUBE, split=np.nan), "split is nan; need a whole number"),
        (lambda: sc.smooth_patches(CUBE, split=-1), "split is -1; need 0 or more"),
        (lambda: sc.round_struts(STRUT, blend="x"), "blend is 'x'; need a number"),
        (lambda: sc.round_struts(STRUT, blend=-1), "blend is -1 mm; need > 0"),
        (lambda: sc.round_struts(STRUT, blend=0), "need > 0, or nodes='sharp' for edges"),
        (lambda: sc.to_solid(sc.round_struts(STRUT), sides=8.5), r"sides is 8\.5; need a whole"),
        (lambda: sc.to_solid(sc.round_struts(STRUT), sides=6), "sides is 6; need a multiple of 4"),
        (lambda: sc.thicken(STRUT, 1.0, sides=10), "sides is 10; need a multiple of 4"),
        (lambda: sc.to_solid(sc.round_struts(STRUT), sides=0), "sides is 0; need 4 or more"),
        (lambda: sc.self_intersections(CUBE, tolerance="x"), "tolerance is 'x'; need a number"),
        (lambda: sc.self_intersections(CUBE, limit=1.5), r"limit is 1\.5; need a whole number"),
    ],
)
def test_what_is_no_number_is_refused(call: Callable[[], object], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        call()


@pytest.mark.parametrize("balls", [{}, "1", [[1.0]], None])
def test_balls_that_are_no_numbers_are_refused(balls: Any) -> None:
    with pytest.raises(SkeletonError, match=r"balls (is not an array of numbers|has shape)"):
        sc.BeamLattice(STRUT, balls)


@pytest.mark.parametrize("value", [2, 2.0, np.float32(2), np.int8(2), np.array(2.0)])
def test_numbers_of_any_type_are_numbers(value: Any) -> None:
    assert as_number(value, "radius") == 2.0
    assert type(as_number(value, "radius")) is float


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (0.0, "gap is 0 mm; need > 0"),
        (-1, "gap is -1 mm; need > 0"),
        (np.nan, "gap is nan mm; need > 0"),
        (np.inf, "gap is inf mm; need > 0"),
        (True, "gap is True; need a number"),
        (1j, "gap is a complex; need a number"),
        (10**400, "gap is beyond 1e308; need a smaller number"),
    ],
)
def test_numbers_out_of_range_are_refused(value: Any, message: str) -> None:
    with pytest.raises(OptionError, match=message):
        as_number(value, "gap")


def test_zero_is_taken_where_it_may_be() -> None:
    assert as_number(0, "gap", or_zero=True) == 0.0
    with pytest.raises(OptionError, match="gap is -1; need >= 0"):
        as_number(-1, "gap", unit="", or_zero=True)


def test_counts_are_whole_numbers() -> None:
    assert type(as_count(np.int64(3), "levels")) is int
    with pytest.raises(OptionError, match="levels is 1; need 2 or more"):
        as_count(1, "levels", least=2)


def test_names_of_kinds_are_only_told_of() -> None:
    check_kind(CUBE, sc.QuadMesh, "Manifold")
    with pytest.raises(OptionError, match=r"got an Embedding; need a QuadMesh or a Manifold$"):
        check_kind(SCAFFOLD.embedding(), sc.QuadMesh, "Manifold")


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: sc.build_scaffold(TRIPOD, colars=True), "no parameter 'colars'; did you mean 'c"),
        (lambda: sc.build_scaffold(TRIPOD, q=1), "parameter 'q'; need one of skeleton, fit, sec"),
        (lambda: RoundStrutsSolid(TRIPOD, radius=3), r"RoundStrutsSolid\(\) has no parameter"),
        (lambda: RoundStrutsSolid(TRIPOD, end="flat"), "'end'; did you mean 'ends'"),
        (lambda: ScaffoldSolid(TRIPOD, collar=True), r"ScaffoldSolid\(\).*did you mean 'collars'"),
        (lambda: StrutFrame(TRIPOD, 1.0, colours="red"), "did you mean 'color'"),
        (lambda: LatticeBox("bcc", 8, 8, 8, 8, 1, modus=1), "did you mean 'mode'"),
        (lambda: LatticeFill(BOX, "bcc", 8, 1, orgin=1), "did you mean 'origin'"),
    ],
)
def test_a_wrong_keyword_gets_the_nearest_one(call: Callable[[], object], message: str) -> None:
    with pytest.raises(OptionError, match=message) as raised:
        call()
    assert isinstance(raised.value, TypeError)


def test_a_wrong_value_gets_the_nearest_one() -> None:
    with pytest.raises(OptionError, match=r"fit is 'Papers'; .*; did you mean 'paper'"):
        sc.build_scaffold(TRIPOD, fit="Papers")


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: sc.round_struts(TRIPOD, ends=STRUTS), "ends is a RoundStruts; need one of flat"),
        (lambda: sc.round_struts(TRIPOD, nodes=10**5000), "nodes is a whole number of 16610 bits"),
        (lambda: sc.round_struts(TRIPOD, ends="x" * 999), "ends is 'x{80}' ...; need one of flat"),
        (lambda: sc.round_struts(TRIPOD, blend=1e300), r"blend is 1e\+300 mm; need at most 1e\+12"),
        (lambda: sc.round_struts(TRIPOD, sockets=SCAFFOLD), "sockets is a Scaffold; need a radius"),
        (
            lambda: sc.Skeleton(BOX, len, 1.0),
            "edges holds items of type builtin_f.*; need whole numbers",
        ),
        (lambda: sc.fill(BOX, "bcc", 8, None), "radius is None; need a number, or a function of"),
        (
            lambda: sc.fill(BOX, "bcc", 1e300, 1),
            r"cell size in mm = \[1e\+300.*need at most 1e\+12",
        ),
        (lambda: sc.fill(BOX, "bcc", 8, 1, crumbs=[]), "crumbs is a list; need True or False"),
        (
            lambda: sc.fill(BOX, "bcc", 8, 1, origin=[[]]),
            "origin is .*; need three finite numbers",
        ),
        (lambda: sc.solidified(STRUTS, factor="x"), "factor is 'x'; need a number"),
        (
            lambda: sc.to_brep(CUBE, smooth=np.ones(2)),
            r"smooth is an array of shape \(2,\); need True",
        ),
        (lambda: sc.write(STRUTS, "x.stl", scale=1e300), r"scale is 1e\+300; need at most 1e\+12"),
        (lambda: sc.write(STRUTS, "x.stl", overlaps=[]), "overlaps is a list; need one of unite"),
        (
            lambda: sc.write(STRUTS, "x.step", write_pcurves="no"),
            "write_pcurves is 'no'; need True",
        ),
        (lambda: sc.read_skeleton("x.json", strict=[]), "strict is a list; need True or False"),
        (lambda: TRIPOD.cleaned(split_contacts=3), "split_contacts is 3; need True or False"),
        (lambda: RoundStrutsSolid(TRIPOD, rotation=90), "rotation is 90; need three angles in deg"),
        (lambda: RoundStrutsSolid(TRIPOD, align="min"), "align is 'min'; need Align.MIN, CENTER"),
        (lambda: ScaffoldSolid(TRIPOD, mode="add"), "mode is 'add'; need a Mode"),
        (lambda: LatticeBox("bcc", 8, 8, -8, 8, 1), "width is -8 mm; need > 0"),
        (
            lambda: LatticeBox("bcc", 8, 8, 8, 8, 1, align=(1, 2, 3)),
            "align holds 1; need Align.MIN",
        ),
    ],
)
def test_a_wrong_value_is_named_in_a_line(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ScaffoldCadError, match=message) as raised:
        call()
    assert len(str(raised.value).splitlines()) == 1
    assert len(str(raised.value)) < 400


def test_angles_of_a_part_may_be_a_list() -> None:
    turned = RoundStrutsSolid(TRIPOD, rotation=[0, 90, 0])
    assert turned.is_valid
    same = RoundStrutsSolid(TRIPOD, rotation=(0, 90, 0))
    assert tuple(turned.center()) == tuple(same.center())


@pytest.mark.parametrize("size", [1e-300, 1.0, 1e300])
def test_a_direction_may_have_any_length(size: float) -> None:
    np.testing.assert_allclose(as_direction([0, 3 * size, -4 * size], "axis"), [0, 0.6, -0.8])
