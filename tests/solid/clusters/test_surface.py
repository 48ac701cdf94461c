"""Clusters: fields where struts are crowded, struts of their own elsewhere, one closed surface."""

from __future__ import annotations

import re

import numpy as np
import pytest

from scaffold_cad.base.positions import in_single_precision
from scaffold_cad.errors import MeshError
from scaffold_cad.lattice import tile
from scaffold_cad.mesh.pieces import without_voids
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.clusters import hollow, unseen, whole_struts
from scaffold_cad.solid.clusters.fineness import Fineness
from scaffold_cad.solid.clusters.surface import field_of
from scaffold_cad.solid.field import field_solid
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts import RoundStruts, round_struts
from scaffold_cad.struts.meshes.surface import triangulated
from tests.crossings import check_as_written
from tests.skeletons import TRIPOD
from tests.solid.field.judges import thicknesses
from tests.solids import contains, distance_to_axes

TIPS = [[20, 0, 0], [19, 3.4, 0], [-15, 8, 0], [-9, -10, 17]]
NARROW = Skeleton([[0, 0, 0], *TIPS], [[0, i] for i in range(1, 5)], 1.0)
"""Four struts, two of them 10° apart: their node is crowded."""

CROSSING = Skeleton([[0, 0, 0], [40, 0, 0], [20, -16, 0.5], [20, 16, 0.5]], [[0, 1], [2, 3]], 1.0)
"""Two struts that cross in their middles."""

TAPERS = Skeleton(
    [[0, 0, 0], [20, 0, 0], [20, 2, 0], *TIPS[2:]], NARROW.edges, [1.2, 0.5, 0.6, 1.8, 0.9]
)


@pytest.mark.parametrize("skeleton", [NARROW, TAPERS])
def test_the_nodes_of_these_tests_are_crowded(skeleton: Skeleton) -> None:
    assert round_struts(skeleton).crowded.any()


def field_triangles(struts: RoundStruts) -> int:
    return len(without_voids(field_of(whole_struts(struts), 8, Fineness(8)))[0].triangles)


@pytest.mark.parametrize("skeleton", [NARROW, CROSSING, TAPERS], ids=["narrow", "cross", "tapers"])
@pytest.mark.parametrize("sides", [8, 16])
def test_a_cluster_is_joined_to_its_struts_as_written(skeleton: Skeleton, sides: int) -> None:
    struts = round_struts(skeleton)
    mesh = round_mesh(struts, sides)
    check_as_written(mesh)
    whole = field_solid(whole_struts(struts)).mesh
    assert len(mesh.triangles) < 0.7 * len(whole.triangles)
    assert mesh.signed_volume == pytest.approx(whole.signed_volume, rel=0.01)


@pytest.mark.parametrize("sides", [16, 32, 64])
def test_clusters_are_as_round_as_polygons_of_as_many_sides(sides: int) -> None:
    mesh = round_mesh(round_struts(CROSSING), sides)
    # Middles of edges on the first strut, beside the crossing and before the cut: in its field.
    ends = mesh.vertices[mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)]
    along = np.abs(ends[..., 0] - 20)
    ends = ends[((along > 1.6) & (along < 2.1)).all(axis=1)]
    radius = distance_to_axes(CROSSING, ends.mean(axis=1), 4000)
    assert len(radius) > 3 * sides
    assert 1 - radius.min() < 1.3 * (1 - np.cos(np.pi / sides))


def test_there_is_no_step_where_a_field_is_cut_off() -> None:
    mesh = round_mesh(round_struts(CROSSING), 16)
    along = np.abs(mesh.vertices[:, 0] - 20)
    on_first = (along > 2.7) & (along < 19.9)  # past the crossing: cuts and rings
    radius = distance_to_axes(CROSSING, mesh.vertices[on_first], 4000)
    assert on_first.sum() > 16
    assert radius == pytest.approx(np.ones(on_first.sum()), abs=0.02)


@pytest.mark.parametrize("place", [1e3, 1e4])
def test_clusters_far_from_the_origin_are_whole_as_written(place: float) -> None:
    check_as_written(round_mesh(round_struts(NARROW.moved(NARROW.nodes + place)), 16))


def test_nodes_beside_a_cluster_stay_as_they_are() -> None:
    lattice = tile("bcc", 10.0, 2, radius=0.4)
    middle = int(np.argmin(np.linalg.norm(lattice.nodes - lattice.nodes.mean(axis=0), axis=1)))
    more = Skeleton(
        np.vstack([lattice.nodes, lattice.nodes[middle] + [2.2, 2.2, 3.0]]),
        np.vstack([lattice.edges, [middle, len(lattice.nodes)]]),
        0.4,
    )
    struts = round_struts(more)
    assert np.flatnonzero(struts.crowded).tolist() == [middle, len(lattice.nodes)]
    mesh, plain = round_mesh(struts, 8), round_mesh(round_struts(lattice), 8)
    check_as_written(mesh)
    own = set(map(tuple, mesh.vertices.tolist()))
    same = sum(vertex in own for vertex in map(tuple, plain.vertices.tolist()))
    assert same > 0.8 * len(plain.vertices)
    assert len(mesh.triangles) < 0.5 * field_triangles(struts)


def test_what_mostly_overlaps_is_one_field() -> None:
    struts = round_struts(tile("bcc", 2.0, 2, radius=0.6))
    assert len(round_mesh(struts, 8).triangles) == field_triangles(struts)


@pytest.mark.parametrize(("ends", "wall"), [("flat", 0.4), ("open", 0.4), ("round", 0.1)])
def test_hollow_struts_stay_hollow_in_clusters(ends: str, wall: float) -> None:
    struts = round_struts(NARROW, wall=wall, ends=ends)  # type: ignore[arg-type]
    mesh = round_mesh(struts, 16)
    check_as_written(mesh)
    length = NARROW.lengths.sum()
    tube = np.pi * (1 - (1 - wall) ** 2) * length
    assert 0.9 * tube < mesh.signed_volume < 1.05 * tube


def test_open_ends_that_overlap_other_struts_are_closed(caplog: pytest.LogCaptureFixture) -> None:
    skeleton = Skeleton([[0, 0, 0], [20, 0, 0], [20, 0.3, 0], [20, 20, 0]], [[0, 1], [2, 3]], 1.0)
    mesh = round_mesh(round_struts(skeleton, wall=0.3, ends="open"), 16)
    assert re.search(
        r"\d open ends? overlaps? other struts, or nearly so, and closed: node", caplog.text
    )
    check_as_written(mesh)


@pytest.mark.parametrize("seed", range(6))
def test_random_frames_with_crowded_nodes_are_whole_as_written(seed: int) -> None:
    rng = np.random.default_rng(seed)
    count = 12
    nodes = rng.uniform(0, 22, (count, 3))
    edges = [[i, int(rng.integers(max(0, i - 3), i))] for i in range(1, count)]
    radii = rng.uniform(0.3, 1.0, count) if seed % 2 else 0.6
    check_as_written(round_mesh(round_struts(Skeleton(nodes, edges, radii)), 8))


def test_curves_beside_struts_that_are_fields_are_whole_as_written() -> None:
    angle = np.linspace(0, 4 * np.pi, 40)
    helix = np.stack([8 * np.cos(angle), 8 * np.sin(angle), 0.8 * angle], axis=1)
    rods = [[20, 0, 0], [23, 0, 0], [21.5, -1.5, 0.2], [21.5, 1.5, 0.2], [21, -1, -0.2],
            [22, 1.5, -0.2]]  # fmt: skip
    chain = 6 + np.column_stack([np.arange(39), np.arange(1, 40)])
    edges = np.concatenate([[[0, 1], [2, 3], [4, 5]], chain])
    struts = round_struts(Skeleton(np.concatenate([rods, helix]), edges, 0.8))
    assert struts.overlapping.tolist() == [0, 1, 2]
    assert struts.curves.curved.sum() == 37
    check_as_written(round_mesh(struts, 8))


UNEVEN = {
    "one thick": ([[-14.6, -1.7, -6.3], [-5.8, 13.3, 6.9], [2.4, 6.3, -14.5], [-1.7, -6.2, -14.6]],
                  [0.49, 2.2, 1.57, 0.82]),
    "one thin": ([[4.5, 7.3, -13.5], [7.2, -7.6, 12.1], [-10.1, 4.3, -11.6], [14.4, 6.9, 1.0]],
                 [0.4, 1.16, 1.54, 2.08]),
}  # fmt: skip
"""Struts with radii of their own: in cells of the usual size a wall of 0.1 crosses itself."""


@pytest.mark.parametrize(("sides", "least"), [(8, 0.5), (32, 0.8)])
@pytest.mark.parametrize("name", UNEVEN)
def test_walls_between_uneven_struts_are_whole_and_thick_as_written(
    name: str, sides: int, least: float
) -> None:
    tips, radii = UNEVEN[name]
    star = Skeleton([[0, 0, 0], *tips], [[0, i] for i in range(1, 5)], 1.0).with_edge_radii(radii)
    mesh = round_mesh(round_struts(star, wall=0.1), sides)
    check_as_written(mesh)
    walls = thicknesses(mesh) / 0.1
    assert walls.min() > least  # the wall is 0.05 r, the sides of polygons of 8 are 0.03 r inside
    assert np.quantile(walls, 0.05) > least + 0.1 * (1 - least)
    assert np.median(walls) == pytest.approx(1.0, rel=0.15)


@pytest.mark.parametrize(
    ("skeleton", "wall"), [(NARROW, 0.07), (CROSSING, 0.07), (NARROW, 0.15), (TAPERS, 0.15)]
)
def test_walls_of_clusters_are_as_thick_as_asked(skeleton: Skeleton, wall: float) -> None:
    mesh = round_mesh(round_struts(skeleton, wall=wall), 16)
    check_as_written(mesh)
    walls = thicknesses(mesh) / wall
    assert walls.min() > (0.8 if skeleton is TAPERS else 0.9)
    assert np.quantile(walls, 0.001) > 0.9
    assert np.median(walls) < 1.04
    assert np.quantile(walls, 0.9) < 1.12
    assert np.median(walls) == pytest.approx(1.0, rel=0.05)


def test_walls_of_sharp_bends_are_as_thick_as_asked_between_triangles() -> None:
    nodes = [[10.0 * k, 40.0 * (k % 2), 0] for k in range(5)]
    zigzag = Skeleton(nodes, [[k, k + 1] for k in range(4)], 1.0)
    struts = round_struts(zigzag, wall=0.2)
    assert not struts.crowded.any()
    mesh = round_mesh(struts, 16)
    check_as_written(mesh)
    assert thicknesses(mesh).min() > 0.9 * 0.2


def test_walls_of_lattices_are_as_thick_as_asked_between_triangles() -> None:
    struts = round_struts(tile("bcc", 8.0, (2, 2, 1), radius=1.0), wall=0.3)
    assert not struts.crowded.any()
    mesh = round_mesh(struts, 8)
    check_as_written(mesh)
    least = [thicknesses(some).min() / 0.3 for some in (mesh, triangulated(struts, 8).mesh)]
    assert least[0] > 0.88  # between polygons of 8 sides it is 0.97
    assert least[1] < 0.8


def test_walls_that_cross_after_all_are_refused_with_a_place(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(hollow, "FINER", 1)
    tips, radii = UNEVEN["one thick"]
    star = Skeleton([[0, 0, 0], *tips], [[0, i] for i in range(1, 5)], 1.0).with_edge_radii(radii)
    with pytest.raises(MeshError, match=r"the wall of 0.01 mm crosses itself .* near \[.*\] mm"):
        round_mesh(round_struts(star, wall=0.01), 8)


@pytest.mark.parametrize("unit", [25.4, 1000.0])
@pytest.mark.parametrize("wall", [None, 0.3])
def test_clusters_are_whole_in_the_numbers_of_another_unit(unit: float, wall: float | None) -> None:
    struts = round_struts(NARROW, wall=wall)
    mesh = round_mesh(struts, 8, 1 / unit)
    written = mesh.vertices / unit
    check_as_written(TriangleMesh(written, mesh.triangles))
    exact = (
        np.abs(in_single_precision(written) - written).max(axis=1) < 1e-12 * np.abs(written).max()
    )
    assert exact.mean() > 0.5  # those of fields, which are 32-bit numbers of that unit
    usual = round_mesh(struts, 8)
    assert mesh.signed_volume == pytest.approx(usual.signed_volume, rel=0.01)


def test_a_node_is_seen_in_the_numbers_of_a_file() -> None:
    struts = round_struts(TRIPOD)
    made = triangulated(struts, 8)
    assert not unseen(struts, made).any()
    assert unseen(struts, made, 1e-60).any()  # all numbers become 0


def test_an_open_end_far_from_a_large_cluster_stays_open(caplog: pytest.LogCaptureFixture) -> None:
    fan = [[20 * np.cos(a), 20 * np.sin(a), 0] for a in np.radians([-12, -6, 0, 6, 12])]
    nodes, edges = [[0, 0, 0], [-12, 0, 0], *fan], [[0, k] for k in range(1, 7)]
    struts = round_struts(Skeleton(nodes, edges, 1.6), wall=0.5, ends="open")
    mesh = round_mesh(struts, 16)
    check_as_written(mesh)
    assert not contains(mesh, np.array([[-11.9, 0, 0.1], [-9, 0, 0.1]])).any()
    assert "node 1 " not in caplog.text
