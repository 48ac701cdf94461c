"""Beam models written for other programs, and solved by them where they are installed."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from scaffold_cad import Skeleton
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.lattice import tile
from scaffold_cad.mechanics import BeamModel, Load, Material, Support, beam_model, write_beams
from tests.mechanics.peers import calculix_displacements, opensees_displacements

STEEL = Material(210e3, 0.3, 7850.0, 235.0)


def block(count: int = 1, radius: float = 0.4) -> BeamModel:
    top = 10.0 * count
    return beam_model(
        tile("bccz", 10.0, (count, count, count), radius=radius),
        STEEL,
        Support(lambda nodes: nodes[:, 2] < 0.1),
        Load(lambda nodes: nodes[:, 2] > top - 0.1, (5, 0, -10), each=True),
    )


@pytest.mark.parametrize("count", [1, 3])
def test_opensees_finds_the_same_displacements(count: int, tmp_path: Path) -> None:
    model = block(count)
    write_beams(model, tmp_path / "block.tcl")
    theirs = opensees_displacements(tmp_path / "block.tcl", len(model.skeleton.nodes))
    ours = model.solved()
    scale = ours.largest_displacement
    np.testing.assert_allclose(theirs[:, :3], ours.displacements, rtol=0, atol=1e-6 * scale)
    np.testing.assert_allclose(
        theirs[:, 3:], ours.rotations, rtol=0, atol=1e-6 * np.abs(ours.rotations).max()
    )


@pytest.mark.parametrize("hollow", [0.0, 0.7])
def test_opensees_finds_the_same_of_an_uneven_frame_under_its_weight(
    hollow: float, tmp_path: Path
) -> None:
    rng = np.random.default_rng(3)
    edges = [[0, 1], [1, 2], [2, 3], [3, 0], [1, 3], [3, 4], [0, 5], [5, 2]]
    frame = Skeleton(rng.uniform(0, 90, (6, 3)), edges, edge_radii=rng.uniform(1, 4, len(edges)))
    model = beam_model(frame, STEEL, Support([0, 2]), gravity=(4e3, 0, -9e3), hollow=hollow)
    write_beams(model, tmp_path / "frame.tcl")
    theirs = opensees_displacements(tmp_path / "frame.tcl", len(frame.nodes))
    ours = model.solved()
    found = np.concatenate([ours.displacements, ours.rotations], axis=1)
    np.testing.assert_allclose(theirs, found, rtol=1e-9, atol=1e-9 * np.abs(found).max())


@pytest.mark.parametrize("count", [5, 10])
def test_opensees_finds_the_same_of_1000_and_of_8000_struts(count: int, tmp_path: Path) -> None:
    top = 10.0 * count
    model = beam_model(
        tile("bcc", 10.0, (count, count, count), radius=0.4),
        STEEL,
        Support(lambda nodes: nodes[:, 2] < 0.1),
        Load(lambda nodes: nodes[:, 2] > top - 0.1, (0, 0, -1), each=True),
    )
    assert len(model.skeleton.edges) == 8 * count**3
    write_beams(model, tmp_path / "block.tcl")
    theirs = opensees_displacements(tmp_path / "block.tcl", len(model.skeleton.nodes))
    ours = model.solved()
    np.testing.assert_allclose(
        theirs[:, :3], ours.displacements, rtol=0, atol=1e-6 * ours.largest_displacement
    )


@pytest.mark.skipif(shutil.which("ccx") is None, reason="needs CalculiX")
@pytest.mark.parametrize("hollow", [0.0, 0.6])
def test_calculix_finds_the_cantilever(hollow: float, tmp_path: Path) -> None:
    arm = Skeleton(np.outer(np.arange(11), [10.0, 0, 0]), [[k, k + 1] for k in range(10)], 5.0)
    model = beam_model(
        arm, STEEL, Support([0]), Load([10], (20, 0, -100)), gravity=(0, 0, -9810), hollow=hollow
    )
    write_beams(model, tmp_path / "arm.inp")
    found = calculix_displacements(tmp_path / "arm.inp")
    expected = model.solved().displacements[10]
    # CalculiX turns beams into bricks whose round section is not quite one.
    assert found[11][2] == pytest.approx(expected[2], rel=0.04)


@pytest.mark.skipif(shutil.which("ccx") is None, reason="needs CalculiX")
def test_calculix_finds_the_cell_of_one_beam_a_strut(tmp_path: Path) -> None:
    model = block()
    write_beams(model, tmp_path / "cell.inp")
    found = calculix_displacements(tmp_path / "cell.inp")
    ours = model.solved()
    theirs = np.array([found[k + 1] for k in range(len(ours.displacements))])
    np.testing.assert_allclose(
        theirs, ours.displacements, rtol=0, atol=0.05 * ours.largest_displacement
    )


def test_cones_of_calculix_have_four_radii(tmp_path: Path) -> None:
    cone = Skeleton([[0, 0, 0], [40, 0, 0]], [[0, 1]], edge_radii=[[2.0, 1.0]])
    write_beams(beam_model(cone, STEEL, Support([0])), tmp_path / "cone.inp")
    deck = (tmp_path / "cone.inp").read_text()
    sizes = re.findall(r"SECTION=CIRC.*\n([\d.]+),", deck)
    assert sorted(map(float, sizes)) == [2.25, 2.75, 3.25, 3.75]
    assert "1, 1, 3, 4\n" in deck
    assert "4, 8, 9, 2\n" in deck


def test_nastran_cards_hold_the_model(tmp_path: Path) -> None:
    model = beam_model(
        Skeleton([[0, 0, 0], [0, 1 / 3, 50]], [[0, 1]], edge_radii=[[2.0, 1.0]]),
        STEEL,
        Support([0]),
        Load([1], (1, 2, 3), (4, 0, 0)),
        gravity=(0, 0, -9.81),
    )
    write_beams(model, tmp_path / "arm.bdf")
    text = (tmp_path / "arm.bdf").read_text()
    assert "PBEAML,1,1,,ROD\n,2.,0.0,YES,1.0,1.,0.0" in text
    assert "CBEAM,1,1,1,2,1.0,0.0,0.0" in text
    assert text.count("SPC,1,1,") == 6
    grid = next(line for line in text.splitlines() if line.startswith("GRID*"))
    fields = [grid[k : k + 16] for k in range(8, 72, 16)]
    assert [int(fields[0]), float(fields[2]), float(fields[3])] == [1, 0.0, 0.0]
    assert all(len(line) <= 72 for line in text.splitlines())


def test_paraview_file_holds_results(tmp_path: Path) -> None:
    meshio = pytest.importorskip("meshio")
    solution = block().solved()
    write_beams(solution, tmp_path / "block.vtu")
    mesh = meshio.read(tmp_path / "block.vtu")
    np.testing.assert_allclose(mesh.point_data["displacement"], solution.displacements)
    np.testing.assert_allclose(mesh.cell_data["utilization"][0], solution.utilization)
    np.testing.assert_array_equal(mesh.cells[0].data, solution.model.skeleton.edges)


def test_unknown_endings_and_kinds_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"its suffix is '.doc'; beams need one of .inp"):
        write_beams(block(), tmp_path / "block.doc")
    with pytest.raises(OptionError, match="need a BeamModel or a BeamSolution"):
        write_beams(block().skeleton, tmp_path / "block.inp")  # type: ignore[arg-type]


def test_tapers_that_a_format_does_not_hold_are_told(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    cone = Skeleton([[0, 0, 0], [100, 0, 0]], [[0, 1]], [5.0, 4.0])
    model = beam_model(cone, "steel", Support([0]), Load([1], (0, 0, -100)))
    for ending, lost in ((".inp", 0), (".bdf", 0), (".tcl", 1)):
        caplog.clear()
        write_beams(model, tmp_path / f"cone{ending}")
        told = f"cone{ending} holds a radius for each member, the mean of both ends: 1 taper lost"
        assert caplog.messages == lost * [told]
