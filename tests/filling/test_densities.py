"""Radii for densities: as measured on the solid, and varied over space."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import Field, relative_density, round_struts, tile, to_solid
from scaffold_cad.base.arrays import Floats
from scaffold_cad.errors import OptionError
from scaffold_cad.filling import densities, graded_radius, solve_radius
from scaffold_cad.filling.innercell import capsules, solid_density
from scaffold_cad.lattice import UnitCell, unit_cell
from scaffold_cad.lattice.density import measured_density
from scaffold_cad.lattice.tiling import cell_size
from scaffold_cad.skeleton import Skeleton


def test_a_measured_radius_gives_the_density_of_the_solid() -> None:
    radius = solve_radius("sc", 10.0, 0.15, measured=True)
    volumes = [
        to_solid(round_struts(tile("sc", 10.0, n, radius=radius))).volume() for n in (2, 3, 4, 5)
    ]
    # The third difference of n³ cells' volumes is 6 times that of a cell of the inside.
    inside = np.diff(volumes, 3)[0] / 6
    assert inside / 1000 == pytest.approx(0.15, rel=2e-3)
    assert radius > solve_radius("sc", 10.0, 0.15)  # the formula counts nodes several times


def test_a_graded_radius_has_the_density_of_its_place() -> None:
    field = Field([[[0.05, 0.2]]], [[0, 0, 0], [0, 0, 40]])
    radius = graded_radius("bcc", 10.0, field)
    points = np.array([[1.0, 2.0, z] for z in (0.0, 13.0, 40.0)])
    for place, found in zip(points, radius(points), strict=True):
        wanted = float(field(place[None])[0])
        assert relative_density("bcc", 10.0, float(found)) == pytest.approx(wanted)
    constant = graded_radius("bcc", 10.0, 0.1)
    np.testing.assert_allclose(constant(points), solve_radius("bcc", 10.0, 0.1))


def test_a_measured_graded_radius_has_the_density_of_the_solid() -> None:
    radius = graded_radius("sc", 10.0, 0.12, measured=True)
    found = float(radius(np.zeros((1, 3)))[0])
    assert solid_density(unit_cell("sc"), np.full(3, 10.0), found) == pytest.approx(0.12, rel=0.02)


def test_a_density_that_is_jumped_over_is_refused_with_what_is_near() -> None:
    tried = []

    def volume(skeleton: Skeleton) -> float:  # voids close at 2 mm
        radius = float(skeleton.radii[0])
        tried.append(radius)
        share = 0.2 * radius**2 if radius < 2.0 else 1.0
        return share * float(np.ptp(skeleton.nodes, axis=0).prod())

    assert solve_radius("sc", 10.0, 0.7, volume=volume) == pytest.approx(3.5**0.5, rel=1e-3)
    tried.clear()
    message = (
        r"no radius gives relative density 0\.9, as voids between struts close: "
        r"struts of 1\.9\S+ mm give 0\.7\d+, of 2\S* mm 1; need 0\.7\d+ or less"
    )
    with pytest.raises(OptionError, match=message):
        solve_radius("sc", 10.0, 0.9, volume=volume)
    assert len(set(tried)) <= 10


@pytest.mark.parametrize("name", ["bcc", "truncated_cube"])
def test_the_middle_of_a_block_is_as_dense_as_what_larger_blocks_grow_by(name: str) -> None:
    cell = unit_cell(name)
    sizes = cell_size(cell, 10.0)

    def volume(skeleton: Skeleton) -> float:
        return float(to_solid(round_struts(skeleton)).volume())

    inside = measured_density(cell, sizes, 0.6, volume)
    assert solid_density(cell, sizes, 0.6) == pytest.approx(inside, rel=1e-4)


def test_a_cell_that_is_slanted_is_measured_whole() -> None:
    cell = UnitCell.of_net("slanted", [[0, 0, 0]], [[0, 0]] * 3, np.eye(3), angles=[1.2, 1.3, 1.1])
    size = np.array([10.0, 8.0, 9.0])
    first_order = cell.density_coefficient_of(size) * 0.1**2
    assert solid_density(cell, size, 0.1) == pytest.approx(first_order, rel=0.03)


@pytest.mark.parametrize(("density", "most"), [(0.5, 4), (0.93, 5)])
def test_few_solids_are_measured_and_a_whole_block_where_a_radius_is_found(
    density: float, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    reaches = []

    def counted(cell: UnitCell, size: Floats, radius: float, reach: float = np.inf) -> float:
        reaches.append(reach)
        return solid_density(cell, size, radius, reach)

    monkeypatch.setattr(densities, "solid_density", counted)
    if density == 0.93:  # voids close below it
        message = r"0\.93, .* struts of 2\.\d+ mm give 0\.[89]\d*, of 2\.\d+ mm 1; need 0\.[89]"
        with pytest.raises(OptionError, match=message):
            solve_radius("sc", 5.0, density, measured=True)
    else:
        assert 0 < solve_radius("sc", 5.0, density, measured=True) < 2.5
    assert len(reaches) <= most
    assert np.isinf(reaches).sum() == (0 if density == 0.93 else 1)


@pytest.mark.parametrize("name", ["kelvin", "diamond"])
def test_struts_far_from_a_cell_have_no_part_in_its_density(name: str) -> None:
    cell = unit_cell(name)
    size = cell_size(cell, 10.0)
    whole = solid_density(cell, size, 0.8)
    assert solid_density(cell, size, 0.8, reach=1.6) == pytest.approx(whole, rel=1e-4)


def test_estimates_are_densities_of_plain_struts() -> None:
    sizes = np.full(3, 10.0)
    estimate = capsules(unit_cell("sc"), sizes)
    # Three cylinders of radius 1 through a cell: 3 · 10 π less twice what all, less what two share.
    shared, three = 16 / 3, 8 * (2 - 2**0.5)
    exact = (30 * np.pi - 3 * shared + three) / 1000
    assert estimate.density(1.0) == pytest.approx(exact, rel=0.02)
    assert estimate.radius(exact) == pytest.approx(1.0, rel=0.01)
    assert estimate.density(0.1) == pytest.approx(0.3 * np.pi / 1000, rel=0.12)
    assert estimate.density(7.08) > 0.999  # the middle of a cell is 7.07 mm away


def test_wrong_densities_are_refused_by_name() -> None:
    with pytest.raises(OptionError, match="volume is given with measured=True"):
        solve_radius("sc", 10.0, 0.1, volume=lambda skeleton: 1.0, measured=True)
    with pytest.raises(OptionError, match=r"relative density is 1.5 at \[0, 0, 0\] mm"):
        graded_radius("sc", 10.0, lambda points: points[:, 0] + 1.5)(np.zeros((2, 3)))
    with pytest.raises(OptionError, match=r"returned shape \(2, 3\) for points"):
        graded_radius("sc", 10.0, lambda points: points)(np.zeros((2, 3)))
