"""Skeletons as 3MF beam lattices: written, read back, and read by lib3mf itself."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import lib3mf
import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings

from scaffold_cad.errors import FormatError, MeshError, SkeletonError
from scaffold_cad.io import read_skeleton
from scaffold_cad.io.write import write
from scaffold_cad.lattice import tile
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.beams import BeamLattice
from scaffold_cad.solid import to_solid
from tests.strategies import skeletons

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


def objects_in(path: Path) -> list[Any]:
    """Return the mesh objects that lib3mf reads, without a warning."""
    model = lib3mf.Wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(path))
    assert reader.GetWarningCount() == 0
    objects, found = model.GetMeshObjects(), []
    while objects.MoveNext():
        found.append(objects.GetCurrentMeshObject())
    return found


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
def test_beam_lattices_of_other_programs_go_round(
    name: str, shared_data: Path, tmp_path: Path
) -> None:
    skeleton = read_skeleton(shared_data / name)
    found = written_and_read(skeleton, tmp_path)
    np.testing.assert_array_equal(found.edges, skeleton.edges)
    np.testing.assert_allclose(found.nodes, skeleton.nodes, rtol=1e-6, atol=1e-5)
    np.testing.assert_allclose(found.radii, skeleton.radii, rtol=0, atol=2 * SIX_DECIMALS)


def test_lib3mf_reads_the_beams_without_a_warning(tmp_path: Path) -> None:
    lattice = tile("bcc", 10.0, 2, radius=0.75)
    write(lattice, tmp_path / "beams.3mf")
    (body,) = objects_in(tmp_path / "beams.3mf")
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


def test_balls_stand_at_the_nodes_that_have_one(tmp_path: Path) -> None:
    lattice = tile("bcc", 10.0, 1, radius=0.75)
    balls = np.where(lattice.valency == 8, 2.5, 0.0)
    write(BeamLattice(lattice, balls=balls), tmp_path / "balls.3mf")
    (body,) = objects_in(tmp_path / "balls.3mf")
    beams = body.BeamLattice()
    assert beams.GetBallOptions()[0] == lib3mf.BeamLatticeBallMode.Mixed
    (middle,) = np.flatnonzero(lattice.valency == 8)
    assert [(ball.Index, ball.Radius) for ball in beams.GetBalls()] == [(middle, 2.5)]
    check_same(read_skeleton(tmp_path / "balls.3mf"), lattice)


def test_one_number_gives_every_node_a_ball(tmp_path: Path) -> None:
    lattice = tile("bcc", 10.0, 1, radius=0.75)
    write(BeamLattice(lattice, balls=1.5), tmp_path / "balls.3mf")
    (body,) = objects_in(tmp_path / "balls.3mf")
    assert body.BeamLattice().GetBallCount() == len(lattice.nodes)


def test_a_lattice_is_clipped_to_a_mesh_before_it(tmp_path: Path) -> None:
    lattice = tile("octet", 8.0, 2, radius=0.5)
    ball = trimesh.creation.icosphere(radius=7.0).apply_translation([8, 8, 8])
    write(BeamLattice(lattice, clip=ball), tmp_path / "clipped.3mf")
    clip, body = objects_in(tmp_path / "clipped.3mf")
    mode, resource = body.BeamLattice().GetClipping()
    assert mode == lib3mf.BeamLatticeClipMode.Inside
    assert resource == clip.GetUniqueResourceID()
    assert clip.GetTriangleCount() == len(ball.faces)
    assert body.BeamLattice().GetBeamCount() == len(lattice.edges)


def test_mesh_and_beams_in_one_object_are_a_mesh_to_programs_without_beams(tmp_path: Path) -> None:
    lattice = tile("bcc", 10.0, 2, radius=0.75)
    solid = to_solid(build_scaffold(lattice))
    write(BeamLattice(lattice, mesh=solid), tmp_path / "both.3mf")
    (body,) = objects_in(tmp_path / "both.3mf")
    assert body.BeamLattice().GetBeamCount() == len(lattice.edges)
    check_same(read_skeleton(tmp_path / "both.3mf"), lattice)
    seen = trimesh.load(tmp_path / "both.3mf", force="mesh")
    assert seen.is_watertight
    assert seen.volume == pytest.approx(solid.volume(), rel=1e-5)


@pytest.mark.parametrize(
    ("balls", "message"),
    [
        (-1.0, r"the ball at node 0 has radius -1 mm; need >= 0"),
        ([1.0, np.nan], r"the ball at node 1 has radius nan mm; need >= 0"),
        ([0.0, 1e30], r"node 1 has a ball of radius 1e\+30 mm; need at most 1e\+12"),
        ([1.0, 2.0, 3.0], r"balls has shape \(3,\); need a number or shape \(2,\)"),
    ],
)
def test_bad_balls_are_refused(balls: Any, message: str) -> None:
    skeleton = Skeleton([[0, 0, 0], [1, 0, 0]], [[0, 1]], 1.0)
    with pytest.raises(SkeletonError, match=message):
        BeamLattice(skeleton, balls=balls)


def test_one_ball_stands_for_all_and_cannot_be_changed() -> None:
    beams = BeamLattice(Skeleton([[0, 0, 0], [1, 0, 0]], [[0, 1]], 1.0), 2)
    assert beams.balls.tolist() == [2.0, 2.0]
    with pytest.raises(ValueError, match="read-only"):
        beams.balls[0] = 1.0


@pytest.mark.parametrize("part", ["clip", "mesh"])
def test_open_meshes_beside_beams_are_refused(part: str, tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(radius=7.0)
    ball.update_faces(np.arange(len(ball.faces)) > 0)
    lattice = BeamLattice(tile("bcc", 8.0, 1, radius=0.5), **{part: ball})
    with pytest.raises(MeshError, match="no triangle runs along the edge from vertex"):
        write(lattice, tmp_path / "open.3mf")
    assert not (tmp_path / "open.3mf").exists()


def test_a_beam_lattice_goes_to_3mf_only(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="a mesh file cannot hold a BeamLattice"):
        write(BeamLattice(tile("bcc", 10.0, 1, radius=0.5)), tmp_path / "beams.stl")
