"""Sharp edges of flat ends in fields, where struts overlap."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.base.vectors import any_perpendicular, length
from scaffold_cad.solid.field import FieldStruts, field_solid, field_struts
from tests.solid.field.judges import check_exact, distances

MIDDLES = np.array([[0.0, 0, 0], [1.1, 0.3, 0], [-0.4, 1.2, 0], [0.7, -1.0, 0]])
"""Of parallel struts of radius 1 mm that overlap."""

UP = np.array([0.0, 0, 5])


def bundle(turn: float, blend: float) -> FieldStruts:
    """Return struts that end in two planes, at an angle to the grid."""
    cosine, sine = np.cos(turn), np.sin(turn)
    turned = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
    ends = np.stack([MIDDLES, MIDDLES + UP], axis=1) @ turned + [0.03, 0.02, 0.01]
    return field_struts(ends, 1.0, flat=True, blend=blend)


def off_sharp_union(points: Points, struts: FieldStruts) -> Floats:
    """Return how far points are outside of all struts, at least, and > 0 just there, (k,), mm."""
    found = np.full(len(points), np.inf)
    for (start, end), radius in zip(struts.ends, struts.radii[:, 0], strict=True):
        axis = (end - start) / length(end - start)
        along = (points - start) @ axis
        away = length(points - start - along[:, None] * axis) - radius
        found = np.minimum(found, np.maximum(away, np.maximum(-along, along - length(end - start))))
    return found


def rims(struts: FieldStruts) -> Points:
    """Return points of the rims of all flat ends that are away from other struts."""
    angle = np.radians(np.arange(0, 360, 5))[:, None]
    points = []
    for number in range(len(struts.ends)):
        others = np.arange(len(struts.ends)) != number
        rest = FieldStruts(*(part[others] for part in vars(struts).values()))
        for place, tail in (struts.ends[number], struts.ends[number, ::-1]):
            outward = (place - tail) / length(place - tail)
            x = any_perpendicular(outward[None])[0]
            around = np.cos(angle) * x + np.sin(angle) * np.cross(outward, x)
            rim = place + struts.radii[number, 0] * around
            points.append(rim[off_sharp_union(rim, rest) > 1.5 * struts.blend.max()])
    return np.concatenate(points)


@pytest.mark.parametrize("turn", [0.0, 0.35])
@pytest.mark.parametrize("blend", [0.2, 0.5])
def test_ends_in_one_plane_have_sharp_rims_and_nothing_past_it(turn: float, blend: float) -> None:
    struts = bundle(turn, blend)
    mesh = field_solid(struts).mesh
    check_exact(mesh)
    read = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    off = distances(rims(struts), read)  # 0.04 where cells cut them off, 0.014 on average
    assert off.max() < 0.015
    assert off.mean() < 1e-4
    start, end = struts.ends[0]
    along = (mesh.vertices - start) @ (end - start) / length(end - start)
    assert along.min() > -0.003  # 0.09 where fillets went on past the plane
    assert along.max() < 5.003


def test_the_rim_of_an_end_that_a_strut_covers_in_part_is_sharp() -> None:
    ends = [[[0, 0, -8], [0, 0, 1.0]], [[-3, 0.6, 0.5], [3, 0.6, 0.5]]]
    struts = field_struts(ends, [1.0, 0.5], flat=True)
    mesh = field_solid(struts).mesh
    check_exact(mesh)
    read = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    assert distances(rims(struts), read).max() < 0.01


def test_struts_that_end_round_stay_as_they_were() -> None:
    struts = field_struts([[[0, 0, 0], [5, 0, 0]], [[2, 0, 0], [2, 5, 0]]], 1.0)
    mesh = field_solid(struts).mesh
    check_exact(mesh)
    assert mesh.vertices[:, 0].max() > 5.9
