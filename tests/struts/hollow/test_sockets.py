"""Sockets: bores of the radius asked for, down to a flat shoulder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from build123d import GeomType, import_step

from scaffold_cad.errors import OptionError
from scaffold_cad.io.write import write
from scaffold_cad.products import to_brep
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts import round_struts
from scaffold_cad.struts.hollow.walls import walls
from tests.solids import check_watertight

TUBE = Skeleton([[0, 0, 0], [0, 0, 20]], [[0, 1]], 5.0)
ELBOWS = Skeleton([[0, 0, 0], [40, 0, 0], [0, 40, 0], [0, 0, 40]], [[0, 1], [0, 2], [0, 3]], 6.0)
BORES = [{1: (4.5, 6.0)}, {1: (3.0, 6.0)}, {0: (4.5, 6.0), 1: (3.0, 5.0)}]


@pytest.mark.parametrize("sockets", BORES)
def test_sockets_have_their_radius_and_depth(sockets: dict[int, tuple[float, float]]) -> None:
    struts = round_struts(TUBE, wall=1.0, ends="open", sockets=sockets)
    deep = sum(depth for _, depth in sockets.values())
    hollow = 16 * (20 - deep) + sum(radius**2 * depth for radius, depth in sockets.values())
    volume = np.pi * (25 * 20 - hollow)
    body = to_brep(struts)
    assert body.is_valid
    assert body.volume == pytest.approx(volume, rel=1e-9)
    radii = sorted(f.radius for f in body.faces() if f.geom_type == GeomType.CYLINDER)
    assert radii == pytest.approx(sorted([5.0, 4.0, *(radius for radius, _ in sockets.values())]))
    mesh = round_mesh(struts, 16)
    check_watertight(mesh)
    assert mesh.signed_volume == pytest.approx(volume, rel=1e-9)
    assert walls(struts).least == pytest.approx(min(1.0, *(5 - r for r, _ in sockets.values())))


def test_sockets_are_deeper_than_the_links_of_a_straight_strut() -> None:
    sockets = {0: (3.0, 9.0), 1: (4.5, 8.0)}
    whole, split = (
        round_struts(tube, wall=1.0, ends="open", sockets=sockets)
        for tube in (TUBE, TUBE.subdivided(4))
    )
    assert to_brep(split).volume == pytest.approx(to_brep(whole).volume, rel=1e-9)


def test_sockets_that_meet_are_refused() -> None:
    with pytest.raises(OptionError, match=r"node 0 at .* 11 mm deep; need > 0 and less than the 9"):
        round_struts(TUBE, wall=1.0, ends="open", sockets={0: (4.5, 11.0), 1: (4.5, 11.0)})


def test_nodes_keep_their_wall_beside_sockets(tmp_path: Path) -> None:
    struts = round_struts(ELBOWS, wall=1.5, ends="open", sockets={1: (5.0, 12.0), 3: (4.8, 8.0)})
    write(struts, tmp_path / "lug.step")
    body = import_step(tmp_path / "lug.step")
    assert body.is_valid
    assert len(body.shells()) == 1
    radii = {round(f.radius, 9) for f in body.faces() if f.geom_type == GeomType.CYLINDER}
    assert radii == {6.0, 4.5, 5.0, 4.8}
    plain = to_brep(round_struts(ELBOWS, wall=1.5, ends="open")).volume
    bored = np.pi * ((25 - 4.5**2) * 12 + (4.8**2 - 4.5**2) * 8)
    assert body.volume == pytest.approx(plain - bored, rel=1e-4)
    check_watertight(round_mesh(struts, 16))


LUG = Skeleton(
    [[0, 0, 0], [-17.5, 0, 57.4], [29.2, 0, -95.6], [107.1, 0, -73.6], [90, 0, 6]],
    [[0, 1], [0, 2], [0, 3], [0, 4]],
    edge_radii=[19.2, 19.2, 17.4, 15.7],
)
"""Tubes of a bicycle's frame, 38° apart: their fillets need most of them."""


def test_nodes_leave_room_for_sockets() -> None:
    sockets = {3: (15.975, 25.0), 4: (13.875, 22.0)}
    struts = round_struts(LUG, blend=4.0, wall=2.6, ends="open", sockets=sockets)
    assert len(struts.overlapping) == 0
    assert struts.fillet[0] == 4.0
    assert walls(struts).nodes[0] >= 0.95 * 2.6
    assert to_brep(struts).is_valid


def test_sockets_that_nodes_cannot_leave_room_for_are_told(
    caplog: pytest.LogCaptureFixture,
) -> None:
    struts = round_struts(LUG, wall=2.6, ends="open", sockets={4: (13.875, 70.0)})
    assert "need longer struts, shallower sockets, thicker struts" in caplog.text
    assert "0 crowded nodes and 2 crowded inside," in str(struts)


def test_sockets_follow_moved_nodes() -> None:
    first = round_struts(ELBOWS, wall=1.5, ends="open", sockets={1: (5.0, 12.0)})
    nodes = ELBOWS.nodes + np.array([[0, 0, 0], [3, 2, 0], [0, 1, 1], [0, 0, 0]])
    moved = ELBOWS.moved(nodes)
    second = round_struts(moved, wall=1.5, ends="open", sockets={1: (5.0, 12.0)}, like=first)
    mesh = round_mesh(second, 12)
    check_watertight(mesh)
    assert np.array_equal(mesh.triangles, round_mesh(first, 12).triangles)
    with pytest.raises(OptionError, match=r"like has sockets at nodes \[1\], not \[\]; need"):
        round_struts(moved, wall=1.5, ends="open", like=first)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"sockets": {1: (4.5, 6)}}, "sockets with ends='flat'; need ends='open', and a wall"),
        (
            {"sockets": {0: (4.5, 6)}},
            "sockets has node 0, which is not an end of a strut; need one",
        ),
        ({"sockets": {1: (6.5, 6)}}, "radius 6.5 mm; need > 0 and less than the 6 mm of its strut"),
        ({"sockets": {1: (5.5, 50)}}, "is 50 mm deep; need > 0 and less than the 40 mm"),
        ({"sockets": {1: (4.5, 5)}}, "has the 4.5 mm of the strut's inside, and so no shoulder"),
    ],
)
def test_sockets_that_cannot_be_are_refused(options: dict[str, Any], message: str) -> None:
    if "flat" not in message:
        options = {**options, "wall": 1.5, "ends": "open"}
    with pytest.raises(OptionError, match=message):
        round_struts(ELBOWS, **options)


@pytest.mark.parametrize(
    ("sockets", "message"),
    [
        (3, r"sockets is 3; need a radius and a depth, mm, by the node"),
        ({1: 4.5}, r"the socket at node 1 is 4.5; need a radius and a depth"),
        ({"a": (4.5, 6.0)}, r"sockets has 'a' for a node; need"),
        ({1: ("wide", 6.0)}, r"the radius of the socket at node 1 is 'wide'; need a number"),
    ],
)
def test_what_is_no_socket_is_refused(sockets: Any, message: str) -> None:
    with pytest.raises(OptionError, match=message):
        round_struts(TUBE, wall=1.0, ends="open", sockets=sockets)
