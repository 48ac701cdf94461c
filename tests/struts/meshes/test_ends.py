"""Ends of round struts as triangles: discs, hemispheres, and the caps of cones."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts import round_struts
from scaffold_cad.struts.meshes.surface import triangulated
from tests.skeletons import STRUT, TAPER


def capsule(length: float, radius: float) -> float:
    return np.pi * radius**2 * length + 4 / 3 * np.pi * radius**3


def test_flat_ends_are_fans_in_the_plane_of_the_node() -> None:
    mesh = triangulated(round_struts(STRUT), 12).mesh
    mesh.check_closed()
    assert len(mesh.triangles) == 12 * 4
    assert mesh.vertices[:, 0].min() == 0.0
    assert mesh.vertices[:, 0].max() == STRUT.nodes[1, 0]
    assert mesh.signed_volume == pytest.approx(np.pi * STRUT.lengths[0], rel=1e-12)


@pytest.mark.parametrize(("sides", "error"), [(8, 0.08), (32, 0.006), (128, 4e-4)])
def test_round_ends_tend_to_the_capsule(sides: int, error: float) -> None:
    mesh = triangulated(round_struts(STRUT, ends="round"), sides).mesh
    mesh.check_closed()
    assert mesh.signed_volume == pytest.approx(capsule(10.0, 1.0), rel=error)
    assert np.ptp(mesh.vertices[:, 0]) == pytest.approx(12.0, rel=0.03)


def test_round_ends_of_a_cone_touch_it_along_its_last_circle() -> None:
    mesh = triangulated(round_struts(TAPER, ends="round"), 256).mesh
    mesh.check_closed()
    (a, b), length = TAPER.radii, TAPER.lengths[0]
    slope = (b - a) / length
    size, center = np.array([a, b]) * np.hypot(1, slope), np.array([a, b]) * slope
    # Spheres around (a slope, 0, 0) and (length + b slope, 0, 0): tangent to the cone.
    # Flat faces reach beyond them, for the same volume.
    tips = [center[0] - size[0], length + center[1] + size[1]]
    x = mesh.vertices @ TAPER.directions[0]
    assert [x.min(), x.max()] == pytest.approx(tips, rel=1e-4)
    for middle, radius in ((center[0], size[0]), (length + center[1], size[1])):
        away = np.linalg.norm(mesh.vertices - middle * TAPER.directions[0], axis=1)
        assert away.min() > radius * (1 - 1e-3)
    ring = mesh.vertices[np.abs(x) < 1e-12]
    assert np.linalg.norm(ring, axis=1) == pytest.approx(a, rel=1e-3)


def test_lone_struts_in_any_direction_are_closed() -> None:
    rng = np.random.default_rng(5)
    for tip in rng.normal(size=(8, 3)):
        strut = Skeleton([np.zeros(3), 9 * tip], [[0, 1]], 0.2)
        triangulated(round_struts(strut, ends="round"), 8).mesh.check_closed()
