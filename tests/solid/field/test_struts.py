from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.errors import OptionError
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.field import field_struts, skeleton_struts

ENDS = [[[0, 0, 0], [10, 0, 0]], [[0, 0, 0], [0, 10, 0]]]


def test_one_radius_stands_for_all_and_balls_come_last() -> None:
    struts = field_struts(ENDS, 2.0, balls=[[0, 0, 0]], ball_radii=3.0, blend=0.5)
    assert struts.radii.tolist() == [[2, 2], [2, 2], [3, 3]]
    assert struts.lengths.tolist() == [10, 10, 0]
    assert struts.blend.tolist() == pytest.approx([0.5, 0.5, 0.9])


def test_a_radius_each_is_that_of_both_ends() -> None:
    assert field_struts(ENDS, [1.0, 2.0]).radii.tolist() == [[1, 1], [2, 2]]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"ends": [], "radii": []}, "no struts and no balls"),
        ({"ends": [[0, 0, 0]], "radii": 1.0}, "ends has shape"),
        ({"ends": [[[0, 0, np.nan], [1, 0, 0]]], "radii": 1.0}, "all finite"),
        ({"ends": ENDS, "radii": [1.0, -2.0]}, "strut 1 has radius -2 mm; need > 0"),
        ({"ends": ENDS, "radii": [1.0, 2.0, 3.0]}, "radii has shape"),
        ({"ends": ENDS, "radii": 1.0, "blend": -1.0}, "blend of strut 0 is -1 mm; need >= 0"),
        ({"ends": ENDS, "radii": 1.0, "flat": [True] * 3}, "flat has shape"),
    ],
)
def test_what_is_no_strut_is_refused_by_name(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        field_struts(**arguments)  # type: ignore[arg-type]


TRIPOD = Skeleton(
    np.array([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]]),
    np.array([[0, 1], [0, 2], [0, 3]]),
    np.array([2.0, 1.0, 1.0, 1.0]),
)


def test_struts_of_a_skeleton_have_their_own_radii_and_thicker_nodes_are_balls() -> None:
    assert skeleton_struts(TRIPOD).radii.tolist() == [[2, 1]] * 3
    own = skeleton_struts(TRIPOD.with_edge_radii([0.5, 0.5, 1.0], TRIPOD.radii))
    assert own.radii.tolist() == [[0.5, 0.5], [0.5, 0.5], [1, 1], [2, 2], [1, 1], [1, 1]]
    # balls at nodes 0, 1 and 2


def test_only_extremities_end_flat() -> None:
    assert skeleton_struts(TRIPOD, flat_ends=True).flat.tolist() == [[False, True]] * 3
