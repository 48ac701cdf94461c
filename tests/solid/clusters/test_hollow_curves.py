"""Hollow curves that are crowded somewhere: both sides of their walls are fields there."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import Skeleton, round_struts
from scaffold_cad.products import to_brep
from scaffold_cad.solid.rounds import round_mesh
from tests.crossings import check_as_written
from tests.skeletons import polyline
from tests.solid.field.judges import thicknesses

WALL = 0.3


def shaky_curve(seed: int) -> Skeleton:
    """Return a curve whose samples are off it by a fifth of its radius."""
    t = np.linspace(0, 0.25, 30)
    curve = np.stack([100 * t, 15 * np.sin(9 * t), 10 * np.cos(7 * t)], axis=1)
    shaken = curve + 0.2 * np.random.default_rng(seed).normal(size=curve.shape)
    return Skeleton(shaken, polyline(30), 0.95)


@pytest.mark.parametrize("seed", [6, 8, 17])
def test_walls_of_curves_are_thick_where_they_become_fields(seed: int) -> None:
    struts = round_struts(shaky_curve(seed), wall=WALL)
    assert struts.crowded.any()
    mesh = round_mesh(struts)
    check_as_written(mesh)
    walls = thicknesses(mesh) / WALL
    assert walls.min() > 0.95
    assert np.quantile(walls, 0.01) > 0.97


def test_walls_of_curves_that_become_facets_are_valid() -> None:
    struts = round_struts(shaky_curve(8), wall=WALL)
    solid = to_brep(struts, overlaps="unite")
    assert solid.is_valid
    assert len(solid.solids()) == 1
    assert solid.volume == pytest.approx(round_mesh(struts).signed_volume, rel=0.03)
