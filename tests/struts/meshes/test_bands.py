"""Bands between two rings: matched with least twist, closed, and of the cylinder's volume."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.struts.meshes.bands import band_triangles, enlargement, matching, twist_of

X, Y, Z = np.eye(3)[:, None]


def at(angle: float) -> np.ndarray:
    """Return the direction at an angle from X toward Y, (1, 3)."""
    return np.array([[np.cos(angle), np.sin(angle), 0.0]])


def band(sides: int, turn: float, growth: float = 1.0) -> TriangleMesh:
    """Return a closed cylinder of radius and height 1, the far ring beginning at `turn` from X."""
    matched = matching(X, Y, at(turn), sides)
    angle = 2 * np.pi / sides * np.arange(sides)
    near = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    far = np.stack([np.cos(turn - angle), np.sin(turn - angle), 1 + 0 * angle], axis=1)
    points = np.concatenate([near, far]) * [growth, growth, 1.0]
    rings = np.arange(sides)[None], sides + np.arange(sides)[None]
    sheath = band_triangles(*rings, matched.shift, matched.twist)
    middles = np.array([[0.0, 0, 0], [0, 0, 1.0]])
    k = np.arange(sides)
    discs = [
        np.stack([np.roll(k, -1), k, 0 * k + 2 * sides], axis=1),
        np.stack([np.roll(k, -1) + sides, k + sides, 0 * k + 2 * sides + 1], axis=1),
    ]
    return TriangleMesh(np.concatenate([points, middles]), np.concatenate([sheath, *discs]))


@pytest.mark.parametrize("sides", [4, 8, 12, 16])
@pytest.mark.parametrize("turn", [0.0, 0.1, -0.3, 1.0, 2.5, np.pi, -3.0])
def test_a_band_is_closed_and_has_the_volume_of_the_cylinder(sides: int, turn: float) -> None:
    twist = matching(X, Y, at(turn), sides).twist
    mesh = band(sides, turn, float(enlargement(twist, sides)[0]))
    mesh.check_closed()
    assert mesh.signed_volume == pytest.approx(np.pi, rel=1e-12)


@pytest.mark.parametrize("sides", [4, 16])
@pytest.mark.parametrize("turn", np.linspace(-3, 3, 7))
def test_the_twist_is_half_a_side_at_most(sides: int, turn: float) -> None:
    matched = matching(X, Y, at(turn), sides)
    assert abs(matched.twist[0]) <= np.pi / sides + 1e-12
    assert twist_of(X, Y, at(turn), sides, matched.shift) == pytest.approx(matched.twist)


def test_another_shift_has_another_twist() -> None:
    shift = matching(X, Y, at(0.1), 16).shift
    assert twist_of(X, Y, at(0.1), 16, shift + 1) == pytest.approx([0.1 - 2 * np.pi / 16])
    assert twist_of(X, Y, at(0.1), 16, shift + 16) == pytest.approx([0.1])


def test_polygons_without_twist_have_the_area_of_the_circle() -> None:
    for sides in (4, 8, 32):
        factor = float(enlargement(np.zeros(1), sides)[0])
        assert sides / 2 * np.sin(2 * np.pi / sides) * factor**2 == pytest.approx(np.pi)
