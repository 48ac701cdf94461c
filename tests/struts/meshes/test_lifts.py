"""Meshes have the volume of their B-rep: blends, their insides, bends, balls, curves and tori."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from scaffold_cad import Skeleton, round_struts, tile, to_brep
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts.meshes.lifts import MOST
from scaffold_cad.struts.meshes.surface import triangulated
from tests.crossings import check_as_written
from tests.skeletons import ELBOW, JACK, TRIPOD
from tests.struts.chains import HOOK, TAPERED, helix


def kink(angle: float, radius: float) -> Skeleton:
    """Two struts of 10 mm at an angle, degrees: at 20°, nearly all of them is blend."""
    tips = [[10 * np.cos(at), 10 * np.sin(at), 0] for at in (0.0, np.radians(angle))]
    return Skeleton([[0, 0, 0], *tips], [[0, 1], [0, 2]], radius)


BALL = Skeleton(JACK.nodes, JACK.edges, [2.5, *[1.0] * 6], edge_radii=np.ones((6, 2)))
BODIES: dict[str, tuple[Skeleton, dict[str, Any]]] = {
    "bend of 20 degrees": (kink(20, 0.8), {}),
    "thick bend of 20 degrees": (kink(20, 1.6), {}),
    "bend": (ELBOW, {}),
    "hollow bend": (ELBOW, {"wall": 0.3}),
    "torus": (ELBOW, {"bend": "torus"}),
    "tripod": (TRIPOD, {}),
    "jack": (JACK, {}),
    "open jack": (JACK, {"wall": 0.25, "ends": "open"}),
    "jack with round ends": (JACK, {"ends": "round"}),
    "jack with a ball": (BALL, {}),
    "cell": (tile("bcc", 10.0, (1, 1, 1), radius=1.0), {}),
    "helix": (helix(60), {}),
    "hollow helix": (helix(60), {"wall": 0.3}),
    "tapered curve": (TAPERED, {}),
    "hook": (HOOK, {}),
}


@pytest.mark.parametrize(("sides", "error"), [(8, 4e-3), (16, 1e-3), (32, 5e-4)])
@pytest.mark.parametrize("name", BODIES)
def test_meshes_have_the_volume_of_their_brep(name: str, sides: int, error: float) -> None:
    skeleton, options = BODIES[name]
    struts = round_struts(skeleton, **options)
    assert len(struts.overlapping) == 0
    mesh = triangulated(struts, sides).mesh
    # OCCT integrates splines to some parts in ten thousand.
    assert mesh.signed_volume == pytest.approx(to_brep(struts).volume, rel=error)


@pytest.mark.parametrize("sides", [8, 16, 32])
@pytest.mark.parametrize("name", BODIES)
def test_meshes_do_not_cross_themselves_as_they_are_written(name: str, sides: int) -> None:
    skeleton, options = BODIES[name]
    mesh = round_mesh(round_struts(skeleton, **options), sides)
    check_as_written(mesh)
    assert len(self_intersections(mesh)) == 0


def test_samples_move_as_far_as_polygons_reach_but_for_tips_of_squares() -> None:
    assert (triangulated(round_struts(JACK), 16).swell == 0).all()
    tip = round_struts(kink(20, 0.8))
    assert (triangulated(tip, 16).swell == 0).all()
    swell = triangulated(tip, 4).swell
    assert 0.1 < swell[0] < MOST * 4.0
    assert (swell[1:] == 0).all()
