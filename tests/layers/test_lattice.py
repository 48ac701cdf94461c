"""Layers of lattices of which some cells are made are those of the whole."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from scaffold_cad import Layer, PeriodicLattice, UnitCell, round_struts, slices
from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.layers import lattice as module
from scaffold_cad.layers import slabs
from scaffold_cad.layers.lattice import RepeatedLattice, lattice_solid
from scaffold_cad.layers.uniting import Solid, united


def check_equal(one: Layer, other: Layer) -> None:
    """Check that two layers have as many polygons, and next to nothing is in one alone."""
    first, second = united(one.loops), united(other.loops)
    assert len(one.loops) == len(other.loops)
    assert ((first - second) + (second - first)).area() < 1e-4 * other.area + 1e-9


def check_same(lattice: PeriodicLattice, heights: Floats, **options: Any) -> None:
    whole = list(slices(round_struts(lattice.skeleton()), heights, **options))
    found = list(slices(lattice, heights, **options))
    assert [layer.height for layer in found] == heights.tolist()
    for one, other in zip(found, whole, strict=True):
        check_equal(one, other)


@pytest.mark.parametrize(
    ("cell", "counts", "radius"),
    [
        ("bcc", (8, 9, 9), 0.1),
        ("octet", (8, 2, 8), 0.06),  # its polygons go on from cell to cell at its nodes
        ("sc", (2, 9, 8), 0.1),
        ("diamond", (8, 8, 2), 0.08),
    ],
)
def test_a_lattice_that_repeats_itself_has_the_layers_of_the_whole(
    cell: str, counts: tuple[int, int, int], radius: float
) -> None:
    lattice = PeriodicLattice(cell, 1.0, counts, radius=radius, origin=[0.3, -7.0, 5.0])
    heights = 5.0 + np.linspace(-0.2, counts[2] + 0.2, 14)
    assert isinstance(lattice_solid(lattice, 16), RepeatedLattice)
    check_same(lattice, heights)


def test_cells_may_lean_sideways() -> None:
    leaning = np.array([[1.0, 0, 0], [0.6, 0.8, 0], [0.3, 0.1, np.sqrt(0.9)]])
    lattice = PeriodicLattice("bcc", 1.0, (8, 8, 9), radius=0.07, axes=leaning)
    assert isinstance(lattice_solid(lattice, 16), RepeatedLattice)
    check_same(lattice, np.linspace(-0.1, 8.6, 14))


def test_cells_that_are_not_level_are_made_at_once() -> None:
    tilted = np.array([[1.0, 0, 0], [0, 0.8, 0.6], [0, -0.6, 0.8]])
    lattice = PeriodicLattice("bcc", 1.0, 2, radius=0.1, axes=tilted)
    assert isinstance(lattice_solid(lattice, 16), Solid)
    check_same(lattice, np.linspace(-1.2, 2.6, 9))


def graded(places: Points) -> Floats:
    return np.asarray(0.05 + 0.01 * places[:, 2] + 0.005 * places[:, 0])


def test_a_lattice_of_many_radii_is_made_a_few_layers_of_cells_at_a_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    lattice = PeriodicLattice("bcc", 1.0, (1, 1, 6), radius=graded)
    monkeypatch.setattr(slabs, "AT_ONCE", 1)
    check_same(lattice, np.linspace(-0.2, 6.2, 14))
    whole = slices(round_struts(lattice.skeleton()), thickness=0.1)
    found = slices(lattice, thickness=0.1)
    assert found.heights == pytest.approx(whole.heights)
    assert (found.box[0] <= [layer.bounds[0] for layer in whole if layer.loops]).all()


def test_struts_without_a_node_in_each_cell_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    rods = UnitCell("rods", [[0, 0.5, 0.5], [1, 0.5, 0.5]], [[0, 1]])
    lattice = PeriodicLattice(rods, 1.0, (20, 2, 2), radius=0.2)
    assert isinstance(lattice_solid(lattice, 16), Solid)
    (layer,) = slices(lattice, [0.5])
    assert layer.areas == pytest.approx([20 * 0.4] * 2)


def test_layers_do_not_depend_on_how_many_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    lattice = PeriodicLattice("bcc", 1.0, 9, radius=0.1)
    heights = 0.01 + 0.25 * np.arange(36)
    many = list(slices(lattice, heights))
    monkeypatch.setattr(module, "MOST_KEPT", 2)
    few = list(slices(lattice, heights))
    for one, other in zip(many, few, strict=True):
        assert np.allclose(one.points, other.points, atol=1e-9)


def test_a_region_cuts_a_lattice(monkeypatch: pytest.MonkeyPatch) -> None:
    from tests.layers.test_slices import cube

    lattice = PeriodicLattice("bcc", 1.0, 8, radius=0.1)
    check_same(lattice, np.linspace(0.2, 7.7, 9), region=cube(1.1, 6.6), skin=0.3)


def test_a_lattice_past_memory_is_cut() -> None:
    lattice = PeriodicLattice("bcc", 1.0, (60, 60, 10**5), radius=0.1)
    layers = slices(lattice, thickness=0.04)
    first, second = next(layers), next(slices(lattice, [54_321.25]))
    assert len(layers) > 2.5e6 - 1
    assert len(first.loops) == 61 * 61 - 4  # at corners one strut ends flat, and begins higher
    # Eight struts of a cell, four at a height, lean at an angle whose cosine is 1/√3.
    assert second.area == pytest.approx(4 * 3600 * np.pi * 0.01 * np.sqrt(3), rel=2e-3)


@pytest.mark.parametrize("cell", ["sc", "diamond"])
def test_fillets_ends_and_walls_are_those_asked_for(cell: str) -> None:
    options: dict[str, Any] = {"blend": 0.12, "ends": "round", "wall": 0.03}
    lattice = PeriodicLattice(cell, 1.0, (1, 8, 8), radius=0.07, **options)
    assert isinstance(lattice_solid(lattice, 16), RepeatedLattice)
    heights = np.linspace(-0.1, 8.05, 8)
    whole = list(slices(round_struts(lattice.skeleton(), **options), heights))
    for one, other in zip(slices(lattice, heights), whole, strict=True):
        check_equal(one, other)
    options["wall"] = None
    full = PeriodicLattice(cell, 1.0, (1, 8, 8), radius=0.07, **options)
    areas = [next(slices(each, [4.25])).area for each in (full, lattice)]
    assert areas[1] < 0.8 * areas[0]


def test_hollow_struts_of_many_radii_are_cut_as_those_of_the_whole(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    options: dict[str, Any] = {"ends": "open", "wall": 0.02}
    lattice = PeriodicLattice("bcc", 1.0, (1, 1, 2), radius=graded, **options)
    monkeypatch.setattr(slabs, "AT_ONCE", 1)
    heights = np.linspace(-0.1, 2.1, 5)
    whole = slices(round_struts(lattice.skeleton(), **options), heights)
    for one, other in zip(slices(lattice, heights), whole, strict=True):
        check_equal(one, other)
