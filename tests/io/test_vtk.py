from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw
from tests.fuzz.samples import POINTS, SAMPLES, VTK_5, VTK_TEXT, VTU
from tests.io.test_reading import written

PATHS = ("text.vtk", "text.vtp", "base64.vtp", "packed.vtp", "raw.vtp")


@pytest.mark.parametrize("name", PATHS)
def test_all_dialects_hold_the_same(tmp_path: Path, name: str) -> None:
    raw = read_raw(written(tmp_path, name, SAMPLES[name]))
    np.testing.assert_array_equal(raw.nodes, POINTS)
    assert raw.edges.tolist() == [[0, 1], [1, 2], [2, 3]]
    assert raw.radii is not None
    assert raw.radii.tolist() == [1, 1.5, 2, 1]


@pytest.mark.parametrize(
    ("name", "radii"), [("version_5.vtk", [1, 2, 3]), ("binary.vtk", [1, 2, 1])]
)
def test_other_kinds_of_cells(tmp_path: Path, name: str, radii: list[float]) -> None:
    raw = read_raw(written(tmp_path, name, SAMPLES[name]))
    np.testing.assert_array_equal(raw.nodes, POINTS[:3])
    assert raw.edges.tolist() == [[0, 1], [1, 2]]
    assert raw.radii is not None
    assert raw.radii.tolist() == radii


def test_cells_that_are_no_lines_are_left_out(tmp_path: Path) -> None:
    raw = read_raw(written(tmp_path, "cells.vtu", VTU))
    assert raw.edges.tolist() == [[0, 1], [1, 2]]
    assert raw.radii is None


def test_pieces_are_put_together(tmp_path: Path) -> None:
    start, stop = VTU.index(b"<Piece"), VTU.index(b"</Unstr")
    twice = VTU[:stop] + VTU[start:stop] + VTU[stop:]
    raw = read_raw(written(tmp_path, "two.vtu", twice))
    assert raw.edges.tolist() == [[0, 1], [1, 2], [3, 4], [4, 5]]


def test_other_data_is_skipped(tmp_path: Path) -> None:
    other = "POINT_DATA 4\nVECTORS v float\n" + "1 2 3\n" * 4 + "COLOR_SCALARS c 2\n" + "0 1\n" * 4
    other += "TEXTURE_COORDINATES t 2 float\n" + "0 1\n" * 4 + "LOOKUP_TABLE l 1\n0 0 0 1\n"
    text = VTK_TEXT.decode().replace("POINT_DATA 4\n", other)
    raw = read_raw(written(tmp_path, "more.vtk", text))
    assert raw.radii is not None
    assert raw.radii.tolist() == [1, 1.5, 2, 1]


@pytest.mark.parametrize(
    ("content", "old", "new", "message"),
    [
        (VTK_TEXT, "POLYDATA", "STRUCTURED_GRID", "line 4: .*; need DATASET POLYDATA"),
        (VTK_TEXT, "3 0 1 2\n2", "3 0 1 2\n9", "has no whole cell 1"),
        (VTK_TEXT, "LINES 2 7", "LINES 1 7", "has 7 numbers of cells; need 4"),
        (VTK_TEXT, "2 2 3", "2 2 7", "has a line through point 7; need 0 to 3"),
        (VTK_TEXT, "10 10 0 10", "10 10 0 x", "has 'x' as a number; need 12 numbers"),
        (VTK_TEXT, "LINES 2 7", "ROPES 2 7", "line 8: 'ROPES 2 7'; need a section"),
        (VTK_TEXT, "1 1.5 2 1\n", "1 1.5\n", "ends within 4 numbers"),
        (VTK_5, "0 3\n", "0 4\n", "has cells that end out of order; need ends up to 3"),
        (VTK_5, "CONNECTIVITY", "CONNECTED", "need CONNECTIVITY after OFFSETS"),
        (VTU, "2 5 7", "2 5", "has cells that end out of order"),
        (VTU, "3 5 3", "3 5", "has 2 types of 3 cells; need as many"),
        (VTU, 'NumberOfPoints="3"', 'NumberOfPoints="4"', "has 3 points; need 4"),
        (VTU, "9 9 0<", "9 9<", "has 8 coordinates; need 3 per point"),
        (VTU, "9 9 0<", "9 9 x<", "has 'x' as a number; need numbers in the array 'of points'"),
        (VTU, "9 9 0<", "9 9 1_0<", "has '1_0' as a number; need numbers in the array"),
        (VTU, "Float32", "Float16", "has numbers of type 'Float16'"),
        (VTU, "0 1 0 1 2 1 2", "0 1 0 1 2 1.5 2", r"has the index 1\.5; need a whole number"),
        (VTU, "UnstructuredGrid", "ImageData", "holds ImageData; need PolyData"),
        (VTU, "offsets", "sizes", "has no Cells/DataArray.*offsets"),
        (SAMPLES["packed.vtp"], "ZLib", "LZ4", "is packed by vtkLZ4DataCompressor; need vtkZLib"),
    ],
)
def test_errors_name_what_is_wrong(
    tmp_path: Path, content: bytes, old: str, new: str, message: str
) -> None:
    changed = content.replace(old.encode(), new.encode())
    assert changed != content
    suffix = "vtk" if content.startswith(b"#") else "vtu"
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, f"bad.{suffix}", changed))
