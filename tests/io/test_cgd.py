"""Nets of Systre files: counts of RCSR, groups of symmetry, names, faults with their line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scaffold_cad import check_skeleton, read_skeleton, tile
from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_nets
from scaffold_cad.lattice import unit_cell

PCU = """CRYSTAL
  NAME pcu
  GROUP P1
  CELL 1.0 1.0 1.0 90.0 90.0 90.0
  NODE 1 6  0 0 0
  EDGE  0 0 0   0 0 1
  EDGE  0 0 0   0 1 0
  EDGE  0 0 0   1 0 0
END
"""

DIA = """# diamond
CRYSTAL
  NAME dia
  GROUP Fd-3m:2
  CELL 2.30940 2.30940 2.30940 90.0 90.0 90.0
  NODE 1 4  0.12500 0.12500 0.62500
  EDGE  0.12500 0.12500 0.62500   0.37500 0.37500 0.37500
# EDGE_CENTER  0.25000 0.25000 0.50000
END
"""

SRS = DIA.replace("dia", "srs").replace("Fd-3m:2", "I4132").replace("2.30940", "2.82843").replace(
    "NODE 1 4  0.12500 0.12500 0.62500", "NODE 1 3 1/8 1/8 1/8"
).replace(
    "0.12500 0.12500 0.62500   0.37500 0.37500 0.37500", "1 0.12500 -0.12500 0.37500"
)  # fmt: skip

PLAIN = DIA.replace("Fd-3m:2", "Fd-3m")
FIRST = DIA.replace("Fd-3m:2", "Fd-3m:1").replace("0.12500 0.12500 0.62500", "0 0 0").replace(
    "0.37500 0.37500 0.37500", "0.25 0.25 0.25"
)  # fmt: skip

GRAPHITE = """CRYSTAL
NAME hcb
GROUP P1
CELL 1.7320508 1.7320508 3 90 90 120
ATOM a 3 1/3 2/3 0
ATOM b 3 2/3 1/3 0
EDGE a b
EDGE a 2/3 4/3 0
EDGE a -1/3 1/3 0
END
"""


def write(folder: Path, text: str) -> Path:
    path = folder / "net.cgd"
    path.write_text(text, "utf-8")
    return path


def test_a_net_without_symmetry_is_the_cell_it_describes(tmp_path: Path) -> None:
    (cell,) = read_nets(write(tmp_path, PCU))
    assert (cell.name, cell.site_count, cell.strut_count) == ("pcu", 1, 3)
    assert cell.valencies == (6,)
    assert len(tile(cell, 5.0, 3, radius=0.3).edges) == 81


@pytest.mark.parametrize(
    ("text", "like"),
    [(DIA, "diamond"), (PLAIN, "diamond"), (FIRST, "diamond"), (SRS, "gyroid")],
    ids=["dia", "plain", "first origin", "srs"],
)
def test_nets_with_symmetry_are_the_known_cells(tmp_path: Path, text: str, like: str) -> None:
    pytest.importorskip("gemmi")
    (cell,) = read_nets(write(tmp_path, text))
    known = unit_cell(like)
    assert (cell.site_count, cell.strut_count, cell.valencies) == (
        known.site_count,
        known.strut_count,
        known.valencies,
    )
    size = np.full(3, 10.0)
    np.testing.assert_allclose(cell.strut_lengths(size), known.strut_lengths(size)[0], rtol=1e-4)
    check_skeleton(tile(cell, 10.0, 2, radius=0.3))


def test_names_fractions_and_slanted_cells_are_read(tmp_path: Path) -> None:
    (cell,) = read_nets(write(tmp_path, GRAPHITE))
    assert cell.valencies == (3,)
    np.testing.assert_allclose(cell.strut_lengths(cell.proportions * np.sqrt(3)), 1.0, rtol=1e-6)


def test_several_nets_of_a_file_come_in_their_order(tmp_path: Path) -> None:
    assert [cell.name for cell in read_nets(write(tmp_path, GRAPHITE + PCU))] == ["hcb", "pcu"]


def test_a_skeleton_is_one_cell_of_the_first_net(tmp_path: Path) -> None:
    skeleton = read_skeleton(write(tmp_path, GRAPHITE), radius=0.1)
    assert len(skeleton.edges) == 3
    np.testing.assert_allclose(skeleton.lengths, 1.0, rtol=1e-6)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("PERIODIC_GRAPH\nEND\n", "has no block CRYSTAL"),
        (PCU.replace("CELL", "#"), "net 'pcu' of line 1 has no CELL, NODE or EDGE"),
        (PCU.replace("90.0 90.0 90.0", "90.0"), "line 4.*need 6 numbers .*: a, b, c, alpha"),
        (PCU.replace("1.0 1.0 1.0", "0 5.0 5.0"), "line 4: 0 5.0 .*need numbers of at least 1e-06"),
        (PCU.replace("1.0 1.0 1.0", "1 5 1e999999999"), "line 4.*need 6 numbers of at most 1e"),
        (PCU.replace("90.0 90.0 90.0", "90 90 200"), r"cgd: .*\[90.0, 90.0, 200.0\] degrees; need"),
        (PCU.replace("NODE 1 6  0 0 0", "NODE 1 6 0 0 1e30"), "line 5.*need 3 numbers of at most"),
        (PCU.replace("NODE 1 6", "NODE 1 \u00b2"), "line 5.*need name, valency, x, y, z"),
        (PCU.replace("NODE 1 6", "NODE 1"), "line 5.*need name, valency, x, y, z"),
        (PCU.replace("NODE 1 6  0 0 0", "NODE 1 6 0 0 1/0"), "line 5.*need 3 numbers"),
        (PCU.replace("0 0 0   0 0 1", "0 0 0   0 0"), "line 6.*need 3 numbers"),
        (PCU.replace("0 0 0   0 0 1", "0 0 0   0 0 1 7"), "line 6.*two ends"),
        (PCU.replace("0 0 0   0 0 1", "0 0 0   0 0 0.5"), "ends at .*, where no node is"),
        (PCU.replace("NODE 1 6", "NODE 1 4"), "node 1 has 6 edges; need 4, as the file says"),
    ],
)
def test_faults_are_named(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        read_nets(write(tmp_path, text))


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"none\.cgd cannot be read: there is no such file"):
        read_nets(tmp_path / "none.cgd")


def test_an_unknown_group_is_named(tmp_path: Path) -> None:
    pytest.importorskip("gemmi")
    with pytest.raises(FormatError, match=r"has the group 'P9'; need one of the 230"):
        read_nets(write(tmp_path, PCU.replace("P1", "P9")))
