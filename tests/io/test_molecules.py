"""MOL, SDF, MOL2 and PDB, and what plain XYZ is told."""

from __future__ import annotations

from pathlib import Path

import pytest

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw
from tests.fuzz.members import MEMBERS, MOL, MOL2, PDB
from tests.io.test_reading import written


def test_the_first_of_several_molecules_is_read(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    raw = read_raw(written(tmp_path, "two.sdf", MOL + b"$$$$\n" + MOL + b"$$$$\n"))
    assert len(raw.edges) == 2
    assert "holds several molecules; the first one is read" in caplog.text
    caplog.clear()
    assert len(read_raw(written(tmp_path, "two.mol2", 2 * MOL2)).edges) == 2
    assert "holds several molecules; the first one is read" in caplog.text


def test_bonds_without_conect_are_taken_from_distances(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    raw = read_raw(written(tmp_path, "bare.pdb", MEMBERS["bare.ent"]))
    assert raw.edges.tolist() == [[0, 1], [1, 2]]  # 1.98 Å, from C to O, is not a bond
    assert "names no bonds; 2 are taken from distances" in caplog.text


def test_only_the_first_model_and_the_first_place_are_read(tmp_path: Path) -> None:
    atoms = PDB.split(b"CONECT")[0]
    third = atoms.splitlines()[2]
    other = third[:16] + b"B" + third[17:]
    text = b"MODEL        1\n" + atoms + other + b"\nENDMDL\nMODEL        2\n" + atoms + b"ENDMDL\n"
    assert len(read_raw(written(tmp_path, "x.pdb", text)).nodes) == 3


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("x.mol", MOL.replace(b"  3  2  0", b"  9  2  0"), r"ends within 9 atoms and 2 bonds"),
        ("x.mol", MOL.replace(b"  1  2  1", b"  1  9  1"), "a bond of an atom that is not there"),
        ("x.mol", MOL.replace(b"1.4000 ", b"x.4000 "), "line 6: .*; need an atom: x, y, z, elem"),
        ("x.mol", b"\n\n", "ends within its header; need four lines"),
        ("x.mol2", MOL2.replace(b"2 2 3 ar", b"2 2 7 ar"), "line 13: '2 2 7 ar'; need a bond"),
        ("x.mol2", MOL2.replace(b" 1.4 0 0", b" a 0 0"), "line 9: .*; need an atom: number, name"),
        ("x.mol2", b"@<TRIPOS>ATOM\n", "has no @<TRIPOS>MOLECULE; need one"),
        ("x.pdb", PDB.replace(b"1.400   0", b"1.4x0   0"), "line 2: .*; need an atom: its number"),
        ("x.pdb", b"END\n", "holds no atoms; need atoms and bonds"),
        (
            "x.pdb",
            PDB.split(b"CONECT")[0].replace(b"   1.400", b"   1e300", 1),
            r"node 1 is at .*1e\+300.* mm; need at most 1e\+12",
        ),
        (
            "x.xyz",
            b"3\nwater\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n",
            r"x\.xyz is plain XYZ, 3 atoms without bonds; need a format with bonds: Tinker XYZ",
        ),
    ],
)
def test_errors_name_the_line(tmp_path: Path, name: str, text: bytes, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, name, text))
