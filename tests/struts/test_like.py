"""Struts made like others keep their triangles, whatever moves."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import RoundStruts, Skeleton, read_skeleton, round_struts
from scaffold_cad.errors import OptionError
from scaffold_cad.struts.meshes.surface import triangulated
from tests.test_examples import EXAMPLES


def bent(degrees: float) -> Skeleton:
    angle = np.radians(degrees)
    tip = [20 + 20 * np.cos(angle), 20 * np.sin(angle), 0]
    return Skeleton([[0, 0, 0], [20, 0, 0], tip], [[0, 1], [1, 2]], 2.0)


def swaying(tree: Skeleton, phase: float) -> Skeleton:
    height = tree.nodes[:, 2] / np.ptp(tree.nodes[:, 2])
    sway = 0.06 * np.ptp(tree.nodes[:, 2]) * np.sin(phase) * height**2
    return tree.moved(tree.nodes + np.stack([sway, 0 * sway, 0 * sway], axis=1))


def check_same(first: RoundStruts, frames: list[RoundStruts]) -> None:
    start = triangulated(first, 12).mesh
    for struts in frames:
        assert len(struts.overlapping) == 0
        mesh = triangulated(struts, 12).mesh
        assert np.array_equal(mesh.triangles, start.triangles)
        mesh.check_closed()
        assert mesh.signed_volume == pytest.approx(start.signed_volume, rel=0.1)


def test_an_elbow_keeps_its_triangles_from_0_to_90_degrees() -> None:
    first = round_struts(bent(45))
    check_same(first, [round_struts(bent(turn), like=first) for turn in np.linspace(0.5, 90, 10)])


def test_a_swaying_tree_keeps_its_triangles() -> None:
    tree = read_skeleton(EXAMPLES / "skeletons" / "tree.json")
    tree = tree.with_radii(0.5 * tree.radii)
    first = round_struts(tree)
    frames = [round_struts(swaying(tree, phase), like=first) for phase in np.linspace(0, 6, 5)]
    check_same(first, frames)


def test_another_graph_is_refused() -> None:
    with pytest.raises(OptionError, match="like has 2 edges, which are not the skeleton's 1; need"):
        round_struts(Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0), like=round_struts(bent(45)))


def test_other_ends_are_refused() -> None:
    with pytest.raises(OptionError, match="like has ends='flat' and wall=None; need the same"):
        round_struts(bent(50), ends="round", like=round_struts(bent(45)))


def test_a_joint_that_was_straight_is_refused_where_it_bends() -> None:
    with pytest.raises(OptionError, match="node 1 was a straight joint in like, and bends now"):
        round_struts(bent(45), like=round_struts(bent(0)))
