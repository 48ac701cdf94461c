"""Tests of the diagonals that the quads of scaffolds are split along."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from scaffold_cad import QuadMesh, Scaffold, Skeleton, build_scaffold, tile
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.scaffold.sleevemesh import UNBALANCED
from tests.strategies import skeletons

BCC = build_scaffold(tile("bcc", 10.0, counts=2, radius=0.7))


def ratio(mesh: QuadMesh) -> float:
    """Return the volume of the triangles over that of the patches."""
    return TriangleMesh(mesh.vertices, mesh.triangles).signed_volume / mesh.signed_volume


def along_shorter_diagonals(scaffold: Scaffold) -> QuadMesh:
    return QuadMesh(scaffold.mesh.vertices, scaffold.mesh.quads)


def test_struts_of_triangles_have_the_volume_of_struts_of_patches() -> None:
    assert ratio(along_shorter_diagonals(BCC)) > 1.1
    assert ratio(BCC.mesh) == pytest.approx(1.0, abs=0.04)
    assert BCC.embedding().certified


def test_quads_that_are_hardly_twisted_are_split_along_their_shorter_diagonals() -> None:
    helix = np.linspace(0, 6, 40)[:, None] * [0, 0, 1.0]
    helix[:, 0], helix[:, 1] = np.cos(helix[:, 2]), np.sin(helix[:, 2])
    edges = np.column_stack([np.arange(39), np.arange(1, 40)])
    scaffold = build_scaffold(Skeleton(10 * helix, edges, 0.3))
    assert abs(ratio(scaffold.mesh) - 1) < UNBALANCED
    np.testing.assert_array_equal(scaffold.mesh.fans, along_shorter_diagonals(scaffold).fans)


@given(skeletons())
def test_other_diagonals_leave_no_strut_out(skeleton: Skeleton) -> None:
    scaffold = build_scaffold(skeleton)
    plain = replace(scaffold, mesh=along_shorter_diagonals(scaffold))
    assert not (plain.embedding().kept & ~scaffold.embedding().kept).any()


def test_a_moved_scaffold_keeps_its_diagonals() -> None:
    skeleton = BCC.skeleton
    moved = build_scaffold(skeleton.moved(skeleton.nodes * [1, 1, 1.5]), like=BCC)
    np.testing.assert_array_equal(moved.mesh.fans, BCC.mesh.fans)


def test_a_pickled_mesh_has_the_same_triangles() -> None:
    fresh = pickle.loads(pickle.dumps(build_scaffold(BCC.skeleton)))
    np.testing.assert_array_equal(fresh.mesh.triangles, BCC.mesh.triangles)
