"""Beams against closed forms and other programs."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import Skeleton
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice import tile
from scaffold_cad.mechanics import BeamSolution, Load, Material, Support, beam_model
from tests.mechanics.peers import pynite_displacements

STEEL = Material(210e3, 0.3, 7850.0, 235.0)
ARM = Skeleton([[0, 0, 0], [100, 0, 0]], [[0, 1]], 5.0)
AREA, INERTIA = np.pi * 25, np.pi / 4 * 625
SHEAR = STEEL.shear_factor() * STEEL.shear_modulus * AREA


def turned(skeleton: Skeleton, seed: int) -> tuple[Skeleton, np.ndarray]:
    """Return the skeleton turned at random and the rotation."""
    rotation = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    rotation *= np.linalg.det(rotation)
    return skeleton.moved(skeleton.nodes @ rotation.T), rotation


@pytest.mark.parametrize("seed", range(5))
def test_cantilever_bends_and_shears_as_timoshenko_says_in_any_direction(seed: int) -> None:
    arm, rotation = turned(ARM, seed)
    load = Load([1], rotation @ [0, 0, -100])
    solution = beam_model(arm, STEEL, Support([0]), load).solved()
    sag = -100 * (100**3 / (3 * STEEL.young * INERTIA) + 100 / SHEAR)
    tilt = 100 * 100**2 / (2 * STEEL.young * INERTIA)
    np.testing.assert_allclose(rotation.T @ solution.displacements[1], [0, 0, sag], atol=1e-12)
    np.testing.assert_allclose(rotation.T @ solution.rotations[1], [0, tilt, 0], atol=1e-12)
    np.testing.assert_allclose(rotation.T @ solution.reactions[0, :3], [0, 0, 100], atol=1e-8)
    np.testing.assert_allclose(rotation.T @ solution.reactions[0, 3:], [0, -1e4, 0], atol=1e-7)
    assert solution.stresses[0] == pytest.approx(1e4 * 5 / INERTIA)


def test_pull_and_twist_of_a_tube() -> None:
    tube = beam_model(ARM, STEEL, Support([0]), Load([1], (1e3, 0, 0), (5e3, 0, 0)), hollow=0.8)
    solution = tube.solved()
    area, polar = AREA * (1 - 0.8**2), 2 * INERTIA * (1 - 0.8**4)
    assert solution.displacements[1, 0] == pytest.approx(1e3 * 100 / STEEL.young / area)
    assert solution.rotations[1, 0] == pytest.approx(5e3 * 100 / STEEL.shear_modulus / polar)
    assert solution.axial[0] == pytest.approx([1e3, 1e3])
    assert solution.stresses[0] == pytest.approx(np.hypot(1e3 / area, 3**0.5 * 5e3 * 5 / polar))
    assert solution.mass == pytest.approx(area * 100 * 7850e-9)


def test_tapered_cantilever_is_the_integral_of_its_curvature() -> None:
    cone = ARM.with_edge_radii([[6.0, 3.0]])
    solution = beam_model(cone, STEEL, Support([0]), Load([1], (0, 1, 0))).solved()
    x = (np.arange(200_000) + 0.5) * 100 / 200_000
    r = 6 - 3 * x / 100
    bending, shear = np.pi / 4 * r**4, STEEL.shear_factor() * STEEL.shear_modulus * np.pi * r**2
    sag = np.mean((100 - x) ** 2 / STEEL.young / bending + 1 / shear) * 100
    assert solution.displacements[1, 1] == pytest.approx(sag, rel=1e-8)


@pytest.mark.parametrize("radii", [(16.0, 2.0), (2.0, 16.0), (5.0, 0.05), (0.05, 5.0)])
def test_steep_cones_are_as_stiff_and_as_heavy_as_their_integrals_say(
    radii: tuple[float, float],
) -> None:
    cone = ARM.with_edge_radii([radii])
    pulled = beam_model(cone, STEEL, Support([0]), Load([1], (1, 0, 0), (1, 0, 0))).solved()
    pressed = beam_model(cone, STEEL, Support([0]), Load([1], (0, 0, -1))).solved()
    heavy = beam_model(cone, STEEL, Support([0]), (), gravity=(0, 0, -9.81)).solved()
    edges = np.geomspace(*radii, 40_001)  # of slices with equal ratios of radii
    r, lever = (np.sqrt(edges[1:] * edges[:-1]), (edges - radii[1]) / (radii[0] - radii[1]) * 100)
    step, lever = lever[:-1] - lever[1:], (lever[1:] + lever[:-1]) / 2
    bending, shear = STEEL.young * np.pi / 4 * r**4, STEEL.shear_modulus * np.pi * r**2
    shear *= STEEL.shear_factor()
    weight = np.pi * 7850e-9 * 9.81 * lever / 12
    beyond = 4 * weight * (r**2 + r * radii[1] + radii[1] ** 2)
    moment = weight * lever * (r**2 + 2 * r * radii[1] + 3 * radii[1] ** 2)
    sag = (step * (lever**2 / bending + 1 / shear)).sum()
    own = (step * (moment * lever / bending + beyond / shear)).sum()
    twist = 2 / (3 * np.pi * STEEL.shear_modulus) * 100 * (radii[0] ** -3 - radii[1] ** -3)
    assert pressed.displacements[1, 2] == pytest.approx(-sag, rel=1e-6)
    assert heavy.displacements[1, 2] == pytest.approx(-own, rel=1e-6)
    assert pulled.rotations[1, 0] == pytest.approx(twist / (radii[1] - radii[0]), rel=1e-9)
    stretch = 100 / STEEL.young / np.pi / np.prod(radii)
    assert pulled.displacements[1, 0] == pytest.approx(stretch, rel=1e-9)


@pytest.mark.parametrize(("thick", "pull"), [(8.0, 0.0), (16.0, 0.0), (16.0, 1.0)])
def test_stress_of_a_cone_is_the_largest_along_it(thick: float, pull: float) -> None:
    cone = ARM.with_edge_radii([[thick, 2.0]])
    solution = beam_model(cone, STEEL, Support([0]), Load([1], (pull, 0, -1))).solved()
    u = np.linspace(0, 1, 100_001)
    r = thick + (2 - thick) * u
    along = (4 * 100 * (1 - u) / r + pull) / np.pi / r**2
    assert solution.stresses[0] == pytest.approx(along.max(), rel=1e-9 if pull == 0 else 0.02)


def test_many_even_pieces_of_a_cone_give_the_same_sag() -> None:
    cone = ARM.with_edge_radii([[6.0, 3.0]])
    whole = beam_model(cone, STEEL, Support([0]), (), gravity=(0, 0, -9.81)).solved()
    places = np.linspace(0, 1, 401)
    chain = Skeleton(
        np.outer(places, [100, 0, 0]),
        np.stack([np.arange(400), np.arange(1, 401)], axis=1),
        edge_radii=6 - 3 * (places[1:] + places[:-1]) / 2,
    )
    pieces = beam_model(chain, STEEL, Support([0]), (), gravity=(0, 0, -9.81)).solved()
    np.testing.assert_allclose(whole.displacements[1], pieces.displacements[-1], rtol=1e-4)
    np.testing.assert_allclose(whole.reactions[0], pieces.reactions[0], rtol=1e-4, atol=1e-10)
    assert whole.stresses[0] == pytest.approx(pieces.stresses.max(), rel=2e-3)


def test_clamped_beam_under_its_weight_has_the_moments_of_the_tables() -> None:
    beam = beam_model(ARM, STEEL, Support([0, 1]), (), gravity=(0, 0, -9.81)).solved()
    weight = AREA * 100 * 7850e-9 * 9.81
    np.testing.assert_allclose(beam.reactions[0, 2], weight / 2)
    np.testing.assert_allclose(beam.reactions[0, 4], -weight * 100 / 12)
    np.testing.assert_allclose(beam.reactions[1, 4], weight * 100 / 12)


def test_portal_frame_sways_as_the_slope_deflection_method_says() -> None:
    height, span, radius = 1000.0, 1500.0, 5.0
    frame = Skeleton(
        [[0, 0, 0], [0, 0, height], [span, 0, height], [span, 0, 0]],
        [[0, 1], [1, 2], [2, 3]],
        radius,
    )
    solution = beam_model(frame, STEEL, Support([0, 3]), Load([1, 2], (10, 0, 0))).solved()
    ratio = height / span  # stiffness of the beam over that of a column
    sway = 10 * height**3 / (12 * STEEL.young * INERTIA) * (2 + 3 * ratio) / (1 + 6 * ratio)
    assert solution.displacements[1, 0] == pytest.approx(sway, rel=1e-3)


def test_euler_load_of_a_hinged_strut() -> None:
    press = Load([1], (-1000, 0, 0))
    free = beam_model(ARM, STEEL, Support([0]), press).solved()
    euler = np.pi**2 * STEEL.young * INERTIA / 100**2
    assert free.buckling_utilization[0] == pytest.approx(1000 / euler)
    flag = beam_model(ARM, STEEL, Support([0]), press, effective_length=2).solved()
    assert flag.buckling_utilization[0] == pytest.approx(4000 / euler)
    assert flag.utilization[0] == max(flag.stress_utilization[0], flag.buckling_utilization[0])


def test_moved_support_stretches_the_strut() -> None:
    pulled = beam_model(ARM, STEEL, [Support([0]), Support([1], "x", 0.1)]).solved()
    force = 0.1 * STEEL.young * AREA / 100
    assert pulled.reactions[:, 0] == pytest.approx([-force, force])
    assert pulled.compliance == pytest.approx(force * 0.1)


def test_rigid_ends_leave_less_to_bend() -> None:
    stiff = beam_model(ARM, STEEL, Support([0]), Load([1], (0, 0, -1)), rigid_ends=[[20.0, 0.0]])
    expected = 80**3 / (3 * STEEL.young * INERTIA) + 80 / SHEAR
    assert stiff.solved().displacements[1, 2] == pytest.approx(-expected)


def test_large_lattice_is_solved_as_a_factored_one(monkeypatch: pytest.MonkeyPatch) -> None:
    lattice = tile("kelvin", 10.0, (4, 4, 4), radius=0.5)

    def solution() -> BeamSolution:
        return beam_model(
            lattice,
            STEEL,
            Support(lambda nodes: nodes[:, 2] < 0.1),
            Load(lambda nodes: nodes[:, 2] > 39.9, (3, 0, -10)),
        ).solved()

    factored = solution()
    monkeypatch.setattr("scaffold_cad.mechanics.solvers.DIRECT_NODES", 0)
    monkeypatch.setattr("scaffold_cad.mechanics.solvers.COARSE_NODES", 20)
    iterated = solution()
    scale = factored.largest_displacement
    np.testing.assert_allclose(
        iterated.displacements, factored.displacements, rtol=0, atol=1e-7 * scale
    )
    np.testing.assert_allclose(iterated.stresses, factored.stresses, rtol=1e-5)


def test_forces_balance_at_every_node() -> None:
    lattice = tile("octet", 10.0, (2, 2, 2), radius=0.6)
    model = beam_model(
        lattice,
        STEEL,
        Support(lambda nodes: nodes[:, 2] < 0.1),
        Load(lambda nodes: nodes[:, 2] > 19.9, (3, 0, -10), (0, 50, 0)),
        gravity=(0, 0, -9.81),
    )
    solution = model.solved()
    at_nodes = np.zeros((len(lattice.nodes), 6))
    np.add.at(at_nodes, lattice.edges, solution.end_forces)
    np.testing.assert_allclose(at_nodes, model.forces + solution.reactions, atol=1e-8)
    weight = model.mass * 9.81
    assert solution.reactions[:, 2].sum() == pytest.approx(10 + weight)


def test_a_part_without_support_is_named() -> None:
    two = Skeleton([[0, 0, 0], [9, 0, 0], [0, 9, 0], [9, 9, 0]], [[0, 1], [2, 3]], 1.0)
    with pytest.raises(OptionError, match="part of 2 nodes with node 2 has no support"):
        beam_model(two, STEEL, Support([0])).solved()


def test_a_hinge_that_lets_the_strut_turn_is_named() -> None:
    with pytest.raises(OptionError, match="can still move about x: its supports hold 5 of 6"):
        beam_model(ARM, STEEL, Support([0, 1], "pinned")).solved()


def test_freedoms_that_do_not_exist_are_refused_where_they_are_given() -> None:
    with pytest.raises(OptionError, match="fixed is 'up'; need all, pinned, or some of x y z"):
        Support([0], "up")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"hollow": 1.0}, "hollow is 1; need 0 or more, less than 1"),
        ({"rigid_ends": 50.0}, "edge 0 of length 100 mm has rigid ends of 100 mm"),
        ({"rigid_ends": -1.0}, "rigid_ends is -1.0; need a number >= 0"),
        ({"gravity": (0, 0)}, "gravity is"),
        ({"supports": Support([], "all")}, "support 0 is on no node"),
        ({"supports": Support([0], "x", (1, 2))}, "displacement of support 0"),
        ({"loads": Load([5])}, "need 0 to 1"),
        ({"loads": Load([0], (1, 2))}, "force of load 0 is"),
        ({"material": "cheese"}, "material is 'cheese'; need one of steel"),
    ],
)
def test_bad_arguments_are_named(change: dict[str, object], message: str) -> None:
    given = {"material": STEEL, "supports": Support([0]), "loads": Load([1], (1, 0, 0))}
    with pytest.raises(OptionError, match=message):
        beam_model(ARM, **{**given, **change})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"young": 0.0}, "Young's modulus is 0 MPa"),
        ({"poisson": 0.5}, "Poisson's ratio is 0.5"),
        ({"strength": 0.0}, "strength is 0 MPa"),
        ({"density": -1.0}, "density is -1"),
    ],
)
def test_bad_materials_are_refused(change: dict[str, float], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        Material(**{"young": 1.0, **change})


def test_a_lack_of_memory_is_one_clear_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(matrix: object) -> None:
        raise MemoryError

    monkeypatch.setattr("scaffold_cad.mechanics.solvers.factor", full)
    with pytest.raises(OptionError, match="the equations of 2 nodes do not fit into memory"):
        beam_model(ARM, STEEL, Support([0])).solved()


def test_steps_that_do_not_converge_are_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scaffold_cad.mechanics.solvers.DIRECT_NODES", 0)
    monkeypatch.setattr("scaffold_cad.mechanics.solvers.COARSE_NODES", 20)
    monkeypatch.setattr("scaffold_cad.mechanics.solvers.MOST_ROUNDS", 2)
    lattice = tile("octet", 10.0, (3, 3, 3), radius=0.5)
    model = beam_model(lattice, STEEL, Support([0]), Load([5], (0, 0, 1)))
    with pytest.raises(OptionError, match="did not converge in 2 steps"):
        model.solved()


def test_results_are_read_only() -> None:
    solution = beam_model(ARM, STEEL, Support([0]), Load([1], (1, 0, 0))).solved()
    for array in (solution.displacements, solution.end_forces, solution.utilization):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


def test_deformed_skeleton_is_moved_by_the_scaled_displacements() -> None:
    solution = beam_model(ARM, STEEL, Support([0]), Load([1], (0, 0, -100))).solved()
    bent = solution.deformed(10.0)
    np.testing.assert_allclose(bent.nodes - ARM.nodes, 10 * solution.displacements)


@pytest.mark.parametrize("count", [2, 5])
def test_pynite_finds_the_same_displacements(count: int) -> None:
    top = 10.0 * count - 0.1
    model = beam_model(
        tile("bcc", 10.0, (count, count, count), radius=0.2),
        Material(210e3, 0.3),
        Support(lambda nodes: nodes[:, 2] < 0.1),
        Load(lambda nodes: nodes[:, 2] > top, (1, 0, -4), each=True),
    )
    ours, theirs = model.solved(), pynite_displacements(model)
    # PyNite's members are Euler's: they do not shear.
    np.testing.assert_allclose(
        ours.displacements, theirs, atol=0.005 * ours.largest_displacement, rtol=0
    )


def tip(thin: float) -> tuple[BeamSolution, float]:
    """Return a thick strut on a thin one, and how far its tip moves in closed form, mm."""
    arm = Skeleton([[0, 0, 0], [10, 0, 0], [20, 0, 0]], [[0, 1], [1, 2]], 1.0)
    radii = np.array([thin, 100.0])
    model = beam_model(arm, STEEL, Support([0]), Load([2], (0, 0, -1)), edge_radii=radii)
    levers = np.array([20.0**3 - 10.0**3, 10.0**3]) / 3
    bends = levers / (STEEL.young * np.pi / 4 * radii**4)
    shears = 10.0 / (STEEL.shear_factor(0.0) * STEEL.shear_modulus * np.pi * radii**2)
    return model.solved(), float((bends + shears).sum())


@pytest.mark.parametrize(("thin", "error"), [(1.0, 1e-12), (0.1, 1e-6)])
def test_thick_struts_do_not_hide_how_thin_ones_bend(thin: float, error: float) -> None:
    solution, expected = tip(thin)
    assert -solution.displacements[2, 2] == pytest.approx(expected, rel=error)
    assert solution.reactions[0, 4] == pytest.approx(-20.0, rel=error)


@pytest.mark.parametrize(
    ("thin", "message"),
    [
        (
            0.01,
            r"node [12] at \[[12]0, 0, 0\] mm is .* N out of balance, of loads of 1 N: .* less",
        ),
        (1e-6, "the equations of 18 freedoms cannot be solved: .* need struts that differ less"),
    ],
)
def test_struts_that_rounding_hides_are_refused(thin: float, message: str) -> None:
    with pytest.raises(OptionError, match=message):
        tip(thin)
