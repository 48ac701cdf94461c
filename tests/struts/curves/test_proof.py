"""The proof of curves: it holds for wide bends, and never where the inside folds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.struts import round_struts
from scaffold_cad.struts.curves.proof import proved
from scaffold_cad.struts.meshes.surface import triangulated
from tests.struts.chains import circle


def thick(wire: float) -> np.ndarray:
    """Return what is proved of the pieces of a circle of radius 10 whose wire is made thicker."""
    curves = round_struts(circle(36)).curves
    return proved(replace(curves, radii=np.full_like(curves.radii, wire)))


@pytest.mark.parametrize("wire", [0.2, 1.0, 5.0, 8.0, 9.0])
def test_bends_wider_than_the_strut_are_proved(wire: float) -> None:
    assert thick(wire).all()


@pytest.mark.parametrize("wire", [10.0, 10.1, 15.0])
def test_bends_narrower_than_the_strut_are_not(wire: float) -> None:
    assert not thick(wire).any()


def test_a_circle_that_is_turned_over_is_not_proved() -> None:
    curves = round_struts(circle(36)).curves
    tangents = curves.tangents.copy()
    tangents[7] *= -1
    found = proved(replace(curves, tangents=tangents))
    assert not found[[6, 7]].any()
    assert np.delete(found, [6, 7]).all()


@pytest.mark.parametrize("seed", range(12))
def test_what_is_proved_does_not_cross_itself(seed: int) -> None:
    generator = np.random.default_rng(seed)
    chain = circle(30, wire=generator.uniform(1.0, 3.0))
    moved = chain.moved(chain.nodes + generator.normal(0, 0.25, chain.nodes.shape))
    struts = round_struts(moved, joints="curve")
    mesh = triangulated(struts, 12).mesh
    if len(struts.overlapping) == 0:
        assert len(self_intersections(mesh)) == 0
