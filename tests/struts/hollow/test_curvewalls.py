"""Walls along curves that taper, or whose bends change: as thick as asked in bends, too."""

from __future__ import annotations

import logging

import numpy as np
import pytest
import trimesh

from scaffold_cad import Skeleton, round_struts
from scaffold_cad.struts.hollow.walls import walls
from scaffold_cad.struts.meshes.surface import triangulated
from scaffold_cad.struts.options import Ends
from tests.skeletons import polyline
from tests.walls import far_from, places_on


def bulb(size: float) -> Skeleton:
    """Return a bent chain whose radius grows and shrinks by so much."""
    share = np.linspace(0.0, 1.0, 17)
    angle, radii = 2.4 * share, 1.2 + size * np.sin(2 * np.pi * share)
    nodes = 4 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    return Skeleton(nodes, polyline(17), radii, np.stack([radii[:-1], radii[1:]], axis=1))


@pytest.mark.parametrize("wall", [0.08, 0.36])
def test_a_curve_that_tapers_keeps_its_wall_inside_the_bend(wall: float) -> None:
    struts = round_struts(bulb(0.8), wall=wall, ends="open")
    assert len(struts.overlapping) == 0
    assert 0.95 * wall < walls(struts).curves.min() <= 1.01 * wall


def test_a_curve_whose_bends_change_keeps_its_wall() -> None:
    wall, t = 0.3, np.linspace(0.0, 4.0, 40)
    nodes = 20 * np.stack([np.cos(t), np.sin(t), 0.3 * t], axis=1)
    nodes += 0.25 * np.random.default_rng(2).normal(size=nodes.shape)
    struts = round_struts(Skeleton(nodes, polyline(40), 1.0), wall=wall, ends="open")
    assert len(struts.overlapping) == 0
    assert 0.98 * wall < walls(struts).curves.min() <= 1.01 * wall


def test_rings_of_the_inside_stand_where_those_outside_do() -> None:
    wall, share = 0.2, np.linspace(0.0, 1.0, 9)
    radii = 1 + 2 * share
    nodes = 8 * np.stack([np.cos(np.pi * share), np.sin(np.pi * share), 0 * share], axis=1)
    horn = Skeleton(nodes, polyline(9), radii, np.stack([radii[:-1], radii[1:]], axis=1))
    struts = round_struts(horn, wall=wall)
    assert len(struts.overlapping) == 0
    mesh = triangulated(struts, 16).mesh
    outer, inner = trimesh.Trimesh(mesh.vertices, mesh.triangles).split()
    assert len(outer.vertices) == len(inner.vertices)
    places, _ = places_on(inner, wall, np.random.default_rng(1))
    assert far_from(places, outer, wall, np.random.default_rng(2)).min() > 0.95 * wall


@pytest.mark.parametrize(("ends", "links", "bend"), [("open", 30, 1.5), ("flat", 10, 1.7)])
def test_a_pipe_bent_as_tightly_as_it_is_wide_is_hollow_to_its_ends(
    ends: Ends, links: int, bend: float
) -> None:
    wall, angle = 0.3, np.linspace(0.0, 3.0, links + 1)
    nodes = bend * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    struts = round_struts(Skeleton(nodes, polyline(links + 1), 1.0), wall=wall, ends=ends)
    assert len(struts.overlapping) == 0
    assert walls(struts).curves.min() > 0.95 * wall
    inside = 3.0 * bend - (2.0 * wall if ends == "flat" else 0.0)
    volume = np.pi * (3.0 * bend - inside * (1.0 - wall) ** 2)
    assert triangulated(struts, 64).mesh.signed_volume == pytest.approx(volume, rel=2e-3)


def test_a_joint_without_a_wall_is_crowded_and_named(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING, "scaffold_cad"):
        struts = round_struts(bulb(1.0), wall=0.18, ends="flat")
    assert struts.inner is not None
    assert not struts.crowded.any()
    assert struts.inner.crowded[15]
    assert "no inside of node 15 leaves a wall of 0.18 mm" in caplog.text
    assert 0.95 * 0.18 < walls(struts).curves.min() <= 1.01 * 0.18
