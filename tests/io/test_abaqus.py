from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

from scaffold_cad import Skeleton, write
from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw, read_skeleton
from scaffold_cad.lattice import tile
from tests.fuzz.members import ABAQUS, ABAQUS_PARTS
from tests.io.test_members import sizes
from tests.io.test_reading import written

NODES = "*NODE\n1, 0, 0, 0\n2, 9, 0, 0\n*ELEMENT, TYPE=B31, ELSET=E\n1, 1, 2\n"


def test_a_beam_with_a_middle_is_two_edges_and_sections_are_those_of_sets(tmp_path: Path) -> None:
    raw = read_raw(written(tmp_path, "beams.inp", ABAQUS))
    assert raw.edges.tolist() == [[0, 1], [1, 3], [3, 2]]
    np.testing.assert_allclose(sizes(raw), [0.5, 1, 1, 1])


def test_parts_are_placed_by_their_instances(tmp_path: Path) -> None:
    raw = read_raw(written(tmp_path, "parts.inp", ABAQUS_PARTS))
    ends = raw.nodes[raw.edges]
    wanted = [[[0, 0, 0], [10, 0, 0]], [[10, 0, 0], [10, 10, 0]]]
    np.testing.assert_allclose(ends, wanted, atol=1e-12)


@pytest.mark.parametrize(
    ("section", "radius"),
    [
        ("*BEAM SECTION, ELSET=E, SECTION=CIRC\n1.5\n", 1.5),
        ("*BEAM SECTION, ELSET=E, SECTION=PIPE\n1.5, 0.1\n", 1.5),
        ("*BEAM SECTION, ELSET=e, SECTION=RECT\n3.141592653589793, 4.\n", 2),
        ("*SOLID SECTION, ELSET=E\n3.141592653589793\n", 1),
    ],
)
def test_the_radius_is_that_of_the_section(tmp_path: Path, section: str, radius: float) -> None:
    raw = read_raw(written(tmp_path, "x.inp", NODES + section))
    np.testing.assert_allclose(sizes(raw), radius)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("*BEAM SECTION, ELSET=S, SECTION=CIRC\n2.\n", "*ELSET, ELSET=S\n1\n"),
        ("", "*ELSET, ELSET=S\n1\n*BEAM SECTION, ELSET=S,\n** of a pin\nSECTION=CIRC\n2.\n"),
    ],
)
def test_keywords_stand_in_any_order_and_go_on(tmp_path: Path, before: str, after: str) -> None:
    raw = read_raw(written(tmp_path, "x.inp", before + NODES + after))
    np.testing.assert_allclose(sizes(raw), 2)


def test_empty_fields_of_a_node_are_0(tmp_path: Path) -> None:
    text = "*NODE\n1, , 5, \n2, 9, 5, 0\n*ELEMENT, TYPE=B31\n1, 1, 2\n"
    assert read_raw(written(tmp_path, "x.inp", text)).nodes[0].tolist() == [0, 5, 0]


def test_what_is_not_read_is_told(tmp_path: Path, caplog) -> None:
    read_raw(written(tmp_path, "x.inp", NODES + "*NODE, INPUT=a\n*TRANSFORM, NSET=A\n1, 1\n"))
    assert "line 6: the file included is not read" in caplog.text
    assert "line 7: supports and loads are taken in the global coordinate system" in caplog.text


def test_a_section_of_another_shape_leaves_radii_to_the_user(tmp_path: Path, caplog) -> None:
    path = written(tmp_path, "x.inp", NODES + "*BEAM SECTION, ELSET=E, SECTION=I\n1, 2, 3\n")
    assert read_raw(path).has_radii is False
    assert "line 6: a section I has no known radius" in caplog.text


def test_beams_that_are_written_are_read_by_meshio_and_by_us(tmp_path: Path) -> None:
    lattice = tile("bcc", 10.0, 1, radius=lambda points: np.where(points[:, 2] > 5, 1.0, 0.5))
    write(lattice, tmp_path / "bcc.inp")
    mesh = meshio.read(tmp_path / "bcc.inp")
    np.testing.assert_array_equal(mesh.points, lattice.nodes)
    theirs = np.concatenate([block.data for block in mesh.cells])
    assert sorted(theirs.tolist()) == sorted(lattice.edges.tolist())
    again = read_skeleton(tmp_path / "bcc.inp", strict=True)
    np.testing.assert_array_equal(again.nodes, lattice.nodes)
    assert sorted(again.edges.tolist()) == sorted(lattice.edges.tolist())


@pytest.mark.parametrize(("units", "young"), [(None, 210e3), ("m", 210e9), ("cm", 210e5)])
def test_the_modulus_is_in_the_unit_of_lengths(
    tmp_path: Path, units: str | None, young: float
) -> None:
    write(Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0), tmp_path / "beam.inp", units=units)
    lines = (tmp_path / "beam.inp").read_text().splitlines()
    assert float(lines[lines.index("*ELASTIC") + 1].split(",")[0]) == pytest.approx(young)


def test_the_first_axis_of_sections_is_not_along_their_beams(tmp_path: Path) -> None:
    lattice = tile("bcc_sc", 10.0, 1, radius=0.5)
    write(lattice, tmp_path / "cell.inp")
    blocks = (tmp_path / "cell.inp").read_text().split("*")
    sections = [block.splitlines() for block in blocks if block.startswith("BEAM SECTION")]
    axes = {rows[0].split("ELSET=")[1].split(",")[0]: rows[2] for rows in sections}
    count = 0
    for rows in (block.splitlines() for block in blocks if block.startswith("ELEMENT")):
        axis = np.array(axes[rows[0].split("ELSET=")[1]].split(","), dtype=float)
        ends = lattice.nodes[np.array([row.split(",")[1:] for row in rows[1:]], dtype=int) - 1]
        along = ends[:, 1] - ends[:, 0]
        cosines = np.abs(along @ axis) / np.linalg.norm(along, axis=1)
        assert cosines.max() < 0.8
        count += len(along)
    assert count == len(lattice.edges)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("*NODE\n1, 0, zero\n", r"line 2: '1, 0, zero' holds no numbers; need a node: number, x"),
        ("*NODE\n1, 0\n", "line 2: '1, 0' is too short; need a node"),
        (NODES + "2, 1\n", "line 6: '2, 1' is too short; need an element"),
        (NODES + "2, 1, 7\n", "line 6: an edge has the end 7; need a node of the file"),
        ("*NODE\n1, 0, 0, 0\n", "has nodes and no struts; need beams, pipes or trusses"),
        ("*NODE, SYSTEM=C\n1, 9, 90\n", "line 1: nodes in a coordinate system of their own; need"),
        ("*SYSTEM\n1, 0, 0\n" + NODES, "line 1: nodes in a coordinate system of their own; need"),
        (NODES + "*ELGEN\n1, 4\n", "line 6: .ELGEN; need nodes and elements that are written out"),
        ("*NODE\n*INSTANCE, PART=P\n", "line 2: an instance of part 'P'; need a part before"),
        (NODES + "*ELSET, ELSET=A, GENERATE\n1, 1e9, 0\n", "line 7: '1, 1e9, 0'; need a range of"),
    ],
)
def test_errors_name_the_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, "x.inp", text))


def test_sets_that_name_themselves_and_each_other_stay_small(tmp_path: Path) -> None:
    text = ABAQUS.decode().replace(
        "*BEAM SECTION",
        "*ELSET, ELSET=A\nBEAMS\n" + "*ELSET, ELSET=A\nBEAMS, , A\n" * 60 + "*BEAM SECTION",
        1,
    )
    text = text.replace("*BOUNDARY", "*NSET, NSET=FEET\nFEET, 2\n" * 60 + "*BOUNDARY", 1)
    path = tmp_path / "sets.inp"
    path.write_text(text)
    assert len(read_skeleton(path, 1.0).edges) == 3
