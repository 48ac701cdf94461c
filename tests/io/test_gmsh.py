"""Gmsh and MED meshes, which meshio reads."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw
from tests.fuzz.members import CORNERS, GMSH
from tests.io.test_reading import written


@pytest.mark.usefixtures("in_this_process")
def test_data_of_cells_called_radius_are_their_radii(tmp_path: Path) -> None:
    cells = [("line", np.array([[0, 1], [1, 2]]))]
    data = {"radius": [np.array([0.5, 0.75])]}
    path = tmp_path / "x.msh"
    mesh = meshio.Mesh(CORNERS, cells, cell_data=data)
    meshio.gmsh.write(path, mesh, binary=True, fmt_version="2.2")
    raw = read_raw(path)
    assert raw.edge_radii is not None
    assert raw.edge_radii.tolist() == [[0.5, 0.5], [0.75, 0.75]]


@pytest.mark.usefixtures("in_this_process")
def test_a_quadratic_line_is_two_edges(tmp_path: Path) -> None:
    points = np.concatenate([CORNERS, [[10, 5, 0]]])
    mesh = meshio.Mesh(points, [("line3", np.array([[1, 2, 3]]))])
    meshio.gmsh.write(tmp_path / "x.msh", mesh, binary=False, fmt_version="2.2")
    assert read_raw(tmp_path / "x.msh").edges.tolist() == [[0, 2], [2, 1]]


@pytest.mark.usefixtures("in_this_process")
def test_points_that_no_line_uses_are_left_out(tmp_path: Path) -> None:
    cells = [("line", np.array([[1, 2]])), ("triangle", np.array([[0, 1, 2]]))]
    path = tmp_path / "x.msh"
    meshio.gmsh.write(path, meshio.Mesh(CORNERS, cells), binary=False, fmt_version="2.2")
    assert read_raw(path).nodes.tolist() == CORNERS[1:].tolist()


@pytest.mark.usefixtures("in_this_process")
def test_a_mesh_without_lines_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "x.msh"
    mesh = meshio.Mesh(CORNERS, [("triangle", np.array([[0, 1, 2]]))])
    meshio.gmsh.write(path, mesh, binary=False, fmt_version="2.2")
    with pytest.raises(FormatError, match=r"x\.msh has no line elements; need at least one"):
        read_raw(path)


@pytest.mark.parametrize("name", ["x.msh", "x.med"])
def test_a_damaged_file_is_refused_and_nothing_is_printed(
    tmp_path: Path, name: str, capfd: pytest.CaptureFixture[str]
) -> None:
    content = GMSH[: len(GMSH) // 2] if name == "x.msh" else b"\x89HDF\r\n\x1a\nand no more"
    with pytest.raises(
        FormatError,
        match=r"x\.m\w\w (is not a sound file|cannot be read|has no \$End\w+): .*; need",
    ):
        read_raw(written(tmp_path, name, content))
    assert capfd.readouterr().out == ""
