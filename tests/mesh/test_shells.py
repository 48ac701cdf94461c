"""Shells of quad meshes, and what bounds a solid."""

from __future__ import annotations

import re

import numpy as np
import pytest

from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.shells import check_oriented, check_solid, quads_of_shells, shell_of_quad
from tests.meshes import CUBE, INSIDE_OUT_CUBE, OPEN_CUBE, TORUS, TWO_CUBES


@pytest.mark.parametrize("mesh", [CUBE, OPEN_CUBE, TORUS])
def test_a_connected_mesh_is_one_shell(mesh) -> None:
    assert not shell_of_quad(mesh).any()


def test_shells_are_numbered_in_the_order_of_their_first_quads() -> None:
    assert shell_of_quad(TWO_CUBES).tolist() == [0, 1] * 6
    assert [quads.tolist() for quads in quads_of_shells(TWO_CUBES)] == [
        [0, 2, 4, 6, 8, 10],
        [1, 3, 5, 7, 9, 11],
    ]


def test_a_shared_vertex_does_not_join_shells() -> None:
    quads = np.concatenate([CUBE.quads, np.where(CUBE.quads == 0, 7, CUBE.quads + 8)])
    vertices = np.concatenate([CUBE.vertices, CUBE.vertices + 2])
    assert shell_of_quad(QuadMesh(vertices, quads)).tolist() == [0] * 6 + [1] * 6


@pytest.mark.parametrize("mesh", [CUBE, TORUS, TWO_CUBES])
def test_closed_outward_meshes_bound_solids(mesh) -> None:
    check_solid(mesh)


def test_an_open_mesh_bounds_no_solid() -> None:
    with pytest.raises(MeshError, match="the mesh is open"):
        check_solid(OPEN_CUBE)


def test_a_shell_that_is_inside_out_is_named_by_its_first_quad() -> None:
    quads = TWO_CUBES.quads.copy()
    quads[1::2] = quads[1::2, ::-1]
    message = re.escape("the shell of quad 1 has a volume of -8 mm³; need > 0")
    with pytest.raises(MeshError, match=message):
        check_solid(QuadMesh(TWO_CUBES.vertices, quads))


@pytest.mark.parametrize("mesh", [CUBE, OPEN_CUBE, INSIDE_OUT_CUBE])
def test_a_shell_may_be_open_or_inside_out(mesh) -> None:
    check_oriented(mesh)


def test_quads_that_disagree_in_direction_are_refused() -> None:
    quads = CUBE.quads.copy()
    quads[0] = quads[0, ::-1]
    with pytest.raises(MeshError, match=r"two quads run along the edge from vertex \d to \d"):
        check_oriented(QuadMesh(CUBE.vertices, quads))


def test_no_quads_are_no_shell() -> None:
    with pytest.raises(MeshError, match="the mesh has no quads; need at least one"):
        check_oriented(QuadMesh(CUBE.vertices, np.zeros((0, 4), dtype=int)))
