"""`scaffold-cad lattice --foam`: the foams of Python, in boxes and parts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from scaffold_cad import Skeleton, delaunay_foam, fill, read_skeleton, voronoi_foam
from scaffold_cad.cli import main
from tests.cli.test_lattice import loaded

BOX = np.array([[0.0, 0.0, 0.0], [20.0, 20.0, 20.0]])
VORONOI = "lattice --foam voronoi --count 30 --radius 0.4"


def beams(folder: Path, line: str) -> Skeleton:
    out = folder / "foam.json"
    assert main([*line.split(), "--beams", "-o", str(out)]) == 0
    return read_skeleton(out, strict=True)


def same(one: Skeleton, other: Skeleton) -> bool:
    return len(one.nodes) == len(other.nodes) and np.allclose(one.nodes, other.nodes, atol=1e-5)


def test_foams_are_those_of_python(tmp_path: Path) -> None:
    foam = beams(tmp_path, f"{VORONOI} --box 20 --seed 4 --regularity 0.6")
    assert same(foam, voronoi_foam(30, BOX, 0.4, seed=4, regularity=0.6))
    assert not same(foam, beams(tmp_path, f"{VORONOI} --box 20 --seed 5 --regularity 0.6"))
    truss = beams(tmp_path, "lattice --foam delaunay --size 5 --radius 0.4 --box 20")
    assert same(truss, delaunay_foam(None, BOX, 0.4, size=5.0))


def test_cells_may_be_stretched_and_repeat(tmp_path: Path) -> None:
    foam = beams(tmp_path, f"{VORONOI} --box 20 --stretch 1,1,3 --periodic")
    wanted = voronoi_foam(30, BOX, 0.4, stretch=(1, 1, 3), periodic=True)
    assert same(foam, wanted)
    ends = [foam.nodes[np.isclose(foam.nodes[:, 0], x, atol=1e-6)] for x in (0, 20)]
    low, high = (np.array(sorted(side[:, 1:].round(5).tolist())) for side in ends)
    assert len(low) > 3
    np.testing.assert_allclose(low, high, atol=1e-4)


def test_a_foam_is_a_solid_of_square_or_round_struts(tmp_path: Path) -> None:
    volumes = []
    for words in ([], ["--round", "--sides", "8"]):
        out = tmp_path / "foam.stl"
        assert main([*VORONOI.split(), "--box", "20", *words, "-o", str(out)]) == 0
        volumes.append(loaded(out).volume)
    assert volumes[1] == pytest.approx(volumes[0] * np.pi / 4, rel=0.1)


def test_struts_at_the_surface_are_those_of_python(tmp_path: Path) -> None:
    line = f"{VORONOI} --box 20 --keep whole --no-dangling --shortest 1.5"
    wanted = voronoi_foam(30, BOX, 0.4, keep="whole", dangling=False, shortest=1.5)
    assert same(beams(tmp_path, line), wanted)
    cells = "lattice --cell diamond --size 7 --radius 0.4 --box 20"
    given = {"keep": "whole", "dangling": False}
    assert same(
        beams(tmp_path, f"{cells} --keep whole --no-dangling"),
        fill(BOX, "diamond", 7.0, 0.4, **given),  # type: ignore[arg-type]
    )
    assert same(
        beams(tmp_path, f"{cells} --shortest 2"), fill(BOX, "diamond", 7.0, 0.4, shortest=2.0)
    )


def test_a_part_is_filled_with_foam(tmp_path: Path) -> None:
    part = tmp_path / "ball.stl"
    trimesh.creation.icosphere(radius=10.0).export(part)
    foam = beams(tmp_path, f"{VORONOI} --inside {part}")
    away = np.linalg.norm(foam.nodes, axis=1)
    assert 9.5 < away.max() < 10.001
    assert foam.component_count == 1


def test_foams_become_layers_cut_flush_with_the_box(tmp_path: Path) -> None:
    out = tmp_path / "foam.svg"
    words = [*VORONOI.split(), "--box", "20", "--trim", "--layer", "2", "-o", str(out)]
    assert main(words) == 0
    assert out.read_text("utf-8").count("<g") >= 10


def test_foams_go_on_to_a_skin_or_the_faces_of_a_box(tmp_path: Path) -> None:
    trimmed, core = tmp_path / "trimmed.stl", tmp_path / "core.stl"
    line = "lattice --foam voronoi --size 8 --radius 0.5 --regularity 0.7 --box 20 --seed 2"
    foam = line.split()
    assert main([*foam, "--trim", "-o", str(trimmed)]) == 0
    assert main([*foam, "--skin", "1", "-o", str(core)]) == 0
    struts, part = (trimesh.load_mesh(path) for path in (trimmed, core))
    np.testing.assert_allclose(struts.bounds, BOX, rtol=0, atol=1e-5)
    assert struts.is_watertight
    shells = sorted(shell.volume for shell in part.split(only_watertight=False))
    assert shells[-1] == pytest.approx(8000, rel=1e-6)
    wall = 20**3 - 18**3
    assert wall < part.volume < wall + struts.volume


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("--foam voronoi --box 8", "--foam needs either the --count of its cells or their --size"),
        ("--foam voronoi --box 8 --count 9 --size 3", "--foam needs either the --count"),
        ("--foam voronoi --box 8 --size 3x3x4", "--stretch makes cells longer one way"),
        ("--foam voronoi --cylinder 9x9x3 --size 3", "--cylinder is for --cell"),
        ("--foam voronoi --box 8 --size 3 --periodic --trim", "--periodic is for struts alone"),
        ("--foam voronoi --box 8 --size 3 --periodic --skin 1", "--periodic is for struts alone"),
        ("--foam voronoi --box 8 --size 3 --trim --keep whole", "--keep is for struts alone"),
        ("--foam delaunay --box 8 --size 3 --no-dangling", "--no-dangling is not for --foam del"),
        ("--cell bcc --box 8 --size 3 --skin 1 --shortest 1", "--shortest is for struts alone"),
        ("--cell bcc --sphere 9x3 --size 3 --shortest 1", "--shortest is for a box or a part"),
        ("--cell bcc --box 8 --size 4 --layer 1 --keep whole", "--keep is not for layers of a box"),
        ("--foam voronoi --box 8 --size 3 --tiles tiles", "--tiles is for --cell"),
        ("--foam delaunay --box 8 --size 3 --periodic", "--periodic is for --foam voronoi"),
        ("--foam voronoi --inside part.stl --size 3 --periodic", "--periodic is for --foam"),
        ("--foam voronoi --box 8 --size 3 --regularity 2", "regularity is 2; need 0 to 0.7"),
        ("--foam voronoi --box 8 --count 0", "count is 0; need 1 or more"),
        ("--foam voronoi --box 20 --size 0.01", "need at most 2000000 nodes: to build them"),
        ("--cell bcc --box 8", "--cell needs the --size of a cell"),
        ("--cell bcc --box 8 --size 4 --seed 0", "--seed is for --foam"),
        ("--cell bcc --box 8 --size 4 --count 3", "--count is for --foam"),
        ("--cell bcc --box 8 --size 4 --layer 1 --nodes sharp", "--nodes is not for layers of a"),
    ],
)
def test_what_does_not_belong_to_foams_or_cells_is_refused(
    line: str,
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    out = "a.cli" if "--layer" in line else "a.stl"
    assert main(["lattice", "--radius", "0.4", *line.split(), "-o", out]) == 2
    (told,) = capsys.readouterr().err.splitlines()
    assert message in told
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("line", ["--cell bcc --foam voronoi", ""])
def test_either_a_cell_or_a_foam_is_needed(line: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["lattice", *line.split(), "--box", "8", "--radius", "1", "-o", "a.stl"])
    assert "--cell" in capsys.readouterr().err
