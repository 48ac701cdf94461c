"""`scaffold-cad build --as hexahedra`: meshes for finite elements, read back by meshio."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

from scaffold_cad import Skeleton, write
from scaffold_cad.cli import main

TRIPOD = Skeleton([[0, 0, 0], [30, 0, 9], [0, 30, 9], [0, 0, 30]], [[0, 1], [0, 2], [0, 3]], 2.0)


@pytest.fixture
def tripod(tmp_path: Path) -> str:
    write(TRIPOD, tmp_path / "tripod.json")
    return str(tmp_path / "tripod.json")


def determinants(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Return the Jacobian's determinants at the corners of hexahedra, (h, 8)."""
    beside = [
        [1, 3, 4],
        [2, 0, 5],
        [3, 1, 6],
        [0, 2, 7],
        [7, 5, 0],
        [4, 6, 1],
        [5, 7, 2],
        [6, 4, 3],
    ]
    corners = points[cells]  # (h, 8, 3)
    return np.linalg.det(corners[:, beside] - corners[:, :, None])


@pytest.mark.parametrize("suffix", ["inp", "bdf", "msh", "vtu"])
@pytest.mark.parametrize(
    "options", [[], ["--collars", "--along", "3"], ["--round", "--sides", "8", "--keep", "volume"]]
)
def test_struts_become_hexahedra_in_each_format(
    suffix: str, options: list[str], tripod: str, tmp_path: Path
) -> None:
    out = tmp_path / f"out.{suffix}"
    assert main(["build", tripod, "--as", "hexahedra", *options, "-o", str(out)]) == 0
    mesh = meshio.read(out)
    cells = mesh.cells_dict["hexahedron"]
    assert len(cells) >= 12
    assert (determinants(mesh.points, cells) > 0).all()
    assert np.unique(cells).tolist() == list(range(len(mesh.points)))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--as hexahedra -o a.stl", "hexahedra are written as .inp, .bdf, .msh, .vtu"),
        ("-o a.inp", "its format holds hexahedra (--as hexahedra), no surface"),
        ("--along 3 -o a.stl", "--along is of hexahedra; need --as hexahedra"),
        ("--as hexahedra --along 0 -o a.inp", "--along is 0; need 1 or more"),
        ("--as hexahedra --layers -1 -o a.inp", "--layers is -1; need 0 or more"),
        ("--as hexahedra --round --wall 1 -o a.inp", "--wall is for solids"),
        ("--as hexahedra --overlaps unite -o a.inp", "--overlaps is for solids"),
        ("--as hexahedra --tiles t -o a.inp", "--tiles is for solids of struts"),
    ],
)
def test_what_hexahedra_have_no_use_for_is_refused(
    words: str,
    message: str,
    tripod: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["build", tripod, *words.split()]) == 2
    assert message in capsys.readouterr().err
    assert not list(tmp_path.glob("a.*"))
