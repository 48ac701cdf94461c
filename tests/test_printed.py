"""What objects print as: one short line with counts and sizes."""

from __future__ import annotations

from typing import Any

import pytest

from scaffold_cad import (
    BeamLattice,
    PeriodicLattice,
    PointField,
    build_scaffold,
    round_struts,
    slices,
)
from scaffold_cad.mechanics import hexahedra
from scaffold_cad.skeleton import Skeleton
from tests.skeletons import TRIPOD

UPRIGHT = round_struts(Skeleton([[0, 0, 0], [0, 0, 9]], [[0, 1]], 1.0))
NARROW = Skeleton([[0, 0, 0], [9, 0, 0], [9, 0.1, 0.2]], [[0, 1], [0, 2]], 1.0)


@pytest.mark.parametrize(
    ("thing", "begin"),
    [
        (slices(UPRIGHT, thickness=0.5), "Layers: 18, 0.5 mm thick, "),
        (slices(UPRIGHT, [3.0]), "Layers: 1, sections, "),
        (PointField([[0, 0, 0], [9, 0, 0]], [1.0, 3.0]), "PointField: 2 points, 9 x 0 x 0 mm, "),
        (
            PeriodicLattice("bcc", 8.0, 2, radius=0.5),
            "PeriodicLattice: 2 x 2 x 2 cells of bcc, each 8 x 8 x 8 mm, 64 struts",
        ),
        (BeamLattice(TRIPOD, balls=2.0), "BeamLattice: 3 beams, 4 balls, "),
        (build_scaffold(TRIPOD).embedding(), "Embedding: certified"),
        (build_scaffold(NARROW).embedding(), "Embedding: 2 of 2 struts and 0 nodes left out"),
        (hexahedra(build_scaffold(TRIPOD)), "Hexahedra: 12 with 39 points, "),
        (TRIPOD.cleaned(), f"{TRIPOD}; repaired: nothing"),
    ],
    ids=lambda value: type(value).__name__,
)
def test_things_print_as_one_short_line(thing: Any, begin: str) -> None:
    assert str(thing).startswith(begin)
    assert len(str(thing)) < 120
    assert "\n" not in str(thing)
