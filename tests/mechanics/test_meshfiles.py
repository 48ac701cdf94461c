"""Hexahedra written through meshio and read back."""

from __future__ import annotations

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


def test_paraview_file_holds_quality(mesh: Hexahedra, tmp_path: Path) -> None:
    write_hexahedra(mesh, tmp_path / "tripod.vtu")
    back = meshio.read(tmp_path / "tripod.vtu")
    np.testing.assert_allclose(back.cell_data["quality"][0], mesh.quality)


def test_unknown_ending_is_refused(mesh: Hexahedra, tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"cannot write a mesh as '.stl'; need one of .inp"):
        write_hexahedra(mesh, tmp_path / "tripod.stl")


def test_missing_meshio_is_named(
    mesh: Hexahedra, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("scaffold_cad.base.backends.find_spec", lambda name: None)
    with pytest.raises(MissingBackendError, match="needs meshio; run: pip install meshio"):
        write_hexahedra(mesh, tmp_path / "tripod.vtu")
