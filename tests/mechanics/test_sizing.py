"""Radii sized by stress and buckling."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import Skeleton
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice import tile
from scaffold_cad.mechanics import BeamModel, Load, Material, Support, beam_model, sized
from scaffold_cad.mechanics.leastmass import utilization_slopes

ALLOY = Material(70e3, 0.33, 2700.0, 200.0)


def rod(force: float, length: float = 100.0) -> BeamModel:
    strut = Skeleton([[0, 0, 0], [length, 0, 0]], [[0, 1]], 3.0)
    return beam_model(strut, ALLOY, Support([0]), Load([1], (force, 0, 0)))


def octet_beam() -> BeamModel:
    beam = tile("octet", 20.0, (4, 1, 1), radius=1.5)
    x, z = beam.nodes[:, 0], beam.nodes[:, 2]
    return beam_model(
        beam,
        ALLOY,
        [Support((x < 0.1) & (z < 0.1), "pinned"), Support((x > 79.9) & (z < 0.1), "y z")],
        Load((np.abs(x - 40) < 0.1) & (z > 19.9), (0, 0, -3000)),
    )


def test_a_pulled_rod_gets_the_area_that_its_force_needs() -> None:
    result = sized(rod(5000), least_radius=0.5)
    assert np.pi * result.radii[0] ** 2 * ALLOY.strength == pytest.approx(5000, rel=3e-3)


def test_a_pressed_rod_gets_the_inertia_that_keeps_it_from_buckling() -> None:
    result = sized(rod(-500), least_radius=0.5)
    euler = np.pi**3 / 4 * ALLOY.young * result.radii[0] ** 4 / 100**2
    assert euler == pytest.approx(500, rel=3e-3)


def test_a_rod_without_much_load_keeps_the_least_radius() -> None:
    result = sized(rod(1.0), least_radius=0.5)
    assert result.radii[0] == pytest.approx(0.5)


def test_a_bent_arm_of_pieces_becomes_the_body_of_equal_strength() -> None:
    # Galileo's problem: the radius grows with the third root of the distance from the load.
    arm = Skeleton(np.outer(np.arange(21), [5.0, 0, 0]), [[k, k + 1] for k in range(20)], 5.0)
    model = beam_model(arm, ALLOY, Support([0]), Load([20], (0, 0, -200)))
    result = sized(model, least_radius=0.5)
    lever = 100 - 5.0 * np.arange(18)
    expected = (4 * 200 * lever / (np.pi * ALLOY.strength)) ** (1 / 3)
    np.testing.assert_allclose(result.radii[:18], expected, rtol=5e-3)


def test_octet_beam_in_three_point_bending_is_lighter_and_not_overloaded() -> None:
    model = octet_beam()
    result = sized(model, least_radius=0.4)
    assert result.solution.utilization.max() <= 1.0
    assert len(result.overloaded) == 0
    assert result.radii.min() >= 0.4 * (1 - 1e-9)
    # The same strength with one radius for all struts.
    even = sized(
        model, least_radius=0.4, groups=np.zeros(len(model.skeleton.edges)), least_mass=False
    )
    assert result.mass < 0.6 * even.mass
    # The linear programs never make it heavier.
    stressed = sized(model, least_radius=0.4, least_mass=False)
    assert result.mass <= stressed.mass * 1.001
    np.testing.assert_array_equal(result.skeleton.edge_radii[:, 0], result.radii)


def test_struts_of_one_group_get_one_radius() -> None:
    model = octet_beam()
    middle = model.skeleton.nodes[model.skeleton.edges].mean(axis=1)
    groups = np.unique(
        np.round(np.abs(middle - [40, 10, 10]) * [1, 1, 0] + middle * [0, 0, 1], 6),
        axis=0,
        return_inverse=True,
    )[1].reshape(-1)
    result = sized(model, least_radius=0.4, groups=groups)
    for group in np.unique(groups):
        assert np.ptp(result.radii[groups == group]) == 0
    assert result.solution.utilization.max() <= 1.0


def test_slopes_are_those_of_solutions_with_other_radii() -> None:
    model = octet_beam()
    before = model.solved()
    slopes = utilization_slopes(before, np.arange(len(model.skeleton.edges)))
    for strut in (0, 17, 60):
        radii = model.edge_radii.copy()
        radii[strut] *= np.exp(1e-4)
        after = model.with_edge_radii(radii).solved()
        difference = (after.utilization - before.utilization) / 1e-4
        np.testing.assert_allclose(slopes[:, strut], difference, atol=2e-3 * np.abs(slopes).max())


def test_what_no_radius_can_carry_is_told() -> None:
    result = sized(rod(5000), least_radius=0.5, largest_radius=1.0)
    assert result.overloaded.tolist() == [0]
    assert result.radii[0] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"least_radius": 0.0}, "least_radius is 0 mm"),
        ({"least_radius": 1e9}, "least_radius is 1e\\+09 mm; need 0.0001 to 1e\\+05 mm for struts"),
        ({"least_radius": 1e-99}, "least_radius is 1e-99 mm; need 0.0001 to"),
        ({"least_radius": 1.0, "largest_radius": 0.5}, "largest_radius is 0.5 mm; need more"),
        ({"least_radius": 1.0, "groups": [0, 1]}, r"groups has shape \(2,\); need \(1,\)"),
        ({"least_radius": 1.0, "steps": 0}, "steps is 0"),
    ],
)
def test_bad_arguments_are_named(options: dict[str, float], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        sized(rod(1.0), **options)  # type: ignore[arg-type]


def test_a_material_without_strength_is_refused() -> None:
    strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    model = beam_model(strut, Material(1e3), Support([0]))
    with pytest.raises(OptionError, match="strength is inf MPa; need a finite one to size"):
        sized(model, least_radius=1.0)
    with pytest.raises(OptionError, match="density is 0 kg/m³; need > 0 to size"):
        sized(beam_model(strut, Material(1e3, strength=9.0), Support([0])), least_radius=1.0)


def test_struts_that_become_thicker_than_long_are_told(caplog: pytest.LogCaptureFixture) -> None:
    sized(rod(5000.0), least_radius=0.5)
    assert not caplog.records
    sized(rod(2e9), least_radius=0.5)
    assert "radii sized: 1 of 1 edge thicker than long (middle radius 1784" in caplog.text
    assert "length between branch points 100 mm): check the loads?" in caplog.text
