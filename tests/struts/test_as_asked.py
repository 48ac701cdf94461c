"""What comes out is what was asked for, as others read it: radii, axes and volumes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from build123d import import_step

from scaffold_cad import Skeleton, round_struts, tile, to_solid, write
from scaffold_cad.base.arrays import UnitVectors
from tests.struts.stars import random_stars
from tests.validation.reread import axes_outside
from tests.validation.struts import cylinder_errors, union_volume


def star(directions: UnitVectors, length: float) -> Skeleton:
    """Return struts of radius 1 from the origin."""
    count = len(directions)
    nodes = np.concatenate([np.zeros((1, 3)), length * directions])
    return Skeleton(nodes, [[0, tip] for tip in range(1, count + 1)], 1.0)


@pytest.mark.parametrize("length", [4.0, 8.0, 20.0])
def test_cylinders_of_random_nodes_are_on_their_axes(length: float, tmp_path: Path) -> None:
    for directions in random_stars(5, 4, 50.0, np.random.default_rng(int(length))):
        struts = round_struts(star(directions, length))
        assert struts.exact.all()
        write(struts, tmp_path / "node.step")
        errors = cylinder_errors(import_step(tmp_path / "node.step"), struts)
        assert len(errors) == 4
        assert errors.max() < 1e-6


@pytest.mark.parametrize("count", [3, 4, 5])
def test_struts_that_fan_to_one_side_stay_in_their_node(count: int, tmp_path: Path) -> None:
    turns = np.radians(np.linspace(-30, 30, count))
    fan = star(np.stack([np.cos(turns), np.sin(turns), 0 * turns], axis=1), 20.0)
    write(round_struts(fan), tmp_path / "fan.step", overlaps="unite")
    shape = import_step(tmp_path / "fan.step")
    assert shape.is_valid
    assert axes_outside(shape, fan) == 0
    volume, error = union_volume(fan, np.random.default_rng(count))
    assert shape.volume == pytest.approx(volume, rel=0.01, abs=3 * error)


@pytest.mark.parametrize(("cell", "radius"), [("bcc", 0.7), ("octet", 0.4)])
def test_eight_sides_are_as_heavy_as_the_cylinders(cell: str, radius: float) -> None:
    lattice = tile(cell, 10.0, 2, radius=radius)
    volume, error = union_volume(lattice, np.random.default_rng(1))
    solid = to_solid(round_struts(lattice), sides=8)
    assert solid.volume() == pytest.approx(volume, rel=0.01, abs=3 * error)


def test_each_member_has_its_own_radius_in_stl(tmp_path: Path) -> None:
    frame = star(np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [-0.6, -0.6, -0.529]]), 30.0)
    frame = frame.with_edge_radii([1.0, 2.0, 3.0, 0.5])
    write(round_struts(frame), tmp_path / "frame.stl", sides=32)
    read = trimesh.load(tmp_path / "frame.stl")
    assert read.is_watertight
    volume, error = union_volume(frame, np.random.default_rng(2))
    assert read.volume == pytest.approx(volume, rel=0.01, abs=3 * error)
    for edge, radius in enumerate([1.0, 2.0, 3.0]):
        section = read.section(plane_origin=20 * np.eye(3)[edge], plane_normal=np.eye(3)[edge])
        rim = np.delete(section.vertices, edge, axis=1)
        np.testing.assert_allclose(np.linalg.norm(rim, axis=1), radius, rtol=0.01)
