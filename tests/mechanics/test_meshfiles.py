"""Hexahedra written through meshio and read back."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from scaffold_cad import Skeleton, build_scaffold
from scaffold_cad.errors import FormatError, MissingBackendError
from scaffold_cad.mechanics import Hexahedra, hexahedra, write_hexahedra

meshio = pytest.importorskip("meshio")


@pytest.fixture(scope="module")
def mesh() -> Hexahedra:
    tripod = Skeleton([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]], [[0, 1], [0, 2], [0, 3]], 1.0)
    return hexahedra(build_scaffold(tripod, collars=True))


@pytest.mark.parametrize("ending", ["inp", "msh", "vtu", "bdf"])
def test_what_is_written_is_what_is_read(mesh: Hexahedra, ending: str, tmp_path: Path) -> None:
    write_hexahedra(mesh, tmp_path / f"tripod.{ending}")
    back = meshio.read(tmp_path / f"tripod.{ending}")
    np.testing.assert_allclose(back.points, mesh.points, atol=1e-6)
    cells = np.concatenate([block.data for block in back.cells if block.type == "hexahedron"])
    np.testing.assert_array_equal(cells, mesh.hexahedra)


def test_abaqus_sets_are_those_of_struts_nodes_and_ends(mesh: Hexahedra, tmp_path: Path) -> None:
    write_hexahedra(mesh, tmp_path / "tripod.inp")
    back = meshio.read(tmp_path / "tripod.inp")
    for edge in range(3):
        np.testing.assert_array_equal(
            back.cell_sets[f"STRUT_{edge}"][0], np.flatnonzero(mesh.edge_of_hexahedron == edge)
        )
        np.testing.assert_array_equal(
            back.point_sets[f"END_{edge + 1}"], np.flatnonzero(mesh.end_of_point == edge + 1)
        )
    assert len(back.cell_sets["NODE_0"][0]) == 12


def test_gmsh_groups_are_struts_and_the_faces_of_ends(mesh: Hexahedra, tmp_path: Path) -> None:
    write_hexahedra(mesh, tmp_path / "tripod.msh")
    back = meshio.read(tmp_path / "tripod.msh")
    assert {"STRUT_0", "STRUT_2", "END_1", "END_3"} <= set(back.field_data)
    number, dimension = back.field_data["END_2"]
    assert dimension == 2
    faces = back.cells_dict["quad"]
    chosen = faces[back.cell_data_dict["gmsh:physical"]["quad"] == number]
    corners = back.points[chosen]  # (4, 4, 3): four faces per section
    np.testing.assert_allclose(corners[..., 1], 9.0)
    a, b, c, d = np.moveaxis(corners, 1, 0)
    areas = np.linalg.norm(np.cross(c - a, d - b), axis=1) / 2
    assert areas.sum() == pytest.approx(np.pi, rel=1e-9)
    struts = back.cell_data_dict["gmsh:physical"]["hexahedron"]
    np.testing.assert_array_equal(struts, mesh.edge_of_hexahedron + 1)


def test_nastran_sets_are_those_of_nodes_and_ends(mesh: Hexahedra, tmp_path: Path) -> None:
    write_hexahedra(mesh, tmp_path / "tripod.bdf")
    control = (tmp_path / "tripod.bdf").read_text().split("BEGIN BULK")[0]
    assert max(map(len, control.splitlines())) <= 72
    sets = {}
    for part in control.split("$ ")[1:]:
        name, text = part.split("\n", 1)
        sets[name] = [int(word) - 1 for word in text.split("=")[1].split(",")]
    assert sets["END_3"] == np.flatnonzero(mesh.end_of_point == 3).tolist()
    assert sets["NODE_0"] == np.flatnonzero(mesh.node_of_hexahedron == 0).tolist()


@pytest.mark.skipif(shutil.which("ccx") is None, reason="needs CalculiX")
def test_calculix_bends_an_arm_as_beams_do(tmp_path: Path) -> None:
    arm = Skeleton([[0, 0, 0], [60, 0, 0]], [[0, 1]], 3.0)
    write_hexahedra(hexahedra(build_scaffold(arm), layers=1, along=20), tmp_path / "arm.inp")
    deck = (tmp_path / "arm.inp").read_text()
    tip = deck.split("*NSET, NSET=END_1\n")[1].replace("\n", ", ").split(", ")
    count = len([word for word in tip if word])
    deck += "*MATERIAL, NAME=M1\n*ELASTIC\n1000., 0.3\n*SOLID SECTION, ELSET=EALL, MATERIAL=M1\n"
    deck += "*BOUNDARY\nEND_0, 1, 3\n*STEP\n*STATIC\n"
    deck += f"*CLOAD\nEND_1, 3, {1 / count:.12g}\n*NODE PRINT, NSET=END_1\nU\n*END STEP\n"
    (tmp_path / "arm.inp").write_text(deck)
    done = subprocess.run(
        ["ccx", "arm"], cwd=tmp_path, capture_output=True, text=True, timeout=100, check=False
    )
    assert "ERROR" not in done.stdout
    rows = [line.split() for line in (tmp_path / "arm.dat").read_text().splitlines()]
    sags = [float(row[3]) for row in rows if len(row) == 4]
    bent = 60**3 / (3 * 1000 * np.pi / 4 * 3**4)  # F L³ / 3 E I, F = 1 N
    assert np.mean(sags) == pytest.approx(bent, rel=0.03)


def test_paraview_file_holds_quality(mesh: Hexahedra, tmp_path: Path) -> None:
    write_hexahedra(mesh, tmp_path / "tripod.vtu")
    back = meshio.read(tmp_path / "tripod.vtu")
    np.testing.assert_allclose(back.cell_data["quality"][0], mesh.quality)


def test_unknown_ending_is_refused(mesh: Hexahedra, tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"'.stl'; meshes for analysis need one of .inp"):
        write_hexahedra(mesh, tmp_path / "tripod.stl")


def test_missing_meshio_is_named(
    mesh: Hexahedra, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("scaffold_cad.base.backends.find_spec", lambda name: None)
    with pytest.raises(MissingBackendError, match="needs meshio; run: pip install meshio"):
        write_hexahedra(mesh, tmp_path / "tripod.vtu")
