"""Gmsh and MED meshes, which meshio reads."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw
from tests.fuzz.members import CORNERS, GMSH
from tests.io.test_members import sizes
from tests.io.test_reading import written


def test_data_called_radius_are_radii_and_quadratic_lines_are_two_edges(tmp_path: Path) -> None:
    points = np.concatenate([CORNERS, [[10, 5, 0]]])
    cells = [("line", np.array([[0, 1]])), ("line3", np.array([[1, 2, 3]]))]
    data = {"radius": [np.array([0.5]), np.array([0.75])]}
    path = tmp_path / "x.msh"
    meshio.gmsh.write(
        path, meshio.Mesh(points, cells, cell_data=data), binary=True, fmt_version="2.2"
    )
    raw = read_raw(path)
    assert raw.edges.tolist() == [[0, 1], [1, 3], [3, 2]]
    np.testing.assert_allclose(sizes(raw), [0.5, 0.75, 0.75, 0.75])


def test_points_that_no_line_uses_are_left_out(tmp_path: Path) -> None:
    cells = [("line", np.array([[1, 2]])), ("triangle", np.array([[0, 1, 2]]))]
    path = tmp_path / "x.msh"
    meshio.gmsh.write(path, meshio.Mesh(CORNERS, cells), binary=False, fmt_version="2.2")
    assert read_raw(path).nodes.tolist() == CORNERS[1:].tolist()


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
    with pytest.raises(FormatError, match=r"x\.m\w\w (is no sound file|cannot be read): .*; need"):
        read_raw(written(tmp_path, name, content))
    assert capfd.readouterr().out == ""
