"""Fields where struts meet have the volume of their union, however thick these are."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import PeriodicLattice
from scaffold_cad.solid.field import FieldStruts, field_solid, field_struts
from scaffold_cad.solid.field.nets import skeleton_struts
from tests.solid.field.judges import check_exact, sampled_volume
from tests.solid.field.test_solid import complete_graph

TURNED = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
"""Axes at no angle to the grid, (3, 3)."""

ERROR = 0.003
"""Most that volumes may be off, as a part of them."""


def lattice(cell: str, radius: float) -> FieldStruts:
    """Return the struts of eight cells of 10 mm."""
    return skeleton_struts(PeriodicLattice(cell, 10.0, 2, radius=radius).skeleton(), blend=0)


def heap() -> FieldStruts:
    """Return 100 struts at random in a box, each eight radii long."""
    rng = np.random.default_rng(5)
    middles, ways = rng.uniform(-10, 10, (100, 3)), rng.normal(size=(100, 3))
    ways *= 4 / np.linalg.norm(ways, axis=1)[:, None]
    return field_struts(np.stack([middles - ways, middles + ways], axis=1), 1.0, blend=0)


@pytest.mark.parametrize(("half", "flat"), [(1.6, True), (1.6, False), (8.0, True), (8.0, False)])
def test_crossing_cylinders_have_their_volume_less_what_is_in_both(half: float, flat: bool) -> None:
    ends = half * np.stack([-TURNED[:2], TURNED[:2]], axis=1)
    mesh = field_solid(field_struts(ends, 1.0, flat=flat, blend=0)).mesh
    balls = 0.0 if flat else 8 / 3 * np.pi
    # Both of two cylinders that cross at right angles are in 16/3 of the radius cubed: Archimedes.
    assert mesh.signed_volume == pytest.approx(4 * half * np.pi + balls - 16 / 3, rel=ERROR)
    check_exact(mesh)


@pytest.mark.parametrize(
    "struts",
    [lattice("gyroid", 2.206), lattice("bcc", 2.0), lattice("bcc", 0.7), heap()],
    ids=["thick gyroid", "thick bcc", "thin bcc", "heap"],
)
def test_struts_thick_and_thin_have_the_volume_of_their_union(struts: FieldStruts) -> None:
    volume, deviation = sampled_volume(struts, 300_000)
    mesh = field_solid(struts).mesh
    assert abs(mesh.signed_volume - volume) < ERROR * volume + 3 * deviation
    check_exact(mesh)


@pytest.mark.parametrize("radius", [1.0, 2.206, 2.515])
def test_fillets_of_coarse_grids_have_the_volume_of_those_of_fine_ones(radius: float) -> None:
    struts = skeleton_struts(PeriodicLattice("gyroid", 10.0, 1, radius=radius).skeleton())
    fine = field_solid(struts, cell=0.15 * radius, equal_volume=False).mesh.signed_volume
    assert field_solid(struts).mesh.signed_volume == pytest.approx(fine, rel=ERROR)


def test_struts_are_moved_alike_each_time() -> None:
    struts = field_struts(complete_graph(6), 1.0)
    one, other = field_solid(struts).mesh, field_solid(struts).mesh
    assert (one.vertices == other.vertices).all()


def test_flat_ends_of_struts_that_meet_stay_flat() -> None:
    ends = 3.0 * np.stack([np.zeros((3, 3)), TURNED], axis=1)
    mesh = field_solid(field_struts(ends, 1.0, flat=[[False, True]] * 3)).mesh
    along = mesh.vertices @ TURNED.T
    assert along.max() < 3.0 + 1e-3
    for k in range(3):  # the disc itself, not less
        on = np.abs(along[:, k] - 3.0) < 1e-3
        corners = mesh.vertices[mesh.triangles[on[mesh.triangles].all(axis=1)]]
        a, b, c = np.moveaxis(corners, 1, 0)
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
        assert area == pytest.approx(np.pi, rel=0.03)
