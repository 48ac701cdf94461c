"""Hexahedra as finite elements, and cells homogenized by them."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import Skeleton, build_scaffold
from scaffold_cad.errors import MeshError
from scaffold_cad.lattice import tile
from scaffold_cad.mechanics import Material, hexahedra, homogenized, homogenized_solid
from scaffold_cad.mechanics.hexahedra.stiffness import elasticity, hexahedron_stiffnesses
from tests.mechanics.test_cells import triangular_cells

STEEL = Material(210e3, 0.3)


def assembled(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    blocks = hexahedron_stiffnesses(points, cells, elasticity(STEEL))
    rows = (3 * cells[:, :, None] + np.arange(3)).reshape(len(cells), 24)
    matrix = np.zeros((3 * len(points), 3 * len(points)))
    np.add.at(matrix, (rows[:, :, None], rows[:, None, :]), blocks)
    return matrix


def test_patch_test_of_a_node_of_the_bcc_lattice() -> None:
    mesh = hexahedra(build_scaffold(tile("bcc", 10.0, (1, 1, 1), radius=0.8), collars=True))
    matrix = assembled(mesh.points, mesh.hexahedra)
    slope = np.random.default_rng(3).normal(size=(3, 3)) * 1e-3
    exact = (mesh.points @ slope.T).reshape(-1)
    outside = np.unique(mesh.boundary)
    free = np.setdiff1d(np.arange(len(exact)), (3 * outside[:, None] + np.arange(3)).reshape(-1))
    assert len(free) >= 27
    held = np.setdiff1d(np.arange(len(exact)), free)
    found = np.linalg.solve(matrix[np.ix_(free, free)], -matrix[np.ix_(free, held)] @ exact[held])
    np.testing.assert_allclose(found, exact[free], rtol=0, atol=1e-10)


def test_a_rigid_motion_costs_nothing() -> None:
    mesh = hexahedra(build_scaffold(Skeleton([[0, 0, 0], [0, 0, 9]], [[0, 1]], 1.0)))
    matrix = assembled(mesh.points, mesh.hexahedra)
    turn = np.cross([0.1, -0.2, 0.3], mesh.points).reshape(-1)
    assert np.abs(matrix @ turn).max() < 1e-9 * np.abs(matrix).max()


def test_a_round_cantilever_of_hexahedra_bends_as_a_beam() -> None:
    arm = Skeleton([[0, 0, 0], [0, 0, 40]], [[0, 1]], 2.0)
    mesh = hexahedra(build_scaffold(arm), layers=1, along=20)
    matrix = assembled(mesh.points, mesh.hexahedra)
    force = np.zeros(3 * len(mesh.points))
    tip = np.flatnonzero(mesh.end_of_point == 1)
    force[3 * tip] = -100 / len(tip)
    foot = np.flatnonzero(mesh.end_of_point == 0)
    held = (3 * foot[:, None] + np.arange(3)).reshape(-1)
    free = np.setdiff1d(np.arange(len(force)), held)
    found = np.zeros(len(force))
    found[free] = np.linalg.solve(matrix[np.ix_(free, free)], force[free])
    inertia, area = np.pi / 4 * 2**4, np.pi * 4
    sag = 100 * 40**3 / (3 * STEEL.young * inertia)
    sag += 100 * 40 / (STEEL.shear_factor() * STEEL.shear_modulus * area)
    assert -found[3 * tip].mean() == pytest.approx(sag, rel=0.03)


def test_slender_cells_are_as_stiff_as_their_beams() -> None:
    solid = homogenized_solid("sc", 0.01, STEEL, layers=1)
    beams = homogenized("sc", 0.01, STEEL)
    assert solid.young_axes == pytest.approx(beams.young_axes, rel=0.01)
    assert solid.relative_density == pytest.approx(beams.relative_density, rel=0.02)


def test_beams_of_a_fat_octet_are_too_soft() -> None:
    solid = homogenized_solid("octet", 0.0887, STEEL, layers=1, along=2)
    beams = homogenized("octet", 0.0887, STEEL)
    assert solid.relative_density == pytest.approx(0.3, abs=0.02)
    assert 0.6 < beams.young_axes[0] / solid.young_axes[0] < 0.8
    # A cubic law: three constants, as the cell's symmetry asks.
    c = solid.stiffness
    assert c[0, 0] == pytest.approx(c[1, 1], rel=1e-3)
    assert c[0, 1] == pytest.approx(c[0, 2], rel=1e-3)
    assert np.abs(c[:3, 3:]).max() < 1e-3 * c[0, 0]


def test_cells_of_any_angles_are_as_stiff_as_boxes_of_the_same_struts() -> None:
    skewed, straight = triangular_cells()
    solid = homogenized_solid(skewed, 0.5, STEEL, size=10.0, layers=1, along=2)
    size = 10.0 * straight.proportions
    same = homogenized_solid(straight, 0.5, STEEL, size=size, layers=1, along=2)
    assert solid.young_axes == pytest.approx(same.young_axes, rel=1e-4)
    assert solid.shear_axes == pytest.approx(same.shear_axes, rel=1e-3)
    assert solid.relative_density == pytest.approx(same.relative_density, rel=1e-6)


def test_struts_that_overlap_beyond_their_nodes_are_refused() -> None:
    with pytest.raises(MeshError, match=r"struts of cell .bcc. of radius 0\.3 mm overlap"):
        homogenized_solid("bcc", 0.3, STEEL, layers=1, along=2)
