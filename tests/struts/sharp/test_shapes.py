"""Shapes of sharp nodes: how many edges there are, and that these are where surfaces meet."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import Skeleton, round_struts
from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.errors import OptionError
from scaffold_cad.struts.sharp.shapes import SharpShape
from tests.struts.sharp.nodes import BEND, LENGTH, NODES, node, random_node
from tests.struts.stars import TEE

COUNTS = {  # vertices, edges, of the ball
    "sharp bend": (2, 3, 1),
    "corner": (4, 6, 1),
    "tee": (2, 3, 0),
    "in a plane": (2, 3, 0),
    "tetrahedral": (4, 6, 0),
    "cubic": (8, 12, 0),
    "body-centered": (6, 12, 0),
}


def shape_of(skeleton: Skeleton) -> SharpShape:
    struts = round_struts(skeleton, nodes="sharp")
    assert len(struts.overlapping) == 0
    ((shape,),) = (group.shapes for group in struts.sharp)
    return shape


def depth(skeleton: Skeleton, points: Points) -> Floats:
    """Return how deep points are inside each strut and inside the node's ball, (p, N + 1)."""
    ways = skeleton.nodes[1:] / LENGTH
    near, far = skeleton.edge_radii.T
    slopes = (far - near) / LENGTH
    along = points @ ways.T
    across = np.sqrt(np.maximum((points**2).sum(axis=1)[:, None] - along**2, 0.0))
    inside = np.minimum(near + slopes * along - across, along + near * slopes)
    touched = (near / np.hypot(1.0, slopes)).max()
    ball = touched if slopes.any() else max(touched, skeleton.radii[0])
    return np.hstack([inside, (ball - np.linalg.norm(points, axis=1))[:, None]])


@pytest.mark.parametrize("name", COUNTS)
def test_a_node_has_as_many_vertices_and_edges_as_its_surfaces_meet_in(name: str) -> None:
    shape = shape_of(NODES[name])
    faces = {face for face, _ in shape.loops if face >= shape.valency}
    assert (len(shape.vertices), len(shape.ends), len(faces)) == COUNTS[name]


@pytest.mark.parametrize("name", NODES)
def test_edges_are_on_two_surfaces_and_inside_of_nothing(name: str) -> None:
    shape = shape_of(NODES[name])
    size = max(NODES[name].radii[0], 1.0) if name != "cones" else 1.0 / np.hypot(1, 0.02)
    angles = shape.outlines.angles(11)[:, 1:-1]
    curve = np.repeat(shape.outlines.curve, angles.shape[1])
    points = size * shape.curves.points(curve, angles.reshape(-1))[0]
    inside = depth(NODES[name], points)
    assert inside.max() < 1e-9
    on_strut = np.abs(inside[:, :-1]).min(axis=1)
    cuts = shape.sides.min(axis=1) >= shape.valency
    assert on_strut[~np.repeat(cuts, angles.shape[1])].max() < 1e-9


@pytest.mark.parametrize("kind", range(18))
def test_random_nodes_are_proved(kind: int) -> None:
    shape = shape_of(random_node(kind))
    assert shape.heights.min() > -0.1
    assert len(shape.loops) >= shape.valency


@pytest.mark.parametrize("noise", [1e-9, 1e-7, 1e-5, 1e-3])
@pytest.mark.parametrize("name", ["tee", "thin tee", "in a plane", "cubic", "body-centered"])
def test_rounded_coordinates_leave_corners_whole(name: str, noise: float) -> None:
    rng = np.random.default_rng(1)
    exact = NODES[name]
    ways = exact.nodes[1:] / LENGTH + noise * rng.normal(size=(len(exact.edges), 3))
    shape = shape_of(node(ways, exact.edge_radii[:, 0]))
    assert shape.slack.max() < 1e-5


def test_a_bend_of_equal_struts_is_mitred_up_to_a_right_angle() -> None:
    shape = shape_of(BEND)
    assert len(shape.ends) == 1
    np.testing.assert_allclose(shape.heights, [1.0, 1.0], atol=1e-3)


def test_nodes_without_room_are_crowded() -> None:
    short = Skeleton(
        [[0, 0, 0], [8, 0, 0], [0, 8, 0], [1.2, 1.2, 0], [9, 3, 2]],
        [[0, 1], [0, 2], [0, 3], [3, 4]],
        1.0,
    )
    struts = round_struts(short, nodes="sharp")
    assert struts.crowded.tolist() == [True, False, False, True, False]


@pytest.mark.parametrize(
    ("option", "value"), [("blend", 0.3), ("joints", "curve"), ("bend", "torus"), ("bend", 9.0)]
)
def test_what_is_for_blends_is_refused(option: str, value: object) -> None:
    with pytest.raises(OptionError, match=f"{option} is given with nodes='sharp', whose"):
        round_struts(BEND, nodes="sharp", **{option: value})


def test_equal_nodes_have_one_shape() -> None:
    ways = np.asarray(TEE, dtype=np.float64)
    one = node(ways)
    both = Skeleton(
        np.concatenate([one.nodes, one.nodes + 30.0]),
        np.concatenate([one.edges, one.edges + len(one.nodes)]),
        1.0,
    )
    (group,) = round_struts(both, nodes="sharp").sharp
    assert len(group.nodes) == 2
    assert len(group.shapes) == 1
