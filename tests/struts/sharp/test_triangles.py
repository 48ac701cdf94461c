"""Triangles of sharp nodes: closed, without crossings, and of their volume."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import Skeleton, round_struts, slices, tile, to_brep, to_solid
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts.sharp.earcut import ears
from scaffold_cad.struts.sharp.surface import without_triangles
from tests.solids import check_solid_of
from tests.struts.sharp.nodes import BEND, NODES, random_node
from tests.struts.stars import random_stars


@pytest.mark.parametrize("name", NODES)
def test_meshes_have_the_volume_of_the_brep(name: str) -> None:
    struts = round_struts(NODES[name], nodes="sharp")
    solid = to_solid(struts)
    check_solid_of(NODES[name], solid)
    assert solid.volume() == pytest.approx(to_brep(struts).volume, rel=1e-3)
    assert solid.num_tri() < 1000  # no field


@pytest.mark.parametrize("kind", range(27))
def test_random_nodes_have_triangles_of_their_own(kind: int) -> None:
    skeleton = random_node(kind)
    struts = round_struts(skeleton, nodes="sharp")
    solid = to_solid(struts)
    check_solid_of(skeleton, solid)
    assert solid.volume() == pytest.approx(to_brep(struts).volume, rel=5e-3)
    assert solid.num_tri() < 1000


@pytest.mark.parametrize("valency", [2, 3, 4])
def test_edges_along_generators_and_beside_them_are_kept(valency: int) -> None:
    rng = np.random.default_rng(7)
    for star in random_stars(6, valency, 40, rng):
        nodes = np.vstack([np.zeros(3), 15 * star])
        edges = [[0, k + 1] for k in range(valency)]
        skeleton = Skeleton(nodes, edges, edge_radii=rng.uniform(0.6, 1.5, valency))
        struts = round_struts(skeleton, nodes="sharp")
        for sides in (16, 20, 48, 96):
            assert not without_triangles(struts, sides).any()


@pytest.mark.parametrize("sides", [8, 12, 32, 128, 256])
def test_sides_change_the_volume_little(sides: int) -> None:
    struts = round_struts(NODES["thin oblique tee"], nodes="sharp")
    assert to_solid(struts, sides=sides).volume() == pytest.approx(to_brep(struts).volume, rel=0.01)


def test_a_mitred_bend_has_its_volume_exactly() -> None:
    solid = to_solid(round_struts(BEND, nodes="sharp"))
    assert solid.volume() == pytest.approx(16 * np.pi, rel=1e-9)


def test_hollow_nodes_are_solids() -> None:
    struts = round_struts(NODES["thin tee"], nodes="sharp", wall=0.2, ends="open")
    solid = to_solid(struts)
    assert solid.volume() == pytest.approx(to_brep(struts).volume, rel=1e-3)
    assert solid.genus() == 2  # three open ends


def test_triangles_have_all_vertices() -> None:
    nodes, edges = [[-9, 0, 0], [0, 0, 0], [3, 8, 0]], [[0, 1], [1, 2]]
    necks = Skeleton(nodes, edges, [0.6, 2.5, 0.6], edge_radii=0.6)
    mesh = round_mesh(round_struts(necks, nodes="sharp"))
    assert len(np.unique(mesh.triangles)) == len(mesh.vertices)


def test_layers_have_the_volume() -> None:
    struts = round_struts(random_node(4), nodes="sharp")
    made = sum(layer.area for layer in slices(struts, thickness=0.05)) * 0.05
    assert made == pytest.approx(to_brep(struts).volume, rel=3e-3)


def test_crowded_nodes_are_fields_between_sharp_ones() -> None:
    skeleton = Skeleton(
        [[0, 0, 0], [8, 0, 0], [0, 8, 0], [20, 0, 0], [1.2, 1.2, 0], [9, 9, 4.0]],
        [[0, 1], [0, 2], [1, 3], [0, 4], [4, 5], [1, 5]],
        0.8,
    )
    struts = round_struts(skeleton, nodes="sharp")
    assert struts.crowded.any()
    check_solid_of(skeleton, to_solid(struts))


def test_a_lattice_is_a_solid() -> None:
    lattice = tile("octet", 10, (2, 2, 2), radius=0.5)
    struts = round_struts(lattice, nodes="sharp")
    assert len(struts.overlapping) == 0
    check_solid_of(lattice, to_solid(struts))


def test_ears_fill_polygons_that_are_not_convex() -> None:
    outline = np.array([[0, 0], [4, 0], [4, 3], [2, 1], [0, 3]], dtype=np.float64)
    cut = ears(outline)
    assert cut is not None
    a, b, c = (outline[[corner[k] for corner in cut]] for k in range(3))
    areas = np.linalg.det(np.stack([b - a, c - a], axis=1)) / 2
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(8.0)


def test_a_clockwise_polygon_has_no_ears() -> None:
    assert ears(np.array([[0, 0], [0, 1], [1, 1], [1, 0]], dtype=np.float64)) is None


def test_holes_that_are_bridged_are_left_free() -> None:
    square, hole = [[0, 0], [4, 0], [4, 4], [0, 4]], [[1, 1], [1, 2], [2, 2], [2, 1], [1, 1]]
    outline = np.array([*square, [0, 0], *hole], dtype=np.float64)
    cut = np.array(ears(outline))
    a, b, c = (outline[cut[:, k]] for k in range(3))
    areas = np.linalg.det(np.stack([b - a, c - a], axis=1)) / 2
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(15.0)
