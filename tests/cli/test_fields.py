"""Numbers of the command line that a file holds for each place."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from scaffold_cad import Skeleton, read_skeleton, write
from scaffold_cad.cli import main
from scaffold_cad.io import read_triangles

ROWS = "x,y,z,value\n0,0,0,0.4\n20,0,0,0.8\n"
"""Two places: what is nearer to the one has its number."""

STRUT = Skeleton([[0, 0, 0], [10, 0, 0], [20, 0, 0]], [[0, 1], [1, 2]], 0.2)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    corners = [f"{x},{y},{z},{0.4 + x / 50}" for x in (0, 20) for y in (0, 20) for z in (0, 20)]
    Path("linear.csv").write_text("\n".join(corners))
    Path("values.csv").write_text(ROWS)
    Path("sizes.txt").write_text("0 0 0 4\n20 0 0 7\n")
    write(STRUT, "strut.json")
    return tmp_path


def beams(line: str) -> Skeleton:
    assert main([*f"lattice {line}".split(), "--beams", "-o", "out.json"]) == 0
    return read_skeleton("out.json", strict=True)


@pytest.mark.parametrize("what", ["--cell bcc --size 5", "--foam voronoi --size 5"])
def test_radii_of_lattices_are_those_of_a_file(what: str) -> None:
    graded = beams(f"{what} --box 20 --radius linear.csv")
    np.testing.assert_allclose(graded.radii, 0.4 + graded.nodes[:, 0] / 50, rtol=1e-5)


def test_radii_of_skeletons_are_those_of_a_file_in_mm() -> None:
    convert = "convert strut.json --radius values.csv -o out.json"
    assert main([*convert.split(), "--turn", "z:90"]) == 0
    assert read_skeleton("out.json").radii.tolist()[::2] == [0.4, 0.8]
    assert main([*convert.split(), "--scale", "0.1"]) == 0
    assert read_skeleton("out.json").radii.tolist() == [0.4, 0.4, 0.4]


def lengths_at_ends(lattice: Skeleton) -> tuple[float, float]:
    middle = lattice.nodes[lattice.edges].mean(axis=1)[:, 0]
    low = float(np.median(lattice.lengths[middle < 8]))
    return low, float(np.median(lattice.lengths[middle > 12]))


@pytest.mark.parametrize(
    "line",
    [
        "--cell bcc --box 20",
        "--cell bcc --inside box.stl",
        "--foam voronoi --regularity 0.6 --box 20",
    ],
)
def test_cells_are_as_large_as_a_file_asks(line: str) -> None:
    build_box("box.stl")
    low, high = lengths_at_ends(beams(f"{line} --size sizes.txt --radius 0.2"))
    assert high > 1.1 * low


def test_cells_on_a_tube_are_as_large_as_a_file_asks() -> None:
    Path("heights.txt").write_text("0 0 0 3\n0 0 20 6\n")
    tube = beams("--cell bcc --cylinder 5x20x5 --size heights.txt --radius 0.2")
    steps = np.diff(np.unique(tube.nodes[:, 2].round(6)))
    assert steps[-1] > 1.4 * steps[0]


def build_box(path: str) -> None:
    trimesh.creation.box(bounds=[[0, 0, 0], [20, 20, 20]]).export(path)


def test_graded_cells_are_cut_flush_and_sliced() -> None:
    line = "lattice --cell bcc --size sizes.txt --radius 0.5 --box 20"
    assert main(f"{line} --trim -o flush.stl".split()) == 0
    mesh = read_triangles("flush.stl")
    assert mesh is not None
    assert np.ptp(mesh.vertices, axis=0) == pytest.approx([20, 20, 20], abs=1e-4)
    assert main(f"{line} --layer 2 -o flush.cli".split()) == 0
    assert main(f"{line} --skin 1 -o core.stl".split()) == 0
    core = read_triangles("core.stl")
    assert core is not None
    # Of the lattice, what is within 1 mm of the faces is in the skin: more than its share.
    assert 20**3 - 18**3 < core.signed_volume < 20**3 - 18**3 + mesh.signed_volume


def test_fillets_are_those_of_a_file() -> None:
    star = Skeleton([[0, 0, 0], [20, 0, 0], [0, 20, 0], [0, 0, 20]], [[0, 1], [0, 2], [0, 3]], 1.0)
    write(star, "star.json")
    volumes = []
    for blend in ("0.3", "blend.csv", "1.5"):
        Path("blend.csv").write_text("0,0,0,1.5\n")
        assert main(f"build star.json --round --blend {blend} -o star.stl".split()) == 0
        mesh = read_triangles("star.stl")
        assert mesh is not None
        volumes.append(mesh.signed_volume)
    assert volumes[0] < volumes[1] == volumes[2]


def test_one_of_several_fields_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    pyvista = pytest.importorskip("pyvista")
    image = pyvista.ImageData(dimensions=(3, 3, 3), spacing=(10, 10, 10))
    image.point_data["thick"] = np.full(27, 0.7)
    image.point_data["thin"] = np.full(27, 0.3)
    image.save("both.vti")
    assert np.allclose(beams("--cell bcc --size 5 --box 20 --radius both.vti:thin").radii, 0.3)
    line = "lattice --cell bcc --size 5 --box 20 --radius both.vti -o a.stl"
    assert main(line.split()) == 2
    assert "has the data 'thick', 'thin' in PointData; need FILE:NAME" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("--radius absent.vti --size 5", "absent.vti cannot be read: there is no such file"),
        ("--radius sizes.txt --size absent.csv", "absent.csv cannot be read: there is no such"),
        ("--radius bad.csv --size 5", "has radius -1 mm; need > 0"),
        ("--radius 1 --size bad.csv", "the cell size is -1 mm at"),
        ("--radius 1 --size sizes.txt --tiles t", "--tiles is for cells of one size; need --size"),
    ],
)
def test_fields_that_cannot_be_are_refused(
    line: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("bad.csv").write_text("0,0,0,-1\n")
    assert main(["lattice", "--cell", "bcc", "--box", "20", *line.split(), "-o", "a.stl"]) == 2
    assert message in capsys.readouterr().err.splitlines()[-1]


def test_what_is_neither_a_number_nor_a_file_is_refused(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(SystemExit):
        main(["build", "strut.json", "--radius", "thick", "-o", "a.stl"])
    assert "'thick' is not a number; need one, or a file of values: .vti" in capsys.readouterr().err
