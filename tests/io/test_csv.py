from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scaffold_cad import write
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.io import read_raw, read_skeleton
from scaffold_cad.lattice import tile
from scaffold_cad.skeleton import Skeleton
from tests.io.test_members import sizes
from tests.io.test_reading import written


def test_members_of_nodes_are_found_in_the_file_beside(tmp_path: Path) -> None:
    written(tmp_path, "truss_nodes.csv", "node,x,y,z\nA,0,0,0\nB,9,0,0\nC,9,9,0\n")
    members = written(tmp_path, "truss_members.csv", "i,j,r\nA,B,1\nB,C,2\n")
    for path in (members, tmp_path / "truss_nodes.csv"):
        raw = read_raw(path)
        assert raw.edges.tolist() == [[0, 1], [1, 2]]
        assert sizes(raw).tolist() == [1, 2, 2]


@pytest.mark.parametrize(
    ("column", "value", "radius"),
    [
        ("radius", "2", 2),
        ("R [cm]", "2", 20),
        ("diameter", "3", 1.5),
        ("Area (cm^2)", "3.141592653589793", 10),
    ],
)
def test_sizes_may_be_radius_diameter_or_area_in_any_unit(
    tmp_path: Path, column: str, value: str, radius: float
) -> None:
    text = f"X1;Y1;X2;Y2;{column}\n0;0;9;0;{value}\n"
    raw = read_raw(written(tmp_path, "plane.csv", text))
    np.testing.assert_allclose(sizes(raw), radius)
    assert raw.nodes.tolist() == [[0, 0, 0], [9, 0, 0]]


def test_samples_without_branches_are_one_path_and_branches_lie_apart(tmp_path: Path) -> None:
    rows = "0,0,0,a\n9,0,0,a\n0,9,0,b\n9,9,0,b\n"
    path = written(tmp_path, "x.csv", "x,y,z,branch\n" + rows)
    assert read_raw(path).edges.tolist() == [[0, 1], [2, 3]]
    path = written(tmp_path, "x.csv", "x,y,z,note\n" + rows)
    assert read_raw(path).edges.tolist() == [[0, 1], [1, 2], [2, 3]]


def test_a_skeleton_reads_back_exactly(tmp_path: Path) -> None:
    lattice = tile("octet", 8.0, 1, radius=lambda points: 0.3 + points[:, 2] / 30)
    write(lattice, tmp_path / "octet.csv")
    again = read_skeleton(tmp_path / "octet.csv", strict=True)
    ours, theirs = lattice.nodes[lattice.edges], again.nodes[again.edges]
    np.testing.assert_array_equal(ours, theirs)
    np.testing.assert_array_equal(lattice.radii[lattice.edges], again.radii[again.edges])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1,2,3\n", r"x\.csv, line 1: '1,2,3' names no columns; need columns x1 y1 z1"),
        ("node,x,y,z\n1,0,0,0\n", r"x\.csv has nodes and no members; need start and end"),
        ("start,end\n1,2\n", r"x\.csv has members and no nodes; need a table of x, y, z"),
        ("x1,y1,z1,x2,y2,z2\n0,0,0,9,zero,0\n", r"x\.csv, line 2: y2 is 'zero'; need a number"),
        ("x1,y1,z1,x2,y2,z2\n0,0,0,9\n", r"x\.csv, line 2: y2 is ''; need a number"),
        ("node,x,y\n1,0,0\n1,9,0\n\ni,j\n1,1\n", r"line 3: node '1' is there already; need each"),
        ("node,x,y\n1,0,0\n2,9,0\n\ni,j\n1,7\n", r"line 6: an edge has the end '7'; need a node"),
        ("x1,y1,z1,x2,y2\n0,0,0,9,0\n", r"x\.csv has a column z1 and no column z2; need both"),
        ("x1,y1,x1,x2,y2\n0,0,9,9,0\n", r"x\.csv, line 1: column x1 is there twice; need it once"),
        ("x1,y1,x2,y2,r1\n0,0,9,0,1\n", r"x\.csv has a column r1 and no column r2; need both"),
        ("x1,y1,x2,y2\n0,5,0,9,0\n", r"x\.csv, line 2: 5 cells below 4 headings; need as many"),
        ("x1,y1,x2,y2,z2\n0,0,9,0,0\n", r"x\.csv has a column z2 and no column z1; need both"),
        ("x [px],y [px]\n0,0\n9,0\n", r"column x has the unit 'px'; need one of nm, um, mm"),
        ("x,y,r (acres)\n0,0,1\n9,0,1\n", r"column r has the unit 'acres'; need one of nm"),
        ("x [m],y\n0,0\n9,0\n", r"column x has a unit and column y has none; need one in each"),
        ("x[m],y[m],r\n0,0,1\n9,0,1\n", r"column x has a unit and column r has none; need one"),
        ("radius,d\n1,2\n", r"x\.csv has the columns radius, d; need columns x1 y1 z1"),
    ],
)
def test_errors_name_the_line_and_the_value(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, "x.csv", text))


def test_columns_name_units_and_no_other_is_taken(tmp_path: Path) -> None:
    strut = Skeleton([[0, 0, 0], [25.4, 0, 0]], [[0, 1]], 2.54)
    path = tmp_path / "strut.csv"
    write(strut, path, units="in")
    assert path.read_text().startswith("x1 [in],y1 [in],")
    again = read_skeleton(path)
    np.testing.assert_allclose(again.nodes, strut.nodes)
    np.testing.assert_allclose(again.radii, strut.radii)
    np.testing.assert_array_equal(read_skeleton(path, units="inch").nodes, again.nodes)
    with pytest.raises(OptionError, match=r"strut\.csv says that its unit is in; need no units"):
        read_skeleton(path, units="m")


def test_the_line_by_which_excel_names_its_separator_is_passed_over(tmp_path: Path) -> None:
    path = written(tmp_path, "x.csv", "sep=;\nx1;y1;x2;y2;radius\n0;0;9,5;0;1,25\n\n;;;;;;\n")
    strut = read_skeleton(path)
    np.testing.assert_array_equal(strut.nodes, [[0, 0, 0], [9.5, 0, 0]])
    assert strut.edge_radii.tolist() == [[1.25, 1.25]]


def test_a_member_without_a_radius_gets_one_and_that_is_told(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    text = "x1,y1,z1,x2,y2,z2,radius\n0,0,0,3,0,0,\n0,0,0,0,5,0,1\n"
    assert read_skeleton(written(tmp_path, "x.csv", text)).edge_radii.tolist() == [[1, 1], [1, 1]]
    assert "x.csv was repaired: 1 edge radius replaced" in caplog.text


def test_only_skeletons_are_written(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="a CSV file cannot hold a ndarray; need a Skeleton"):
        write(np.zeros(3), tmp_path / "x.csv")
    write(Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0), tmp_path / "strut.csv")
    assert (tmp_path / "strut.csv").read_text().splitlines() == [
        "x1,y1,z1,x2,y2,z2,r1,r2",
        "0.0,0.0,0.0,9.0,0.0,0.0,1.0,1.0",
    ]
