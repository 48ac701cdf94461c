"""Chains whose links are shorter than they are thick: nothing stands out past their flat ends."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.solid.field import FieldStruts, field_solid, field_struts
from tests.solid.field.judges import check_exact


def chain(points: np.ndarray, radius: float = 1.0) -> FieldStruts:
    ends = np.stack([points[:-1], points[1:]], axis=1)
    flat = np.zeros((len(ends), 2), dtype=np.bool_)
    flat[0, 0] = flat[-1, 1] = True
    return field_struts(ends, radius, flat=flat)


@pytest.mark.parametrize("link", [0.1, 0.3, 0.7, 3.0])
@pytest.mark.parametrize("size", [1e-3, 1.0, 1e4])
def test_a_straight_chain_is_its_cylinder(link: float, size: float) -> None:
    along = np.linspace(0, 6, round(6 / link) + 1)
    points = size * (np.array([1.0, 2.0, 3.0]) + along[:, None] * [0.48, 0.6, 0.64])
    mesh = field_solid(chain(points, size)).mesh
    check_exact(mesh)
    reach = (mesh.vertices - points[0]) @ [0.48, 0.6, 0.64] / size
    assert reach.min() > -3e-3  # what fields are exact to
    assert reach.max() < 6 + 3e-3
    assert mesh.signed_volume == pytest.approx(6 * np.pi * size**3, rel=0.01)


@pytest.mark.parametrize("count", [20, 60, 200])
def test_a_curved_chain_ends_at_its_planes(count: int) -> None:
    angle = np.linspace(0, np.pi, count + 1)  # half a ring of radius 3
    points = np.stack([3 * np.cos(angle), 3 * np.sin(angle), 0 * angle], axis=1)
    mesh = field_solid(chain(points)).mesh
    check_exact(mesh)
    slack = 3 * np.pi / count / 6 + 3e-3  # ends are at right angles to the links
    assert mesh.vertices[:, 1].min() > -slack
    assert mesh.signed_volume == pytest.approx(3 * np.pi**2, rel=0.02)


@pytest.mark.parametrize("links", [3, 7, 8])
def test_chains_shorter_than_thick_end_on_both_sides(links: int) -> None:
    points = np.linspace([0.0, 0, 0], [0.8, 0, 0], links + 1)
    mesh = field_solid(chain(points)).mesh
    check_exact(mesh)
    assert mesh.vertices[:, 0].min() > -3e-3
    assert mesh.vertices[:, 0].max() < 0.8 + 3e-3
    assert mesh.signed_volume == pytest.approx(0.8 * np.pi, rel=0.03)


def test_what_branches_off_beside_an_end_is_not_cut() -> None:
    ends = [[[0, 0, 0], [9.6, 0, 0]], [[9.6, 0, 0], [10, 0, 0]], [[9.6, 0, 0], [9.6, 7, 0]]]
    flat = [[False, False], [False, True], [False, False]]
    mesh = field_solid(field_struts(ends, 1.0, flat=flat)).mesh
    beside = mesh.vertices[mesh.vertices[:, 1] > 2]
    assert beside[:, 0].max() > 10.55


def test_what_is_much_thicker_than_the_end_is_not_cut() -> None:
    ends = [[[-9, 0, 0], [0, 0, 0]], [[0, 0, 0], [0.9, 0, 0]]]
    flat = [[False, False], [False, True]]
    mesh = field_solid(field_struts(ends, [[1.0, 4.0], [4.0, 1.0]], flat=flat)).mesh
    assert mesh.vertices[:, 0].max() > 3.5  # the ball of 4 around the origin
