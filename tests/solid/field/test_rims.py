"""How small cells are at rims: smaller where other struts are near."""

from __future__ import annotations

import numpy as np

from scaffold_cad.solid.field import field_struts
from scaffold_cad.solid.field.rims import ALONE, COVERED, rim_fractions


def test_rims_beside_other_struts_have_the_smallest_cells() -> None:
    ends = [
        [[0, 0, 0], [20, 0, 0]],  # its end is near the side of the next one
        [[21.2, -9, 0], [21.2, 9, 0]],
        [[0, 0, 9], [20, 0, 9]],  # alone
    ]
    flat = [[True, True], [True, True], [False, True]]
    found = rim_fractions(field_struts(ends, 1.0, flat=flat))
    np.testing.assert_array_equal(found, [[ALONE, COVERED], [ALONE, ALONE], [1.0, ALONE]])


def test_struts_that_end_round_have_cells_of_the_usual_size() -> None:
    assert (rim_fractions(field_struts([[[0, 0, 0], [9, 0, 0]]], 1.0)) == 1.0).all()
