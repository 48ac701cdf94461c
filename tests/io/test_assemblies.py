"""3MF files whole: beams with their radii, caps and balls, clipping, and meshes beside them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from scaffold_cad import BeamLattice, Skeleton, TriangleMesh, build_scaffold, round_struts, write
from scaffold_cad.brep import read_brep
from scaffold_cad.cli import main
from scaffold_cad.errors import BrepError, FormatError, MeshError, OptionError
from scaffold_cad.io import read_assembly, read_skeleton, read_triangles
from scaffold_cad.products.assembly import Assembly, assembly_solid, models_of
from scaffold_cad.products.assemblybreps import assembly_brep
from scaffold_cad.skeleton.beams import CAPS
from tests.io.test_threemf import SOLID, mesh, model, packed

RIGHT = {
    "3mf_clip_inside.3mf": 127.8,
    "3mf_solid_and_beams.3mf": 1104.5,
    "3mf_mesh_and_beams_one_object.3mf": 1104.5,
    "3mf_thin_and_thick_beams.3mf": 322.7,
}
"""Volume of what users reported, mm³, worked out by others."""

ROD = Skeleton([[0, 0, 0], [10, 0, 0]], [[0, 1]], 1.0)
ELBOW = Skeleton([[0, 0, 0], [10, 0, 0], [10, 10, 0]], [[0, 1], [1, 2]], 1.0)


def cube(corner: float, side: float) -> TriangleMesh:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * side + corner
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return TriangleMesh(corners, [row for a, b, c, d in quads for row in ([a, b, c], [a, c, d])])


@pytest.mark.parametrize(("name", "volume"), RIGHT.items(), ids=str)
def test_reported_files_have_the_right_volume_in_build_and_check_alike(
    shared_data: Path, tmp_path: Path, name: str, volume: float
) -> None:
    path = shared_data / "reported" / name
    if not path.is_file():
        pytest.skip(f"no {name} beside the repository")
    mesh = read_triangles(path)  # what `check` reads
    assert mesh is not None
    assert mesh.signed_volume == pytest.approx(volume, rel=1e-3)
    assert main(["build", str(path), "-o", str(tmp_path / "out.stl")]) == 0
    built = read_triangles(tmp_path / "out.stl")
    assert built is not None
    assert built.signed_volume == pytest.approx(volume, rel=1e-3)


@pytest.mark.parametrize(("name", "volume"), RIGHT.items(), ids=str)
def test_reported_files_have_the_right_volume_with_round_struts_too(
    shared_data: Path, tmp_path: Path, name: str, volume: float
) -> None:
    path = shared_data / "reported" / name
    if not path.is_file():
        pytest.skip(f"no {name} beside the repository")
    built = {}
    for nodes in ("sharp", "blend"):
        out = tmp_path / f"{nodes}.stl"
        assert main(["build", str(path), "--round", "--nodes", nodes, "-o", str(out)]) == 0
        mesh = read_triangles(out)
        assert mesh is not None
        built[nodes] = mesh.signed_volume
    assert built["sharp"] == pytest.approx(volume, rel=1e-3)  # no fillets
    assert volume < built["blend"] < 1.015 * volume


@pytest.mark.parametrize("suffix", [".stl", ".3mf", ".obj", ".ply"])
def test_plates_and_clipping_are_kept_with_round_struts_in_all_meshes(
    tmp_path: Path, suffix: str
) -> None:
    clipped = BeamLattice(ROD, clip=cube(-5.0, 10.0), mesh=cube(20.0, 3.0))
    write(Assembly([clipped], [cube(30.0, 2.0)]), tmp_path / "in.3mf")
    out = tmp_path / f"out{suffix}"
    options = ["--round", "--sides", "32"]
    assert main(["build", str(tmp_path / "in.3mf"), *options, "-o", str(out)]) == 0
    found = read_triangles(out)
    assert found is not None
    assert found.signed_volume == pytest.approx(5 * math.pi + 27 + 8, rel=1e-6)


def test_hollow_struts_stay_hollow_where_they_are_cut() -> None:
    lattice = BeamLattice(ROD, clip=cube(-5.0, 10.0))
    solid = assembly_solid(
        Assembly([lattice]), make=lambda rod: round_struts(rod, wall=0.25, ends="open")
    )
    assert solid.volume() == pytest.approx(5 * math.pi * (1 - 0.75**2), rel=1e-6)


def test_square_struts_stand_for_beams_where_asked_for() -> None:
    lattice = BeamLattice(ROD, clip=cube(-5.0, 10.0))
    solid = assembly_solid(Assembly([lattice]), make=build_scaffold)
    assert solid.volume() == pytest.approx(5 * 4)  # a square around the circle


def test_balls_are_united_with_round_struts() -> None:
    solid = assembly_solid(Assembly([BeamLattice(ROD, [2.0, 0.0])]), 48, make=round_struts)
    within = math.sqrt(3)
    height = 2 - within
    cap = math.pi * height**2 * (6 - height) / 3
    volume = 32 / 3 * math.pi - cap + math.pi * (10 - within)
    assert solid.volume() == pytest.approx(volume, rel=2e-3)


def test_clipping_and_balls_have_no_exact_faces_but_plane_ones(tmp_path: Path) -> None:
    clipped = Assembly([BeamLattice(ELBOW, [0, 2, 0], clip=cube(-5.0, 20.0))])
    match = r"clipped to what is inside of a mesh and have a ball of radius 2 mm at node 1, \[10, 0"
    with pytest.raises(BrepError, match=match):
        assembly_brep(clipped)
    wanted = assembly_solid(clipped, make=round_struts).volume()
    assert assembly_brep(clipped, overlaps="unite").volume == pytest.approx(wanted, rel=1e-6)
    write(clipped, tmp_path / "in.3mf")
    out = tmp_path / "out.step"
    assert main(["build", str(tmp_path / "in.3mf"), "--round", "-o", str(out)]) == 2
    options = ["--round", "--overlaps", "unite"]
    assert main(["build", str(tmp_path / "in.3mf"), *options, "-o", str(out)]) == 0
    (read,) = read_brep(out).solids()
    assert read.is_valid
    assert read.volume == pytest.approx(wanted, rel=1e-5)


def test_a_plate_is_a_body_of_six_faces_beside_exact_struts(tmp_path: Path) -> None:
    write(Assembly([BeamLattice(ROD)], [cube(-3.0, 6.0)]), tmp_path / "out.step")
    struts, plate = read_brep(tmp_path / "out.step").solids()
    assert struts.volume == pytest.approx(10 * math.pi)
    assert plate.volume == pytest.approx(6**3)
    assert [len(body.faces()) for body in (struts, plate)] == [3, 6]


def test_meshes_that_bound_nothing_and_faces_that_cross_are_refused() -> None:
    inverted = TriangleMesh(cube(0.0, 1.0).vertices, cube(0.0, 1.0).triangles[:, ::-1])
    with pytest.raises(MeshError, match="volume of -1 mm³; need > 0"):
        assembly_brep(Assembly([BeamLattice(ROD)], [inverted]))
    with pytest.raises(OptionError, match="overlaps is 'allow' for struts that are united"):
        assembly_solid(Assembly([BeamLattice(ROD)]), make=round_struts, overlaps="allow")
    crossing = Skeleton([[0, 0, 0], [10, 0, 0], [5, -5, 0], [5, 5, 0]], [[0, 1], [2, 3]], 1.0)
    with pytest.raises(BrepError, match="2 of 2 struts overlap"):
        assembly_solid(Assembly([BeamLattice(crossing)]), make=round_struts, overlaps="refuse")


@pytest.mark.parametrize(
    ("caps", "volume"),
    [
        ("butt", 10 * math.pi),
        ("sphere", (10 + 4 / 3) * math.pi),
        ("hemisphere", (10 + 4 / 3) * math.pi),
    ],
)
def test_caps_of_a_beam_have_their_volume(caps: str, volume: float) -> None:
    solid = assembly_solid(Assembly([BeamLattice(ROD, caps=caps)]), 48)
    assert solid.volume() == pytest.approx(volume, rel=2e-3)


def test_balls_stand_at_the_ends_of_a_beam() -> None:
    solid = assembly_solid(Assembly([BeamLattice(ROD, 2.0, caps="butt")]), 48)
    within = math.sqrt(3)  # so far from its middle a ball of radius 2 is as wide as the beam
    height = 2 - within
    cap = math.pi * height**2 * (6 - height) / 3  # what of a ball is in the beam, beyond that
    volume = 2 * 32 / 3 * math.pi - 2 * cap + math.pi * (10 - 2 * within)
    assert solid.volume() == pytest.approx(volume, rel=2e-3)


def test_a_beam_that_tapers_is_a_cone() -> None:
    skeleton = Skeleton([[0, 0, 0], [12, 0, 0]], [[0, 1]], edge_radii=[[1.0, 2.0]])
    solid = assembly_solid(Assembly([BeamLattice(skeleton, caps="butt")]), 32)
    assert solid.volume() == pytest.approx(math.pi * 12 / 3 * (1 + 2 + 4), rel=1e-6)


def test_flat_joints_leave_a_notch_that_is_filled_unless_asked_for() -> None:
    lattice = Assembly([BeamLattice(ELBOW, caps="butt")])
    steinmetz = 16 / 3 / 4  # two half cylinders at a right angle share a quarter of it
    notched = 20 * math.pi - steinmetz
    flat = assembly_solid(lattice, 48, flat_joints=True)
    assert flat.volume() == pytest.approx(notched, rel=2e-3)
    filled = notched + math.pi / 3  # a quarter of a sphere
    assert assembly_solid(lattice, 48).volume() == pytest.approx(filled, rel=2e-3)


@pytest.mark.parametrize(
    ("clipping", "volume"), [("inside", 5 * math.pi), ("outside", 5 * math.pi)]
)
def test_beams_are_cut_to_what_is_inside_or_outside(clipping, volume: float) -> None:
    lattice = BeamLattice(ROD, clip=cube(-5.0, 10.0), caps="butt", clipping=clipping)
    solid = assembly_solid(Assembly([lattice]), 32)
    assert solid.volume() == pytest.approx(volume, rel=1e-6)
    assert (solid.bounding_box()[3] > 6) == (clipping == "outside")


def test_an_assembly_goes_round(tmp_path: Path) -> None:
    skeleton = Skeleton(ELBOW.nodes, ELBOW.edges, edge_radii=[[1.0, 0.5], [0.25, 0.75]])
    caps = [[CAPS.index("butt"), CAPS.index("sphere")], [CAPS.index("hemisphere"), 0]]
    lattice = BeamLattice(
        skeleton,
        [0, 2, 0],
        cube(-20.0, 25.0),
        cube(30.0, 2.0),
        caps=caps,
        clipping="outside",
        representation=cube(0.0, 9.0),
    )
    write(Assembly([lattice], [cube(50.0, 3.0)]), tmp_path / "all.3mf")
    again = read_assembly(tmp_path / "all.3mf")
    (found,), (beside,) = again.lattices, again.meshes
    np.testing.assert_allclose(found.skeleton.edge_radii, skeleton.edge_radii)
    np.testing.assert_array_equal(found.caps, caps)
    np.testing.assert_allclose(found.balls, [0, 2, 0])
    assert found.clipping == "outside"
    for part, volume in ((found.clip, 25), (found.mesh, 2), (found.representation, 9), (beside, 3)):
        assert part.signed_volume == pytest.approx(volume**3)
    assert again.beyond_skeleton() == [
        "2 meshes of 24 triangles",
        "the clipping of 1 lattice (what is outside stays)",
        "1 ball",
        "1 flat end of beams",
    ]


def test_balls_of_all_nodes_and_their_radius_are_read(tmp_path: Path) -> None:
    lattice = 'radius="1" minlength="0.1" ballmode="all" ballradius="3"'
    (found,) = read_assembly(packed(tmp_path, model([mesh(lattice=lattice)]))).lattices
    assert found.balls.tolist() == [3, 3, 3]


def test_beams_alone_stay_a_skeleton_and_meshes_alone_a_mesh(tmp_path: Path) -> None:
    path = packed(tmp_path, model([mesh()]))
    assert read_triangles(path) is None
    assert read_assembly(path).is_skeleton
    path = packed(tmp_path, model([SOLID]))
    found = read_triangles(path)
    assert found is not None
    assert len(found.triangles) == 4
    assert not read_assembly(path).is_skeleton


def test_what_is_beside_the_beams_is_told_and_a_body_of_its_own_in_a_cad_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    items = '<item objectid="1"/><item objectid="2"/>'
    path = str(packed(tmp_path, model([mesh(), SOLID], items)))
    assert main(["info", path, "--strict"]) == 0
    assert "beside it      1 mesh of 4 triangles" in capsys.readouterr().out
    out = tmp_path / "out.step"
    for options in ([], ["--round"]):
        assert main(["build", path, *options, "-o", str(out)]) == 0
        assert "a body beside 1 mesh of 4 triangles; --overlaps unite" in capsys.readouterr().err
        bodies = read_brep(out).solids()
        assert all(body.is_valid for body in bodies)
        assert [len(body.faces()) for body in bodies][-1] == 4
    strict = ["build", path, "--strict", "-o", str(tmp_path / "out.stl")]
    assert main(strict) == 0
    assert main([*strict, "--as", "frame"]) == 2
    assert "--as frame is for beams alone" in capsys.readouterr().err
    for loses in (["build", "--tiles", "tiles"], ["check", "--as", "frame"]):
        words = [*loses, path, *(["-o", str(tmp_path / "out.stl")] if loses[0] == "build" else [])]
        assert main(words) == 2
        assert "holds also 1 mesh of 4 triangles; need the beams in" in capsys.readouterr().err
    assert main(["strength", path, "--weight", "--fix", "0", "--strict"]) == 2
    assert "holds also 1 mesh of 4 triangles; need nothing" in capsys.readouterr().err
    assert len(read_skeleton(path).edges) == 2


def test_beams_that_are_none_are_told_and_refused_where_nothing_may_go(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    beams = '<b:beam v1="0" v2="1"/><b:beam v1="1" v2="2" r1="-1" r2="-1"/>'
    path = str(
        packed(
            tmp_path, model([mesh(beams), SOLID], items='<item objectid="1"/><item objectid="2"/>')
        )
    )
    assert main(["check", path]) == 0
    assert "left out 1 beam without a length or a radius > 0" in capsys.readouterr().err
    for command in ("check", "info"):
        assert main([command, path, "--strict"]) == 2
        assert "has 1 beam without a length or a radius > 0; need none" in capsys.readouterr().err
    path = str(
        packed(tmp_path, model([mesh('<b:beam v1="0" v2="1"/>', 'radius="-1" minlength="0.1"')]))
    )
    for command in (["check"], ["build", "-o", str(tmp_path / "a.stl")]):
        assert main([*command, path]) == 2
        assert "no radius above 1e-08 mm, the least for these" in capsys.readouterr().err


def test_repairs_of_the_beams_that_struts_stand_for_are_told(
    caplog: pytest.LogCaptureFixture,
) -> None:
    nodes = [[0, 0, 0], [9, 0, 0], [9, 0, 0], [9, 9, 0]]
    beams = BeamLattice(Skeleton(nodes, [[0, 1], [2, 3]], 1.0))
    (struts,) = models_of(Assembly([beams]), round_struts)
    assert len(struts.skeleton.nodes) == 3
    assert "beams were repaired: 1 node" in caplog.text


@pytest.mark.parametrize("seed", range(8))
def test_beams_on_a_plate_are_united_whatever_way_they_are_turned(seed: int) -> None:
    corners = [[x, y, 0] for x in (0, 10) for y in (0, 10)] + [[0, 0, 10]]
    beams = BeamLattice(Skeleton(corners, [[0, 1], [0, 2], [1, 3], [0, 4], [3, 4]], 1.0))
    plate = TriangleMesh(cube(-3.0, 16.0).vertices * [1, 1, 3 / 16], cube(0, 1).triangles)
    plate = TriangleMesh(plate.vertices - [0, 0, plate.vertices[:, 2].max()], plate.triangles)
    level = assembly_solid(Assembly([beams], [plate])).volume()
    turn = Rotation.random(random_state=seed).as_matrix()
    for parts in (Assembly([beams], [plate]), Assembly([BeamLattice(beams.skeleton, mesh=plate)])):
        turned = assembly_solid(parts.transformed(turn))
        assert turned.volume() == pytest.approx(level, rel=2e-3)
        assert len(turned.decompose()) == 1


def test_an_assembly_is_turned_mirrored_and_scaled_whole() -> None:
    lattice = BeamLattice(
        ELBOW, [0, 2, 0], clip=cube(-5.0, 20.0), mesh=cube(20.0, 3.0), caps="butt"
    )
    before = Assembly([lattice], [cube(30.0, 2.0)])
    after = before.transformed(2 * np.array([[0, 1, 0], [1, 0, 0], [0, 0, 1]]))
    (found,) = after.lattices
    np.testing.assert_allclose(found.skeleton.nodes, 2 * ELBOW.nodes[:, [1, 0, 2]])
    np.testing.assert_allclose(found.skeleton.edge_radii, 2)
    assert found.balls.tolist() == [0, 4, 0]
    assert found.clip.signed_volume == pytest.approx(8 * 8000)
    assert assembly_solid(after).volume() == pytest.approx(
        8 * assembly_solid(before).volume(), rel=1e-3
    )
    with pytest.raises(OptionError, match=r"rows are \[\[1.0, 0.0, 0.0\]"):
        before.transformed(np.diag([1.0, 2.0, 1.0]))


def test_flat_ends_are_lost_only_where_a_skeleton_is_all_there_is(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = str(tmp_path / "flat.3mf"), str(tmp_path / "out")
    write(BeamLattice(ELBOW, caps="butt"), path)
    read_skeleton(path)
    assert "left out 4 flat ends of beams" in caplog.text
    for words in (
        ["build", "--round", "-o", f"{out}.stl"],
        ["build", "--collars", "--strict", "-o", f"{out}.step"],
        ["slice", "--layer", "1", "-o", f"{out}.cli"],
        ["slice", "--layer", "1", "--sides", "8", "-o", f"{out}.cli"],
        ["check", "--round", "--strict"],
        ["check"],
        ["convert", "-o", f"{out}.json"],
    ):
        assert main([words[0], path, *words[1:]]) == 0
        assert "flat end" not in capsys.readouterr().err
    with pytest.raises(FormatError, match="holds also 4 flat ends of beams; need nothing"):
        read_skeleton(path, strict=True)


def test_balls_and_flat_ends_stay_where_edges_do(caplog: pytest.LogCaptureFixture) -> None:
    assembly = Assembly([BeamLattice(ELBOW, [0, 2, 0], mesh=cube(20.0, 3.0), caps="butt")])
    thin = assembly.with_skeletons(lambda beams: beams.with_radii(0.5))
    assert thin.beyond_skeleton() == assembly.beyond_skeleton()
    assert caplog.text == ""
    cut = assembly.with_skeletons(lambda beams: beams.subdivided(2))
    assert "left out 1 ball and 4 flat ends, as beams are changed" in caplog.text
    assert cut.beyond_skeleton() == ["1 mesh of 12 triangles"]


def test_options_that_change_beams_keep_what_is_beside_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = tmp_path / "in.3mf", tmp_path / "out.stl"
    write(Assembly([BeamLattice(ROD, clip=cube(-5.0, 10.0))], [cube(20.0, 3.0)]), path)
    command = ["build", str(path), "--round", "--scale", "2", "--turn", "z:90", "--mirror", "x"]
    assert main([*command, "--radius", "0.5", "--join", "0.01", "-o", str(out)]) == 0
    built = read_triangles(out)
    assert built is not None
    assert built.signed_volume == pytest.approx(10 * math.pi / 4 + 6**3, rel=1e-6)
    np.testing.assert_allclose(built.vertices.min(axis=0), [-0.5, 0, -0.5], atol=0.01)
    assert main(["build", str(path), "--units", "in", "-o", str(out)]) == 2
    assert "says that its unit is millimeter; need no --units" in capsys.readouterr().err
    assert main(["convert", str(path), "--scale", "2", "-o", str(tmp_path / "twice.3mf")]) == 0
    twice = read_assembly(tmp_path / "twice.3mf")
    assert twice.meshes[0].signed_volume == pytest.approx(6**3)
    layers = ["slice", str(path), "--layer", "1", "-o", str(tmp_path / "out.cli")]
    for options in ([], ["--scale", "2"], ["--blend", "0.2", "--sides", "8"]):
        assert main([*layers, *options]) == 0
        assert "1 beam united with 1 mesh of 12 triangles" in capsys.readouterr().err


def test_balls_that_go_are_refused_where_nothing_may(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    crossing = Skeleton([[0, 0, 0], [10, 0, 0], [5, -5, 0], [5, 5, 0]], [[0, 1], [2, 3]], 1.0)
    write(BeamLattice(crossing, 2.0), tmp_path / "in.3mf")
    command = ["build", str(tmp_path / "in.3mf"), "--join", "0.1", "-o", str(tmp_path / "out.stl")]
    assert main([*command, "--strict"]) == 2
    assert "holds 4 balls; need nothing that beams lose" in capsys.readouterr().err
    assert main(command) == 0
    assert "left out 4 balls, as beams are changed" in capsys.readouterr().err
