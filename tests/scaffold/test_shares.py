"""Struts shared out among surfaces that are embedded each for itself."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.filling import voronoi_foam
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.scaffold.shares import MOST_SHARES, Share, shared_out
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import to_solid
from scaffold_cad.solid.pieces import surface_of

TETRAHEDRON = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(3.0)


def star_at(place: list[float], turn: float) -> Skeleton:
    """Return four struts of 10 mm about a node, turned about z."""
    cosine, sine = np.cos(turn), np.sin(turn)
    about = np.array([[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1]])
    nodes = np.concatenate([[[0.0, 0.0, 0.0]], 10.0 * TETRAHEDRON @ about]) + place
    return Skeleton(nodes, [[0, 1], [0, 2], [0, 3], [0, 4]], 1.0)


FIRST, SECOND = star_at([0.0, 0.0, 0.0], 0.0), star_at([1.3, 0.7, 0.4], 0.6)


def shares_of(skeleton: Skeleton) -> list[Share]:
    scaffold = build_scaffold(skeleton)
    return shared_out(scaffold, scaffold.embedding(), np.ones(len(skeleton.nodes), dtype=np.bool_))


def test_two_stars_through_each_other_are_two_shares() -> None:
    both = FIRST + SECOND
    shares = shares_of(both)
    assert [int(share.struts.sum()) for share in shares] == [4, 4]
    assert [int(share.nodes.sum()) for share in shares] == [1, 1]


def test_their_solid_is_the_union_of_the_solids_of_both() -> None:
    one, two = (to_solid(build_scaffold(star)) for star in (FIRST, SECOND))
    whole = to_solid(build_scaffold(FIRST + SECOND))
    assert whole.volume() == pytest.approx((one + two).volume(), rel=1e-5)
    assert whole.volume() < 0.95 * (one.volume() + two.volume())


@pytest.mark.parametrize("seed", [1, 2])
def test_shares_of_a_foam_have_each_strut_and_node_once_and_are_embedded(seed: int) -> None:
    box = np.array([[0.0, 0.0, 0.0], [30.0, 30.0, 30.0]])
    skeleton = voronoi_foam(30, box, 0.7, seed=seed)
    scaffold = build_scaffold(skeleton)
    shares = shares_of(skeleton)
    assert 1 < len(shares) <= MOST_SHARES
    assert np.sum([share.struts for share in shares], axis=0).max() == 1
    assert np.sum([share.nodes for share in shares], axis=0).max() == 1
    for share in shares:
        surface = surface_of(scaffold, share, scaffold.embedding().within_cone)
        surface.check_closed()
        assert surface.signed_volume > 0
        assert len(self_intersections(surface)) == 0
