"""Surfaces of unions as files hold them: what crosses is mended, sheets that touch are parted."""

from __future__ import annotations

import re

import numpy as np
import pytest
from manifold3d import Manifold

from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid import cleaning, manifolds
from scaffold_cad.solid.cleaning import FaultySurfaceError, clean_surface, without_flakes
from tests.crossings import INSTALLED, check_as_written, faults_by_cgal


def cube(*place: float, size: float = 2.0) -> Manifold:
    return Manifold.cube([size] * 3).translate(list(place))


BLOCK = cube(-5, -5, -5, size=10.0)
TOUCHING = {
    "at a vertex": cube(0, 0, 0) + cube(2, 2, 2),
    "along an edge": cube(0, 0, 0) + cube(2, 2, 0),
    "void at a vertex": BLOCK - cube(0, 0, 0) - cube(-2, -2, -2),
    "void along an edge": BLOCK - cube(0, 0, 0) - cube(-2, -2, 0),
    "a checkerboard": sum(
        (cube(2 * i, 2 * j, 2 * k) for i in range(3) for j in range(3) for k in range(3)
         if (i + j + k) % 2 == 0), start=Manifold()
    ),
}  # fmt: skip
"""Solids that touch themselves; a file without indices has vertices and edges of several sheets."""


@pytest.mark.parametrize("name", TOUCHING)
def test_what_touches_itself_is_parted_as_written_and_told(
    name: str, caplog: pytest.LogCaptureFixture
) -> None:
    solid = TOUCHING[name]
    with caplog.at_level("INFO"):
        mesh = clean_surface(solid)
    check_as_written(mesh)
    assert len(np.unique(mesh.vertices, axis=0)) == len(mesh.vertices)
    assert mesh.signed_volume == pytest.approx(solid.volume(), rel=1e-3)
    off = np.abs(mesh.vertices - np.round(mesh.vertices)).max()
    assert off < 1.1 * cleaning.PARTINGS[0] * np.abs(mesh.vertices).max()  # rounded
    told = re.search(r"touches itself at .* moved apart by up to (\S+) mm", caplog.text)
    assert told
    assert 0.94 * off < float(told[1]) < 1.8 * off  # the way, not what it is along an axis


@pytest.mark.skipif(not INSTALLED, reason="CGAL is not installed")
@pytest.mark.parametrize("name", ["at a vertex", "along an edge", "void at a vertex"])
def test_such_a_solid_has_a_fault_as_it_is(name: str) -> None:
    mesh = manifolds.manifold_triangles(TOUCHING[name])
    assert faults_by_cgal(mesh.vertices, mesh.triangles) == "no manifold"


def test_a_surface_that_touches_nowhere_stays_as_it_is() -> None:
    mesh = clean_surface(BLOCK)
    assert np.abs(mesh.vertices).tolist() == [[5.0] * 3] * 8


LEAST = 1e-4
"""Shortest edge of a surface, mm."""


def folded(gap: float) -> TriangleMesh:
    """Return the block with a vertex on its top beside a corner, `gap` beyond an edge."""
    block = manifolds.manifold_triangles(BLOCK)
    top = (block.vertices[block.triangles][:, :, 2] == 5.0).all(axis=1)
    ring = np.array([[-5, -5, 5], [5, -5, 5], [5, 5, 5], [-5, 5, 5]])
    corner = [int(np.flatnonzero((block.vertices == place).all(axis=1))[0]) for place in ring]
    fan = [[corner[k], corner[(k + 1) % 4], len(block.vertices)] for k in range(4)]
    vertices = np.concatenate([block.vertices, [[5.0 + gap, 5.0 - 3.0 * gap, 5.0]]])
    return TriangleMesh(vertices, np.concatenate([block.triangles[~top], fan]))


def test_short_edges_are_drawn_together_where_a_surface_crosses_itself() -> None:
    mesh = folded(2.0 * LEAST)
    mesh.check_closed()
    assert len(self_intersections(mesh))
    mended = cleaning._uncrossed(mesh, LEAST)
    mended.check_closed()
    assert len(self_intersections(mended)) == 0
    assert mended.signed_volume == pytest.approx(1000.0, rel=1e-4)
    assert len(mended.vertices) == 8


def test_a_crossing_without_short_edges_is_named() -> None:
    with pytest.raises(FaultySurfaceError, match="crosses itself in") as caught:
        cleaning._uncrossed(folded(1.0), LEAST)
    assert (caught.value.places[:, 0] >= 5.0).any()


@pytest.mark.parametrize("turned", [False, True])
def test_shells_thinner_than_32_bit_coordinates_tell_are_left_out(turned: bool) -> None:
    block = manifolds.manifold_triangles(BLOCK)
    count = len(block.vertices)
    step = float(np.spacing(np.float32(9.0)))
    flake = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    corners = np.array([[9, 0, 0], [9, 1, 0], [9, 0, 1], [9, 0.5, 0.5]])
    for thickness, left in ((step, 0), (20 * step, 4)):
        corners[3, 0] = 9.0 + thickness
        rows = count + (flake[:, ::-1] if turned else flake)
        mesh = TriangleMesh(
            np.concatenate([block.vertices, corners]), np.concatenate([block.triangles, rows])
        )
        assert len(without_flakes(mesh).triangles) == len(block.triangles) + left


def test_two_triangles_back_to_back_are_left_out() -> None:
    block = manifolds.manifold_triangles(BLOCK)
    count = len(block.vertices)
    flap = [[count, count + 1, count + 2], [count, count + 2, count + 1]]
    vertices = np.concatenate([block.vertices, [[9, 0, 0], [9, 1, 0], [9, 0, 1]]])
    mesh = cleaning._uncrossed(
        TriangleMesh(vertices, np.concatenate([block.triangles, flap])), LEAST
    )
    assert len(mesh.vertices) == count
    assert mesh.signed_volume == pytest.approx(1000.0)


def test_a_place_that_cannot_be_parted_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def as_it_is(mesh: TriangleMesh, *_: object) -> TriangleMesh:
        return mesh

    monkeypatch.setattr(cleaning, "_drawn_in", as_it_is)
    with pytest.raises(FaultySurfaceError, match="touches itself at 1 place") as caught:
        clean_surface(TOUCHING["at a vertex"])
    assert caught.value.places.tolist() == [[2.0, 2.0, 2.0]] * 2
