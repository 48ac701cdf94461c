"""Relative density: the first-order formula, and the one measured on solids."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scaffold_cad.errors import OptionError
from scaffold_cad.filling import solve_radius
from scaffold_cad.lattice import cells, measured_density, relative_density, tile
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton

# Strut length in a cell of size 1 (and its volume for the hexagonal prism, 1 · √3 · 1), times π.
COEFFICIENTS = {
    "sc": 3 * np.pi,
    "bcc": 4 * np.sqrt(3) * np.pi,
    "bcc_sc": (4 * np.sqrt(3) + 3) * np.pi,
    "bccz": (4 * np.sqrt(3) + 1) * np.pi,
    "fcc": 6 * np.sqrt(2) * np.pi,
    "octet": 12 * np.sqrt(2) * np.pi,
    "kelvin": 6 * np.sqrt(2) * np.pi,
    "diamond": 4 * np.sqrt(3) * np.pi,
    "rhombic_dodecahedron": 8 * np.sqrt(3) * np.pi,
    "truncated_cube": 15 * (np.sqrt(2) - 1) * np.pi,
    "cuboctahedron": 6 * np.sqrt(2) * np.pi,
    "auxetic": (0.75 + 0.75 + 8 * 0.75) * np.pi,
    "hexagonal_prism": (6 / np.sqrt(3) + 4) / np.sqrt(3) * np.pi,
    "gyroid": 3 * np.sqrt(2) * np.pi,
    "fbcc": (6 * np.sqrt(2) + 4 * np.sqrt(3)) * np.pi,
    "star": (4 * np.sqrt(3) + 3) * np.pi,
    "pyrochlore": 12 * np.sqrt(2) * np.pi,
    "weaire_phelan": np.pi
    * (8 * np.sqrt(3) / 12 + 48 * np.sqrt(525) / 96 + 12 * 5 / 16 + 24 * np.sqrt(45) / 32),
    "triangular_prism": 8 / np.sqrt(3) * np.pi,
    "reentrant_honeycomb": (4 / np.sqrt(3) + 4 / np.sqrt(3) + 4) / np.sqrt(3) * np.pi,
}


def cylinders(skeleton: Skeleton) -> float:
    """Return the volume of the struts, what overlaps counted as often as it does."""
    return float(np.pi * (skeleton.radii[skeleton.edges[:, 0]] ** 2 * skeleton.lengths).sum())


def cylinders_without_overlaps(skeleton: Skeleton) -> float:
    """Return roughly the volume of the struts: at a node all but one give up a half ball."""
    overlaps = (skeleton.valency - 1) * skeleton.radii**3
    return cylinders(skeleton) - float(2 / 3 * np.pi * overlaps.sum())


@pytest.mark.parametrize("name", cells())
def test_the_coefficient_of_a_cell_is_its_strut_length_over_its_volume(name: str) -> None:
    assert cells()[name].density_coefficient == pytest.approx(COEFFICIENTS[name], rel=1e-12)
    assert relative_density(name, 8.0, 0.4) == pytest.approx(COEFFICIENTS[name] * 0.05**2)


def test_the_density_of_a_stretched_cell_counts_its_true_lengths() -> None:
    # Three struts of 2, 3 and 6 mm in 36 mm³.
    assert relative_density("sc", (2.0, 3.0, 6.0), 0.5) == pytest.approx(np.pi / 4 * 11 / 36)


@given(
    name=st.sampled_from(sorted(cells())), size=st.floats(0.1, 100.0), density=st.floats(1e-4, 0.5)
)
def test_the_radius_solved_for_has_the_density(name: str, size: float, density: float) -> None:
    radius = solve_radius(name, size, density)
    assert relative_density(name, size, radius) == pytest.approx(density, rel=1e-12)


@pytest.mark.parametrize("name", cells())
def test_the_measured_density_of_bare_cylinders_is_that_of_first_order(name: str) -> None:
    measured = measured_density(name, 5.0, 0.3, cylinders)
    assert measured == pytest.approx(relative_density(name, 5.0, 0.3), rel=1e-9)


def test_the_measured_density_has_no_part_of_the_block_s_outside() -> None:
    # Per cell of BCC two nodes of valency 8, though nodes on the block's outside have less.
    overlap = 2 * 7 * 2 / 3 * np.pi * 0.3**3 / 5.0**3
    measured = measured_density("bcc", 5.0, 0.3, cylinders_without_overlaps)
    assert measured == pytest.approx(relative_density("bcc", 5.0, 0.3) - overlap, rel=1e-9)


def test_the_measured_density_of_scaffolds_is_the_growth_of_large_blocks() -> None:
    def volume(skeleton: Skeleton) -> float:
        return build_scaffold(skeleton).mesh.signed_volume

    def block(n: int) -> float:
        return volume(tile("sc", 10.0, n, radius=0.5))

    inside = (block(5) - 3 * block(4) + 3 * block(3) - block(2)) / 6  # third difference of n³
    assert measured_density("sc", 10.0, 0.5, volume) == pytest.approx(inside / 1000, rel=1e-6)


@settings(max_examples=20)
@given(name=st.sampled_from(["sc", "bcc", "kelvin", "diamond"]), density=st.floats(0.01, 0.2))
def test_the_radius_solved_for_on_solids_has_the_measured_density(
    name: str, density: float
) -> None:
    radius = solve_radius(name, 5.0, density, volume=cylinders_without_overlaps)
    assert radius > solve_radius(name, 5.0, density)  # overlaps take something away
    measured = measured_density(name, 5.0, radius, cylinders_without_overlaps)
    assert measured == pytest.approx(density, rel=1e-3)


@pytest.mark.parametrize("fraction", [0.1, 1e6])
def test_a_density_that_no_radius_has_is_refused(fraction: float) -> None:
    with pytest.raises(OptionError, match=r"no radius gives relative density 0\.5: the last"):
        solve_radius(
            "sc", 5.0, 0.5, volume=lambda skeleton: fraction * 5.0**3 * len(skeleton.edges)
        )


@pytest.mark.parametrize("density", [0.0, 1.0, -0.1, np.nan])
def test_a_density_out_of_range_is_refused(density: float) -> None:
    with pytest.raises(OptionError, match=r"relative density is .*; need more than 0, less than 1"):
        solve_radius("sc", 5.0, density)


def test_a_radius_out_of_range_is_refused() -> None:
    with pytest.raises(OptionError, match="radius is 0 mm; need > 0"):
        relative_density("sc", 5.0, 0.0)


def test_struts_too_thick_for_a_density_are_refused() -> None:
    most = 5 / np.sqrt(COEFFICIENTS["sc"])
    assert relative_density("sc", 5.0, most * (1 - 1e-9)) == pytest.approx(1.0)
    # As when size and radius are given the wrong way round.
    with pytest.raises(OptionError, match=r"radius is 5 mm, .* 942; need less than 0\.163 mm"):
        relative_density("sc", 0.5, 5.0)
