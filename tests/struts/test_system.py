import numpy as np
import pytest

from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.partition import partition_spheres
from scaffold_cad.partition.arcs import side_twins
from scaffold_cad.struts.quarter import DEGREE
from scaffold_cad.struts.splines import SMOOTHNESS, spline
from scaffold_cad.struts.system import Layout, equations, fit_of, net_of, system_of
from tests.struts.stars import random_stars

TWINS = side_twins(partition_spheres(random_stars(1, 4, 40, np.random.default_rng(0))).quads)[0]
LAYOUTS = [Layout(1, 1, 5), Layout(2, 2, 4)]


@pytest.mark.parametrize("layout", LAYOUTS)
def test_free_numbers_keep_the_joins(layout: Layout) -> None:
    system = system_of(TWINS, layout)
    left = equations(TWINS, net_of(TWINS, layout), layout) @ system.points_of_free.T
    assert np.abs(left).max() < 1e-10


@pytest.mark.parametrize("layout", LAYOUTS)
def test_fit_is_the_least_squares_solution(layout: Layout) -> None:
    rng = np.random.default_rng(1)
    system, stiffness = system_of(TWINS, layout), 1e-3
    fit = fit_of(TWINS, layout, stiffness)
    wanted = rng.normal(size=(1, system.samples_of_free.shape[1]))
    given = rng.normal(size=(1, len(system.given)))
    best = wanted @ fit.free_of_samples + given @ fit.free_of_given

    def energy(free: np.ndarray) -> float:
        points = free @ system.points_of_free + given @ system.points_of_given
        samples = free @ system.samples_of_free + given @ system.samples_of_given
        u, v = ([one.products(order) for order in range(3)] for one in (layout.u, layout.v))
        patches = points[0][system.net.number]
        plate = sum(
            weight * np.einsum("pij,ik,pkl,jl->", patches, u[a], patches, v[b])
            for a, b, weight in ((2, 0, 1), (1, 1, 2), (0, 2, 1))
        )
        weights = np.tile(layout.weights, len(TWINS))
        return float((weights * (samples - wanted) ** 2).sum() + stiffness * plate)

    lowest = energy(best)
    for _ in range(5):
        change = 1e-3 * rng.normal(size=best.shape)
        assert energy(best + change) > lowest
        assert energy(best + change) - lowest == pytest.approx(
            energy(best - change) - lowest, rel=1e-4
        )


@pytest.mark.parametrize("pieces", [1, 2, 3])
def test_pieces_are_those_of_the_spline(pieces: int) -> None:
    one = spline(pieces)
    at = np.linspace(0, 1, 7)
    whole = one.values_at(np.concatenate([(at + k) / pieces for k in range(pieces)]))
    for order in range(SMOOTHNESS + 1):
        for k in range(1, pieces):
            left = bernstein(DEGREE, np.array([1.0]), order) @ one.extraction[k - 1]
            right = bernstein(DEGREE, np.array([0.0]), order) @ one.extraction[k]
            assert left == pytest.approx(right, abs=1e-9)
    assert whole == pytest.approx(one.values(at), abs=1e-12)
    assert whole.sum(axis=1) == pytest.approx(1)


@pytest.mark.parametrize("pieces", [1, 2, 3])
def test_refined_polynomials_are_the_same(pieces: int) -> None:
    rng, at = np.random.default_rng(3), np.linspace(0, 1, 31)
    coefficients = rng.normal(size=DEGREE + 1)
    refined = spline(pieces).refinement @ coefficients
    assert spline(pieces).values_at(at) @ refined == pytest.approx(
        bernstein(DEGREE, at) @ coefficients
    )
