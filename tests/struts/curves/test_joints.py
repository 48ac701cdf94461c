"""Which joints are taken for samples of a curve, and where straight struts begin beside them."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.errors import OptionError
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts import round_struts
from tests.skeletons import ELBOW, STICK_FIGURE, TREFOIL, ZIGZAG
from tests.struts.chains import HOOK, circle, helix


def test_chains_sampled_from_curves_are_curves() -> None:
    for skeleton in (TREFOIL, circle(24), helix(80)):
        struts = round_struts(skeleton)
        assert struts.at_curves[skeleton.joints].all()
        assert len(struts.overlapping) == 0
        assert struts.blended == ()


def test_bends_of_straight_members_stay_bends() -> None:
    for skeleton in (ELBOW, ZIGZAG, STICK_FIGURE):
        struts = round_struts(skeleton)
        assert not struts.at_curves.any()
        assert struts.exact.all()


def test_the_choice_can_be_made() -> None:
    zigzag = round_struts(ZIGZAG, joints="curve")
    assert zigzag.at_curves[ZIGZAG.joints].all()
    assert not round_struts(circle(24), joints="blend").at_curves.any()
    with pytest.raises(OptionError, match="joints is 'torus'; need"):
        round_struts(ELBOW, joints="torus")  # type: ignore[arg-type]


def test_a_joint_with_a_ball_or_a_step_of_radius_stays_a_bend() -> None:
    balls = np.ones(24)
    balls[5] = 1.5
    for given in ({"radii": balls, "edge_radii": 1.0}, {"edge_radii": np.where(balls > 1, 1.1, 1)}):
        chain = circle(24)
        changed = Skeleton(chain.nodes, chain.edges, given.pop("radii", 1.0), **given)
        struts = round_struts(changed, joints="curve")
        assert not struts.at_curves[5]
        assert struts.at_curves[9]


def test_joints_without_room_for_a_bend_are_curves() -> None:
    # Turns of 60 degrees on edges of 1.2 radii: bends would overlap.
    ways = np.array([[6, 0], [0.6, 1.039], [-0.6, 1.039], [-6, 0]])
    nodes = np.pad(np.cumsum(ways, axis=0), ((1, 0), (0, 1)))
    chain = Skeleton(nodes, [[k, k + 1] for k in range(4)], 1.0)
    struts = round_struts(chain)
    assert struts.at_curves.tolist() == [False, True, True, True, False]
    assert len(round_struts(chain, joints="blend").overlapping) > 0


def test_long_edges_stay_straight_beside_a_curve() -> None:
    struts = round_struts(HOOK)
    assert struts.exact[0]
    assert not struts.exact[1:-1].any()
    straight = struts.runs.lengths[0] - struts.collar[:2].sum()
    assert straight > 0.9 * 30


def test_a_curve_next_to_a_branch_point_leaves_its_collar_room() -> None:
    chain = helix(40)
    tips = [[12, 0, -8], [12, -8, 0]]
    nodes = np.concatenate([chain.nodes, tips])
    edges = np.concatenate([chain.edges, [[0, 40], [0, 41]]])
    struts = round_struts(Skeleton(nodes, edges, 1.0))
    assert len(struts.overlapping) == 0
    assert struts.fillet[0] == pytest.approx(0.5)
    assert struts.collar.reshape(-1, 2)[0].sum() < chain.lengths[0]
