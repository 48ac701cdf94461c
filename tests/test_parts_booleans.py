"""Booleans of parts by OCCT hold what they must, and agree with manifold3d on the triangles."""

from __future__ import annotations

import build123d as bd
import pytest

from scaffold_cad.brep import tessellated
from scaffold_cad.intersections import self_intersections
from scaffold_cad.manifolds import to_manifold
from scaffold_cad.parts import ScaffoldSolid, SmoothScaffold
from tests.skeletons import NAMED

BOX = bd.Pos(3, 2, 1) * bd.Box(13, 11, 9)
"""Cuts every named skeleton somewhere."""


@pytest.mark.parametrize("part", [ScaffoldSolid, SmoothScaffold])
@pytest.mark.parametrize("name", ["tripod", "cross"])
def test_unions_cuts_and_intersections_add_up(name: str, part: type) -> None:
    solid = part(NAMED[name], collars=True)
    surface = tessellated(solid)
    assert len(self_intersections(surface)) == 0
    shared = (solid & BOX).volume
    reference = to_manifold(surface) ^ to_manifold(tessellated(BOX))
    assert shared == pytest.approx(reference.volume(), rel=0.01)
    assert (solid + BOX).volume == pytest.approx(solid.volume + BOX.volume - shared, rel=1e-4)
    assert (BOX - solid).volume == pytest.approx(BOX.volume - shared, rel=1e-4)
    assert (solid - BOX).volume == pytest.approx(solid.volume - shared, rel=1e-4)
