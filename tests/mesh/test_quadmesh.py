from __future__ import annotations

import pickle
from collections.abc import Callable
from copy import copy, deepcopy
from dataclasses import FrozenInstanceError

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scaffold_cad.base.vectors import triple
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.quadmesh import QuadMesh

CORNERS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
CUBE_QUADS = np.array(
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
)
CUBE = QuadMesh(CORNERS, CUBE_QUADS)
"""The unit cube."""

_COORDINATE = st.floats(-5, 5, allow_nan=False, width=32)
_VERTICES = st.lists(st.tuples(_COORDINATE, _COORDINATE, _COORDINATE), min_size=8, max_size=8)


def torus(around: int, along: int) -> QuadMesh:
    """Return a torus of radii 3 and 1."""
    u, v = np.meshgrid(
        2 * np.pi * np.arange(around) / around, 2 * np.pi * np.arange(along) / along, indexing="ij"
    )
    reach = 3 + np.cos(v)
    vertices = np.stack([reach * np.cos(u), reach * np.sin(u), np.sin(v)], axis=2).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(around), np.arange(along), indexing="ij")
    index = np.arange(around * along).reshape(around, along)
    a, b = index[i, j], index[(i + 1) % around, j]
    c, d = index[(i + 1) % around, (j + 1) % along], index[i, (j + 1) % along]
    return QuadMesh(vertices, np.stack([a, b, c, d], axis=2).reshape(-1, 4))


def test_a_cube_is_closed_and_has_its_counts_and_volume() -> None:
    CUBE.check_closed()
    assert (len(CUBE.edges), CUBE.euler_characteristic) == (12, 2)
    assert CUBE.signed_volume == pytest.approx(1.0)


def test_a_torus_is_closed_and_has_genus_one() -> None:
    mesh = torus(80, 60)
    mesh.check_closed()
    assert mesh.euler_characteristic == 0
    assert mesh.signed_volume == pytest.approx(2 * np.pi**2 * 3, rel=0.01)


def test_two_bodies_add_up() -> None:
    two = QuadMesh(
        np.concatenate([CORNERS, CORNERS + 5]), np.concatenate([CUBE_QUADS, CUBE_QUADS + 8])
    )
    two.check_closed()
    assert two.euler_characteristic == 4
    assert two.signed_volume == pytest.approx(2.0)


def test_vertices_without_a_quad_do_not_count() -> None:
    assert QuadMesh(np.concatenate([CORNERS, CORNERS + 5]), CUBE_QUADS).euler_characteristic == 2


def test_half_edges_run_around_each_quad() -> None:
    assert CUBE.half_edges[:4].tolist() == [[0, 2], [2, 3], [3, 1], [1, 0]]
    low_first = np.sort(CUBE.half_edges, axis=1)
    np.testing.assert_array_equal(CUBE.edges[CUBE.edge_of_half_edge], low_first)
    assert CUBE.edges.tolist() == sorted(CUBE.edges.tolist())


def test_a_mesh_cannot_be_changed() -> None:
    with pytest.raises(FrozenInstanceError):
        CUBE.quads = CUBE_QUADS  # type: ignore[misc]
    for name in ("vertices", "quads", "half_edges", "edges", "edge_of_half_edge", "triangles"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(CUBE, name)[0] = 0


@pytest.mark.parametrize("copied", [copy, deepcopy, lambda mesh: pickle.loads(pickle.dumps(mesh))])
def test_no_copy_of_a_mesh_can_be_changed(copied: Callable[[QuadMesh], QuadMesh]) -> None:
    mesh = torus(6, 4)
    assert len(mesh.edges) == 48
    other = copied(mesh)
    for name in ("vertices", "quads", "half_edges", "edges", "edge_of_half_edge", "triangles"):
        np.testing.assert_array_equal(getattr(other, name), getattr(mesh, name))
        assert not getattr(other, name).flags.writeable


def test_moving_shares_the_quads_and_nothing_that_was_computed() -> None:
    wide = CUBE.moved(CORNERS * [2, 1, 1])
    assert wide.quads is CUBE.quads
    assert CUBE.signed_volume == pytest.approx(1.0)
    assert wide.signed_volume == pytest.approx(2.0)


def test_moving_needs_as_many_vertices() -> None:
    with pytest.raises(MeshError, match="7 vertices given; need 8"):
        CUBE.moved(CORNERS[:7])


def test_bad_arrays_are_refused() -> None:
    with pytest.raises(MeshError, match=r"quads\[5\] has vertices \[1, 3, 7, 5\]; need 0 to 6"):
        QuadMesh(CORNERS[:7], CUBE_QUADS[[0, 0, 0, 0, 0, 5]])
    with pytest.raises(MeshError, match=r"vertices\[0\] is \[nan, nan, nan\]; need finite"):
        QuadMesh(CORNERS * np.nan, CUBE_QUADS)
    with pytest.raises(MeshError, match=r"vertices\[0\] is \[nan, nan, nan\]; need finite"):
        CUBE.moved(CORNERS * np.nan)


# Triangles and volume


def test_triangles_split_each_quad_along_its_shorter_diagonal() -> None:
    rhombus = np.array([[0, 0, 0], [3, -1, 0], [6, 0, 0], [3, 1, 0]], dtype=float)
    assert QuadMesh(rhombus, [[0, 1, 2, 3]]).triangles.tolist() == [[3, 0, 1], [3, 1, 2]]
    assert QuadMesh(rhombus, [[1, 2, 3, 0]]).triangles.tolist() == [[1, 2, 3], [1, 3, 0]]


def test_at_a_tie_the_first_diagonal_is_taken() -> None:
    assert CUBE.triangles[:2].tolist() == [[0, 2, 3], [0, 3, 1]]


@given(_VERTICES)
def test_triangles_are_closed_and_keep_the_orientation(
    vertices: list[tuple[float, float, float]],
) -> None:
    mesh = CUBE.moved(vertices)
    directed = np.concatenate([mesh.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    pairs = {tuple(pair) for pair in directed.tolist()}
    assert len(pairs) == len(directed)
    assert {(b, a) for a, b in pairs} == pairs


@given(_VERTICES)
def test_the_volume_is_the_mean_of_both_triangulations(
    vertices: list[tuple[float, float, float]],
) -> None:
    mesh = CUBE.moved(vertices)
    a, b, c, d = (mesh.vertices[mesh.quads[:, k]] for k in range(4))
    one = (triple(a, b, c) + triple(a, c, d)).sum() / 6
    other = (triple(a, b, d) + triple(b, c, d)).sum() / 6
    assert mesh.signed_volume == pytest.approx((one + other) / 2, abs=1e-9)


def test_quads_the_wrong_way_round_have_a_negative_volume() -> None:
    inside_out = QuadMesh(CORNERS, CUBE_QUADS[:, ::-1])
    inside_out.check_closed()
    assert inside_out.signed_volume == pytest.approx(-1.0)


# Closedness


def test_a_mesh_without_quads_is_refused() -> None:
    empty = QuadMesh(np.zeros((0, 3)), np.zeros((0, 4), dtype=int))
    assert (empty.euler_characteristic, empty.signed_volume) == (0, 0.0)
    assert empty.edges.shape == (0, 2)
    with pytest.raises(MeshError, match="the mesh has no quads; need at least 6 for a closed"):
        empty.check_closed()


def test_an_open_mesh_is_refused() -> None:
    message = "the edge between vertices 1 and 3 belongs to one quad only; need two"
    with pytest.raises(MeshError, match=message):
        QuadMesh(CORNERS, CUBE_QUADS[:5]).check_closed()


def test_an_edge_of_four_quads_is_refused() -> None:
    # Two cubes that share the edge between vertices 5 and 7.
    beside = np.array([5, 8, 7, 9, 10, 11, 12, 13])
    vertices = np.concatenate([CORNERS, CORNERS[[1, 3, 4, 5, 6, 7]] + [1, 0, 1]])
    touching = QuadMesh(vertices, np.concatenate([CUBE_QUADS, beside[CUBE_QUADS]]))
    message = "the edge between vertices 5 and 7 belongs to more than two quads; need two"
    with pytest.raises(MeshError, match=message):
        touching.check_closed()


def test_a_quad_turned_round_is_refused() -> None:
    quads = CUBE_QUADS.copy()
    quads[3] = quads[3, ::-1]
    message = "the edge between vertices 2 and 3 is run along twice in the same direction"
    with pytest.raises(MeshError, match=message):
        QuadMesh(CORNERS, quads).check_closed()


def test_quads_on_other_vertices_are_split_along_the_same_diagonals() -> None:
    rhombus = np.array([[0, 0, 0], [3, -1, 0], [6, 0, 0], [3, 1, 0]], dtype=float)
    mesh = QuadMesh(rhombus, [[0, 1, 2, 3]])
    tall = mesh.moved(rhombus * [1, 9, 1])
    assert tall.triangles.tolist() == mesh.triangles.tolist()
    assert tall.triangles.tolist() != QuadMesh(tall.vertices, tall.quads).triangles.tolist()
