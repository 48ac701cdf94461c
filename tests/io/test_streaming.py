"""3MF files of lattices written layer by layer, and as repeated blocks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scaffold_cad import PeriodicLattice, Skeleton, UnitCell, cells, read_skeleton, tile, write
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.io import write_repeated
from scaffold_cad.io._rows import decimal, rows_of, whole
from scaffold_cad.io.threemf import streaming

CHAIN = UnitCell.of_net("chain", [[0.2, 0.5, 0.5]], [[0, 0], [0, 0]], [[1, 0, 0], [2, 1, -1]])
"""A net whose struts reach two cells on."""


def test_rows_hold_numbers_without_zeros_at_their_ends() -> None:
    found = rows_of(decimal(np.array([0.0, -0.5, 12.25, 1e-9, 1999.9999999]), 6), b"\n").decode()
    assert found.split() == ["0", "-0.5", "12.25", "0", "2000"]
    found = rows_of(whole(np.array([0, 7, 12_345, 99_999_999])), b" ").decode()
    assert found.split() == ["0", "7", "12345", "99999999"]


def test_rows_are_the_nearest_decimals() -> None:
    values = np.random.default_rng(5).normal(size=2000) * 300
    found = [float(word) for word in rows_of(decimal(values, 6), b" ").split()]
    assert np.abs(found - values).max() <= 0.5000001e-6


def name_of(cell: str | UnitCell) -> str:
    return cell if isinstance(cell, str) else cell.name


def places(skeleton: Skeleton) -> list[tuple[tuple[float, ...], ...]]:
    """Return the ends of all struts, in an order of their own."""
    ends = skeleton.nodes[skeleton.edges].round(4) + 0.0
    return sorted(tuple(sorted(tuple(end) for end in strut)) for strut in ends.tolist())


@pytest.mark.parametrize("layers", [1, 10**6])
@pytest.mark.parametrize("cell", [*cells(), CHAIN], ids=name_of)
def test_beams_written_by_layers_are_those_of_the_lattice(
    cell: str | UnitCell, layers: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(streaming, "AT_ONCE", layers)
    lattice = PeriodicLattice(cell, 8.0, (4, 2, 3), radius=0.5, origin=(1, -2, 30))
    write(lattice, tmp_path / "a.3mf")
    found, wanted = read_skeleton(tmp_path / "a.3mf"), lattice.skeleton()
    np.testing.assert_array_equal(found.edges, wanted.edges)
    np.testing.assert_allclose(found.nodes, wanted.nodes, atol=5e-6)
    np.testing.assert_array_equal(found.edge_radii, 0.5)


@pytest.mark.parametrize("cell", [*cells(), CHAIN], ids=name_of)
def test_repeated_blocks_have_each_beam_once(cell: str | UnitCell, tmp_path: Path) -> None:
    lattice = PeriodicLattice(cell, 8.0, (5, 2, 3), radius=0.5, origin=(1, -2, 30))
    write_repeated(lattice, tmp_path / "a.3mf", block=2)
    found = read_skeleton(tmp_path / "a.3mf").cleaned(weld_distance=1e-4).skeleton
    assert places(found) == places(lattice.skeleton())


def test_lib3mf_reads_all_beams(tmp_path: Path) -> None:
    lib3mf = pytest.importorskip("lib3mf")
    lattice = PeriodicLattice("octet", 2.0, 12, radius=lambda at: 0.1 + at[:, 2] / 1000)
    write(lattice, tmp_path / "a.3mf")
    model = lib3mf.Wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(tmp_path / "a.3mf"))
    assert reader.GetWarningCount() == 0
    meshes = model.GetMeshObjects()
    assert meshes.MoveNext()
    body = meshes.GetCurrentMeshObject()
    skeleton = lattice.skeleton()
    assert body.GetVertexCount() == len(skeleton.nodes)
    assert body.BeamLattice().GetBeamCount() == len(skeleton.edges)
    last = body.BeamLattice().GetBeam(len(skeleton.edges) - 1)
    assert list(last.Indices) == skeleton.edges[-1].tolist()
    np.testing.assert_allclose(list(last.Radii), skeleton.edge_radii[-1], atol=1e-6)


def test_lib3mf_reads_repeated_blocks(tmp_path: Path) -> None:
    lib3mf = pytest.importorskip("lib3mf")
    lattice = PeriodicLattice("bcc", 2.0, 12, radius=0.1)
    write_repeated(lattice, tmp_path / "a.3mf", block=5)
    model = lib3mf.Wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(tmp_path / "a.3mf"))
    components = model.GetComponentsObjects()
    assert components.MoveNext()
    assert components.GetCurrentComponentsObject().GetComponentCount() >= 27


def test_the_same_lattice_gives_the_same_bytes(tmp_path: Path) -> None:
    lattice = PeriodicLattice("bcc", 8.0, 3, radius=0.5)
    for name in ("a.3mf", "b.3mf"):
        write(lattice, tmp_path / name)
    assert (tmp_path / "a.3mf").read_bytes() == (tmp_path / "b.3mf").read_bytes()


def test_a_lattice_in_a_box_is_that_of_tile(tmp_path: Path) -> None:
    lattice = PeriodicLattice("fcc", (3.0, 4.0, 5.0), (3, 2, 4), radius=0.2)
    wanted = tile("fcc", (3.0, 4.0, 5.0), (3, 2, 4), radius=0.2)
    np.testing.assert_array_equal(lattice.skeleton().nodes, wanted.nodes)
    np.testing.assert_array_equal(lattice.skeleton().edges, wanted.edges)
    write(lattice.scaled(2.0), tmp_path / "a.3mf")
    write(lattice, tmp_path / "b.3mf", scale=2.0)
    assert (tmp_path / "a.3mf").read_bytes() == (tmp_path / "b.3mf").read_bytes()


def test_radii_that_differ_are_not_repeated(tmp_path: Path) -> None:
    lattice = PeriodicLattice("bcc", 8.0, 3, radius=lambda at: 0.5 + at[:, 0])
    with pytest.raises(FormatError, match="radius is a function; need one number"):
        write_repeated(lattice, tmp_path / "a.3mf")
    assert not (tmp_path / "a.3mf").exists()


def test_radii_too_small_for_the_file_are_refused(tmp_path: Path) -> None:
    lattice = PeriodicLattice("bcc", 8.0, 3, radius=1e-8)
    with pytest.raises(FormatError, match="has radius 1e-08 mm; a beam lattice needs 1e-06 mm"):
        write(lattice, tmp_path / "a.3mf")
    assert list(tmp_path.iterdir()) == []


def test_more_nodes_than_an_object_may_have_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(streaming, "MOST_VERTICES", 50)
    with pytest.raises(FormatError, match="more than 50 nodes; a 3MF object holds no more"):
        write(PeriodicLattice("bcc", 8.0, 3, radius=0.5), tmp_path / "a.3mf")


def test_what_is_no_lattice_is_refused(tmp_path: Path) -> None:
    with pytest.raises(OptionError, match="got a Skeleton; need a PeriodicLattice"):
        write_repeated(tile("bcc", 8.0, 2, radius=0.5), tmp_path / "a.3mf")  # type: ignore[arg-type]
    with pytest.raises(OptionError, match="block is 0"):
        write_repeated(PeriodicLattice("bcc", 8.0, 2, radius=0.5), tmp_path / "a.3mf", block=0)


def test_a_repeated_lattice_of_8_million_beams_is_small(tmp_path: Path) -> None:
    write_repeated(PeriodicLattice("bcc", 1.0, 100, radius=0.1), tmp_path / "a.3mf")
    assert (tmp_path / "a.3mf").stat().st_size < 400_000
