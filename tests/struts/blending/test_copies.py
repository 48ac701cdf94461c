"""Nodes that are turned copies of each other have one blend, turned."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from scaffold_cad import Skeleton, round_struts
from scaffold_cad.struts.blending import nodes
from scaffold_cad.struts.blending.copies import Views
from scaffold_cad.struts.hollow.walls import walls_at
from tests.struts.stars import random_stars

COPIES = 20


def copies(valency: int) -> tuple[Skeleton, np.ndarray, np.ndarray]:
    """Return turned copies of a star with struts of their own radii in any order.

    The orders (COPIES, N) and turns (COPIES, 3, 3) are returned too.
    """
    rng = np.random.default_rng(valency)
    star = 20 * random_stars(1, valency, 40, rng)[0]
    radii = rng.uniform(0.7, 1.4, valency)
    order = np.argsort(rng.random((COPIES, valency)), axis=1)
    turns = Rotation.random(COPIES, rng=rng).as_matrix()
    places, edges, own, count = [], [], [], 0
    for copy, (turn, some) in enumerate(zip(turns, order, strict=True)):
        places.append(np.vstack([np.zeros(3), star[some]]) @ turn.T + [100.0 * copy, 0, 0])
        edges += [[count, count + 1 + k] for k in range(valency)]
        own.append(radii[some])
        count += valency + 1
    return Skeleton(np.vstack(places), edges, edge_radii=np.concatenate(own)), order, turns


@pytest.mark.parametrize("valency", [2, 3, 4, 6])
def test_turned_copies_are_solved_once(valency: int, monkeypatch: pytest.MonkeyPatch) -> None:
    solved = []
    work = nodes._solved

    def counted(own: nodes.Stars, *rest: object) -> nodes.Solved:
        solved.append(len(own))
        return work(own, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(nodes, "_solved", counted)
    skeleton, order, turns = copies(valency)
    struts = round_struts(skeleton)
    assert max(solved) == 1
    (group,) = struts.blended
    assert group.shapes.sound.all()
    shapes = group.shapes[group.shape_of]
    shape = (COPIES, valency, 4, -1, 3)
    row = np.arange(COPIES)[:, None]
    own_order = np.argsort(order, axis=1)
    back = shapes.control.reshape(shape)[row, own_order] @ turns[:, None, None]
    np.testing.assert_allclose(back, np.broadcast_to(back[:1], back.shape), atol=1e-9)
    along = shapes.collar_distances[row, own_order]
    np.testing.assert_allclose(along, np.broadcast_to(along[:1], along.shape), rtol=1e-9)


@pytest.mark.parametrize("valency", [3, 4])
def test_insides_of_turned_copies_are_solved_once(valency: int) -> None:
    skeleton, order, turns = copies(valency)
    struts = round_struts(skeleton, wall=0.3)
    assert struts.inner is not None
    (group,) = struts.inner.blended
    assert len(group.originals.skins) == 1
    control = group.shapes.control[group.shape_of].reshape(COPIES, valency, 4, -1, 3)
    back = control[np.arange(COPIES)[:, None], np.argsort(order, axis=1)] @ turns[:, None, None]
    np.testing.assert_allclose(back, np.broadcast_to(back[:1], back.shape), atol=1e-9)
    walls = walls_at(struts.blended, struts.inner.blended, len(skeleton.nodes))[group.nodes]
    assert np.ptp(walls) < 1e-9
    assert walls.min() > 0.95 * 0.3


def test_mirrored_nodes_are_no_copies() -> None:
    star = random_stars(1, 4, 40, np.random.default_rng(1))
    both = np.concatenate([star, star * [1, 1, -1]])
    views = Views.of(both, np.ones((2, 4)))
    one, other = views.by_number(views.seen(both))
    assert np.abs(one - other).max() > 0.1


@pytest.mark.parametrize("turn", [0.0, 1e-15, 1e-13, 1e-9, 1e-5])
def test_struts_on_one_line_have_a_frame(turn: float) -> None:
    rotations = Rotation.random(20, rng=np.random.default_rng(3)).as_matrix()
    pair = np.array([[1.0, 0, 0], [-np.cos(turn), np.sin(turn), 0]])
    frames = Views.of(pair @ rotations, np.array([[1.0, 0.7]] * 20)).frames
    eyes = np.broadcast_to(np.eye(3), frames.shape)
    np.testing.assert_allclose(frames @ frames.swapaxes(1, 2), eyes, atol=1e-10)


@pytest.mark.parametrize("turn", [0.0, 1e-15, 1e-13, 1e-9, 1e-5])
def test_steps_of_straight_struts_are_blended_around_their_axis(turn: float) -> None:
    tip = [-20 * np.cos(turn), 20 * np.sin(turn), 0.0]
    nodes = np.array([[0.0, 0, 0], [20, 0, 0], tip])
    for rotation in Rotation.random(3, rng=np.random.default_rng(4)).as_matrix():
        axis = rotation[:, 0]
        struts = round_struts(Skeleton(nodes @ rotation.T, [[0, 1], [0, 2]], edge_radii=[1, 0.7]))
        (group,) = struts.blended
        assert group.shapes.sound.all()
        points = group.shapes.control.reshape(-1, 3)
        assert np.linalg.norm(np.cross(points, axis), axis=1).min() > 0.69


def test_what_is_seen_is_meant() -> None:
    stars = random_stars(30, 5, 20, np.random.default_rng(2))
    views = Views.of(stars, np.ones((30, 5)))
    np.testing.assert_allclose(np.linalg.det(views.frames), 1.0)
    seen = views.by_number(views.seen(stars))
    np.testing.assert_allclose(views.meant(views.by_strut(seen)), stars, atol=1e-15)
    assert (np.abs(seen[:, :, 1:]).sum(axis=2).min(axis=1) < 1e-15).all()  # one is along x
