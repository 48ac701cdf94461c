"""Skeletons as 3MF beam lattices: written, read back, and read by lib3mf itself."""

from __future__ import annotations

from pathlib import Path

import lib3mf
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from scaffold_cad.errors import FormatError
from scaffold_cad.export import write
from scaffold_cad.io import read_skeleton
from scaffold_cad.lattice import tile
from scaffold_cad.skeleton import Skeleton
from tests.strategies import skeletons

DATA = Path(__file__).parents[1] / ".." / "shared" / "data"

SIX_DECIMALS = 1e-6
"""How far a coordinate or a radius may be off, mm: lib3mf writes no more."""


def written_and_read(skeleton: Skeleton, folder: Path) -> Skeleton:
    path = folder / "beams.3mf"
    write(skeleton, path)
    return read_skeleton(path, strict=True)


def check_same(found: Skeleton, wanted: Skeleton) -> None:
    np.testing.assert_array_equal(found.edges, wanted.edges)
    np.testing.assert_allclose(found.nodes, wanted.nodes, rtol=1e-6, atol=SIX_DECIMALS)
    np.testing.assert_allclose(found.radii, wanted.radii, rtol=0, atol=SIX_DECIMALS)


@given(skeleton=skeletons())
@settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
def test_skeletons_read_back_as_they_were(skeleton: Skeleton, tmp_path: Path) -> None:
    check_same(written_and_read(skeleton, tmp_path), skeleton)


def test_radii_differ_along_a_graded_lattice(tmp_path: Path) -> None:
    lattice = tile("octet", 8.0, 2, radius=lambda points: 0.3 + points[:, 2] / 40)
    check_same(written_and_read(lattice, tmp_path), lattice)


@pytest.mark.parametrize("name", ["pyramid.3mf", "Box_Simple.3mf"])
def test_beam_lattices_of_other_programs_go_round(name: str, tmp_path: Path) -> None:
    if not (DATA / name).exists():
        pytest.skip(f"no {DATA / name}")
    skeleton = read_skeleton(DATA / name)
    found = written_and_read(skeleton, tmp_path)
    np.testing.assert_array_equal(found.edges, skeleton.edges)
    np.testing.assert_allclose(found.nodes, skeleton.nodes, rtol=1e-6, atol=1e-5)
    np.testing.assert_allclose(found.radii, skeleton.radii, rtol=0, atol=2 * SIX_DECIMALS)


def test_lib3mf_reads_the_beams_without_a_warning(tmp_path: Path) -> None:
    lattice = tile("bcc", 10.0, 2, radius=0.75)
    write(lattice, tmp_path / "beams.3mf")
    model = lib3mf.Wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(tmp_path / "beams.3mf"))
    assert reader.GetWarningCount() == 0
    objects = model.GetMeshObjects()
    assert objects.MoveNext()
    body = objects.GetCurrentMeshObject()
    assert body.GetTriangleCount() == 0
    beams = body.BeamLattice().GetBeams()
    assert [tuple(beam.Indices) for beam in beams] == [tuple(row) for row in lattice.edges.tolist()]
    assert {tuple(beam.Radii) for beam in beams} == {(0.75, 0.75)}
    sphere = lib3mf.BeamLatticeCapMode.Sphere.value
    assert {tuple(beam.CapModes) for beam in beams} == {(sphere, sphere)}


def test_the_same_skeleton_gives_the_same_bytes(tmp_path: Path) -> None:
    lattice = tile("bcc", 10.0, 2, radius=0.75)
    write(lattice, tmp_path / "a.3mf")
    write(lattice, tmp_path / "b.3mf")
    assert (tmp_path / "a.3mf").read_bytes() == (tmp_path / "b.3mf").read_bytes()
    write(lattice.with_radii(0.8), tmp_path / "b.3mf")
    assert (tmp_path / "a.3mf").read_bytes() != (tmp_path / "b.3mf").read_bytes()


def test_radii_that_would_be_written_as_zero_are_refused(tmp_path: Path) -> None:
    skeleton = Skeleton([[0, 0, 0], [1, 0, 0]], [[0, 1]], [1.0, 1e-7])
    with pytest.raises(FormatError, match=r"node 1 has radius 1e-07 mm; a beam lattice needs"):
        write(skeleton, tmp_path / "thin.3mf")
    assert not (tmp_path / "thin.3mf").exists()
