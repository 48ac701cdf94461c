"""Hollow curves that are crowded somewhere: both sides of their walls are fields there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
import trimesh

from scaffold_cad import Skeleton, round_struts
from scaffold_cad.base.arrays import Bools
from scaffold_cad.products import to_brep
from scaffold_cad.solid.clusters.hollow import tell_closed
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


@dataclass
class Made:
    """What of a surface tells which ends are closed."""

    nodes: Bools
    pieces: Bools


@pytest.mark.parametrize("in_field", [True, False])
def test_ends_that_bends_close_are_not_told_as_overlapping(
    in_field: bool, caplog: pytest.LogCaptureFixture
) -> None:
    angle = np.linspace(0.0, 3.0, 11)
    arc = 1.3 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    struts = round_struts(Skeleton(arc, polyline(11), 1.0), wall=WALL, ends="open")
    made = Made(np.ones(11, dtype=np.bool_), np.full(len(struts.curves.pieces), in_field))
    tell_closed(struts, made)  # type: ignore[arg-type]
    (text,) = [record.message for record in caplog.records]
    if in_field:
        near = f"[{arc[1, 0]:.6g}, {arc[1, 1]:.6g}, 0] mm, where the radius is 1 mm"
        assert text.startswith("2 open ends are closed, as the curve beside bends too tightly")
        assert f"node 0 at [1.3, 0, 0] mm first, near {near}" in text
    else:
        assert text.startswith("2 open ends overlap other struts")


def test_a_longer_straight_end_of_a_tight_bend_stays_open(caplog: pytest.LogCaptureFixture) -> None:
    angle = np.linspace(0.0, 3.0, 31)
    arc = 1.1 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    ends = [arc[0] - [0, 3, 0], arc[-1] + 3 * np.array([-np.sin(3), np.cos(3), 0])]
    skeleton = Skeleton(np.concatenate([ends[:1], arc, ends[1:]]), polyline(33), 1.0)
    struts = round_struts(skeleton, wall=WALL, ends="open")
    assert len(struts.overlapping) == 0
    mesh = round_mesh(struts, 16)
    assert trimesh.Trimesh(mesh.vertices, mesh.triangles).euler_number == 0
    assert not caplog.records
