import numpy as np
import pytest

from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.struts import blends
from scaffold_cad.struts.blending.proof import prove
from scaffold_cad.struts.blending.quarter import DEGREE
from tests.struts.stars import CUBIC, TRIPOD, random_stars, stars_of


def determinants(control: np.ndarray, count: int = 41) -> np.ndarray:
    at = np.linspace(0, 1, count)
    value, slope = bernstein(DEGREE, at), bernstein(DEGREE, at, 1)
    surface = np.einsum("ai,bj,...ijx->...abx", value, value, control)
    along_u = np.einsum("ai,bj,...ijx->...abx", slope, value, control)
    along_v = np.einsum("ai,bj,...ijx->...abx", value, slope, control)
    return (surface * np.cross(along_u, along_v)).sum(axis=-1)


def test_a_node_is_proved_and_its_solid_angles_fill_the_sphere() -> None:
    (found,) = blends(stars_of(CUBIC))
    assert found.proved.all()
    assert found.shapes.solid_angle == pytest.approx(4 * np.pi, abs=1e-3)
    assert found.shapes.least_cosine.min() > 0.2


def test_a_fold_is_never_proved() -> None:
    (found,) = blends(stars_of(TRIPOD))
    shapes = found.shapes
    rng = np.random.default_rng(0)
    for size in np.geomspace(0.01, 2, 12):
        control = shapes.control + size * rng.normal(size=shapes.control.shape)
        proof = prove(control, shapes.collar_distances, shapes.collar_radii)
        if determinants(control).min() <= 0:
            assert not proof.is_star_shaped[0]


def test_what_is_positive_by_a_good_margin_is_proved() -> None:
    rng = np.random.default_rng(1)
    stars = stars_of(random_stars(20, 4, 50, rng))
    for found in blends(stars):
        shapes = found.shapes
        positive = determinants(shapes.control).min(axis=(1, 2, 3)) > 0.05
        assert positive.any()
        assert shapes.is_star_shaped[positive].all()


def test_a_surface_turned_inside_out_is_not_proved() -> None:
    (found,) = blends(stars_of(TRIPOD))
    shapes = found.shapes
    control = shapes.control[:, :, ::-1]
    assert not prove(control, shapes.collar_distances, shapes.collar_radii).is_star_shaped[0]


def test_a_second_covering_of_the_sphere_is_not_proved() -> None:
    (found,) = blends(stars_of(TRIPOD))
    shapes = found.shapes
    twice = np.concatenate([shapes.control, shapes.control], axis=1)
    proof = prove(twice, shapes.collar_distances, shapes.collar_radii)
    assert proof.is_star_shaped[0]
    assert not proof.proved[0]
