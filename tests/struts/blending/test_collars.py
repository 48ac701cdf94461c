import numpy as np
import pytest

from scaffold_cad.base.vectors import any_perpendicular
from scaffold_cad.struts.blending.collars import LEAST_BLEND, collars
from scaffold_cad.struts.blending.distances import Union
from tests.struts.stars import FAN, FIVE_TUBES, random_stars, stars_of

RNG = np.random.default_rng(7)


def union_of(stars) -> Union:
    return Union(
        np.moveaxis(stars.directions, -1, 0).copy(),
        stars.radii,
        stars.slopes,
        stars.balls,
        stars.blends,
    )


def clearances(union: Union, distances: np.ndarray, strut: int) -> np.ndarray:
    """Return how far f is from the strut's own distance on its circle, by 720 points, (M,)."""
    axes = np.moveaxis(union.directions, 0, -1)
    x = any_perpendicular(axes[:, strut])
    y = np.cross(axes[:, strut], x)
    angle = np.linspace(0, 2 * np.pi, 721)
    radius = union.radii[:, strut] + union.slopes[:, strut] * distances
    ring = np.cos(angle)[:, None] * x[:, None] + np.sin(angle)[:, None] * y[:, None]
    points = distances[:, None, None] * axes[:, strut, None] + radius[:, None, None] * ring
    value, _ = union.value_and_slope(np.moveaxis(points, -1, 0))
    return np.abs(value).max(axis=1)


@pytest.mark.parametrize("slope", [0.0, 0.08, -0.02])
@pytest.mark.parametrize("ball", [0.0, 2.5])
def test_collars_are_the_nearest_with_the_fillet_beyond_reach(slope: float, ball: float) -> None:
    radii = RNG.uniform(0.5, 2, size=(30, 4))
    stars = stars_of(random_stars(30, 4, 40, RNG), radii, slopes=slope, balls=ball)
    union = union_of(stars)
    found = collars(union, stars.most).distances
    for strut in range(4):
        clear = clearances(union, found[:, strut], strut)
        near = clearances(union, found[:, strut] - 1e-2, strut)
        open_rows = found[:, strut] > 2e-2  # thick struts may need no distance at all
        assert clear.max() < 1e-6
        if ball == 0:  # else the collar also keeps away from the ball
            assert (near[open_rows] > 1e-6).mean() > 0.9  # circles are looked at in steps


def test_collar_of_a_pair_has_the_closed_form() -> None:
    angle = np.radians(50)
    pair = np.array([[1.0, 0, 0], [np.cos(angle), np.sin(angle), 0]])
    stars = stars_of(pair)
    wanted = (1 + np.cos(angle) + 0.6) / np.sin(angle)
    assert collars(union_of(stars), stars.most).distances == pytest.approx(wanted)


def test_blend_shrinks_to_the_room_that_there_is() -> None:
    stars = stars_of(FIVE_TUBES, blends=2.0)
    free = collars(union_of(stars), stars.most)
    short = collars(union_of(stars), 0.9 * free.distances)
    assert (short.distances <= 0.9 * free.distances + 1e-9).all()
    assert 0.1 < short.blends[0] < 2.0
    assert short.has_room[0]


def test_no_room_is_told() -> None:
    stars = stars_of(FAN, most=0.5)
    found = collars(union_of(stars), stars.most)
    assert not found.has_room[0]
    assert found.blends[0] == pytest.approx(LEAST_BLEND)
