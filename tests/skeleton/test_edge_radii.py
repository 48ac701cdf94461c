"""Struts keep the radii that are asked for, whatever is done with their skeleton."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path

import numpy as np
import pytest

from scaffold_cad import Skeleton, build_scaffold, read_skeleton, write
from scaffold_cad.base.arrays import Floats
from scaffold_cad.errors import SkeletonError
from scaffold_cad.io import skeleton_from_networkx, skeleton_to_networkx
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.skeleton.repair import repaired

NODES = [[0, 0, 0], [10, 0, 0], [20, 0, 0], [10, 10, 0]]
EDGES = [[0, 1], [1, 2], [3, 1]]
SIZES = [[1.0, 2.0], [0.5, 0.5], [0.25, 0.75]]


def members() -> Skeleton:
    return Skeleton(NODES, EDGES, edge_radii=SIZES)


def test_struts_have_the_radii_of_their_nodes_by_default() -> None:
    skeleton = Skeleton(NODES, EDGES, [1.0, 2.0, 3.0, 4.0])
    assert skeleton.edge_radii.tolist() == [[1, 2], [2, 3], [4, 2]]
    assert not skeleton.has_member_radii


def test_nodes_have_the_largest_radius_of_their_struts_by_default() -> None:
    assert members().radii.tolist() == [1.0, 2.0, 0.5, 0.25]
    assert members().has_member_radii


def test_one_radius_a_strut_stands_for_both_ends() -> None:
    assert Skeleton(NODES, EDGES, edge_radii=[1, 2, 3]).edge_radii[:, 1].tolist() == [1, 2, 3]


@pytest.mark.parametrize(
    ("sizes", "message"),
    [
        ([1, 2], r"edge_radii has shape \(2,\); need \(3, 2\), two per edge"),
        ([1, 0, 3], r"edge 1 near \[.*\] mm has radii \[0.0, 0.0\] mm; need > 0"),
        ([[1, 1], [1, np.nan], [1, 1]], r"edge 1 near \[.*\] mm has radii \[1.0, nan\] mm; need"),
    ],
)
def test_wrong_radii_are_refused_by_name(sizes: list[float], message: str) -> None:
    with pytest.raises(SkeletonError, match=message):
        Skeleton(NODES, EDGES, edge_radii=sizes)


def test_a_skeleton_needs_radii_of_nodes_or_of_struts() -> None:
    with pytest.raises(SkeletonError, match="radii and edge_radii are both None; need one"):
        Skeleton(NODES, EDGES)


def test_editing_keeps_the_radii_of_struts() -> None:
    skeleton = members()
    assert skeleton.moved(skeleton.nodes + 1).edge_radii.tolist() == SIZES
    assert skeleton.scaled(2).edge_radii.tolist() == (2 * np.array(SIZES)).tolist()
    assert skeleton.with_edges([2]).edge_radii.tolist() == SIZES[2:]
    assert skeleton.with_edge_radii(3.0).edge_radii.tolist() == [[3, 3]] * 3
    assert skeleton.with_radii(3.0).edge_radii.tolist() == [[3, 3]] * 3


def test_copies_keep_the_radii_of_struts() -> None:
    for twin in (copy.deepcopy(members()), pickle.loads(pickle.dumps(members()))):
        assert twin.edge_radii.tolist() == SIZES
        assert not twin.edge_radii.flags.writeable


def test_welding_leaves_every_strut_its_own_radius() -> None:
    apart = Skeleton(
        [[0, 0, 0], [10, 0, 0], [10, 0, 0], [20, 0, 0]], [[0, 1], [2, 3]], edge_radii=[1.5, 0.4]
    )
    clean = apart.cleaned().skeleton
    assert clean.edge_radii.tolist() == [[1.5, 1.5], [0.4, 0.4]]
    assert clean.radii.tolist() == [1.5, 1.5, 0.4]


def test_of_repeated_struts_the_larger_radii_stay() -> None:
    twice = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1], [1, 0]], edge_radii=[[1, 2], [1.5, 3]])
    clean = twice.cleaned()
    assert clean.repairs.duplicate_edges == 1
    assert clean.skeleton.edge_radii.tolist() == [[3, 2]]


def test_a_strut_that_is_split_tapers_on() -> None:
    tee = Skeleton(
        [[0, 0, 0], [10, 0, 0], [4, 0, 0], [4, 5, 0]],
        [[0, 1], [2, 3]],
        edge_radii=[[1.0, 2.0], [0.5, 0.5]],
    )
    clean = tee.cleaned(split_contacts=True).skeleton
    sizes = {
        tuple(sorted(edge)): size
        for edge, size in zip(clean.edges.tolist(), clean.edge_radii.tolist(), strict=True)
    }
    assert sizes[(0, 2)] == pytest.approx([1.0, 1.4])
    assert sizes[(1, 2)] == pytest.approx([1.4, 2.0])
    assert sizes[(2, 3)] == [0.5, 0.5]


def test_an_overlapping_strut_goes_on_with_the_radius_it_has_there() -> None:
    graph = repaired(
        np.array([[0.0, 0, 0], [4, 0, 0], [10, 0, 0]]),
        np.array([[0, 1], [0, 2]]),
        None,
        np.array([[3.0, 3.0], [1.0, 2.0]]),
    )
    assert graph.edges.tolist() == [[0, 1], [1, 2]]
    assert graph.edge_radii == pytest.approx(np.array([[3.0, 3.0], [1.4, 2.0]]))


def test_thinning_keeps_the_steps_between_members() -> None:
    x = np.arange(7.0) * 10
    path = Skeleton(
        np.stack([x, 0 * x, 0 * x], axis=1),
        np.stack([np.arange(6), np.arange(1, 7)], axis=1),
        edge_radii=[1.0, 1, 1, 2, 2, 2],
    )
    thin = path.simplified(0.01)
    assert thin.nodes[:, 0].tolist() == [0, 30, 60]
    assert thin.edge_radii.tolist() == [[1, 1], [2, 2]]


def test_thinning_keeps_tapers() -> None:
    x = np.arange(5.0) * 10
    ends = np.linspace(1.0, 2.0, 5)
    path = Skeleton(np.stack([x, 0 * x, 0 * x], axis=1), [[0, 1], [2, 1], [2, 3], [3, 4]], ends)
    assert path.simplified(0.01).edge_radii == pytest.approx(np.array([[1.0, 2.0]]))


def test_a_radius_too_small_for_its_place_is_repaired_as_none() -> None:
    radii = np.array([1.0, 5e-8, 1.0])
    graph = repaired(
        np.array([[0.0, 0, 0], [500, 0, 0], [900, 0, 0]]), np.array([[0, 1], [1, 2]]), radii
    )
    assert graph.repairs.radii_replaced == 1
    assert graph.radii.tolist() == [1.0, 1.0, 1.0]


def test_struts_give_their_radii_to_nodes_without_any() -> None:
    raw = RawSkeleton(NODES, EDGES, None, [1.0, 2.0, np.nan])
    assert raw.has_radii
    graph = repaired(raw.nodes, raw.edges, raw.radii, raw.edge_radii)
    assert graph.radii.tolist() == [1.0, 2.0, 2.0, 2.0]
    assert graph.edge_radii.tolist() == [[1, 1], [2, 2], [2, 2]]
    assert graph.repairs.radii_replaced == 0


def test_json_keeps_the_radii_of_struts(tmp_path: Path) -> None:
    write(members(), tmp_path / "members.json")
    assert '"version": 2' in (tmp_path / "members.json").read_text("utf-8")
    assert read_skeleton(tmp_path / "members.json").edge_radii.tolist() == SIZES


def test_json_without_radii_of_struts_stays_as_old_readers_know_it(tmp_path: Path) -> None:
    write(Skeleton(NODES, EDGES, 1.0), tmp_path / "plain.json")
    assert '"version": 1' in (tmp_path / "plain.json").read_text("utf-8")


def test_networkx_keeps_the_radii_of_struts() -> None:
    pytest.importorskip("networkx")
    back = skeleton_from_networkx(skeleton_to_networkx(members()))
    sizes = dict(zip(map(tuple, back.edges.tolist()), back.edge_radii.tolist(), strict=True))
    assert sizes == {(0, 1): [1.0, 2.0], (1, 2): [0.5, 0.5], (1, 3): [0.75, 0.25]}


def test_collared_scaffolds_have_the_radius_of_each_strut() -> None:
    star = Skeleton(
        [[0, 0, 0], [40, 0, 0], [0, 40, 0], [0, 0, 40]],
        [[0, 1], [0, 2], [0, 3]],
        edge_radii=[3.0, 2.0, 1.0],
    )
    scaffold = build_scaffold(star, collars=True)
    refined = scaffold.refined
    strut = refined.valency[refined.edges].max(axis=1) < 3  # between collar and extremity
    widths: Floats = refined.radii[refined.edges[strut]]
    assert widths.tolist() == [[3, 3], [2, 2], [1, 1]]


def test_nodes_are_no_thicker_than_the_edges_left_unless_they_were_balls() -> None:
    nodes, edges = [[0, 0, 0], [20, 0, 0], [20, 20, 0]], [[0, 1], [1, 2]]
    path = Skeleton(nodes, edges, edge_radii=[3.0, 0.5])
    ball = Skeleton(nodes, edges, [3.0, 4.0, 0.5], edge_radii=[3.0, 0.5])
    corner = [[15, -1, -1], [25, 25, 1]]
    for skeleton, expected in ((path, 0.5), (ball, 4.0)):
        assert skeleton.with_edges([1]).radii.tolist() == [expected, 0.5]
        assert skeleton.cut(corner, keep="whole").radii.tolist() == [expected, 0.5]
    assert sorted(path.cut(corner).radii.tolist()) == [0.5, 3.0, 3.0]
