import numpy as np
import pytest

from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.partition import partition_spheres
from scaffold_cad.partition.arcs import side_twins
from scaffold_cad.struts.blending.fits import free_of_pulls, patch_fit
from scaffold_cad.struts.blending.joins import valences
from scaffold_cad.struts.blending.layouts import Layout
from scaffold_cad.struts.blending.quarter import DEGREE
from scaffold_cad.struts.blending.splines import SMOOTHNESS, spline
from scaffold_cad.struts.blending.system import System, system_of
from tests.struts.stars import random_stars

TWINS = side_twins(partition_spheres(random_stars(1, 4, 40, np.random.default_rng(0))).quads)[0]
LAYOUTS = [Layout(1, 1, 5), Layout(2, 2, 4), Layout(1, 2, 4)]
AT = np.linspace(0, 1, 9)


def patches(system: System, free: np.ndarray, given: np.ndarray, core: np.ndarray) -> np.ndarray:
    """Return the control points (4 N, n_u, n_v) of one coordinate."""
    rim = free @ system.rim_of_free + given @ system.rim_of_given
    return np.concatenate([rim, given, core])[system.net.number]


@pytest.mark.parametrize("layout", LAYOUTS)
def test_free_numbers_keep_the_joins(layout: Layout) -> None:
    rng, system = np.random.default_rng(2), system_of(TWINS, layout)
    core = rng.normal(size=system.net.count - system.net.rim - system.net.given)
    free = rng.normal(size=len(system.rim_of_free))
    points = patches(system, free, np.zeros(system.net.given), core)
    u, v = layout.u, layout.v
    sides = np.arange(len(TWINS))
    following = (sides & ~3) | ((sides + 1) & 3)
    cosines = 2 * np.cos(2 * np.pi / valences(TWINS))
    zero, one = np.zeros(1), np.ones(1)
    across = [
        (v.values_at(AT) @ points.transpose(0, 2, 1) @ u.values_at(end, 1).T)[..., 0]
        for end in (zero, one)
    ]
    spoke = points[:, -1] @ v.values_at(AT, 1).T
    alpha = cosines[following][:, None] * (1 - AT)
    assert across[0][following] - across[1] == pytest.approx(alpha * spoke, abs=1e-9)
    across = (u.values_at(AT) @ points @ v.values_at(zero, 1).T)[..., 0]
    arc = points[:, :, 0] @ u.values_at(AT, 1).T
    ends = cosines[:, None], cosines[following][:, None]
    alpha = ends[0] * (1 - AT) ** 2 - ends[1] * AT**2
    assert across + across[TWINS][:, ::-1] == pytest.approx(alpha * arc, abs=1e-9)


@pytest.mark.parametrize("layout", LAYOUTS)
def test_fit_is_the_least_squares_solution(layout: Layout) -> None:
    rng, stiffness = np.random.default_rng(1), 1e-3
    system, patch = system_of(TWINS, layout), patch_fit(layout, stiffness)
    wanted = rng.normal(size=(len(TWINS), len(layout.weights)))
    given = rng.normal(size=system.net.given)
    known = patches(system, np.zeros(len(system.rim_of_free)), given, np.zeros(10**4))
    known = known.reshape(len(TWINS), -1)[:, layout.given]
    fixed = (given @ system.rim_of_given)[system.rims]
    pulls = wanted @ patch.pulls_of_samples + known @ patch.pulls_of_given
    pulls += fixed @ patch.pulls_of_rim
    at_free = system.pulls_at_free(pulls.reshape(1, -1))[0]
    best = at_free @ free_of_pulls(TWINS, layout, stiffness)
    rims = (best @ system.rim_of_free)[system.rims] + fixed
    core = wanted @ patch.core_of_samples + rims @ patch.core_of_rim + known @ patch.core_of_given
    found = np.zeros(system.net.count - system.net.rim - system.net.given)
    place = system.net.number.reshape(len(TWINS), -1)[:, layout.core]
    found[place - system.net.rim - system.net.given] = core

    def energy(free: np.ndarray, core: np.ndarray) -> float:
        points = patches(system, free, given, core)
        u, v = ([one.products(order) for order in range(3)] for one in (layout.u, layout.v))
        plate = sum(
            weight * np.einsum("pij,ik,pkl,jl->", points, u[a], points, v[b])
            for a, b, weight in ((2, 0, 1), (1, 1, 2), (0, 2, 1))
        )
        samples = layout.u.values(layout.at) @ points @ layout.v.values(layout.at).T
        off = samples.reshape(wanted.shape) - wanted
        return float((layout.weights * off**2).sum() + stiffness * plate)

    lowest = energy(best, found)
    for _ in range(5):
        free, inner = 1e-3 * rng.normal(size=best.shape), 1e-3 * rng.normal(size=found.shape)
        more, less = energy(best + free, found + inner), energy(best - free, found - inner)
        assert more > lowest
        assert more - lowest == pytest.approx(less - lowest, rel=1e-4)


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
