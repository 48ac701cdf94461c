"""The rims of flat ends in fields, measured on sections that trimesh cuts."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from scaffold_cad.base.arrays import Floats
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.clusters.ends import with_flat_ends
from scaffold_cad.solid.field import FieldStruts, field_solid, field_struts
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts import round_struts
from tests.crossings import check_as_written
from tests.solid.field.judges import check_exact
from tests.solid.field.test_solid import random_struts

SLANTED = np.array([[0.1, 0.2, 0.3], [6.1, 8.2, 10.3]])
"""A strut at no angle to the grid, mm."""

SIDES = 16

CORNER = np.sqrt(2 * np.pi / SIDES / np.sin(2 * np.pi / SIDES))
"""Corners of a polygon with the area of its circle, in radii; its sides are nearer."""

SIDE = CORNER * np.cos(np.pi / SIDES)


def radii_below(mesh: TriangleMesh, tip: Floats, outward: Floats, depth: float) -> Floats:
    """Return how far the outline of a section below an end is from the axis, mm."""
    read = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    lines = trimesh.intersections.mesh_plane(read, outward, tip - depth * outward)  # (l, 2, 3)
    places = np.concatenate([lines[:, 0], lines.mean(axis=1)]) - tip
    across = places - (places @ outward)[:, None] * outward
    return np.linalg.norm(across, axis=1)


def made(struts: FieldStruts) -> TriangleMesh:
    return with_flat_ends(field_solid(struts).mesh, struts, SIDES)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1.37, 3.0, 1e5])
@pytest.mark.parametrize("shift", [0.0, 300.0])
@pytest.mark.parametrize("radii", [[1.0, 1.0], [1.0, 4.0]])
def test_the_rim_of_a_flat_end_is_a_circle(size: float, shift: float, radii: list[float]) -> None:
    ends = (SLANTED + shift) * size
    mesh = made(field_struts([ends], [np.array(radii) * size], flat=True))
    axis = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    for end, outward, radius in zip(ends, (-axis, axis), radii, strict=True):
        found = radii_below(mesh, end, outward, 1e-4 * size) / (radius * size)
        assert found.min() > SIDE - 1e-3
        assert found.max() < CORNER + 1e-3
        assert ((mesh.vertices - end) @ outward).max() < 1e-4 * size
    check_exact(mesh)


def test_ends_in_a_crowd_have_rims_and_those_that_struts_cover_have_none() -> None:
    across = [[[-3.0, 0.6, 1.2], [3.0, 0.6, 1.2]], [[-3, 0, -5], [3, 0, -5]]]
    struts = field_struts([[[0, 0, -8], [0, 0, 1]], *across], [1.0, 0.5, 0.7], flat=True)
    mesh = made(struts)
    check_exact(mesh)
    out = np.array([0.0, 0.0, 1.0])
    lowest = radii_below(mesh, np.array([0, 0, -8.0]), -out, 1e-3)
    assert lowest.min() > SIDE - 1e-3
    assert lowest.max() < CORNER + 1e-3
    assert mesh.vertices[:, 2].max() > 1.65  # the strut across the other end is whole


@pytest.mark.parametrize("seed", range(20, 26))
def test_ends_of_random_struts_are_closed_and_free_of_crossings(seed: int) -> None:
    ends, radii, _ = random_struts(seed, spread=(1.5, 3.0, 10.0)[seed % 3])
    struts = field_struts(ends, radii, flat=True, blend=0.1 * (seed % 2))
    field = field_solid(struts).mesh
    mesh = with_flat_ends(field, struts, (8, 16, 64)[seed % 3])
    check_exact(mesh)
    assert mesh.signed_volume == pytest.approx(field.signed_volume, rel=0.02)


@pytest.mark.parametrize("factor", [1.0, 1 / 25.4])
def test_ends_of_struts_that_mostly_overlap_have_the_polygons_of_others(factor: float) -> None:
    angles = np.radians([0, 14, 28, 42, 180])
    tips = 17.0 * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    star = Skeleton([[0, 0, 0], *tips], [[0, i] for i in range(1, 6)], 1.5)
    struts = round_struts(star)
    assert struts.crowded.any()
    mesh = round_mesh(struts, SIDES, factor)
    check_as_written(TriangleMesh(mesh.vertices * factor, mesh.triangles))
    for tip in tips:
        found = radii_below(mesh, tip, tip / 17, 1e-3) / 1.5
        assert found.min() > SIDE - 1e-3
        assert found.max() < CORNER + 1e-3
