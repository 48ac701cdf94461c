"""Meshes of curves: closed, of the curve's volume, the same triangles when nodes move."""

from __future__ import annotations

import numpy as np
import pytest
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps

from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.products import to_brep
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts import round_struts
from tests.skeletons import TREFOIL
from tests.solids import check_watertight
from tests.struts.chains import HOOK, TAPERED, circle, helix


@pytest.mark.parametrize(("sides", "error"), [(8, 1e-3), (16, 3e-4), (32, 5e-5)])
def test_a_circle_has_the_volume_of_its_torus(sides: int, error: float) -> None:
    # Pappus: the section's area times the way of its center.
    mesh = round_mesh(round_struts(circle(24)), sides)
    assert mesh.signed_volume == pytest.approx(2 * np.pi**2 * 10, rel=error)


@pytest.mark.parametrize("radius", [5.0, 24.0, 200.0])  # of the circle, for a wire of 1 mm
@pytest.mark.parametrize("sides", [8, 16, 48])
def test_wide_circles_have_chords_as_near_as_the_polygons_of_struts(
    radius: float, sides: int
) -> None:
    mesh = round_mesh(round_struts(circle(18, radius), joints="curve"), sides)
    middles = mesh.vertices[mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]]].mean(axis=2).reshape(-1, 3)
    from_axis = np.hypot(np.hypot(middles[:, 0], middles[:, 1]) - radius, middles[:, 2])
    assert np.abs(from_axis - 1).max() < 4 * (1 - np.cos(np.pi / sides)) + 2e-5 * radius


@pytest.mark.parametrize("sides", [8, 16, 32])
def test_a_helix_has_the_volume_of_its_wire(sides: int) -> None:
    way = 2 * np.hypot(2 * np.pi * 10, 6)
    mesh = round_mesh(round_struts(helix(120, wire=0.8)), sides)
    assert mesh.signed_volume == pytest.approx(np.pi * 0.8**2 * way, rel=1e-3)


@pytest.mark.parametrize("sides", [16, 32, 64])
def test_a_wire_that_swells_and_shrinks_has_its_volume(sides: int) -> None:
    wire = np.where(np.arange(40) % 2 == 0, 0.7, 1.3)
    struts = round_struts(helix(40, wire=wire), joints="curve")
    props = GProp_GProps()
    BRepGProp.VolumeProperties_s(to_brep(struts).wrapped, props, 1e-5, False)
    assert round_mesh(struts, sides).signed_volume == pytest.approx(props.Mass(), rel=2e-3)


@pytest.mark.parametrize("ends", ["flat", "round"])
@pytest.mark.parametrize("skeleton", [TREFOIL, TAPERED, HOOK, helix(500)])
def test_meshes_are_closed_and_do_not_cross_themselves(skeleton: Skeleton, ends: str) -> None:
    struts = round_struts(skeleton, ends=ends)  # type: ignore[arg-type]
    mesh = round_mesh(struts, 12)
    check_watertight(mesh)
    assert len(self_intersections(mesh)) == 0
    faces = len(mesh.triangles)
    assert len(mesh.vertices) - faces // 2 == (0 if skeleton is TREFOIL else 2)


def test_moved_nodes_keep_their_triangles() -> None:
    coil = round_struts(helix(60))
    for pitch in (4.0, 6.0, 12.0):
        moved = round_struts(helix(60, pitch=pitch), like=coil)
        assert len(moved.overlapping) == 0
        mesh = round_mesh(moved, 8)
        assert np.array_equal(mesh.triangles, round_mesh(coil, 8).triangles)
        check_watertight(mesh)


def test_walls_of_hollow_curves_are_of_one_thickness() -> None:
    struts = round_struts(helix(60), wall=0.25, ends="open")
    assert struts.inner is not None
    outer, inner = struts.curves.frames, struts.inner.curves.frames
    np.testing.assert_allclose(outer[:, :, 0], inner[:, :, 0], atol=1e-12)
    np.testing.assert_allclose(0.75 * outer[:, :, 1:], inner[:, :, 1:], atol=1e-12)
    mesh = round_mesh(struts, 16)
    check_watertight(mesh)
    way = 2 * np.hypot(2 * np.pi * 10, 6)
    assert mesh.signed_volume == pytest.approx(np.pi * (1 - 0.75**2) * way, rel=2e-3)
