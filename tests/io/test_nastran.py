from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw
from tests.io.test_members import sizes
from tests.io.test_reading import written

GRIDS = "GRID,1,,0.,0.,0.\nGRID,2,,9.,0.,0.\n"


@pytest.mark.parametrize(
    ("cards", "radius"),
    [
        ("CONROD,1,1,2,9,3.141592653589793\n", 1),
        ("CBAR,1,5,1,2\nPBAR,5,9,12.566370614359172\n", 2),
        ("CBEAM,1,5,1,2\nPBEAML,5,9,,TUBE\n,1.5,1.\n", 1.5),
        ("CBAR,1,5,1,2\nPBARL,5,9,,BAR\n,3.141592653589793,4.\n", 2),
        ("CTUBE,1,5,1,2\nPTUBE,5,9,3.,.1\n", 1.5),
        ("CROD,5,,1,2\nPROD,5,9,3.141592653589793\n", 1),
    ],
)
def test_radii_come_from_properties(tmp_path: Path, cards: str, radius: float) -> None:
    raw = read_raw(written(tmp_path, "x.bdf", GRIDS + cards))
    assert raw.edges.tolist() == [[0, 1]]
    np.testing.assert_allclose(sizes(raw), radius)


@pytest.mark.parametrize(
    ("text", "value"), [("7.", 7), (".7+1", 7), ("70.-1", 7), ("7.0D0", 7), ("-7", -7), ("", 0)]
)
def test_numbers_may_lack_their_e(tmp_path: Path, text: str, value: float) -> None:
    lines = f"GRID,1,,{text},0.,0.\nGRID,2,,9.,9.,0.\nCROD,1,1,1,2\n"
    assert read_raw(written(tmp_path, "x.bdf", lines)).nodes[0, 0] == value


@pytest.mark.parametrize(
    "entry",
    [
        "GRID*,1,,1.,2.\n*,3.\n",
        "GRID*,1,,1.,2.,*G1\n*G1,3.\n",
        f"{'GRID*':8}{1:16}{'':16}{1.0:16}{2.0:16}*G1\n{'*G1':8}{3.0:16}\n",
        f"{'GRID*':8}{1:16}{'':16}{1.0:16}{2.0:16}\n{'*':8}{3.0:16}\n",
        f"{'GRID':8}{1:8}{'':8}{1.0:8}{2.0:8}{3.0:8}\n",
    ],
)
def test_wide_fields_go_on_in_the_next_line(tmp_path: Path, entry: str) -> None:
    raw = read_raw(written(tmp_path, "x.bdf", entry + "GRID,2,,9.,0.,0.\nCROD,1,1,1,2\n"))
    assert raw.nodes[0].tolist() == [1, 2, 3]


def test_a_file_that_is_included_is_named(tmp_path: Path, caplog) -> None:
    read_raw(written(tmp_path, "x.bdf", "INCLUDE 'more.bdf'\n" + GRIDS + "CROD,1,1,1,2\n"))
    assert "line 1: the file included is not read" in caplog.text


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("GRID,1,4,0.,0.,0.\n", "line 1: a node in the coordinate system 4; need the basic one, 0"),
        ("GRDSET,,4\nGRID,1,,0.,0.,0.\n", "line 1: a node in the coordinate system 4; need"),
        ("GRID,1,,x,0.,0.\n", "line 1: field 4 is 'x'; need a number"),
        ("GRID,one,,0.,0.,0.\n", "line 1: field 2 is 'one'; need a whole number"),
        (GRIDS + "CROD,1,1,1,7\n", "line 3: an edge has the end 7; need a node of the file"),
        (
            "BEGIN BULK\n" + GRIDS + "CROD,1,1,1\nENDDATA\n",
            "line 4: field 5 is ''; need a whole number",
        ),
        ("BEGIN BULK\n" + GRIDS, "does not end with ENDDATA: need the whole file"),
        ("CROD,1,1,1,2\n", "line 1: an edge has the end 1; need a node"),
    ],
)
def test_errors_name_the_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, "x.bdf", text))


def test_a_shape_without_a_radius_is_named(tmp_path: Path, caplog) -> None:
    text = GRIDS + "CBAR,1,5,1,2\nPBARL,5,9,,I\n,1.,2.\n"
    assert read_raw(written(tmp_path, "x.bdf", text)).has_radii is False
    assert "line 4: a section I has no known radius" in caplog.text
