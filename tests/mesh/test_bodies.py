"""Bodies of other people: turned, taken apart where they touch, faults named with their place."""

from __future__ import annotations

import json
import logging

import numpy as np
import pytest
import trimesh
from manifold3d import Manifold
from scipy.spatial.transform import Rotation

from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.bodies import (
    body_of,
    check_uncrossed,
    parted,
    shells_of,
    turned_outwards,
    winding_number,
)
from scaffold_cad.mesh.trianglemesh import TriangleMesh, cone_volumes


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> TriangleMesh:
    mesh = trimesh.creation.box(bounds=[low, high])
    return TriangleMesh(mesh.vertices, mesh.faces)


def joined(*meshes: TriangleMesh) -> TriangleMesh:
    counts = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    return TriangleMesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([m.triangles + k for m, k in zip(meshes, counts, strict=False)]),
    )


def soup(mesh: TriangleMesh) -> TriangleMesh:
    """Return the mesh as an STL file has it."""
    return TriangleMesh(
        mesh.vertices[mesh.triangles].reshape(-1, 3), np.arange(mesh.triangles.size).reshape(-1, 3)
    )


def reversed_(mesh: TriangleMesh) -> TriangleMesh:
    return TriangleMesh(mesh.vertices, mesh.triangles[:, ::-1])


CUBE = box((0, 0, 0), (2, 2, 2))
BESIDE = box((2, 2, 0), (4, 4, 2))
"""A cube that touches `CUBE` along an edge."""


def test_bodies_that_touch_along_an_edge_are_taken_apart(
    caplog: pytest.LogCaptureFixture,
) -> None:
    caplog.set_level(logging.INFO)
    body = body_of(soup(joined(CUBE, BESIDE)))
    body.check_closed()
    assert len(body.vertices) == 16
    assert int(shells_of(body.triangles, len(body.vertices)).max()) == 1
    assert body.signed_volume == pytest.approx(16)
    assert "touches itself along 1 edge" in caplog.text


def test_bodies_that_touch_in_a_row_of_edges_are_taken_apart() -> None:
    stairs = [box((2 * k, 2 * k, 0), (2 * k + 2, 2 * k + 2, 2)) for k in range(5)]
    body = body_of(soup(joined(*stairs)))
    body.check_closed()
    assert int(shells_of(body.triangles, len(body.vertices)).max()) == 4


def test_a_body_that_touches_itself_keeps_its_material_together() -> None:
    boxes = [((0, 0, 0), (2, 2, 2)), ((2, 2, 0), (4, 4, 2)), ((0, 0, -1), (4, 4, 0))]
    whole = sum(
        (Manifold.cube(np.subtract(b, a)).translate(a) for a, b in boxes), Manifold()
    ).to_mesh()
    pinched = soup(TriangleMesh(whole.vert_properties[:, :3], whole.tri_verts))
    body = body_of(pinched)
    body.check_closed()
    assert body.signed_volume == pytest.approx(32)
    assert shells_of(body.triangles, len(body.vertices)).max() == 0
    on_edge = (np.abs(body.vertices[:, :2] - 2) < 1e-6).all(axis=1)
    assert on_edge.sum() == 3  # two at the top, one at the foot of the edge


@pytest.mark.parametrize("turn", [np.eye(3), Rotation.from_rotvec([0.3, 1.1, -0.7]).as_matrix()])
def test_bodies_that_share_whole_faces_are_taken_apart(turn: np.ndarray) -> None:
    cells = [(x, y, 0) for x in (0, 2, 4) for y in (0, 2)]
    mesh = joined(*(box(low, tuple(np.add(low, 2))) for low in cells))
    body = body_of(soup(TriangleMesh(mesh.vertices @ turn, mesh.triangles)))
    body.check_closed()
    shell = shells_of(body.triangles, len(body.vertices))
    volumes = np.bincount(shell, weights=cone_volumes(body.vertices, body.triangles))
    assert volumes == pytest.approx(np.full(6, 8.0))


def test_vertices_are_as_they_were_where_nothing_touches() -> None:
    assert parted(CUBE) is CUBE
    assert body_of(CUBE).vertices is CUBE.vertices


def test_what_is_inside_out_is_turned_and_said(caplog: pytest.LogCaptureFixture) -> None:
    for mesh, volume in (
        (reversed_(CUBE), 8.0),
        (joined(CUBE, reversed_(box((5, 5, 5), (6, 6, 6)))), 9.0),
        (reversed_(joined(CUBE, reversed_(box((0.5, 0.5, 0.5), (1, 1, 1))))), 7.875),
    ):
        caplog.clear()
        assert turned_outwards(mesh).signed_volume == pytest.approx(volume)
        assert "inside out, as at" in caplog.text


def test_cavities_stay_and_nothing_is_said(caplog: pytest.LogCaptureFixture) -> None:
    hollow = joined(CUBE, reversed_(box((0.5, 0.5, 0.5), (1, 1, 1))))
    assert turned_outwards(hollow) is hollow
    assert caplog.text == ""


def test_winding_numbers_count_shells_around_a_place() -> None:
    twofold = joined(box((-9, -9, -9), (9, 9, 9)), CUBE)
    corners = twofold.vertices[twofold.triangles]
    assert winding_number(np.array([1.0, 1.0, 1.0]), corners) == 2
    assert winding_number(np.array([5.0, 1.0, 1.0]), corners) == 1
    assert winding_number(np.array([50.0, 1.0, 1.0]), corners) == 0


def test_a_hole_is_named_with_its_place() -> None:
    open_mesh = TriangleMesh(CUBE.vertices + 10, CUBE.triangles[1:])
    with pytest.raises(
        MeshError, match=r"no triangle runs along the edge from \[1.* mm \(3 such edges\)"
    ):
        body_of(open_mesh)
    with pytest.raises(MeshError, match="the body has no triangles"):
        body_of(TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=int)))


def test_a_body_that_crosses_itself_is_named_with_the_place() -> None:
    check_uncrossed(joined(CUBE, BESIDE))
    crossing = joined(CUBE, box((1, 1, 1), (3, 3, 3)))
    with pytest.raises(MeshError, match=r"the body crosses itself near \[.*\] mm") as caught:
        check_uncrossed(crossing)
    place = np.array(json.loads(str(caught.value).split("near ")[1].split(" mm")[0]))
    assert (place >= 1 - 1e-9).all()
    assert (place <= 2 + 1e-9).all()
