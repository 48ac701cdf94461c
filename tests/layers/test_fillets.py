"""Sections at crowded nodes against those of the field solid that a mesh has there."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import trimesh
from manifold3d import CrossSection, FillRule

from scaffold_cad import Skeleton, round_struts, slices, tile
from scaffold_cad.base.arrays import Floats
from scaffold_cad.layers import fillets
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.clusters import whole_struts
from scaffold_cad.solid.field import field_solid
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts.sharp.surface import without_triangles

SIDES = 48
"""Of polygons that stand for circles."""


def star(directions: list[list[float]], radii: Any) -> Skeleton:
    """Return struts of 10 mm from a node, with a radius at the node and at each end."""
    ends = np.array(directions) / np.linalg.norm(directions, axis=1)[:, None]
    edges = [[0, k + 1] for k in range(len(ends))]
    return Skeleton(np.vstack([[0, 0, 0], 10 * ends]), edges, radii)


NARROW = [[1, 0, 0.1], [1, 0.12, 0.3], [1, -0.1, 0.2], [-1, 0.2, -0.2], [0, -1, 0.6]]
CROSS = Skeleton([[-9, 0, 0], [9, 0, 0], [0, -9, 1], [0, 9, 1]], [[0, 1], [2, 3]], 0.8)
TOUCHING = Skeleton([[0, 0, 0], [0, 0, 9], [2, 0, 0], [2, 0, 9]], [[0, 1], [2, 3]], 1.0)
SWALLOWED = star([[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, -1, -1]], [3, 1, 1, 1, 1])
CURVE = Skeleton(
    [[5 * np.cos(a), 5 * np.sin(a), 0.35 * a] for a in np.linspace(0, 8, 33)],
    [[k, k + 1] for k in range(32)],
    1.2,
)
CASES = [
    ("narrow", star(NARROW, 1.0), {"ends": "round"}, (-0.7, 0.8), 0.004),
    ("cones", star(NARROW, [1.2, 1, 0.8, 0.5, 0.6, 0.7]), {"ends": "round"}, (-0.7, 0.8), 0.002),
    ("level", star([[1, 0, 0], [1, 0.1, 0], [0, -1, 0]], 1.0), {"blend": 0.8}, (-0.6, 0.6), 0.003),
    ("crossing", CROSS, {"blend": 0.5}, (0.0, 0.5), 0.006),
    ("thick", tile("bcc", 4.0, (2, 1, 1), radius=1.1), {}, (0.3, 3.6), 0.02),
]


def area_at(mesh: TriangleMesh, height: float) -> float:
    """Return the area of a mesh's section, cut by trimesh."""
    made = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    path = made.section(plane_origin=[0, 0, height], plane_normal=[0, 0, 1])
    return CrossSection([loop[:-1, :2] for loop in path.discrete], FillRule.EvenOdd).area()


@pytest.mark.parametrize(
    ("skeleton", "options", "between", "share"),
    [case[1:] for case in CASES],
    ids=[case[0] for case in CASES],
)
def test_crowded_nodes_have_the_sections_of_the_field_solid(
    skeleton: Skeleton,
    options: dict[str, Any],
    between: tuple[float, float],
    share: float,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    struts = round_struts(skeleton, **options)
    assert struts.crowded.any() or struts.crowded_runs.any()
    field = field_solid(whole_struts(struts), cell=0.125 * float(skeleton.radii.min())).mesh
    heights = np.linspace(*between, 3)
    wanted = np.array([area_at(field, height) for height in heights.tolist()])
    layers = slices(struts, heights, sides=SIDES)
    box, found = layers.box, np.zeros(0)
    for layer in layers:
        found = np.append(found, layer.area)
        assert (layer.bounds[0] >= box[0]).all()
        assert (layer.bounds[1] <= box[1]).all()
    assert np.abs(found / wanted - 1).max() < 0.003

    def nothing(self: Any, heights: Floats) -> list[Any]:
        return []

    monkeypatch.setattr(fillets.FilletSections, "loops", nothing)
    without = np.array([layer.area for layer in slices(struts, heights, sides=SIDES)])
    assert (1 - without / wanted).max() > share


@pytest.mark.parametrize(
    ("skeleton", "options"),
    [
        (TOUCHING, {}),
        (SWALLOWED, {}),
        (SWALLOWED, {"nodes": "ball"}),
        (CURVE, {"joints": "curve"}),
        (star(NARROW, 1.0), {"nodes": "sharp"}),
    ],
    ids=["touching", "swallowed", "ball", "curve", "sharp"],
)
def test_layers_are_the_sections_of_meshes(skeleton: Skeleton, options: dict[str, Any]) -> None:
    struts = round_struts(skeleton, **options)
    mesh = round_mesh(struts, 64)
    low, high = mesh.vertices[:, 2].min(), mesh.vertices[:, 2].max()
    heights = low + (high - low) * np.array([0.31, 0.44, 0.72])
    found = [layer.area for layer in slices(struts, heights, sides=64)]
    wanted = [area_at(mesh, height) for height in heights.tolist()]
    np.testing.assert_allclose(found, wanted, rtol=0.005)


def test_webs_between_hollow_struts_are_a_little_thicker_than_in_meshes() -> None:
    struts = round_struts(TOUCHING, wall=0.3, ends="open")
    (layer,) = slices(struts, [4.5], sides=16)
    assert 0.99 < layer.area / area_at(round_mesh(struts, 16), 4.5) < 1.07


def test_fillets_of_thin_struts_beside_thick_ones_are_found_on_a_few_squares() -> None:
    spike = Skeleton([[0, 0, 0], [30, 5, 0], [60, 0, 5]], [[0, 1], [1, 2]], [5.0, 0.005, 4.0])
    struts = round_struts(spike)
    heights = np.array([-2.0, 0.0, 3.0])
    found = [layer.area for layer in slices(struts, heights, sides=SIDES)]
    mesh = round_mesh(struts, SIDES)
    wanted = [area_at(mesh, height) for height in heights.tolist()]
    np.testing.assert_allclose(found, wanted, rtol=0.005)


def test_the_wall_of_hollow_struts_is_as_thick_at_crowded_nodes() -> None:
    skeleton = star(NARROW, 1.0)
    solid, hollow = (round_struts(skeleton, ends="round", wall=wall) for wall in (None, 0.2))
    assert hollow.inner is not None
    assert hollow.inner.crowded.any()
    for outside, walls in zip(
        slices(solid, [0.0, 0.5], sides=SIDES), slices(hollow, [0.0, 0.5], sides=SIDES), strict=True
    ):
        around = sum(
            np.linalg.norm(loop - np.roll(loop, 1, axis=0), axis=1).sum() for loop in walls.loops
        )
        # Across a plane that cuts struts along, walls are wider than they are thick.
        assert 0.2 * around / 2 < walls.area < outside.area


def test_fillets_between_flat_ends_are_in_the_box() -> None:
    struts = round_struts(star([[1, 0.1, 0], [1, -0.1, 0]], 1.0), blend=0.8)
    layers = slices(struts, [0.0, 0.4])
    for layer in layers:
        assert (layer.bounds[0] >= layers.box[0]).all()
        assert (layer.bounds[1] <= layers.box[1]).all()


def test_sharp_nodes_without_triangles_are_in_layers() -> None:
    tips = np.array([[1.4, 10, 1.2], [-8.4, 7.1, -5.3], [4.6, 13, 8.2], [5.2, -15.7, -0.6]])
    radii = np.array([[1.2, 1.3], [0.8, 0.8], [0.6, 0.5], [1.2, 1.3]])
    nodes, edges = np.vstack([np.zeros(3), tips]), [[0, k + 1] for k in range(4)]
    struts = round_struts(Skeleton(nodes, edges, edge_radii=radii), nodes="sharp")
    assert without_triangles(struts, 40).any()
    (layer,) = slices(struts, [-0.4], sides=40)
    step = 0.02
    x, y = np.meshgrid(np.arange(-10, 8, step), np.arange(-18, 12, step))
    places = np.stack([x, y, np.full_like(x, -0.4)], axis=-1).reshape(-1, 3)
    inside = (places**2).sum(axis=1) < radii[:, 0].max() ** 2  # the ball behind the struts
    for tip, (near, far) in zip(tips, radii, strict=True):
        share = places @ tip / (tip @ tip)
        away = np.linalg.norm(places - share[:, None] * tip, axis=1)
        inside |= (share > 0) & (share < 1) & (away < near + share * (far - near))
    assert layer.area == pytest.approx(inside.sum() * step**2, rel=1e-3)
