"""Hollow struts: their volume, their shells, and walls that cannot be."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import Skeleton, round_struts, to_brep
from scaffold_cad.errors import OptionError
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.struts.options import Ends
from scaffold_cad.struts.surface import triangulated
from scaffold_cad.struts.walls import least_wall

TUBE = Skeleton([[0, 0, 0], [0, 0, 20]], [[0, 1]], 5.0)
ELBOWS = Skeleton([[0, 0, 0], [40, 0, 0], [0, 40, 0], [0, 0, 40]], [[0, 1], [0, 2], [0, 3]], 6.0)
HOLLOW = {
    "open": np.pi * (25 - 16) * 20,
    "flat": np.pi * (25 * 20 - 16 * 18),
    "round": np.pi * (25 - 16) * 20 + 4 / 3 * np.pi * (125 - 64),
}


@pytest.mark.parametrize("ends", ["open", "flat", "round"])
def test_a_hollow_tube_has_the_volume_of_its_wall(ends: Ends) -> None:
    struts = round_struts(TUBE, ends=ends, wall=1.0)
    body = to_brep(struts)
    assert body.is_valid
    assert body.volume == pytest.approx(HOLLOW[ends], rel=1e-9)
    mesh: TriangleMesh = triangulated(struts, 64).mesh
    mesh.check_closed()
    assert mesh.signed_volume == pytest.approx(HOLLOW[ends], rel=2e-3)
    assert least_wall(struts) == 1.0


@pytest.mark.parametrize(("ends", "shells"), [("open", 1), ("flat", 2), ("round", 2)])
def test_a_hollow_node_is_one_valid_solid(ends: Ends, shells: int) -> None:
    struts = round_struts(ELBOWS, ends=ends, wall=1.5)
    body = to_brep(struts)
    assert body.is_valid
    assert len(body.solids()) == 1
    assert len(body.shells()) == shells
    assert body.volume < to_brep(round_struts(ELBOWS, ends="round")).volume
    assert least_wall(struts) > 1.2
    triangulated(struts, 16).mesh.check_closed()


def test_a_wall_as_thick_as_a_strut_is_refused() -> None:
    with pytest.raises(OptionError, match="wall is 5 mm, and edge 0 has radius 5 mm; need a wall"):
        round_struts(TUBE, wall=5.0)


def test_closed_ends_need_room() -> None:
    short = Skeleton([[0, 0, 0], [0, 0, 3]], [[0, 1]], 5.0)
    with pytest.raises(OptionError, match="edge 0 is 3 mm long; need more than its closed ends"):
        round_struts(short, wall=2.0)


def test_open_ends_need_a_wall() -> None:
    with pytest.raises(OptionError, match="ends is 'open' without a wall; need wall="):
        round_struts(TUBE, ends="open")


def test_solid_struts_have_no_wall_to_measure() -> None:
    with pytest.raises(OptionError, match="the struts are solid; need wall="):
        least_wall(round_struts(TUBE))
