"""Curves that are crowded somewhere: the rest of them stays an exact surface."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.solid.clusters.core import unproved
from scaffold_cad.solid.clusters.growth import bodies_of, clusters_of
from scaffold_cad.solid.clusters.spans import CUT, no_spans
from scaffold_cad.solid.clusters.stumps import wanted_fillets
from scaffold_cad.solid.clusters.zones import MARGIN, core_of, zones_of
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts import RoundStruts, round_struts
from scaffold_cad.struts.apart import EXACT
from tests.crossings import check_as_written
from tests.skeletons import TREFOIL
from tests.struts.chains import COIL, CROSSED_COIL, crossed

PLACE = {"helix": 30, "trefoil": 3, "its first": 0}
BODIES = {
    "helix": CROSSED_COIL,
    "trefoil": crossed(TREFOIL, 3),
    "its first": crossed(TREFOIL, 0),
}


def far_from(struts: RoundStruts, place: int, count: int) -> np.ndarray:
    """Return the joints that are 6 places along the chain or more from one of `count` nodes."""
    joints = np.flatnonzero(struts.at_curves)
    away = np.abs(joints - place)
    return joints[np.minimum(away, count - away) >= 6]


@pytest.mark.parametrize("sides", [8, 16])
@pytest.mark.parametrize("name", BODIES)
def test_a_crossing_leaves_most_of_a_curve_as_it_is(name: str, sides: int) -> None:
    skeleton = BODIES[name]
    struts = round_struts(skeleton)
    assert 0 < len(struts.overlapping) < 8
    mesh = round_mesh(struts, sides)
    check_as_written(mesh)
    place = PLACE[name]
    curves, count = struts.curves, len(skeleton.nodes) - 2
    joints = far_from(struts, place, count)
    assert len(joints) > 0.6 * count
    circle = np.array([np.flatnonzero(curves.nodes == joint)[0] for joint in joints])
    # Rings of the exact surface stand in the planes of the joints' circles.
    for row in circle:
        way = mesh.vertices - curves.centers[row]
        ring = np.abs(way @ curves.tangents[row]) < 1e-6
        ring &= np.linalg.norm(way, axis=1) < 1.2 * curves.radii[row]
        assert ring.sum() == sides
        size = np.linalg.norm(way[ring], axis=1) / curves.radii[row]
        assert size.min() > 1.0
        assert size.max() < 1.15


def test_the_volume_of_a_crossed_curve_is_that_of_its_parts() -> None:
    alone = round_mesh(round_struts(COIL)).signed_volume
    found = round_mesh(round_struts(BODIES["helix"])).signed_volume
    strut = np.pi * 0.5**2 * 8
    # They overlap in the middle, and have fillets.
    assert alone + 0.6 * strut < found < alone + strut


def test_zones_reach_as_far_as_cuts_take() -> None:
    curves = round_struts(COIL).curves
    nodes = np.zeros(60, dtype=np.bool_)
    nodes[30] = True
    core = core_of(curves, nodes)
    assert core.sum() == 2
    zones = zones_of(curves, core, 60, np.zeros_like(core))
    assert zones.nodes[30]
    (inside,) = np.nonzero(zones.pieces)
    assert (np.diff(inside) == 1).all()
    assert len(inside) > 2
    first, last = curves.pieces[inside[0]], curves.pieces[inside[-1]] + 1
    for end in (first, last):
        way = np.linalg.norm(curves.centers[end] - curves.centers[curves.nodes == 30][0])
        assert way > MARGIN * curves.radii[end]
    assert MARGIN > CUT


def test_what_is_left_is_cut_at_two_joints() -> None:
    struts = round_struts(BODIES["helix"])
    core = unproved(struts)
    assert not core.nodes.any()
    assert not core.pieces.any()
    bodies = bodies_of(struts)
    found = clusters_of(struts, lambda: bodies, wanted_fillets(struts), EXACT, core, no_spans())
    assert found is not None
    cut = found.rest.cut_curves
    assert len(cut.nodes) == 2
    assert (cut.nodes < 30).tolist() != (cut.nodes > 30).tolist()
    rest = found.rest.struts
    # Short straight struts stand on the circles, of their radius.
    short = rest.runs.edges[-2:]
    np.testing.assert_array_equal(short[:, 0], cut.nodes)
    assert (rest.runs.lengths[-2:] < 0.2 * cut.radii).all()
