"""round_struts(): what each strut and node gets, what is crowded, and that it follows its input."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.lattice import tile
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts import round_struts
from scaffold_cad.struts.meshes.surface import triangulated
from tests.skeletons import BCC_STAR, CUBE, ELBOW, JACK, K4, STRUT, TETRAPOD, TRIPOD, TWO_STRUTS
from tests.struts.stars import random_stars

APART = {
    "strut": STRUT,
    "elbow": ELBOW,
    "tripod": TRIPOD,
    "tetrapod": TETRAPOD,
    "jack": JACK,
    "bcc_star": BCC_STAR,
    "k4": K4,
    "cube": CUBE,
    "two_struts": TWO_STRUTS,
}


@pytest.mark.parametrize("skeleton", APART.values(), ids=APART)
def test_struts_with_room_are_exact_and_keep_apart(skeleton: Skeleton) -> None:
    struts = round_struts(skeleton)
    assert struts.exact.all()
    assert struts.overlapping.tolist() == []
    assert not struts.crowded.any()
    inner = skeleton.valency > 1
    assert (struts.fillet[inner] == 0.5).all()
    assert np.isnan(struts.fillet[~inner]).all()


def test_the_blend_asked_for_is_reached_where_it_has_room() -> None:
    for blend in (0.2, 0.5, 1.5):
        assert round_struts(TRIPOD, blend=blend).fillet[0] == blend


def test_the_fillet_of_a_node_that_is_a_field_is_the_one_asked_for() -> None:
    turns = np.radians([-30, -15, 0, 15, 30])
    tips = 40 * np.stack([np.cos(turns), np.sin(turns), 0 * turns], axis=1)
    fan = Skeleton([[0, 0, 0], *tips], [[0, k] for k in range(1, 6)], 2.0)
    struts = round_struts(fan, blend=1.0)
    assert struts.crowded[0]
    assert struts.fillet[0] == 1.0


def test_a_wider_blend_has_its_collars_further_out() -> None:
    collars = [round_struts(TRIPOD, blend=blend).collar[[0, 2, 4]] for blend in (0.2, 0.5, 1.5)]
    assert (np.diff(collars, axis=0) > 0).all()


def test_a_blend_without_room_shrinks_and_says_so() -> None:
    short = TRIPOD.scaled(3.0 / TRIPOD.lengths[0]).with_radii(1.0)  # collars want 3.5 mm
    struts = round_struts(short, blend=2.5)
    assert struts.overlapping.tolist() == []
    assert 0.1 <= struts.fillet[0] < 2.5
    assert (struts.collar[0::2] < struts.runs.lengths).all()


def test_struts_shorter_than_their_node_is_wide_are_crowded() -> None:
    short = Skeleton([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 0.9]], TRIPOD.edges, 1.0)
    struts = round_struts(short)
    assert struts.crowded.any()
    assert 2 in struts.overlapping.tolist()
    assert not struts.exact[2]
    assert struts.exact[[0, 1]].all()


def test_only_what_is_crowded_overlaps() -> None:
    crossing = np.array([[100, 0, 0], [120, 0, 0], [110, -8, 0], [110, 8, 0]])
    nodes = np.concatenate([K4.nodes, crossing])
    edges = np.concatenate([K4.edges, [[4, 5], [6, 7]]])
    struts = round_struts(Skeleton(nodes, edges, 1.0))
    assert struts.overlapping.tolist() == [6, 7]
    assert struts.exact.tolist() == [True] * 6 + [False] * 2


@pytest.mark.parametrize("wall", [None, 0.3])
def test_a_blend_too_wide_to_be_proved_shrinks_until_it_is(wall: float | None) -> None:
    for directions in random_stars(2, 4, 45.0, np.random.default_rng(3)):
        nodes = np.concatenate([np.zeros((1, 3)), 100 * directions])
        star = Skeleton(nodes, [[0, k] for k in range(1, 5)], 1.0)
        struts = round_struts(star, blend=40.0, wall=wall, ends="flat" if wall is None else "open")
        assert not struts.crowded.any()
        assert 0.5 <= struts.fillet[0] < 40.0


def test_fillets_that_shrink_are_told(caplog: pytest.LogCaptureFixture) -> None:
    round_struts(TRIPOD, blend=1.0)
    assert caplog.messages == []
    round_struts(TRIPOD.scaled(3.0 / TRIPOD.lengths[0]).with_radii(1.0), blend=2.5)
    assert re.search(
        r"1 fillet is shrunk: node 0 at \[0, 0, 0\] mm has .* of the 2.5 mm", caplog.text
    )


def test_equal_nodes_share_one_blend() -> None:
    struts = round_struts(tile("bcc", 10.0, 2, radius=0.6))
    inner = [group for group in struts.blended if group.quads.shape[1] == 8]
    assert sum(len(group.nodes) for group in inner) >= 8
    assert sum(len(group.shapes.control) for group in inner) == 1


@pytest.mark.parametrize("name", ["tripod", "bcc_star", "cube"])
def test_struts_turn_move_and_grow_with_their_skeleton(name: str) -> None:
    skeleton = APART[name]
    turn = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    there = skeleton.scaled(3.0)
    there = there.moved(there.nodes @ turn.T + [10, 20, 30])
    here, other = round_struts(skeleton), round_struts(there)
    np.testing.assert_allclose(other.collar, 3 * here.collar, rtol=1e-6)
    np.testing.assert_allclose(other.fillet, 3 * here.fillet, rtol=1e-9)
    volumes = [triangulated(struts, 16).mesh.signed_volume for struts in (here, other)]
    assert volumes[1] == pytest.approx(27 * volumes[0], rel=1e-3)


def test_the_same_input_gives_the_same_output() -> None:
    one, other = (round_struts(K4) for _ in range(2))
    np.testing.assert_array_equal(one.collar, other.collar)
    for a, b in zip(one.blended, other.blended, strict=True):
        np.testing.assert_array_equal(a.shapes.control, b.shapes.control)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"blend": -1.0}, "blend is -1 mm; need > 0"),
        ({"blend": "x"}, "blend is 'x'; need a number"),
        ({"ends": "dome"}, "ends is 'dome'; need one of flat, round, open"),
        ({"wall": 0}, "wall is 0 mm; need > 0"),
        ({"ends": "open"}, "ends is 'open' without a wall"),
    ],
)
def test_options_out_of_range_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        round_struts(TRIPOD, **options)


def test_skeletons_that_cannot_be_built_on_are_refused() -> None:
    with pytest.raises(SkeletonError, match="no edges"):
        round_struts(Skeleton([[0, 0, 0]], [], 1.0))


def test_a_node_beside_one_with_a_ball_has_its_own_blend() -> None:
    beside = TRIPOD.moved(TRIPOD.nodes + np.array([50.0, 0.0, 0.0]))
    radii = np.concatenate([TRIPOD.radii, beside.radii])
    radii[0] *= 1.8
    both = Skeleton(
        [*TRIPOD.nodes, *beside.nodes],
        [*TRIPOD.edges, *(TRIPOD.edges + len(TRIPOD.nodes))],
        radii,
        np.concatenate([TRIPOD.edge_radii, TRIPOD.edge_radii]),
    )
    found = round_struts(both)
    alone = round_struts(TRIPOD).blended[0].shapes.control[0]
    (group,) = (one for one in found.blended if len(TRIPOD.nodes) in one.nodes)
    shape = group.shape_of[group.nodes.tolist().index(len(TRIPOD.nodes))]
    np.testing.assert_array_equal(group.shapes.control[shape], alone)
    assert np.isfinite(group.shapes.misfit).all()


def test_struts_without_ends_may_end_round() -> None:
    mesh = triangulated(round_struts(K4, ends="round"), 8).mesh
    mesh.check_closed()


def test_no_strut_is_exact_whose_collars_pass_each_other() -> None:
    # The least collars of both stars are 4.7 radii together on the strut that both share.
    first, second = random_stars(2, 4, 35, np.random.default_rng(38))
    second = second @ Rotation.align_vectors(-first[:1], second[:1])[0].as_matrix().T
    middle = 4.5 * first[0]
    nodes = [[0, 0, 0], *(20 * first[1:]), middle, *(middle + 20 * second[1:])]
    edges = [*([0, k] for k in (1, 2, 3, 4)), *([4, k] for k in (5, 6, 7))]
    struts = round_struts(Skeleton(nodes, edges, 1.0))
    passing = struts.collar.reshape(-1, 2).sum(axis=1) > struts.runs.lengths
    assert passing.tolist() == [False, False, False, True, False, False, False]
    assert not struts.exact[passing].any()
    assert struts.crowded[[0, 4]].all()


@pytest.mark.parametrize("length", [3.5, 4.5, 6.0])
def test_collars_beyond_the_corners_of_patches_come_nearer_where_a_strut_is_short(
    length: float,
) -> None:
    """Thick struts at 38°: fillets end 3 radii from the node, corners of patches 5."""
    angles = np.radians([107, -73, -34.5, 3.8])
    tips = np.stack([np.cos(angles), 0 * angles, np.sin(angles)], axis=1)
    tips *= np.array([3.5, length, 7.0, 5.0])[:, None]
    radii = [1.0, 1.0, 0.9, 0.8]
    lug = Skeleton([[0, 0, 0], *tips], [[0, 1], [0, 2], [0, 3], [0, 4]], edge_radii=radii)
    struts = round_struts(lug, blend=0.2)
    assert not struts.crowded.any()
    assert struts.fillet[0] == 0.2
    assert struts.collar[2] < length
