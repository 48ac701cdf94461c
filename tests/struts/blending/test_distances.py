import numpy as np
import pytest

from scaffold_cad.base.vectors import normalize
from scaffold_cad.struts.blending.distances import Union
from tests.struts.stars import FAN, TRIPOD

RNG = np.random.default_rng(4)


def union(directions: np.ndarray, radius: float, slope: float, ball: float = 0.0) -> Union:
    unit = normalize(directions)
    shape = (1, len(unit))
    return Union(
        np.ascontiguousarray(unit.T[:, None]),
        np.full(shape, radius),
        np.full(shape, slope),
        np.array([ball]),
        np.array([0.6]),
    )


def spheres_distance(point: np.ndarray, direction: np.ndarray, radius: float, slope: float):
    """Return the least distance to balls on a half line: the strut by its definition."""
    cosine = 1 / np.sqrt(1 + slope**2)
    far = np.linspace(0, 30, 60001)  # along the cone's inscribed balls
    centers = far[:, None] * direction
    size = (radius + slope * far) * cosine
    return (np.linalg.norm(point - centers, axis=1) - size).min()


@pytest.mark.parametrize("slope", [0.0, 0.2, -0.03])
def test_distance_is_that_to_the_swept_balls(slope: float) -> None:
    points = RNG.normal(size=(40, 3)) * 2.5
    field = union(np.array([[0.3, -0.5, 0.8]]), 1.0, slope)
    found = field.nearest(points.T[:, None])[0]
    axis = field.directions[:, 0, 0]
    assert found == pytest.approx(
        [spheres_distance(point, axis, 1.0, slope) for point in points], abs=1e-6
    )


@pytest.mark.parametrize("ball", [0.0, 1.8])
def test_f_falls_as_distances_do_along_its_slope(ball: float) -> None:
    field = union(FAN, 1.0, 0.05, ball)
    points = np.random.default_rng(1).normal(size=(3, 1, 600)) * 2
    points = points[:, :, field.nearest(points)[0] < 0.55]
    value, slope = field.value_and_slope(points)
    step = 1e-4
    rise = field.value_and_slope(points + step * slope)[0] - value
    size = np.sqrt((slope**2).sum(axis=0))
    # Normals turn while the point moves: the slope is that of planes.
    assert np.quantile(rise / (step * size), 0.05) > 0.5


def test_surfaces_that_go_the_same_way_have_no_fillet() -> None:
    # The back of a T, and the outside of a bend of 10 degrees.
    tee = union(np.array([[1.0, 0, 0], [-1, 0, 0], [0, 0, 1]]), 1.0, 0.0)
    angle = np.linspace(np.pi, 2 * np.pi, 9)[1:-1]
    back = np.stack([0 * angle + 0.1, np.cos(angle), np.sin(angle)])[:, None]
    assert np.abs(tee.value_and_slope(back)[0]).max() < 1e-3
    bend = union(np.array([[1.0, 0, 0], [-np.cos(0.17), 0, np.sin(0.17)]]), 1.0, 0.0)
    outside = np.array([0.05, 0.0, -1.0])[:, None, None]
    assert abs(bend.value_and_slope(outside)[0][0, 0]) < 2e-3


@pytest.mark.parametrize("turn", [30, 60, 90])
def test_fillets_of_mild_corners_are_arcs_of_their_radius(turn: int) -> None:
    # In the plane across two walls, far from the node, a circle of radius rho touches both.
    angle = np.radians(turn)
    field = union(np.array([[1.0, 0, 0], [-np.cos(angle), np.sin(angle), 0]]), 1.0, 0.0)
    # Walls y = 1 beyond the corner, and the other strut's inner side.
    normals = np.array([[0.0, 1, 0], [np.sin(angle), np.cos(angle), 0]])
    center = np.linalg.solve(normals[:, :2], [1.6, 1.6])
    middle = normals.sum(axis=0)[:2]
    point = np.append(center - 0.6 * middle / np.linalg.norm(middle), 0.0)
    assert field.value_and_slope(point[:, None, None])[0][0, 0] == pytest.approx(0, abs=1e-9)


def test_fillet_at_right_angles_is_an_arc_of_its_radius() -> None:
    # Far from the node two walls at right angles are met by a ball of radius ρ.
    field = union(np.array([[1.0, 0, 0], [0, 1, 0]]), 1.0, 0.0)
    center = np.array([1.6, 1.6, 0])
    for angle in np.linspace(np.pi, 1.5 * np.pi, 7):
        point = center + 0.6 * np.array([np.cos(angle), np.sin(angle), 0])
        assert field.value_and_slope(point[:, None, None])[0][0, 0] == pytest.approx(0, abs=1e-12)


def test_rays_reach_the_surface() -> None:
    field = union(TRIPOD, 1.0, 0.1, 1.5)
    rays = normalize(RNG.normal(size=(300, 3)))
    rays = rays[(rays @ field.directions[:, 0]).max(axis=1) < 0.8]
    far = field.reached(rays.T[:, None])
    assert np.abs(field.value_and_slope(far * rays.T[:, None])[0]).max() < 1e-9


def test_projected_points_lie_on_the_surface() -> None:
    field = union(FAN, 1.0, 0.0)
    points = normalize(RNG.normal(size=(200, 3))).T[:, None] * 2
    found = field.projected(points, 20)
    assert np.quantile(np.abs(field.value_and_slope(found)[0]), 0.95) < 1e-6


def test_planes_stand_for_the_surface_near_their_points() -> None:
    field = union(TRIPOD, 1.0, 0.0)
    points = field.projected(normalize(RNG.normal(size=(200, 3))).T[:, None] * 2, 20)
    planes = field.planes_at(points)
    step = 1e-3 * RNG.normal(size=points.shape)
    found = planes.reached(points + step)
    # What a step of a thousandth along a plane leaves is of the order of its square.
    assert np.quantile(np.abs(field.value_and_slope(found)[0]), 0.95) < 2e-5
    inward = points - 0.05 * planes.slopes
    further = planes.reached(inward, urge=0.5) - planes.reached(inward)
    deep = planes.values - 0.05 * (planes.slopes**2).sum(axis=0) < 0
    assert ((further * planes.slopes).sum(axis=0)[deep] > 0).all()


@pytest.mark.parametrize("ball", [0.0, 1.8])
def test_excess_is_how_much_deeper_than_allowed_points_are(ball: float) -> None:
    field = union(TRIPOD, 1.0, 0.0, ball)
    points = normalize(RNG.normal(size=(200, 3))).T[:, None] * RNG.uniform(0.5, 3.0, 200)
    depth = field.deepest(points)
    _, excess = field.planes_and_excess(points, 0.1)
    assert ((excess > 1e-9) == (depth > 0.1 + 1e-9)).all()
    if ball == 0:  # else depths are over one of two radii
        inside = depth > 0
        assert excess[inside] == pytest.approx(depth[inside] - 0.1)


def test_lifted_points_go_beyond_the_surface() -> None:
    field = union(TRIPOD, 1.0, 0.0)
    points = field.projected(normalize(RNG.normal(size=(50, 3))).T[:, None] * 2, 20)
    planes = field.planes_at(points)
    lifted = planes.reached(points, lift=np.full((1, 50), 0.01))
    assert np.quantile(np.abs(field.nearest(lifted) - 0.01), 0.5) < 1e-3
