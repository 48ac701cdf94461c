"""Bodies of blended nodes are closed, and equal ones are told so."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import Skeleton, round_struts, tile
from scaffold_cad.struts.bodies import OFTEN, NodeBodies
from tests.skeletons import JACK, TETRAPOD, ZIGZAG, star


@pytest.mark.parametrize("skeleton", [TETRAPOD, JACK, ZIGZAG], ids=["tetrapod", "jack", "zigzag"])
def test_bodies_are_closed_and_in_their_boxes(skeleton: Skeleton) -> None:
    struts = round_struts(skeleton)
    bodies = NodeBodies(struts, 16, ~struts.crowded)
    assert len(bodies) == (~np.isnan(struts.fillet)).sum()
    assert (np.diff(bodies.low[:, 2]) >= 0).all()
    for number in range(len(bodies)):
        mesh = bodies.mesh(slice(number, number + 1))
        mesh.check_closed()
        assert mesh.signed_volume > 0
        assert (mesh.vertices >= bodies.low[number] - 1e-9).all()
        assert (mesh.vertices <= bodies.high[number] + 1e-9).all()


def test_crowded_nodes_have_no_body() -> None:
    struts = round_struts(star([[9, 0, 0], [9, 0.8, 0], [9, 0, 1.1]]))
    assert struts.crowded[0]
    assert len(NodeBodies(struts, 16, ~struts.crowded)) == 0


def test_equal_nodes_are_told_so() -> None:
    struts = round_struts(tile("bcc", 8.0, 3, radius=0.6))
    bodies = NodeBodies(struts, 16, ~struts.crowded)
    centers = np.flatnonzero((bodies.nodes % 8.0 == 4.0).all(axis=1))
    assert len(centers) == 27
    kinds, counts = np.unique(bodies.kinds[bodies.kinds >= 0], return_counts=True)
    assert (counts >= OFTEN).all()
    assert kinds.tolist() == list(range(len(kinds)))
    for kind in kinds.tolist():
        equal = np.flatnonzero(bodies.kinds == kind)
        first, last = (
            bodies.mesh(equal[place : place + 1]).vertices - bodies.nodes[equal[place]]
            for place in (0, len(equal) - 1)
        )
        assert first == pytest.approx(last, abs=1e-5)


def test_nodes_with_few_like_them_are_of_no_kind() -> None:
    struts = round_struts(ZIGZAG)
    assert NodeBodies(struts, 8, ~struts.crowded).kinds.tolist() == [-1] * 4
