"""Surfaces cut along loops of three short edges that are no triangle."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.base.arrays import Bools
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.necks import without_necks
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid import cleaning
from tests.crossings import check_whole

THIN = 1e-3
"""Radius of a neck, mm."""

PYRAMIDS = TriangleMesh(
    [[THIN, 0, 0], [-THIN, THIN, 0], [-THIN, -THIN, 0], [0, 0, 5.0], [0, 0, -5.0]],
    [[0, 1, 3], [1, 2, 3], [2, 0, 3], [1, 0, 4], [2, 1, 4], [0, 2, 4]],
)


def ring(count: int = 8, *, turned: bool = False) -> TriangleMesh:
    """Return a ring of triangular section, thin at one place: there it may be turned over."""
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    out = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    corner = np.linspace(0, 2 * np.pi, 3, endpoint=False)
    size = np.where(np.arange(count) == 0, THIN, 2.0)[:, None, None]
    sign = np.where((np.arange(count) == 0) & turned, -1.0, 1.0)[:, None]
    across = np.cos(corner)[None, :, None] * out[:, None]
    up = sign[:, :, None] * np.sin(corner)[None, :, None] * np.array([0, 0, 1.0])
    points = 10 * out[:, None] + size * (across + up)
    i, k = np.divmod(np.arange(3 * count), 3)
    a, b = 3 * i + k, 3 * i + (k + 1) % 3
    c, d = 3 * ((i + 1) % count) + k, 3 * ((i + 1) % count) + (k + 1) % 3
    rows = np.concatenate([np.stack([a, d, b], axis=1), np.stack([a, c, d], axis=1)])
    return TriangleMesh(points.reshape(-1, 3), rows)


def everywhere(mesh: TriangleMesh) -> Bools:
    return np.ones(len(mesh.vertices), dtype=np.bool_)


def test_bodies_that_a_neck_joins_are_two() -> None:
    mesh = without_necks(PYRAMIDS, 10 * THIN, everywhere(PYRAMIDS))
    mesh.check_closed()
    assert mesh.signed_volume == pytest.approx(PYRAMIDS.signed_volume)
    assert (len(mesh.vertices), len(mesh.triangles)) == (8, 8)  # two tetrahedra


def test_a_handle_is_opened_at_its_neck() -> None:
    whole = ring()
    check_whole(whole)
    mesh = without_necks(whole, 10 * THIN, everywhere(whole))
    mesh.check_closed()
    assert mesh.signed_volume == pytest.approx(whole.signed_volume)
    sides = 3 * len(mesh.triangles) // 2
    assert len(mesh.vertices) - sides + len(mesh.triangles) == 2  # a ball; a ring has 0


@pytest.mark.parametrize("longest", [THIN / 10, 10 * THIN])
def test_only_short_loops_that_are_asked_for_are_cut(longest: float) -> None:
    nowhere = np.zeros(len(PYRAMIDS.vertices), dtype=np.bool_)
    near = nowhere if longest > THIN else ~nowhere
    assert without_necks(PYRAMIDS, longest, near) is PYRAMIDS


def test_triangles_are_no_necks() -> None:
    tetrahedron = TriangleMesh(np.eye(4)[:, :3], [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]])
    assert without_necks(tetrahedron, 10.0, everywhere(tetrahedron)) is tetrahedron


def test_a_neck_that_is_turned_over_is_mended() -> None:
    mesh = ring(turned=True)
    mesh.check_closed()
    assert len(self_intersections(mesh))
    mended = cleaning.parted(cleaning._uncrossed(mesh, THIN), 12.0)
    check_whole(mended)
    assert mended.signed_volume == pytest.approx(mesh.signed_volume, rel=1e-3)
