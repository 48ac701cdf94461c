"""What the documentation says of formats: what their files hold, and come back as."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from scaffold_cad import Skeleton, read_skeleton, write
from scaffold_cad.errors import FormatError
from scaffold_cad.io import RawSkeleton, known_formats, read_raw
from tests.fuzz.members import APART, sample_apart
from tests.fuzz.samples import SAMPLES

PAGE = Path(__file__).parents[2] / "docs" / "formats.md"


@dataclass(frozen=True)
class Row:
    """A row of the table."""

    suffixes: tuple[str, ...]
    what: str
    radii: str
    unit: str
    written: str


def table() -> list[Row]:
    page = PAGE.read_text("utf-8").partition("## Read")[2].partition("What real files do")[0]
    found = re.findall(r"^\|(.*)\|(.*)\|(.*)\|(.*)\|(.*)\|$", page, re.MULTILINE)[2:]
    return [
        Row(tuple(re.findall(r"`([^`]+)`", one[0])), *(cell.strip() for cell in one[1:]))
        for one in found
    ]


def samples(suffix: str) -> dict[str, bytes]:
    """Return the samples of a suffix by name."""
    there = {name: content for name, content in SAMPLES.items() if name.endswith(suffix)}
    apart = {name: sample_apart(name) for name in APART if name.endswith(suffix)}
    return there | apart


def read(folder: Path, suffixes: tuple[str, ...]) -> list[RawSkeleton]:
    found = []
    for suffix in suffixes:
        for name, content in samples(suffix).items():
            path = folder / name
            path.write_bytes(content)
            found.append(read_raw(path))
    return found


def test_the_table_has_every_suffix_that_is_read() -> None:
    listed = {suffix for row in table() for suffix in row.suffixes}
    assert listed == {suffix for known in known_formats() for suffix in known.suffixes}


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("row", table(), ids=lambda row: " ".join(row.suffixes))
def test_samples_hold_what_the_table_says(row: Row, tmp_path: Path) -> None:
    raws = read(tmp_path, row.suffixes)
    assert raws
    assert all(len(raw.nodes) > 1 and len(raw.edges) > 0 for raw in raws)
    of_nodes = any(raw.radii is not None for raw in raws)
    of_members = any(raw.edge_radii is not None for raw in raws)
    if row.suffixes == (".json",):  # five formats share the suffix
        assert of_nodes
        assert of_members
        return
    assert not of_nodes or re.search("node|ball", row.radii)
    assert not of_members or re.search("member|stick", row.radii)
    assert of_nodes or of_members or re.search("none|data", row.radii)
    named = any(raw.unit or raw.usual_unit for raw in raws)
    assert named == (row.unit != "-" and row.suffixes != (".svg",) and "taken as" not in row.unit)


TREE = Skeleton(
    [[0.1, 0, 0], [10, 1 / 3, 0], [10, 10, 0], [19, -3, 2]],
    [[0, 1], [1, 2], [1, 3]],
    [2.0, 1.5, 1.0, 1.25],
    [[0.5, 0.75], [0.25, 0.25], [1.0, 0.5]],
)
"""Balls at nodes, members that taper, numbers that are no short decimals."""

ROUND = {suffix: row for row in table() for suffix in row.suffixes if row.written}
"""Rows of formats that are written, by suffix."""


@pytest.mark.parametrize("suffix", ROUND)
def test_skeletons_come_back_as_the_table_says(suffix: str, tmp_path: Path) -> None:
    said = ROUND[suffix].written
    path = tmp_path / f"tree{suffix}"
    if suffix in (".tsv", ".vtp", ".wire") or said.startswith("("):
        with pytest.raises(FormatError):
            write(TREE, path)
        return
    write(TREE, path)
    back = read_skeleton(path, None if read_raw(path).has_radii else 1.0)
    exact = "six decimals" not in said
    np.testing.assert_allclose(back.nodes, TREE.nodes, rtol=0, atol=0 if exact else 1e-6)
    order = np.lexsort(back.edges.T[::-1])  # beams of .inp files stand in order of their sections
    assert back.edges[order].tolist() == TREE.edges.tolist()
    if said == "exact":
        np.testing.assert_array_equal(back.radii, TREE.radii)
    if "lost" not in said and suffix != ".swc":
        np.testing.assert_allclose(back.edge_radii[order], TREE.edge_radii, rtol=0, atol=1e-6)
    if "tapers" in said:
        means = TREE.edge_radii.mean(axis=1, keepdims=True)
        np.testing.assert_allclose(back.edge_radii[order], np.repeat(means, 2, axis=1), rtol=1e-12)
    if suffix == ".swc":
        np.testing.assert_array_equal(back.radii, TREE.radii)


@pytest.mark.parametrize("row", table(), ids=lambda row: " ".join(row.suffixes))
def test_formats_that_are_not_written_are_refused(row: Row, tmp_path: Path) -> None:
    if row.written or row.suffixes[0].endswith(".json"):  # as ours, under any longer suffix
        return
    for suffix in row.suffixes:
        with pytest.raises(FormatError, match="need"):
            write(TREE, tmp_path / f"tree{suffix}")
