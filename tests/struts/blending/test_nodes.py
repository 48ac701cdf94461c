from dataclasses import replace

import numpy as np
import pytest

from scaffold_cad.errors import OptionError
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts import Blends, Stars, blends, round_struts, sampled
from scaffold_cad.struts.blending import nodes
from scaffold_cad.struts.blending.bends import bend_partitions
from scaffold_cad.struts.blending.fitting import union_of
from tests.struts.stars import (
    BODY_CENTERED,
    CUBIC,
    FAN,
    FIVE_TUBES,
    TEE,
    TRIPOD,
    random_stars,
    stars_of,
)

GRID = np.linspace(0, 1, 9)
TUBES = np.array([17.5, 16, 14, 9, 9])
ELBOW = np.eye(3)[:2]
CASES = {
    "tripod": stars_of(TRIPOD),
    "tee": stars_of(TEE),
    "elbow": stars_of(ELBOW),
    "cubic": stars_of(CUBIC),
    "body-centered": stars_of(BODY_CENTERED),
    "fan": stars_of(FAN),
    "five tubes": stars_of(FIVE_TUBES, TUBES, blends=8.0),
    "big ball on thin necks": stars_of(TRIPOD, balls=6.0),
    "cones": stars_of(CUBIC, slopes=-0.05),
    "random": stars_of(random_stars(6, 5, 45, np.random.default_rng(3))),
}


def evaluated(found: Blends, order_u: int, order_v: int) -> np.ndarray:
    """Return derivatives on a grid, shape (U, 4 N, 9, 9, 3)."""
    u = found.layout.u.values_at(GRID, order_u)
    v = found.layout.v.values_at(GRID, order_v)
    return np.einsum("ai,upijx,bj->upabx", u, found.control, v)


def unit_normals(found: Blends) -> np.ndarray:
    normals = np.cross(evaluated(found, 1, 0), evaluated(found, 0, 1))
    return normals / np.linalg.norm(normals, axis=-1, keepdims=True)


def degrees(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.degrees(np.linalg.norm(a - b, axis=-1).max()))


def solved() -> list:
    return [
        pytest.param(found, id=f"{name}-{found.layout.along_arc}")
        for name, stars in CASES.items()
        for found in blends(stars)
    ]


SOLVED = solved()


@pytest.mark.parametrize("found", SOLVED)
def test_nodes_are_proved(found: Blends) -> None:
    assert found.proved.all()


@pytest.mark.parametrize("found", SOLVED)
def test_normals_agree_across_spokes_and_arcs(found: Blends) -> None:
    normals = unit_normals(found)
    sides = np.arange(normals.shape[1])
    following = (sides & ~3) | ((sides + 1) & 3)
    assert degrees(normals[:, :, -1], normals[:, following, 0]) < 1e-4
    twins = np.take_along_axis(normals[:, :, :, 0], found.twins[:, :, None, None], axis=1)
    assert degrees(normals[:, :, :, 0], twins[:, :, ::-1]) < 1e-4


@pytest.mark.parametrize("found", SOLVED)
def test_collars_are_circles_and_struts_leave_them_without_a_tilt(found: Blends) -> None:
    first = np.unique(found.shape_of, return_index=True)[1]
    axes = found.stars.directions[first].repeat(4, axis=1)[:, :, None]
    slopes = found.stars.slopes[first].repeat(4, axis=1)[:, :, None, None]
    rim = evaluated(found, 0, 0)[:, :, :, -1]
    height = (rim * axes).sum(axis=-1)
    across = rim - height[..., None] * axes
    radius = np.linalg.norm(across, axis=-1)
    assert height == pytest.approx(
        np.broadcast_to(found.shapes.collar_distances.repeat(4, axis=1)[..., None], height.shape)
    )
    wanted = found.shapes.collar_radii.repeat(4, axis=1)[..., None]
    assert np.abs(radius / wanted - 1).max() < 2e-9
    normal = across / radius[..., None] - slopes * axes
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    assert degrees(unit_normals(found)[:, :, :, -1], normal) < 1e-4


@pytest.mark.parametrize("found", SOLVED)
def test_surface_is_near_the_filleted_union(found: Blends) -> None:
    assert found.shapes.depth.max() <= 0.02
    assert found.shapes.misfit.max() < 0.12


@pytest.mark.parametrize("found", SOLVED)
def test_collar_corners_start_their_quarters(found: Blends) -> None:
    first = np.unique(found.shape_of, return_index=True)[1]
    shapes = found.shapes
    axes = found.stars.directions[first][:, :, None]
    corners = (
        shapes.collar_distances[..., None, None] * axes
        + shapes.collar_radii[..., None, None] * shapes.collar_corners
    )
    at_corners = found.control[:, :, 0, -1].reshape(corners.shape)
    assert at_corners == pytest.approx(corners, abs=1e-9)


@pytest.mark.parametrize("found", SOLVED)
def test_bounds_hold_the_patches(found: Blends) -> None:
    points = evaluated(found, 0, 0)
    axes = found.axes.repeat(4, axis=1)[:, :, None, None]
    least, most, widest = np.moveaxis(found.bounds.repeat(4, axis=1)[:, :, None, None], -1, 0)
    height = (points * axes).sum(axis=-1)
    across = np.linalg.norm(points - height[..., None] * axes, axis=-1)
    assert (height > least - 1e-9).all()
    assert (height < most + 1e-9).all()
    assert (across < widest + 1e-9).all()
    assert np.linalg.norm(points, axis=-1).max() <= found.shapes.reach.max() + 1e-9


@pytest.mark.parametrize(("valency", "count"), [(3, 40), (4, 40), (6, 12)])
def test_struts_of_any_radius_are_nowhere_cut_by_more_than_a_fiftieth(
    valency: int, count: int
) -> None:
    rng = np.random.default_rng(5)
    star = random_stars(count, valency, 30, rng)
    radii = np.exp(rng.uniform(np.log(0.5), np.log(2), star.shape[:2]))
    stars = stars_of(star, radii, blends=0.6 * radii.mean(axis=1))
    found = blends(stars)
    at = np.linspace(0, 1, 41)
    for group in found:
        assert group.proved.all()
        u, v = group.layout.u.values_at(at), group.layout.v.values_at(at)
        points = (u @ np.moveaxis(group.control, -1, 0) @ v.T).reshape(3, len(group.shapes), -1)
        first = np.unique(group.shape_of, return_index=True)[1]
        depth = union_of(group.stars[first], group.shapes.rho).deepest(points)
        assert depth.max() < 0.022  # it is looked for at fewer samples


def test_a_long_patch_of_a_thin_strut_is_cut_into_pieces_along_it() -> None:
    star = np.array([[0.0, 0, 1], [np.sin(0.6), 0, np.cos(0.6)], [0, 1, -0.3]])
    (found,) = blends(stars_of(star, np.array([[2.0, 0.5, 1.5]]), blends=0.8))
    assert found.proved.all()
    assert found.layout.along_strut > 1
    assert found.shapes.depth.max() <= 0.02


def test_equal_nodes_are_solved_once() -> None:
    rng = np.random.default_rng(0)
    some = random_stars(3, 4, 50, rng)
    (found,) = blends(stars_of(some[[0, 1, 0, 2, 1, 0]]))
    assert len(found.shapes) == 3
    assert found.shape_of[0] == found.shape_of[2] == found.shape_of[5]
    assert found.shape_of[1] == found.shape_of[4]


def test_a_node_is_the_same_alone_and_among_others() -> None:
    some = random_stars(5, 4, 50, np.random.default_rng(1))
    (together,) = blends(stars_of(some))
    (alone,) = blends(stars_of(some[2]))
    assert together.control[together.shape_of[2]] == pytest.approx(alone.control[0], abs=1e-9)


def test_nodes_of_other_types_change_nothing() -> None:
    some = stars_of(random_stars(6, 6, 60, np.random.default_rng(2)))
    together = blends(some)
    for node in range(2):
        (alone,) = blends(some[np.array([node])])
        for found in together:
            for shape in found.shape_of[found.nodes == node]:
                assert found.layout == alone.layout
                assert found.control[shape] == pytest.approx(alone.control[0], abs=1e-9)


@pytest.mark.parametrize("valency", [6, 8])
def test_struts_30_degrees_apart_are_proved_at_high_valencies(valency: int) -> None:
    some = stars_of(random_stars(3, valency, 30, np.random.default_rng(5)))
    assert sum(found.proved.sum() for found in blends(some)) == 3


def test_scaled_nodes_have_scaled_blends() -> None:
    (one,) = blends(stars_of(TRIPOD))
    (ten,) = blends(stars_of(TRIPOD, 10.0, blends=6.0))
    assert ten.control == pytest.approx(10 * one.control, abs=1e-6)


def test_order_of_struts_does_not_matter() -> None:
    order = np.array([2, 0, 3, 1])
    star = random_stars(1, 4, 50, np.random.default_rng(5))
    (one,) = blends(stars_of(star))
    (other,) = blends(stars_of(star[:, order]))
    assert other.shapes.collar_distances == pytest.approx(one.shapes.collar_distances[:, order])
    assert other.shapes.solid_angle == pytest.approx(one.shapes.solid_angle)


def test_samples_are_shared_and_close_but_for_the_collars() -> None:
    (found,) = blends(stars_of(CUBIC))
    samples = sampled(found, GRID, GRID)
    quads = samples.quads[0]
    edges = np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2)
    _, counts = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    assert set(counts) == {1, 2}
    assert (counts == 1).sum() == 6 * 4 * 8
    assert len(samples.points[0]) - len(counts) + len(quads) == 2 - 6


def test_samples_lie_on_the_patches_with_outward_normals() -> None:
    (found,) = blends(stars_of(TRIPOD))
    samples = sampled(found, GRID, GRID)
    number = samples.number[0]
    assert samples.points[0][number] == pytest.approx(evaluated(found, 0, 0)[0])
    assert samples.normals[0][number] == pytest.approx(unit_normals(found)[0], abs=1e-6)
    assert ((samples.points * samples.normals).sum(axis=-1) > 0).all()


def test_wrong_numbers_are_named() -> None:
    with pytest.raises(OptionError, match=r"radii of node 0 has -1; need a number > 0"):
        stars_of(TRIPOD, -1.0)
    with pytest.raises(OptionError, match=r"balls of node 0 has -2; need a number ≥ 0"):
        stars_of(TRIPOD, balls=-2.0)
    with pytest.raises(OptionError, match=r"radii does not fit; need numbers of shape \(1, 3\)"):
        stars_of(TRIPOD, np.ones(2))
    (found,) = blends(stars_of(TRIPOD))
    with pytest.raises(OptionError, match="need both u and 1 - u"):
        sampled(found, np.array([0, 0.2, 1.0]), GRID)
    with pytest.raises(OptionError, match="need ascending numbers from 0 to 1"):
        sampled(found, GRID, np.array([0, 0.5]))


def test_stars_are_picked_by_rows() -> None:
    some = stars_of(random_stars(4, 3, 50, np.random.default_rng(8)))
    assert isinstance(some[np.array([2, 0])], Stars)
    assert (some[np.array([2, 0])].directions[0] == some.directions[2]).all()


@pytest.mark.parametrize("degrees", [150, 90, 45, 30, 25, 22, 20])
def test_bends_down_to_twenty_degrees_are_sound(degrees: float) -> None:
    angle = np.radians(degrees)
    bend = bend_partitions(np.array([[[1.0, 0, 0], [np.cos(angle), np.sin(angle), 0]]]))
    (found,) = blends(Stars.of(bend, radii=1.0, blends=0.5))
    assert found.shapes.sound.all()
    assert found.shapes.depth[0] < 0.02


def test_a_proved_blend_that_cuts_deep_into_a_strut_is_not_sound() -> None:
    (found,) = blends(stars_of(np.eye(3)[None]))
    assert found.shapes.sound.all()
    deep = replace(found.shapes, depth=np.array([0.2]))
    assert deep.proved.all()
    assert not deep.sound.any()


# Proved and nowhere deep by the first recipe, which leaves them a third of their thinnest strut
# outside the filleted union.
BULGING = {
    "two beside a thick one": (
        [[-0.92, 0.28, -0.27], [0.52, 0.85, 0.12], [-0.12, 0.93, 0.34], [-0.51, -0.17, 0.84]],
        [0.54, 0.56, 0.96, 0.55],
    ),
    "a thick one opposite": (
        [[-0.66, -0.13, -0.74], [0.69, 0.15, 0.71], [0.52, -0.4, 0.76], [0.19, -0.91, 0.37]],
        [0.65, 0.54, 0.26, 0.29],
    ),
}


@pytest.mark.parametrize("name", BULGING)
def test_struts_of_mixed_radii_do_not_bulge_where_another_recipe_is_better(name: str) -> None:
    directions, radii = (np.array(each) for each in BULGING[name])
    stars = stars_of(directions, radii, blends=0.6 * radii.mean())
    (found,) = blends(stars)
    assert found.proved.all()
    assert found.shapes.depth[0] <= 0.02
    union = union_of(stars, found.shapes.rho)
    points = np.moveaxis(evaluated(found, 0, 0), -1, 0).reshape(3, 1, -1)
    value, gradient = union.value_and_slope(points)
    away = value / np.maximum(np.linalg.norm(gradient, axis=0), 0.1)
    assert away.max() < 0.1 * radii.min()
    assert found.shapes.bulge[0] < 0.1


@pytest.mark.parametrize(("fillet", "most"), [(1e-9, 3), (20.0, 2)])
def test_few_ways_are_tried_for_fillets_that_nobody_can_see_or_have(
    fillet: float, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    solve, tried = nodes._solved, []
    monkeypatch.setattr(nodes, "_solved", lambda *given: tried.append(given[2]) or solve(*given))
    (found,) = blends(stars_of(BODY_CENTERED, blends=fillet))
    assert not found.proved[0]
    assert 1 <= len(tried) <= most


def test_a_fillet_that_is_far_too_wide_becomes_as_wide_as_can_be() -> None:
    arms = Skeleton(
        np.vstack([np.zeros(3), 20 * BODY_CENTERED]), [[0, k] for k in range(1, 9)], 1.0
    )
    (node,) = (each for each in round_struts(arms, blend=1e9).blended)
    assert node.shapes.sound.all()
    assert 4.0 < node.shapes.rho[0] < 6.0
    assert node.shapes.bulge[0] < 0.2


def test_without_room_patches_are_closed_and_no_system_is_made(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse(*_: object) -> None:
        raise AssertionError("a system was made")

    monkeypatch.setattr("scaffold_cad.struts.blending.fits.system_of", refuse)
    (found,) = blends(stars_of(random_stars(2, 12, 20, np.random.default_rng(5)), most=0.5))
    assert not found.shapes.has_room.any()
    points = evaluated(found, 0, 0)
    sides = np.arange(points.shape[1])
    following = (sides & ~3) | ((sides + 1) & 3)
    assert points[:, :, -1] == pytest.approx(points[:, following, 0], abs=1e-12)
    arcs = np.take_along_axis(points[:, :, :, 0], found.twins[:, :, None, None], axis=1)
    assert points[:, :, :, 0] == pytest.approx(arcs[:, :, ::-1], abs=1e-12)
    rim = found.control[:, :, 0, -1].reshape(2, 12, 4, 3)
    height = (rim * found.axes[:, :, None]).sum(axis=-1)
    assert height == pytest.approx(
        np.broadcast_to(found.shapes.collar_distances[..., None], height.shape)
    )
