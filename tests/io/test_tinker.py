from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw, read_skeleton
from tests.fuzz.samples import CJSON, XYZ
from tests.io.test_reading import written


def test_molecules_are_atoms_and_bonds(tmp_path: Path) -> None:
    water = read_raw(written(tmp_path, "water.xyz", XYZ))
    assert water.nodes.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    assert water.edges.tolist() == [[0, 1], [0, 2]]
    bent = read_raw(written(tmp_path, "bent.cjson", CJSON))
    assert bent.nodes.tolist() == [[0, 0, 0], [1.5, 0, 0], [1.5, 1.5, 0]]
    assert bent.edges.tolist() == [[0, 1], [1, 2]]


def test_atoms_of_known_elements_are_balls_and_their_bonds_sticks(tmp_path: Path) -> None:
    water = read_skeleton(written(tmp_path, "water.xyz", XYZ))
    assert water.radii.tolist() == [0.25 * 1.52, 0.25 * 1.2, 0.25 * 1.2]
    assert water.edge_radii.tolist() == [[0.15, 0.15]] * 2
    salt = XYZ.replace(b" O ", b" CT ").replace(b"3 H", b"3 Cl")
    radii = read_raw(written(tmp_path, "salt.xyz", salt)).radii
    assert radii == pytest.approx(np.array([0.25 * 1.7, 0.25 * 1.2, 0.25 * 1.75]))
    for named in (b'"number": [6, 1, 35]', b'"type": ["C", "H", "Br"]'):
        text = CJSON.replace(b'"atoms": {', b'"atoms": {"elements": {' + named + b"}, ")
        radii = read_raw(written(tmp_path, "bent.cjson", text)).radii
        assert radii == pytest.approx(np.array([0.25 * 1.7, 0.25 * 1.2, 0.25 * 1.85]))


def test_chemical_json_has_an_element_for_each_atom(tmp_path: Path) -> None:
    text = CJSON.replace(b'"atoms": {', b'"atoms": {"elements": {"number": [6]}, ')
    with pytest.raises(FormatError, match="has 1 elements; need 3, one per atom"):
        read_raw(written(tmp_path, "bent.cjson", text))


def test_a_periodic_box_is_left_out(tmp_path: Path) -> None:
    boxed = XYZ.replace(b"water\n", b"water\n30 30 30 90 90 90\n")
    assert len(read_raw(written(tmp_path, "water.txyz", boxed)).edges) == 2


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("2\nplain\nO 0 0 0\nH 1 0 0\n", "is plain XYZ, 2 atoms without bonds; need a format with"),
        ("2\nO 0 0 0\nH 1 0 0\n", "is plain XYZ, 2 atoms without bonds; need a format with"),
        ("1\n1 O 0 0 0 1 7\n", "line 2: atom 7; need 1 to 1"),
        ("many\n", "line 1: 'many' is not a whole number; need the number of atoms"),
    ],
)
def test_xyz_errors_name_the_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, "bad.xyz", text))
