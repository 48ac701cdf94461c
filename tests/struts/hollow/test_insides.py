"""The inside of hollow nodes: smooth, proved, and a wall away from the outside."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from scaffold_cad import Skeleton, round_struts, to_brep
from scaffold_cad.partition.arcs import side_twins
from scaffold_cad.struts import Blends, blends
from scaffold_cad.struts.blending.blend import Solved
from scaffold_cad.struts.hollow.gaps import INSIDE, Gaps, surface_samples
from scaffold_cad.struts.hollow.insides import Skins, insides
from tests.struts.stars import CUBIC, FIVE_TUBES, TRIPOD, random_stars, stars_of
from tests.validation.reread import least_wall

TUBES = np.array([17.5, 16, 14, 9, 9])
ELBOW = np.eye(3)[:2]
FORK = np.array([[0.26, 0, 0.9656], [-0.26, 0, 0.9656]]) / np.hypot(0.26, 0.9656)  # 30 degrees
UNEVEN = random_stars(6, 4, 50, np.random.default_rng(4))
CASES = {
    "tripod": (stars_of(TRIPOD), 0.3),
    "elbow": (stars_of(ELBOW), 0.7),
    "cubic": (stars_of(CUBIC), 0.15),
    "five tubes": (stars_of(FIVE_TUBES, TUBES, blends=5.0), 3.0),
    "cones": (stars_of(CUBIC, slopes=-0.2), 0.3),
    "ball": (stars_of(TRIPOD, balls=2.0), 0.3),
    "hairpin": (stars_of(FORK), 0.2),
    "uneven": (stars_of(UNEVEN, np.array([1.0, 0.5, 2.0, 1.3]), blends=0.25), 0.2),
}


def skins_of(found: Blends) -> Skins:
    first = np.unique(found.shape_of, return_index=True)[1]
    quads, slopes = found.stars.quads[first], found.stars.slopes[first]
    return Skins(found.shapes, quads, found.axes, slopes)


def hollow(name: str) -> list[tuple[Solved, Solved, Skins, float]]:
    """Return outer surfaces, their insides, what they are of, and the wall."""
    stars, wall = CASES[name]
    return [
        (found.shapes[rows], made, skins_of(found)[rows], wall)
        for found in blends(stars)
        for rows, made in insides(skins_of(found), wall)
    ]


@pytest.mark.parametrize("name", CASES)
def test_walls_are_as_thick_as_asked(name: str) -> None:
    made = hollow(name)
    assert sum(len(inner) for _, inner, _, _ in made) == len(CASES[name][0])
    for outer, inner, _, wall in made:
        assert inner.proved.all()
        for row in range(len(outer)):
            # By the nearest of very many points, and not where the fit looked.
            points, _ = surface_samples(outer[np.array([row])], 49)
            inside, _ = surface_samples(inner[np.array([row])], 22)
            nearest, _ = cKDTree(points[0]).query(inside[0])
            assert nearest.min() > 0.95 * wall
            assert nearest.max() < 1.25 * wall + 0.03 * outer.collar_radii[row].max()


@pytest.mark.parametrize("name", CASES)
def test_collars_are_a_wall_further_in(name: str) -> None:
    for outer, inner, skins, wall in hollow(name):
        rim = inner.control[:, :, [0, -1], -1]  # ends of quarters
        axes = np.repeat(skins.axes, 4, axis=1)[:, :, None]
        height = (rim * axes).sum(axis=-1)
        across = np.linalg.norm(rim - height[..., None] * axes, axis=-1)
        cosines = 1 / np.hypot(1, skins.slopes)
        radii = (outer.collar_radii - wall * cosines).repeat(4, axis=1)[..., None]
        moved = outer.collar_distances + wall * skins.slopes * cosines
        assert across == pytest.approx(np.broadcast_to(radii, across.shape))
        places = np.broadcast_to(moved.repeat(4, axis=1)[..., None], height.shape)
        assert height == pytest.approx(places)
        # Both circles are on one normal of the cone.
        assert np.hypot(
            moved - outer.collar_distances, outer.collar_radii - inner.collar_radii
        ) == (pytest.approx(wall))


@pytest.mark.parametrize("name", CASES)
def test_insides_are_smooth_across_arcs(name: str) -> None:
    for _, inner, skins, _ in hollow(name):
        layout = inner.layout
        u, v = layout.u, layout.v
        at = np.linspace(0, 1, 9)
        patches = np.moveaxis(inner.control, -1, 0)
        start = np.zeros(1)
        by_u = u.values_at(at, 1) @ patches @ v.values_at(start).T
        by_v = u.values_at(at) @ patches @ v.values_at(start, 1).T
        normals = np.cross(by_u, by_v, axis=0)[..., 0]
        normals = np.moveaxis(normals / np.sqrt((normals**2).sum(axis=0)), 0, -1)  # (U, 4 N, 9, 3)
        twins = side_twins(skins.quads)
        other = np.take_along_axis(normals, twins[:, :, None, None], axis=1)[:, :, ::-1]
        assert np.degrees(np.linalg.norm(normals - other, axis=-1).max()) < 1e-3


def test_insides_of_equal_nodes_are_the_same_beside_others() -> None:
    (found,) = (each for each in blends(CASES["uneven"][0]) if each.layout.along_arc == 1)
    skins = skins_of(found)
    together = {
        row: made.control[place]
        for rows, made in insides(skins, 0.2)
        for place, row in enumerate(rows)
    }
    for row in range(len(skins)):
        ((_, alone),) = insides(skins[np.array([row])], 0.2)
        assert np.array_equal(alone.control[0], together[row])


def test_gaps_are_distances_to_the_surface() -> None:
    (found,) = blends(stars_of(TRIPOD))
    outer = found.shapes
    thinner = Solved(outer.layout, 0.9 * outer.control, *(getattr(outer, name) for name in REST))
    points, _ = surface_samples(outer, 97)
    inside, _ = surface_samples(thinner, INSIDE)
    nearest = cKDTree(points[0]).query(inside[0])[0].min()
    least, most = Gaps(outer).least_and_most(thinner)
    assert least[0] == pytest.approx(nearest, rel=2e-3)
    assert most[0] == pytest.approx(0.1 * outer.reach[0], rel=0.2)
    assert Gaps(thinner).least(outer)[0] < -0.05


REST = list(Solved.__dataclass_fields__)[2:]


def test_nodes_without_room_for_their_collars_are_fitted_anew() -> None:
    stub = Skeleton([[0, 0, 0], [2.3, 0, 0], [0, 9, 0], [0, 0, 9]], [[0, 1], [0, 2], [0, 3]], 1.0)
    struts = round_struts(stub, wall=0.4, blend=1.0)
    assert struts.inner is not None
    assert len(struts.overlapping) == 0
    # The closed end takes a part of a strut: the fillet inside is tighter, and the wall thicker.
    assert struts.inner.fillet[0] < struts.fillet[0] + 0.39


def test_an_inside_that_its_node_does_not_see_is_proved_around_another_point() -> None:
    """Between struts 30 degrees apart the inside ends before it reaches the node."""
    half = np.radians(15.0)
    tips = 25 * np.array([[np.sin(half), 0, np.cos(half)], [-np.sin(half), 0, np.cos(half)]])
    fork = Skeleton(np.concatenate([np.zeros((1, 3)), tips]), [[0, 1], [0, 2]], 1.0)
    struts = round_struts(fork, wall=0.5, ends="open")
    assert struts.inner is not None
    assert not struts.inner.crowded.any()
    assert len(struts.overlapping) == 0
    shape = to_brep(struts)
    assert shape.is_valid
    assert len(shape.faces()) == 22  # none is a facet
    assert least_wall(shape, 0.5) > 0.96
