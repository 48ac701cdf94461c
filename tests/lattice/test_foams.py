"""Random foams: Voronoi and Delaunay edges, their valencies, their walls, their seeds."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias, get_args

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import Voronoi, cKDTree

from scaffold_cad.base.regions import ImplicitRegion, Keep
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.filling import delaunay_foam, voronoi_foam
from scaffold_cad.lattice.foampoints import random_points
from scaffold_cad.lattice.powercells import cell_edges
from scaffold_cad.skeleton import Skeleton, check_skeleton

Foam: TypeAlias = Callable[..., Skeleton]

BOX = np.array([[0.0, 0.0, 0.0], [100.0, 80.0, 60.0]])


def on_walls(nodes: np.ndarray) -> np.ndarray:
    return (np.abs(nodes[:, None] - BOX) < 1e-6).any(axis=(1, 2))


@given(
    count=st.integers(30, 150),
    seed=st.integers(0, 2**32),
    regularity=st.floats(0, 0.7),
    keep=st.sampled_from(get_args(Keep)),
)
@settings(max_examples=40)
def test_any_foam_is_a_valid_skeleton_in_its_box(
    count: int, seed: int, regularity: float, keep: Keep
) -> None:
    foam = voronoi_foam(count, BOX, 0.5, seed, regularity=regularity, keep=keep)
    check_skeleton(foam)
    assert (foam.nodes >= BOX[0] - 1e-6).all()
    assert (foam.nodes <= BOX[1] + 1e-6).all()


def test_nodes_inside_have_valency_4_and_those_on_the_walls_1() -> None:
    foam = voronoi_foam(300, BOX, 0.5, seed=1, shortest=0.0)
    wall = on_walls(foam.nodes)
    assert set(foam.valency[wall].tolist()) == {1}
    assert set(foam.valency[~wall].tolist()) == {4}


def test_nodes_are_equally_far_from_their_four_nearest_points() -> None:
    foam = voronoi_foam(200, BOX, 0.5, seed=2, shortest=0.0)
    distance, _ = cKDTree(random_points(200, BOX, 2)).query(foam.nodes, 4)
    inside = ~on_walls(foam.nodes)
    spread = np.ptp(distance, axis=1)
    assert spread[inside].max() < 1e-6
    assert np.ptp(distance[~inside][:, :3], axis=1).max() < 1e-6  # on an edge of three cells
    assert np.median(spread[~inside]) > 1


def test_whole_struts_are_those_of_the_voronoi_diagram_inside_the_box() -> None:
    points = random_points(120, BOX, 3)
    diagram = Voronoi(points)
    pairs = set()
    for ridge in diagram.ridge_vertices:
        pairs |= {frozenset(p) for p in zip(ridge, ridge[1:] + ridge[:1], strict=True)}
    inside = ((diagram.vertices > BOX[0]) & (diagram.vertices < BOX[1])).all(axis=1)
    expected = [sorted(p) for p in pairs if -1 not in p and all(inside[k] for k in p)]
    foam = voronoi_foam(120, BOX, 0.5, 3, keep="whole", shortest=0.0)
    assert len(foam.edges) == len(expected)
    assert foam.lengths.sum() == pytest.approx(
        np.linalg.norm(np.diff(diagram.vertices[expected], axis=1), axis=2).sum()
    )


def test_a_clipped_foam_has_the_struts_of_the_whole_one_and_ends_at_the_walls() -> None:
    clipped = voronoi_foam(200, BOX, 0.5, 4, shortest=0.0)
    whole = voronoi_foam(200, BOX, 0.5, 4, keep="whole", shortest=0.0)
    at_wall = on_walls(clipped.nodes)[clipped.edges].any(axis=1)
    assert len(whole.edges) == (~at_wall).sum()
    assert whole.lengths.sum() == pytest.approx(clipped.lengths[~at_wall].sum())


def test_dangling_struts_go_if_asked() -> None:
    foam = voronoi_foam(200, BOX, 0.5, 4, dangling=False)
    assert len(foam.extremities) == 0
    assert not on_walls(foam.nodes).any()
    assert foam.loop_count == voronoi_foam(200, BOX, 0.5, 4).loop_count


def test_no_strut_is_shorter_than_asked() -> None:
    natural = voronoi_foam(200, BOX, 0.5, 5, shortest=0.0)
    foam = voronoi_foam(200, BOX, 0.5, 5, shortest=1.0)
    assert natural.lengths.min() < 0.5
    assert np.quantile(foam.lengths, 0.01) > 0.9  # nodes move by what is shrunk beside them
    check_skeleton(foam)
    assert on_walls(foam.nodes).sum() > 0.8 * on_walls(natural.nodes).sum()
    assert foam.loop_count <= natural.loop_count


@pytest.mark.parametrize("foam", [voronoi_foam, delaunay_foam])
def test_the_same_seed_gives_the_same_foam_and_another_one_does_not(foam: Foam) -> None:
    one, same, other = (foam(60, BOX, 0.5, seed) for seed in (7, 7, 8))
    assert np.array_equal(one.nodes, same.nodes)
    assert np.array_equal(one.edges, same.edges)
    assert not np.array_equal(one.nodes[0], other.nodes[0])


@given(count=st.integers(5, 300), seed=st.integers(0, 1000), regularity=st.floats(0, 0.7))
@settings(max_examples=25)
def test_regular_points_keep_their_distance(count: int, seed: int, regularity: float) -> None:
    points = random_points(count, BOX, seed, regularity)
    assert points.shape == (count, 3)
    nearest = cKDTree(points).query(points, 2)[0][:, 1]
    # Neighbors in a body-centered cubic lattice of edge a, with 2 points an a³.
    edge = np.cbrt(2 * np.prod(BOX[1]) / count)
    assert nearest.min() >= regularity * edge * np.sqrt(3) / 2 * (1 - 1e-12)


def test_a_radius_may_depend_on_the_place() -> None:
    for foam in (voronoi_foam, delaunay_foam):
        graded = foam(60, BOX, lambda points: 1 + points[:, 0] / 100)
        np.testing.assert_allclose(graded.radii, 1 + graded.nodes[:, 0] / 100)


@given(count=st.integers(10, 200), seed=st.integers(0, 2**32))
@settings(max_examples=20)
def test_any_truss_is_valid_and_each_strut_passes_no_nearer_point(count: int, seed: int) -> None:
    truss = delaunay_foam(count, BOX, 0.5, seed)
    check_skeleton(truss)
    points = random_points(count, BOX, seed)
    assert len(truss.nodes) <= count
    assert cKDTree(points).query(truss.nodes)[0].max() < 1e-2 * np.cbrt(np.prod(BOX[1]) / count)


def test_a_truss_has_the_nodes_that_a_foam_has_cells() -> None:
    # Each strut of the truss crosses a face between two cells of the foam.
    truss = delaunay_foam(500, BOX, 0.5, 9, shortest=0.0)
    points = random_points(500, BOX, 9)
    assert np.array_equal(truss.nodes, points[cKDTree(points).query(truss.nodes)[1]])
    ridges = {frozenset(pair) for pair in Voronoi(points).ridge_points.tolist()}
    nearest = cKDTree(points).query(truss.nodes)[1]
    assert {frozenset(pair) for pair in nearest[truss.edges].tolist()} <= ridges
    assert truss.valency.mean() == pytest.approx(14, rel=0.1)  # 15.5 without walls


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"count": 0}, "count is 0; need 1 or more"),
        ({"count": 10**20}, "count is 100000000000000000000; need at most 10000000"),
        ({"regularity": 0.8}, r"regularity is 0\.8; need 0 to 0\.7"),
        ({"regularity": -0.1}, r"regularity is -0\.1; need 0 to 0\.7"),
        ({"region": BOX[::-1]}, "need the first below the second"),
        ({"shortest": -1.0}, "shortest length is -1 mm; need >= 0"),
        ({"radius": 0.0}, "radius is 0 mm; need > 0"),
    ],
)
@pytest.mark.parametrize("foam", [voronoi_foam, delaunay_foam])
def test_arguments_out_of_range_are_refused(
    foam: Foam, arguments: dict[str, object], message: str
) -> None:
    with pytest.raises(OptionError, match=message):
        foam(**{"count": 50, "region": BOX, "radius": 0.5, **arguments})


def test_an_unknown_way_to_keep_struts_is_refused() -> None:
    with pytest.raises(OptionError, match="keep is 'cut'; need one of clip, whole"):
        voronoi_foam(50, BOX, 0.5, keep="cut")  # type: ignore[arg-type]


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("foam", [voronoi_foam, delaunay_foam])
def test_too_few_points_for_a_strut_are_refused(foam: Foam, count: int) -> None:
    with pytest.raises(SkeletonError, match=r"no strut in the box from \[0.0, .* more points"):
        foam(count, BOX, 0.5)


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("keep", get_args(Keep))
def test_foams_are_in_one_piece(seed: int, keep: Keep, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level("INFO"):
        foam = voronoi_foam(400, [[0, 0, 0], [30, 30, 30]], 0.3, seed, keep=keep)
    assert foam.component_count == 1
    if keep == "clip":  # corners of cells at the box are cut loose
        (line,) = [line for line in caplog.messages if "left out" in line]
        left_out, count = (int(word) for word in line.split() if word.isdigit())
        assert len(foam.edges) <= count - left_out
        assert 0 < left_out < 0.02 * count


@pytest.mark.parametrize("seed", range(5))
def test_trusses_are_in_one_piece(seed: int) -> None:
    assert delaunay_foam(60, BOX, 0.3, seed).component_count == 1


def test_a_periodic_foam_meets_itself_on_opposite_faces() -> None:
    foam = voronoi_foam(60, BOX, 0.5, seed=3, periodic=True, shortest=0.0)
    check_skeleton(foam)
    for axis in range(3):
        low, high = (
            np.delete(foam.nodes[np.abs(foam.nodes[:, axis] - side) < 1e-6], axis, axis=1)
            for side in BOX[:, axis]
        )
        assert len(low) == len(high) > 10
        assert cKDTree(low).query(high)[0].max() < 1e-6
    with pytest.raises(OptionError, match="a periodic foam in a region that is not a box"):
        voronoi_foam(60, ImplicitRegion(lambda p: p[:, 0] - 50, BOX), 0.5, periodic=True)


def test_equal_weights_give_voronoi_cells() -> None:
    points = random_points(200, BOX, 5)
    one = cell_edges(points, BOX)
    other = cell_edges(points, BOX, np.full(len(points), 7.0))
    # The four far points have no weight: cells at the border may differ.
    inside = ((one.middles > BOX[0]) & (one.middles < BOX[1])).all(axis=1)
    gaps = cKDTree(other.middles).query(one.middles[inside])[0]
    assert np.median(gaps) < 1e-6
    assert (gaps < 1e-6).mean() > 0.95


def test_the_corners_of_laguerre_cells_have_one_power_to_their_four_points() -> None:
    random = np.random.default_rng(1)
    points, weights = random_points(300, BOX, 6), random.uniform(0, 60, 300)
    struts = cell_edges(points, BOX, weights)
    nodes = struts.nodes[np.unique(struts.edges)]
    inside = nodes[((nodes > BOX[0] + 15) & (nodes < BOX[1] - 15)).all(axis=1)]
    assert len(inside) > 50
    powers = ((inside[:, None] - points) ** 2).sum(axis=2) - weights
    least = np.sort(powers, axis=1)
    assert (least[:, 3] - least[:, 0]).max() < 1e-6
    assert np.median(least[:, 4] - least[:, 0]) > 1


def test_cells_are_as_large_as_a_function_asks() -> None:
    foam = voronoi_foam(None, BOX, 0.2, size=lambda p: 6 + 10 * p[:, 0] / 100, regularity=0.5)
    check_skeleton(foam)
    middles = foam.nodes[foam.edges].mean(axis=1)[:, 0]
    small, large = foam.lengths[middles < 20], foam.lengths[middles > 80]
    assert large.mean() / small.mean() == pytest.approx(15 / 7, rel=0.2)


def test_a_size_gives_as_many_cells_as_fit() -> None:
    volume = float((BOX[1] - BOX[0]).prod())
    by_size = voronoi_foam(None, BOX, 0.5, seed=1, size=10.0)
    by_count = voronoi_foam(round(volume / 1000), BOX, 0.5, seed=1)
    np.testing.assert_array_equal(by_size.nodes, by_count.nodes)


def test_stretched_cells_are_longer_along_one_axis() -> None:
    foam = voronoi_foam(300, BOX, 0.3, seed=2, regularity=0.5, stretch=(1, 1, 3))
    spans = np.abs(np.diff(foam.nodes[foam.edges], axis=1)[:, 0]).mean(axis=0)
    assert spans[2] / spans[:2].mean() == pytest.approx(3, rel=0.3)


def test_points_of_ones_own_are_taken() -> None:
    points = random_points(80, BOX, 7)
    one, other = voronoi_foam(points, BOX, 0.5), voronoi_foam(80, BOX, 0.5, seed=7)
    np.testing.assert_array_equal(one.nodes, other.nodes)
    with pytest.raises(OptionError, match="points are given with a size"):
        voronoi_foam(points, BOX, 0.5, size=3.0)


@pytest.mark.parametrize("foam", [voronoi_foam, delaunay_foam])
def test_foams_stay_in_any_region_as_one_piece(foam: Foam) -> None:
    ring = ImplicitRegion(
        lambda p: np.hypot(np.hypot(p[:, 0] - 50, p[:, 1] - 40) - 25, p[:, 2] - 30) - 10, BOX
    )
    skeleton = foam(300, ring, 0.3, seed=1)
    check_skeleton(skeleton)
    assert ring.values(skeleton.nodes).max() < 1e-6
    ends = skeleton.nodes[skeleton.edges]
    along = np.linspace(0, 1, 9)[:, None, None]
    between = ends[:, 0] + along * (ends[:, 1] - ends[:, 0])
    assert (ring.values(between.reshape(-1, 3)) < 0.4).all()  # sampled: slivers may pass
    assert skeleton.component_count == 1
    assert skeleton.loop_count > 50


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"count": None}, "need either a count of cells or their size"),
        ({"size": 3.0}, "need either a count of cells or their size"),
        ({"count": None, "size": -1.0}, "size of a cell is -1 mm"),
        ({"count": None, "size": lambda p: -p[:, 0]}, "the cell size is -.* mm at"),
        ({"stretch": (1, 0, 1)}, "need three numbers > 0"),
        (
            {"region": ImplicitRegion(lambda p: p[:, 0] + 1, BOX)},
            "takes less than 1/20000 of its bounds",
        ),
    ],
)
def test_arguments_that_contradict_are_refused(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        voronoi_foam(**{"count": 50, "region": BOX, "radius": 0.5, **arguments})  # type: ignore[arg-type]
