"""Cells on maps: counts, closed seams, stretch, folds, graded sizes, every cell on every map."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scaffold_cad import build_scaffold
from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.base.vectors import length
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.lattice import (
    BoxMap,
    CellMap,
    CylinderMap,
    FunctionMap,
    QuadMap,
    SphereMap,
    cells,
    lattice_on,
    tile,
)
from scaffold_cad.lattice.maps.quads import vertex_normals
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.skeleton import check_skeleton

PLATE = QuadMesh(
    [[x, y, 0.1 * x * y] for x in (0, 9, 18) for y in (0, 9)], [[0, 2, 3, 1], [2, 4, 5, 3]]
)
"""Two quads side by side, bent."""

MAPS: dict[str, tuple[CellMap, tuple[int, int, int]]] = {
    "box": (BoxMap([20, 10, 30], [1, 2, 3]), (2, 1, 3)),
    "turned box": (BoxMap([9, 9, 9], axes=[[1, 1, 0], [-1, 1, 0], [0, 0, 1]]), (2, 2, 2)),
    "pipe": (CylinderMap(10, 20, 4), (9, 3, 1)),
    "half pipe": (CylinderMap(10, 20, 4, angle=np.pi), (5, 3, 1)),
    "ball": (SphereMap(20, 4), (3, 3, 1)),
    "band": (SphereMap(20, 4, latitudes=[-0.5, 1.0]), (12, 4, 1)),
    "plate": (QuadMap(PLATE, 3.0), (2, 2, 1)),
    "ring": (FunctionMap(lambda p: np.c_[5 * np.cos(p[:, :1]), 5 * np.sin(p[:, :1]), p[:, 1:2]]
                         * (1 + p[:, 2:]), (2 * np.pi, 8, 0.4), (True, False, False)), (8, 3, 1)),
}  # fmt: skip
"""A map of each kind and counts of cells on it."""

NOT_SQUARE = ("gyroid", "hexagonal_prism", "pyrochlore", "reentrant_honeycomb")
"""Cells whose four sides are not the same when mirrored and turned: not for a cube's sides."""


@pytest.mark.parametrize("kind", MAPS)
@pytest.mark.parametrize("name", cells())
def test_every_cell_on_every_map_is_certified_or_named(name: str, kind: str) -> None:
    mapping, counts = MAPS[kind]
    if kind == "ball" and name in NOT_SQUARE:
        with pytest.raises(SkeletonError, match=r"do not meet at \[.*\] mm, where the side"):
            lattice_on(mapping, name, radius=0.1, counts=counts)
        return
    if mapping.patches > 1 and cells()[name].is_net:
        with pytest.raises((OptionError, SkeletonError), match=r"patches|do not meet"):
            lattice_on(mapping, name, radius=0.1, counts=counts)
        return
    lattice = lattice_on(mapping, name, radius=0.1, counts=counts)
    check_skeleton(lattice.skeleton)
    assert lattice.counts == counts
    assert 0.3 < lattice.least_stretch <= lattice.largest_stretch < 2.0
    whole = tile(name, 1.0, (*counts[:2], counts[2]), radius=0.1)
    assert lattice.skeleton.component_count <= whole.component_count


@pytest.mark.parametrize("name", ["bcc", "octet", "kelvin", "sc"])
@pytest.mark.parametrize("kind", ["pipe", "ball", "plate"])
def test_scaffolds_of_mapped_lattices_are_certified(name: str, kind: str) -> None:
    mapping, counts = MAPS[kind]
    skeleton = lattice_on(mapping, name, radius=0.05, counts=counts).skeleton
    assert build_scaffold(skeleton, collars=True).embedding().certified


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=20)
def test_a_box_map_is_a_tiled_box_moved(seed: int) -> None:
    random = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    size, origin = random.uniform(3, 30, 3), random.uniform(-9, 9, 3)
    x, y, z = random.integers(1, 4, 3).tolist()
    counts = (x, y, z)
    name = random.choice(sorted(name for name, cell in cells().items() if not cell.is_net))
    mapped = lattice_on(BoxMap(size, origin, turn), name, radius=0.2, counts=counts)
    tiled = tile(name, size / counts, counts, radius=0.2)
    np.testing.assert_array_equal(mapped.skeleton.edges, tiled.edges)
    np.testing.assert_allclose(mapped.skeleton.nodes, origin + tiled.nodes @ turn, atol=1e-9)
    np.testing.assert_allclose(mapped.stretch, 1.0)


def test_cells_around_a_pipe_close_without_a_seam() -> None:
    n, height = 12, 3
    pipe = lattice_on(CylinderMap(10, 9, 3), "bcc", radius=0.3, counts=(n, height, 1)).skeleton
    assert len(pipe.edges) == 8 * n * height
    assert len(pipe.nodes) == n * (height + 1) * 2 + n * height
    away = np.hypot(*pipe.nodes[:, :2].T)
    np.testing.assert_allclose(np.unique(away.round(9)), [10, 11.5, 13])
    # A turn by one cell brings the lattice onto itself.
    turn = 2 * np.pi / n
    matrix = [[np.cos(turn), np.sin(turn), 0], [-np.sin(turn), np.cos(turn), 0], [0, 0, 1]]
    turned = pipe.nodes @ np.array(matrix)
    assert {tuple(row) for row in (turned + 0.0).round(6)} == {
        tuple(row) for row in (pipe.nodes + 0.0).round(6)
    }


def test_nets_close_around_a_pipe_and_end_at_its_ends() -> None:
    foam = lattice_on(CylinderMap(20, 20, 4), "weaire_phelan", radius=0.1, counts=(8, 2, 1))
    valency = np.bincount(foam.skeleton.valency)
    away = np.hypot(*foam.skeleton.nodes[:, :2].T)
    inside = (away > 20.01) & (away < 23.99)
    inside &= (foam.skeleton.nodes[:, 2] > 0.01) & (foam.skeleton.nodes[:, 2] < 19.99)
    assert set(foam.skeleton.valency[inside].tolist()) == {4}
    assert valency[1] > 0  # cut at the walls
    assert foam.skeleton.component_count == 1


def test_a_ball_of_cells_has_no_border() -> None:
    # Euler's formula on each of the two spheres of nodes: V - E + F = 2, quads only.
    ball = lattice_on(SphereMap(10, 2), "sc", radius=0.2, counts=(4, 4, 1)).skeleton
    per_sphere = 6 * 4 * 4 + 2
    assert len(ball.nodes) == 2 * per_sphere
    assert len(ball.edges) == 2 * (2 * 6 * 4 * 4) + per_sphere
    np.testing.assert_allclose(np.unique(np.linalg.norm(ball.nodes, axis=1).round(9)), [10.0, 12.0])


def test_the_number_of_cells_fits_the_size_asked_for() -> None:
    lattice = lattice_on(CylinderMap(10, 20, 4), "bcc", radius=0.3, size=4.0)
    assert lattice.counts == (19, 5, 1)  # 2 pi 12 / 4 = 18.8
    three = lattice_on(BoxMap([20, 20, 20]), "sc", radius=0.3, size=[5, 10, 20])
    assert three.counts == (4, 2, 1)
    tall = lattice_on(BoxMap([8, 8 * np.sqrt(3), 8]), "hexagonal_prism", radius=0.3, size=4.0)
    assert tall.counts == (2, 2, 2)


def test_counts_that_differ_do_not_meet_on_a_sphere() -> None:
    with pytest.raises(SkeletonError, match=r"3 cells along u and 4 along v do not meet at \[.*mm"):
        lattice_on(SphereMap(20, 4), "bcc", radius=0.1, counts=(3, 4, 1))


def test_a_pipe_stretches_struts_by_the_ratio_of_its_radii() -> None:
    lattice = lattice_on(CylinderMap(9, 30, 6), "sc", radius=0.3, counts=(90, 9, 1))
    assert lattice.largest_stretch == pytest.approx(15 / 12, rel=1e-3)
    assert lattice.least_stretch == pytest.approx(9 / 12, rel=1e-3)


def test_cells_are_as_large_as_a_function_of_position_asks() -> None:
    def wanted(points: Points) -> Floats:
        sizes: Floats = 2.0 + points[:, 2] / 10.0
        return sizes

    lattice = lattice_on(BoxMap([20, 20, 60]), "sc", radius=0.2, size=wanted).skeleton
    z = np.unique(lattice.nodes[:, 2].round(9))
    middles = (z[1:] + z[:-1]) / 2
    ratio = np.diff(z) / (2.0 + middles / 10.0)
    assert ratio.min() > 0.9 * ratio.mean()
    assert ratio.max() < 1.1 * ratio.mean()
    assert z[-1] == pytest.approx(60)


def test_graded_cells_still_close_around_a_pipe() -> None:
    pipe = lattice_on(
        CylinderMap(20, 40, 4), "kelvin", radius=0.2, size=lambda p: 4 + (p[:, 0] + 20) / 10
    ).skeleton
    check_skeleton(pipe)
    assert pipe.component_count == 1
    inner = pipe.nodes[np.hypot(*pipe.nodes[:, :2].T) < 20.001]
    gaps = np.diff(np.sort(np.arctan2(inner[:, 1], inner[:, 0])))
    assert gaps.max() < 0.4  # nowhere open


@pytest.mark.parametrize("mapping", [SphereMap(20, 5), QuadMap(PLATE, 3.0)], ids=["6", "18"])
def test_graded_cells_meet_between_patches_as_even_ones_do(mapping: CellMap) -> None:
    start = mapping.positions(np.zeros((1, 3)), np.zeros(1, dtype=np.intp))[0]

    def wanted(points: Points) -> Floats:
        sizes: Floats = 0.4 + length(points - start) / 8.0
        return sizes

    graded = lattice_on(mapping, "bcc", radius=0.05, size=wanted)
    even = lattice_on(mapping, "bcc", radius=0.05, counts=graded.counts)
    check_skeleton(graded.skeleton)
    assert len(graded.skeleton.nodes) == len(even.skeleton.nodes)
    assert len(graded.skeleton.edges) == len(even.skeleton.edges)
    assert graded.skeleton.component_count == 1
    ratio = graded.skeleton.lengths / even.skeleton.lengths
    assert ratio.min() < 0.95
    assert ratio.max() > 1.05


def test_struts_between_quads_are_shared_once() -> None:
    lattice = lattice_on(QuadMap(PLATE, 3.0), "sc", radius=0.2, counts=(3, 3, 2)).skeleton
    n, m, layers = 6, 3, 2
    layer = n * (m + 1) + m * (n + 1)
    assert len(lattice.edges) == (layers + 1) * layer + layers * (n + 1) * (m + 1)


def test_a_thickness_may_be_a_height_field() -> None:
    hill = lattice_on(
        QuadMap(PLATE, lambda p: 2 + 0.1 * p[:, 0], 1.0), "sc", radius=0.2, counts=1
    ).skeleton
    ends = hill.nodes[hill.edges]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    for expected in (2.0, 2.9, 3.8):  # at x = 0, 9 and 18
        assert (np.abs(lengths - expected) < 1e-9).sum() == 2


def test_a_layer_thicker_than_the_surface_is_curved_is_refused_with_the_place() -> None:
    inward = FunctionMap(
        lambda p: np.c_[(5 - p[:, 2]) * np.cos(p[:, 0]), (5 - p[:, 2]) * np.sin(p[:, 0]), p[:, 1]],
        (2.0, 8.0, 8.0),
    )
    with pytest.raises(SkeletonError, match=r"the map folds cell \[\d+, \d+, \d+\] at \[.*\] mm"):
        lattice_on(inward, "bcc", radius=0.2, counts=(4, 2, 2))


def test_tile_takes_a_map() -> None:
    mapping = CylinderMap(10, 20, 4)
    one, other = (
        tile("bcc", 4.0, radius=0.3, on=mapping),
        lattice_on(mapping, "bcc", radius=0.3, size=4.0),
    )
    np.testing.assert_array_equal(one.nodes, other.skeleton.nodes)
    np.testing.assert_array_equal(one.edges, other.skeleton.edges)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: tile("bcc", 4.0, radius=0.3), "counts are None; need three whole numbers"),
        (
            lambda: tile("bcc", counts=2, radius=0.3),
            "cell size in mm is None; need one number or three",
        ),
        (lambda: lattice_on(BoxMap([1, 1, 1]), "bcc", radius=0.1), "either the size of a cell or"),
        (
            lambda: lattice_on(CylinderMap(5, 5, 1), "bcc", radius=0.1, counts=2),
            "2 cells along u, where the map closes; need 3 or more",
        ),
        (
            lambda: lattice_on(BoxMap([9, 9, 9]), "bcc", radius=0.1, size=lambda p: p[:, 0] - 1),
            r"the cell size is -1 mm at \[0, 0, 0\] mm; need > 0",
        ),
        (lambda: BoxMap([1, 0, 1]), "size of the box in mm"),
        (lambda: BoxMap([1, 1, 1], axes=[[1, 0, 0], [2, 0, 0], [0, 0, 1]]), "lie in a plane"),
        (lambda: CylinderMap(5, 5, 1, angle=7.0), "angle is 7 rad; need at most 2 pi"),
        (lambda: CylinderMap(5, 5, 1, axis=[0, 0, 0]), "need a direction"),
        (lambda: SphereMap(5, 1, latitudes=[0, 2]), "need two, ascending"),
        (lambda: SphereMap(5, 1, angle=1.0), "without latitudes"),
        (lambda: FunctionMap(3), "need a function"),  # type: ignore[arg-type]
        (
            lambda: lattice_on(FunctionMap(lambda p: p[:, :2]), "sc", radius=0.1, counts=1),
            "the map returned shape",
        ),
        (
            lambda: lattice_on(FunctionMap(lambda p: p / 0.0), "sc", radius=0.1, counts=1),
            "the map returned .*; need finite numbers",
        ),
        (lambda: QuadMap(PLATE, 0.0), "thickness is 0 mm"),
        (lambda: lattice_on("box", "sc", radius=0.1, counts=1), "need a CellMap"),  # type: ignore[arg-type]
    ],
)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_what_cannot_be_is_refused_by_name(make: object, message: str) -> None:
    with pytest.raises((OptionError, SkeletonError), match=message):
        make()  # type: ignore[operator]


def test_normals_at_edges_of_the_shape_are_seen_by_all_quads() -> None:
    # One wide quad, three narrow ones at right angles to it and to each other's plane.
    vertices = [[0, 0, 0], [9, 0, 0], [9, 9, 0], [0, 9, 0], [9, 0, -1], [0, 0, -1], [0, 9, -1]]
    mesh = QuadMesh(vertices, [[0, 1, 2, 3], [1, 0, 5, 4], [0, 3, 6, 5]])
    np.testing.assert_allclose(vertex_normals(mesh)[0], np.array([-1, -1, 1]) / 3**0.5, atol=0.05)
