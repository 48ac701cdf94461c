"""Struts that print without supports."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.lattice import tile
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.supporting import self_supporting

ARCH = Skeleton(
    [[0, 0, 0], [0, 0, 10], [6, 0, 10], [6, 0, 4], [12, 0, 18], [20, 0, 14]],
    [[0, 1], [1, 2], [2, 3], [2, 4], [4, 5]],
    0.5,
)
"""A column, a beam of 6 mm, a strut that hangs from it, and two that rise and fall from its end."""


def test_flat_and_hanging_struts_go() -> None:
    kept = self_supporting(ARCH)
    assert kept.nodes.tolist() == [[0, 0, 0], [0, 0, 10]]


def test_short_bridges_stay_only_between_held_nodes() -> None:
    portal = Skeleton(
        [[0, 0, 0], [0, 0, 10], [6, 0, 10], [6, 0, 0], [9, 0, 10]],
        [[0, 1], [1, 2], [2, 3], [2, 4]],
        0.5,
    )
    assert len(self_supporting(portal).edges) == 2
    assert len(self_supporting(portal, bridge=6.0).edges) == 3
    assert len(self_supporting(portal, bridge=5.0).edges) == 2


def test_the_direction_of_building_counts() -> None:
    cubes = tile("sc", 5.0, 3, radius=0.4)
    for axis in range(3):
        kept = self_supporting(cubes, direction=np.eye(3)[axis])
        assert len(kept.edges) == 3 * 16
        along = np.abs(kept.directions[::2])
        np.testing.assert_allclose(along[:, axis], 1.0)


def test_struts_of_just_the_least_angle_stay() -> None:
    bcc = tile("bcc", 10.0, 2, radius=0.5)
    steepness = np.arcsin(1 / np.sqrt(3))  # of a cube's diagonal
    assert len(self_supporting(bcc, steepness).edges) == len(bcc.edges)
    with pytest.raises(SkeletonError, match="no strut rises at 40 degrees"):
        self_supporting(bcc, np.radians(40))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"angle": 2.0}, "angle is 2 rad; need 0 to pi/2"),
        ({"direction": [0, 0, 0]}, "direction is .* need a direction, three finite numbers"),
        ({"bridge": -1.0}, "bridge is -1 mm"),
    ],
)
def test_arguments_out_of_range_are_refused(options: dict[str, object], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        self_supporting(ARCH, **options)  # type: ignore[arg-type]
