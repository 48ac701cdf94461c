"""`scaffold-cad lattice` and `scaffold-cad cells`, and the line that tells their progress."""

from __future__ import annotations

import io
import re
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import trimesh

from scaffold_cad.base.counts import Count, running, tracked
from scaffold_cad.cli import main
from scaffold_cad.cli.progress import PERIOD, QUIET_TIME, Progress
from scaffold_cad.io import read_skeleton
from scaffold_cad.lattice import cell_picture, cells, tile

BCC = ["lattice", "--cell", "bcc", "--size", "8", "--radius", "0.6"]


def loaded(path: Path) -> trimesh.Trimesh:
    mesh = trimesh.load(path, force="mesh")
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0
    return mesh


@pytest.mark.parametrize("suffix", [".stl", ".3mf", ".glb"])
def test_a_box_is_filled(tmp_path: Path, suffix: str) -> None:
    out = tmp_path / f"box{suffix}"
    assert main([*BCC, "--box", "16x16x24", "-o", str(out)]) == 0
    assert loaded(out).euler_number == 2 - 2 * tile("bcc", 8.0, (2, 2, 3), radius=0.6).loop_count


def test_round_struts_have_more_triangles_and_the_radius(tmp_path: Path) -> None:
    volumes, sizes = [], []
    for options in ([], ["--round"]):
        out = tmp_path / "box.stl"
        assert main([*BCC, "--box", "16x16x16", *options, "-o", str(out)]) == 0
        mesh = loaded(out)
        volumes.append(mesh.volume)
        sizes.append(len(mesh.faces))
    assert sizes[1] > 3 * sizes[0]
    # A square around a circle has 4/π of its area.
    assert volumes[1] == pytest.approx(volumes[0] * np.pi / 4, rel=0.1)


def test_a_trimmed_box_measures_as_asked(tmp_path: Path) -> None:
    out = tmp_path / "box.stl"
    assert main([*BCC, "--box", "16x16x24", "--trim", "-o", str(out)]) == 0
    np.testing.assert_allclose(loaded(out).bounds, [[0, 0, 0], [16, 16, 24]], atol=1e-5)


NETS = Path(__file__).parents[2] / "examples/skeletons/nets.cgd"


def test_a_net_of_a_file_is_a_cell(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    given = ["--size", "8", "--radius", "0.5"]
    out = tmp_path / "box.json"
    of_net = ["lattice", "--cell", f"{NETS}:dia", *given]
    assert main([*of_net, "--box", "20", "--beams", "-o", str(out)]) == 0
    struts = read_skeleton(out)
    inner = struts.nodes[struts.valency == 4]
    assert len(inner) > 30
    np.testing.assert_allclose(struts.lengths.max(), np.sqrt(3) / 4 * 8 * np.sqrt(2))
    assert main([*of_net, "--cylinder", "20x24x6", "-o", str(tmp_path / "sleeve.stl")]) == 0
    assert loaded(tmp_path / "sleeve.stl").volume > 0
    layers = [*of_net, "--box", "20", "--layer", "2", "-o", str(tmp_path / "box.cli")]
    assert main(layers) == 0
    capsys.readouterr()
    for name, told in (
        (str(NETS), "nets.cgd holds nets pcu, dia; need FILE:NAME of one of them"),
        (f"{NETS}:srs", "pcu, dia, and 0 are called 'srs'; need FILE:NAME of one of them"),
        (str(tmp_path / "none.cgd"), "none.cgd cannot be read: there is no such file"),
    ):
        asked = ["lattice", "--cell", name, *given, "--box", "20", "-o", str(tmp_path / "b.stl")]
        assert main(asked) == 2
        assert told in capsys.readouterr().err


def test_cells_stand_on_tubes_and_spheres(tmp_path: Path) -> None:
    out = tmp_path / "part.stl"
    assert main([*BCC, "--cylinder", "20x24x8", "-o", str(out)]) == 0
    assert loaded(out).extents[:2].min() > 2 * 27
    assert main([*BCC, "--sphere", "20x8", "--beams", "-o", str(tmp_path / "ball.3mf")]) == 0
    ball = read_skeleton(tmp_path / "ball.3mf", strict=True)
    away = np.linalg.norm(ball.nodes, axis=1)
    assert away.min() == pytest.approx(20, abs=1e-3)
    assert away.max() == pytest.approx(28, abs=1e-3)


def test_cells_stand_on_a_face_of_a_part_or_a_sheet(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    build123d = pytest.importorskip("build123d")
    sheet, out = tmp_path / "sheet.step", tmp_path / "out.stl"
    build123d.export_step(build123d.Shell(build123d.Cylinder(20, 40).faces()), sheet)
    words = [*BCC, "--thickness", "8", "-o", str(out), "--face"]
    assert main([*words, str(sheet)]) == 0
    assert loaded(out).extents[0] > 2 * 27
    assert main([*words, str(sheet), "--face-number", "7"]) == 2
    assert main([*words, str(out)]) == 2
    assert "out.stl holds no face of CAD" in capsys.readouterr().err


def test_cells_stand_between_two_faces_of_a_part(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    build123d = pytest.importorskip("build123d")
    part, out = tmp_path / "part.step", tmp_path / "out.json"
    build123d.export_step(build123d.Box(32, 24, 16), part)
    faces = build123d.import_step(part).faces()
    low, high = (faces.index(faces.sort_by(build123d.Axis.Z)[k]) for k in (0, -1))
    words = [*BCC, "--face", str(part), "--beams", "-o", str(out), "--face-number", str(low)]
    assert main([*words, "--to-face", str(high)]) == 0
    found = read_skeleton(out)
    assert len(found.edges) == 8 * 4 * 3 * 2
    np.testing.assert_allclose(np.ptp(found.nodes, axis=0), [32, 24, 16])
    for number, message in ((6, "--to-face is 6; need 0 to 5"), (low, "the face itself")):
        assert main([*words, "--to-face", str(number)]) == 2
        assert message in capsys.readouterr().err


def test_cells_stand_on_the_whole_surface_of_a_mesh(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    part, out = tmp_path / "ball.stl", tmp_path / "out.json"
    trimesh.creation.icosphere(subdivisions=3, radius=20).export(part)
    words = [*BCC, "--surface", str(part), "--thickness", "3", "--beams", "-o", str(out)]
    assert main([*words, "--size", "4x4x3"]) == 0
    assert "1 x 1 x 1 cells" in capsys.readouterr().err
    found = read_skeleton(out)
    assert found.component_count == 1
    away = np.linalg.norm(found.nodes, axis=1)
    assert 19.5 < away.min() < 20.01
    assert 22.5 < away.max() < 23.1
    assert main([*words, "--size", "4x5x3"]) == 2
    assert "need two equal ones along --surface" in capsys.readouterr().err


@pytest.mark.parametrize("options", [[], ["--round", "--blend", "0.2"]])
def test_a_lattice_has_the_density_that_is_asked_for(options: list[str], tmp_path: Path) -> None:
    out = tmp_path / "out.stl"
    cells = ["lattice", "--cell", "sc", "--size", "5", "--density", "0.15"]
    assert main([*cells, "--box", "15", "--trim", *options, "-o", str(out)]) == 0
    assert loaded(out).volume == pytest.approx(0.15 * 15**3, rel=2e-3)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--density", "1.5", "--box", "9"], "--density is 1.5; need > 0 and < 1"),
        (["--density", "0.1", "--sphere", "20x8"], "--density is of equal cells in a box"),
    ],
)
def test_densities_that_no_cells_have_are_refused(
    words: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["lattice", "--cell", "bcc", "--size", "5", *words, "-o", str(tmp_path / "a.stl")]
    assert main(command) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--box 16 --skin 1e-9 -o a.stl", "--skin is 1e-09 mm; need 0.00012 mm or more"),
        ("--box 16 --skin 9 -o a.stl", "--skin is 9 mm, which fills the body; need less"),
        ("--box 16 --skin 1 --drain 1e-9 -o a.stl", "--drain is 1e-09 mm; need"),
        ("--box 16 --max-nodes 5 -o a.stl", "need at most 5 nodes"),
        ("--box 16 --skin 1 --layer 1 --tiles t -o a.cli", "--skin is not for lattices by --tiles"),
        ("--inside none.stl -o a.stl", "none.stl cannot be read"),
    ],
)
def test_what_cannot_be_is_refused_before_a_radius_is_searched(
    words: str, message: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("scaffold_cad.cli.latticeradius.radius", pytest.fail)
    command = ["lattice", "--cell", "bcc", "--size", "8", "--density", "0.2", *words.split()]
    assert main(command) == 2
    assert message in capsys.readouterr().err


def test_powder_gets_out_of_a_skin_that_is_drained(tmp_path: Path) -> None:
    closed, drained = tmp_path / "closed.stl", tmp_path / "drained.stl"
    skin = [*BCC, "--box", "24", "--skin", "1.5"]
    assert main([*skin, "-o", str(closed)]) == 0
    assert main([*skin, "--drain", "4", "-o", str(drained)]) == 0
    assert [loaded(path).body_count for path in (closed, drained)] == [2, 1]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--face", "part.step"], "--face needs either the --thickness"),
        (["--face", "a.step", "--thickness", "3", "--to-face", "1"], "--face needs either the"),
        (["--box", "16", "--thickness", "3"], "--thickness is of a layer; need --face or --surf"),
        (["--box", "16", "--to-face", "3"], "--to-face is of a face; need --face"),
        (["--surface", "part.stl"], "--surface needs the --thickness"),
        (["--box", "16", "--drain", "3"], "--drain is for holes in the skin of a mesh; need --sk"),
        (["--sphere", "20x8", "--trim"], "--trim cuts struts flush with a box or a part"),
        (["--sphere", "20x8", "--skin", "1"], "--skin is the wall of a box or a part"),
        (["--box", "16", "--trim", "--skin", "1"], "--trim is for struts without a skin"),
    ],
)
def test_options_that_do_not_belong_together_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], message: str
) -> None:
    assert main([*BCC, *words, "-o", str(tmp_path / "out.stl")]) == 2
    assert message in capsys.readouterr().err


def test_beams_are_the_struts_themselves(tmp_path: Path) -> None:
    out = tmp_path / "beams.3mf"
    assert main([*BCC, "--box", "16x16x16", "--beams", "-o", str(out)]) == 0
    assert len(read_skeleton(out, strict=True).edges) == 64


def test_a_box_becomes_cad(tmp_path: Path) -> None:
    build123d = pytest.importorskip("build123d")
    out = tmp_path / "box.step"
    assert main([*BCC, "--box", "8x8x8", "-o", str(out)]) == 0
    (solid,) = build123d.import_step(out).solids()
    assert solid.is_valid


@pytest.mark.parametrize("suffix", [".stl", ".ply"])
def test_a_mesh_is_filled_under_a_skin(tmp_path: Path, suffix: str) -> None:
    part, out = tmp_path / f"part{suffix}", tmp_path / "out.stl"
    trimesh.creation.cylinder(10.0, 20.0).export(part)
    assert main([*BCC, "--inside", str(part), "--skin", "1.2", "-o", str(out)]) == 0
    mesh = loaded(out)
    np.testing.assert_allclose(mesh.extents, [20, 20, 20], rtol=1e-5)
    assert mesh.volume < 0.8 * np.pi * 100 * 20


def test_a_step_part_is_filled(tmp_path: Path) -> None:
    build123d = pytest.importorskip("build123d")
    part, out = tmp_path / "part.step", tmp_path / "out.step"
    build123d.export_step(build123d.Box(20, 16, 16), part)
    assert main([*BCC, "--inside", str(part), "-o", str(out)]) == 0
    (solid,) = build123d.import_step(out).solids()
    assert solid.is_valid
    assert solid.volume < 0.3 * 20 * 16 * 16


def test_struts_are_cut_flush_with_a_part(tmp_path: Path) -> None:
    part, box, out = tmp_path / "part.stl", tmp_path / "box.stl", tmp_path / "out.stl"
    trimesh.creation.box(bounds=[[0, 0, 0], [16, 16, 16]]).export(part)
    assert main([*BCC, "--inside", str(part), "--trim", "-o", str(out)]) == 0
    assert main([*BCC, "--box", "16", "--trim", "-o", str(box)]) == 0
    assert loaded(out).volume == pytest.approx(loaded(box).volume, rel=1e-5)


def test_a_box_has_a_skin_too(tmp_path: Path) -> None:
    out = tmp_path / "out.stl"
    assert main([*BCC, "--box", "16x16x16", "--skin", "1", "-o", str(out)]) == 0
    outside = max(part.volume for part in loaded(out).split(only_watertight=True))
    assert outside == pytest.approx(16**3, rel=1e-4)


def test_a_part_from_a_step_file_is_filled_as_one(tmp_path: Path) -> None:
    build123d = pytest.importorskip("build123d")
    part, out = tmp_path / "part.step", tmp_path / "out.step"
    build123d.export_step(build123d.Box(16, 16, 16), part)
    assert main([*BCC, "--inside", str(part), "--skin", "1.5", "--round", "-o", str(out)]) == 0
    (solid,) = build123d.import_step(out).solids()
    assert solid.is_valid
    assert len(solid.faces().filter_by(build123d.GeomType.CYLINDER)) > 8


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["--box", "8x8x8", "--skin", "1", "-o", "out.step"], "hold struts without --skin, --tr"),
        (["--box", "8x8x8", "--beams", "--round", "-o", "out.3mf"], "without --round and --skin"),
        (["--box", "8x8x8", "--beams", "--skin", "1", "-o", "out.3mf"], "without --round and"),
        (["--box", "8x8x8", "--beams", "-o", "out.stl"], "cannot hold a skeleton, only a solid"),
        (["--box", "8x8x8", "--skin", "9", "-o", "out.stl"], "which fills the body"),
        (["--inside", "absent.stl", "-o", "out.stl"], "absent.stl cannot be read"),
        (["--inside", "absent.step", "-o", "out.stl"], "there is no such file"),
        (["--inside", "part.swc", "-o", "out.stl"], "holds no closed part"),
        (["--box", "8x8x8", "-o", "out.xyz"], "its suffix is '.xyz'"),
        (["--box", "8x8x8", "-o", "out.json"], "its suffix is '.json'; need one of .3mf, .brep"),
        (["--size", "1e-30", "--box", "8x8x8", "-o", "out.stl"], "need at most 1e+08"),
        (["--size", "1e-320", "--box", "8x8x8", "--skin", "1", "-o", "out.stl"], "need at most 1e"),
        (
            ["--size", "0.05", "--box", "10x10x10", "-o", "out.stl"],
            "8000000 cells have some 16000000 nodes and 64000000 struts; need at most 2000000",
        ),
        (["--box", "16x16x16", "--max-nodes", "9", "-o", "out.3mf"], "need at most 9 nodes: to"),
    ],
)
def test_bad_input_is_told_in_one_line(
    arguments: list[str],
    complaint: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main([*BCC, *arguments]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert complaint in line
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("option", "text", "complaint"),
    [
        ("--box", "8x8", "is not a box"),
        ("--box", "eight", "is not a box"),
        ("--box", "8x8x8x8", "is not a box"),
        ("--cylinder", "20", "'20'; need RxHxT: 3 lengths"),
        ("--cylinder", "20x0x4", "need RxHxT: 3 lengths, all > 0"),
        ("--sphere", "20x4x4", "need RxT: 2 lengths"),
    ],
)
def test_sizes_are_as_many_lengths_as_their_place_has(
    option: str, text: str, complaint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main([*BCC, option, text, "-o", "out.stl"])
    assert complaint in capsys.readouterr().err


def test_an_unknown_cell_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    command = ["lattice", "--cell", "octett", "--size", "8", "--radius", "1", "--box", "8x8x8"]
    assert main([*command, "-o", str(tmp_path / "out.stl")]) == 2
    assert "did you mean 'octet'?" in capsys.readouterr().err


def test_cells_are_listed_with_valency_and_density(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["cells"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(cells())
    (octet,) = [line for line in lines if line.startswith("octet ")]
    assert "valency 12" in octet
    assert "Maxwell 9 " in octet  # 24 struts, 4 nodes
    assert "53.31 (r/a)²" in octet


def test_a_density_that_cannot_be_is_told_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["cells", "--stiffness", "-1"]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err == "scaffold-cad: --stiffness is -1; need > 0\n"


def test_cells_are_drawn_on_a_page(tmp_path: Path) -> None:
    page = tmp_path / "cells.html"
    assert main(["cells", "-o", str(page)]) == 0
    text = page.read_text(encoding="utf-8")
    pictures = [ElementTree.fromstring(part) for part in re.findall("<svg.*?</svg>", text)]
    assert [svg.findtext("{*}title") for svg in pictures] == list(cells())
    for svg, cell in zip(pictures, cells().values(), strict=True):
        assert len(svg.findall("{*}line")) == 12 + len(cell.edges)
        ends = [float(line.get(end)) for line in svg.findall("{*}line") for end in ("x1", "y2")]
        assert 0 < min(ends) < max(ends) < float(svg.get("width"))


def test_the_page_of_cells_is_a_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["cells", "-o", str(tmp_path / "cells.png")]) == 2
    assert "need .html" in capsys.readouterr().err


def test_notebooks_show_the_picture_of_a_cell() -> None:
    octet = cells()["octet"]
    assert octet._repr_svg_() == cell_picture(octet)
    assert f"<title>{octet.name}</title>" in cell_picture(octet)


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_long_stage_counts_what_is_done_on_a_terminal_and_clears_it() -> None:
    terminal = Terminal()

    def slow() -> Iterator[str]:
        for letter in "abcdef":
            time.sleep((QUIET_TIME + 2 * PERIOD) / 6)
            yield letter

    with Progress(terminal).stage("struts", 100, "struts"):
        list(tracked("blends", slow(), [10] * 6))
    shown = terminal.getvalue().split("\r\x1b[K")
    pattern = r"struts: 100 struts, \d s so far; blends: \d0 of 60, .* per second, about \d s left"
    assert re.fullmatch(pattern, shown[1])
    assert shown[-1] == ""
    assert running() is None


def test_a_long_stage_without_counts_shows_the_time_it_took() -> None:
    terminal = Terminal()
    with Progress(terminal).stage("solid", 100, "struts"):
        time.sleep(QUIET_TIME + 2 * PERIOD)
    shown = terminal.getvalue().split("\r\x1b[K")
    assert re.fullmatch(r"solid: 100 struts, \d s so far", shown[1])


@pytest.mark.parametrize(
    ("options", "stages"),
    [
        (["--round"], ["struts: 64 struts", "file: 64 struts"]),
        (["--beams"], ["file: 64 struts"]),
        (["--trim"], ["lattice: 8 cells", "file: 1628 triangles"]),
    ],
)
def test_making_and_writing_are_stages(
    options: list[str], stages: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = []

    def noted(_: Progress, name: str, count: int, unit: str) -> AbstractContextManager[None]:
        shown.append(f"{name}: {count} {unit}")
        return nullcontext()

    monkeypatch.setattr(Progress, "stage", noted)
    assert main([*BCC, *options, "--box", "16x16x16", "-o", str(tmp_path / "box.3mf")]) == 0
    assert shown == stages


def test_struts_tested_for_overlaps_and_triangles_written_are_counted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: dict[str, Count] = {}
    made = Count.__init__

    def noted(count: Count, name: str, total: int) -> None:
        made(count, name, total)
        begun[name] = count

    monkeypatch.setattr(Count, "__init__", noted)
    assert main([*BCC, "--round", "--box", "8x8x8", "-o", str(tmp_path / "cell.stl")]) == 0
    for name in ("struts and nodes tested for overlaps", "triangles written"):
        assert begun[name].done == begun[name].total > 8


def test_nothing_is_shown_of_short_stages_nor_in_a_pipe() -> None:
    for stream in (Terminal(), io.StringIO()):
        with Progress(stream).stage("solid", 100, "struts"):
            pass
        assert stream.getvalue() == ""


@pytest.mark.parametrize(
    ("options", "outcome"),
    [
        (["-o", "fat.step"], ": faces would cross; need struts apart"),
        (["-o", "fat.step", "--overlaps", "allow"], ": faces cross there"),
        (["-o", "fat.stl"], "; they are united"),
        (["-o", "fat.stl", "--round"], "; they are united"),
    ],
)
def test_overlapping_struts_are_told(
    options: list[str],
    outcome: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    command = ["lattice", "--cell", "octet", "--size", "8", "--radius", "1.6", "--box", "8"]
    assert main([*command, *options]) == (2 if options == ["-o", "fat.step"] else 0)
    told = capsys.readouterr().err
    assert "36 of 36 struts overlap others or their nodes (edges 0, 1, 2, 3, 4, ...; the" in told
    (line,) = [line for line in told.splitlines() if "struts overlap others" in line]
    assert outcome in line


@pytest.mark.parametrize("text", ["16x8x8", "16X8X8", "16,8,8"])
def test_boxes_are_written_with_x_or_commas(text: str, tmp_path: Path) -> None:
    out = tmp_path / "beams.json"
    assert main([*BCC, "--box", text, "--beams", "-o", str(out)]) == 0
    np.testing.assert_allclose(np.ptp(read_skeleton(out).nodes, axis=0), [16, 8, 8])


def test_a_single_number_is_a_cube(tmp_path: Path) -> None:
    out = tmp_path / "beams.json"
    assert main([*BCC, "--box", "16", "--beams", "-o", str(out)]) == 0
    np.testing.assert_allclose(np.ptp(read_skeleton(out).nodes, axis=0), 16)


def test_filled_parts_take_the_options_of_round_struts(tmp_path: Path) -> None:
    volumes = []
    for nodes in ("sharp", "blend"):
        out = tmp_path / f"{nodes}.stl"
        box = [*BCC, "--box", "16x16x16", "--skin", "1.2", "--round", "--sides", "16"]
        assert main([*box, "--nodes", nodes, "-o", str(out)]) == 0
        volumes.append(loaded(out).volume)
    assert volumes[0] < 0.999 * volumes[1]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("--sides 6", "--sides is 6; need a multiple of 4"),
        ("--ends open", "--ends is 'open' without a wall; need --wall, mm, or --ends flat"),
    ],
)
def test_values_of_round_struts_are_checked_before_any_are_made(
    words: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    box = ["--cell", "bcc", "--size", "5", "--radius", "0.4", "--box", "10", "--round"]
    assert main(["lattice", *box, *words.split(), "-o", str(tmp_path / "a.stl")]) == 2
    assert capsys.readouterr().err == f"scaffold-cad: {told}\n"
