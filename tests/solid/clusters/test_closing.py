"""Open ends of hollow struts that lie in other struts."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import Skeleton, round_struts
from scaffold_cad.solid.rounds import round_mesh
from tests.crossings import check_as_written
from tests.solids import contains

RADII = [[1.5, 1.5], [0.6, 1.2]]


@pytest.mark.parametrize("depth", [0.3, 0.95])
def test_the_closed_end_of_a_tapered_tube_has_no_ball_inside(depth: float) -> None:
    nodes = [[-9, 0, 0], [9, 0, 0], [0, 0, 12], [0, 0, -depth]]
    tee = Skeleton(nodes, [[0, 1], [2, 3]], [1.5, 1.5, 0.6, 1.2], RADII)
    mesh = round_mesh(round_struts(tee, wall=0.25, ends="open"))
    check_as_written(mesh)
    below = np.array([[0.0, 0.0, -1.38], [0.0, 0.3, -1.36], [0.3, 0.0, -1.36]])
    assert contains(mesh, below).all()  # in the wall of the thick tube, below the end
    assert not contains(mesh, np.array([[6.0, 0, 0], [0, 0, 6.0]])).any()
