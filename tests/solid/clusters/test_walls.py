"""Walls of clusters: how what is inside moves away from the outside."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scaffold_cad.base.arrays import Ints
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.clusters.aims import Aim
from scaffold_cad.solid.clusters.walls import Walls, tell_thin, thickened
from scaffold_cad.struts.meshes.bands import polygon_wall

NONE = np.zeros(0, dtype=np.intp)
WALL = 1.2
VALLEY = TriangleMesh(
    np.array([[x, y, 1 + 0.4 * abs(x)] for x in (-40.0, 0.0, 40.0) for y in (-50.0, 50.0)]),
    np.array([[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5]]),
)
"""Faces up; its lowest edge is 1 above the plane z = 0."""
BELOW = TriangleMesh(np.array([[-32.0, -9, 0], [20, 9, 0], [28, -9, 0]]), np.array([[0, 2, 1]]))
"""A triangle none of whose corners and middles is near that edge."""


def depth_at_edge(mesh: TriangleMesh) -> float:
    """Return how far the plane of the last three vertices is below (0, 0, 1)."""
    a, b, c = mesh.vertices[-3:]
    normal = np.cross(b - a, c - a)
    return float(abs(normal @ (a - [0, 0, 1])) / np.linalg.norm(normal))


def test_walls_below_reentrant_edges_are_as_thick_as_asked() -> None:
    made = thickened(Walls.between(VALLEY, BELOW, NONE), WALL, 1.0, 1.0)
    assert 0.97 * WALL < depth_at_edge(made) < 1.1 * WALL


@pytest.mark.parametrize("tilt", [-0.03, 0.03])
def test_a_corner_moves_for_the_thinnest_of_the_walls_that_it_is_a_part_of(tilt: float) -> None:
    below = TriangleMesh(BELOW.vertices + tilt * BELOW.vertices[:, [2, 2, 1]], BELOW.triangles)
    made = thickened(Walls.between(VALLEY, below, NONE), WALL, 1.0, 1.0)
    a, b, c = made.vertices[-3:]
    normal = np.cross(b - a, c - a)
    height = np.linspace(-8.0, 1.5, 20)  # along the edge, above the triangle
    places = np.stack([0 * height, height, 0 * height + 1.0], axis=1)
    depths = np.abs((places - a) @ normal) / np.linalg.norm(normal)
    assert 0.97 * WALL < depths.min() < 1.1 * WALL


@pytest.mark.parametrize(("fixed", "told"), [(np.array([0, 1]), True), (NONE, False)])
def test_walls_that_stay_thin_are_told(
    fixed: Ints, told: bool, caplog: pytest.LogCaptureFixture
) -> None:
    walls = Walls.between(VALLEY, BELOW, fixed)
    made = thickened(walls, WALL, 1.0, 1.0)
    tell_thin(replace(walls, mesh=made), WALL, 1.0)
    assert (depth_at_edge(made) < 0.95 * WALL) == told
    assert ("a wall is as thin as 1 mm near [0, " in caplog.text) == told


@pytest.mark.parametrize(("part", "between", "told"), [
    (0.93, 1.0, True), (0.96, 1.0, False), (0.93, polygon_wall(4), False),
])  # fmt: skip
def test_walls_below_095_of_what_was_asked_are_told(
    part: float, between: float, told: bool, caplog: pytest.LogCaptureFixture
) -> None:
    tell_thin(Walls.between(VALLEY, BELOW, NONE), 1.0 / part, between)
    assert ("a wall is as thin as 1 mm" in caplog.text) == told


@pytest.mark.parametrize("fixed", [np.arange(3), np.arange(2)])
def test_the_outside_moves_where_corners_inside_stay(fixed: Ints) -> None:
    small = TriangleMesh(VALLEY.vertices * [0.1, 0.1, 1], VALLEY.triangles)
    walls = Walls.between(small, BELOW, fixed)
    made = thickened(walls.turned(walls.mesh, NONE), WALL, 1.0, 1.0)
    assert np.array_equal(made.vertices[-3:], BELOW.vertices)
    assert 0.97 * WALL < made.vertices[2:4, 2].min() < 1.1 * WALL


def test_small_triangles_that_would_fold_are_evened() -> None:
    at = np.linspace(-6.0, 6.0, 25)
    corner = np.arange(24 * 25).reshape(24, 25)[:, :-1].reshape(-1)
    fan = np.concatenate([np.stack([corner, corner + 1, corner + 25], axis=1),
                          np.stack([corner + 1, corner + 26, corner + 25], axis=1)])  # fmt: skip
    points = np.stack([*np.meshgrid(at, at), np.zeros((25, 25))], axis=-1).reshape(-1, 3)
    # A roof above them: what is below its ridge is pushed to both sides.
    points[:, 2] = 2.0 - np.abs(points[:, 0])
    roof = TriangleMesh(points + np.array([0, 0, 0.4]), fan)
    made = thickened(Walls.between(roof, TriangleMesh(points, fan), NONE), WALL, 1.0, 1.0)
    assert len(self_intersections(made)) == 0
    inside = made.vertices[len(points) :][np.abs(points[:, :2]).max(axis=1) < 4]
    depths = (2.4 - np.abs(inside[:, 0]) - inside[:, 2]) / np.sqrt(2)
    assert depths.min() > 0.95 * WALL


def test_walls_that_cross_from_the_first_are_left_so() -> None:
    through = TriangleMesh(
        BELOW.vertices + np.array([[0, 0, 8], [0, 0, 0], [0, 0, 0]]), BELOW.triangles
    )
    walls = Walls.between(VALLEY, through, np.array([0, 1]))
    made = thickened(walls, WALL, 1.0, 1.0)
    assert len(self_intersections(made)) > 0
    assert np.array_equal(made.vertices, walls.mesh.vertices)


def test_walls_below_needles_beside_each_other_are_found_thin() -> None:
    angle, rows = 2 * np.pi * np.arange(160) / 160, np.arange(1, 159)
    rim = 4 * WALL * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    fan = np.stack([0 * rows, rows, rows + 1], axis=1)  # needles from one corner
    x, y = np.meshgrid(np.linspace(1.8, 3.0, 9) * WALL, np.linspace(-1, 1, 9) * WALL)
    below = np.stack([x, y, np.full_like(x, -0.9 * WALL)], axis=-1).reshape(-1, 3)
    aim = Aim.of(np.concatenate([rim, below]), fan, below, WALL, 0.97 * WALL)
    assert aim.thicker(below)[:, 2] == pytest.approx(-0.0797 * WALL, rel=0.02)
