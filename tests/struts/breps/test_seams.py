"""Seams: each strut's face is closed along one generator, from a vertex to a vertex."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts import round_struts
from scaffold_cad.struts.breps.seams import QUARTER, seams
from tests.skeletons import CUBE, K4, NAMED, TAPER, TETRAPOD


@pytest.mark.parametrize("skeleton", [K4, CUBE, TETRAPOD], ids=["k4", "cube", "tetrapod"])
def test_a_seam_is_one_generator(skeleton: Skeleton) -> None:
    struts = round_struts(skeleton)
    found = seams(struts)
    y = np.cross(struts.runs.directions, struts.x)
    at = np.cos(found.angle)[:, None] * struts.x + np.sin(found.angle)[:, None] * y
    np.testing.assert_allclose(at[0::2], at[1::2], atol=1e-9)


@pytest.mark.parametrize("name", ["k4", "cube", "bcc_star", "stick_figure"])
def test_what_a_seam_does_not_split_it_meets_in_a_corner(name: str) -> None:
    found = seams(round_struts(NAMED[name]))
    offset = found.angle - QUARTER * np.round(found.angle / QUARTER)
    assert np.abs(offset[~found.splits]).max() < 1e-9
    inside = found.angle - QUARTER * found.quarter
    assert ((inside > -1e-8) & (inside < QUARTER)).all()


def test_a_seam_begins_at_the_thin_end_of_a_cone() -> None:
    struts = round_struts(TAPER)
    (near,) = seams(struts).near.tolist()
    assert struts.runs.radii.reshape(-1)[near] == TAPER.radii.min()
