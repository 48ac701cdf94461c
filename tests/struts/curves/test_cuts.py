"""Curves cut at the circles of their joints: what is left is as it was."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.struts import round_struts
from scaffold_cad.struts.curves.cuts import chains_left, cut_curves, neighbors
from tests.skeletons import TREFOIL
from tests.struts.chains import helix


def test_nothing_left_out_changes_nothing() -> None:
    for skeleton in (helix(60), TREFOIL):
        curves = round_struts(skeleton).curves
        cut = cut_curves(curves, np.zeros(len(curves.pieces), dtype=np.bool_), 1000)
        assert len(cut.nodes) == 0
        np.testing.assert_array_equal(cut.curves.half_runs, curves.half_runs)
        np.testing.assert_array_equal(cut.curves.frames, curves.frames)


@pytest.mark.parametrize("left_out", [[4], [4, 5, 6], [0], [57, 58]])
def test_an_open_curve_ends_on_the_circles_beside_what_is_left_out(left_out: list[int]) -> None:
    curves = round_struts(helix(60)).curves
    count = len(curves.pieces)
    gone = np.isin(np.arange(count), left_out)
    cut = cut_curves(curves, gone, 1000, 2)
    np.testing.assert_array_equal(cut.curves.frames, curves.frames[~gone])
    at_end = (left_out[0] == 0) + (left_out[-1] == count - 1)
    assert len(cut.curves.half_runs) == len(cut.nodes) == 2 - at_end
    own = cut.curves.half_runs[cut.curves.half_runs >= 1000]
    assert own.tolist() == [1000, 1002][: len(own)]
    assert set(cut.beyond.tolist()) <= set(left_out)
    way = curves.centers[curves.pieces[cut.beyond]] + curves.centers[curves.pieces[cut.beyond] + 1]
    circle = round_struts(helix(60)).skeleton.nodes[cut.nodes]
    assert (((way / 2 - circle) * cut.outward).sum(axis=1) > 0).all()


@pytest.mark.parametrize("left_out", [[0], [7], [39], [38, 39, 0, 1]])
def test_a_closed_curve_runs_on_past_its_first_joint(left_out: list[int]) -> None:
    curves = round_struts(TREFOIL).curves
    gone = np.isin(np.arange(len(curves.pieces)), left_out)
    cut = cut_curves(curves, gone, 1000)
    order, chain = chains_left(curves, gone)
    assert (chain == 0).all()
    np.testing.assert_array_equal(cut.curves.frames, curves.frames[order])
    assert cut.curves.half_runs.tolist() == [[1000, 1001]]
    before, after = neighbors(curves)
    assert cut.beyond.tolist() == [before[order[0]], after[order[-1]]]
    assert gone[cut.beyond].all()
