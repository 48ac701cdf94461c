from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from random import Random
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from manifold3d import Manifold, OpType
from numpy.typing import ArrayLike

from scaffold_cad.base.arrays import Points
from scaffold_cad.base.vectors import normalize
from scaffold_cad.errors import MeshError, OptionError
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from tests.crossings import INSTALLED, faults_by_cgal

# ---------------------------------------------------------------------------------------------
# The oracle: every corner of an intersection is a corner of a triangle, or lies where an edge
# crosses an edge or a plane. List them all in fractions and look for one that is not shared.
# ---------------------------------------------------------------------------------------------

Vector = tuple[Fraction, Fraction, Fraction]


def minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def scalar(a: Vector, b: Vector) -> Fraction:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def vector(a: Vector, b: Vector) -> Vector:
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def between(a: Vector, b: Vector, t: Fraction) -> Vector:
    d = minus(b, a)
    return a[0] + t * d[0], a[1] + t * d[1], a[2] + t * d[2]


def is_on_segment(p: Vector, a: Vector, b: Vector) -> bool:
    return not any(vector(minus(p, a), minus(b, a))) and scalar(minus(p, a), minus(p, b)) <= 0


def is_in_hull(p: Vector, corners: list[Vector]) -> bool:
    if len(corners) == 3:
        a, b, c = corners
        normal = vector(minus(b, a), minus(c, a))
        if any(normal):
            sides = ((a, b), (b, c), (c, a))
            return scalar(normal, minus(p, a)) == 0 and all(
                scalar(normal, vector(minus(t, s), minus(p, s))) >= 0 for s, t in sides
            )
    return any(is_on_segment(p, a, b) for a in corners for b in corners)


def edge_crossings(a: Vector, b: Vector, corners: list[Vector]) -> list[Vector]:
    found = []
    along = minus(b, a)
    p, q, r = corners
    normal = vector(minus(q, p), minus(r, p))
    steepness = scalar(normal, along)
    if steepness:
        found.append(between(a, b, scalar(normal, minus(p, a)) / steepness))
    for c, d in ((p, q), (q, r), (r, p)):
        across = vector(along, minus(d, c))
        if any(across):
            t = scalar(vector(minus(c, a), minus(d, c)), across) / scalar(across, across)
            found.append(between(a, b, t))
    return found


def meet_outside(first: list[Vector], second: list[Vector], shared: list[Vector]) -> bool:
    points = first + second
    for a, b in combinations(first, 2):
        points = points + edge_crossings(a, b, second)
    for a, b in combinations(second, 2):
        points = points + edge_crossings(a, b, first)
    return any(
        is_in_hull(p, first) and is_in_hull(p, second) and not is_in_hull(p, shared)
        for p in dict.fromkeys(points)
    )


def boxes_meet(first: list[Vector], second: list[Vector]) -> bool:
    return all(
        min(a) <= max(b) and min(b) <= max(a)
        for a, b in zip(zip(*first, strict=True), zip(*second, strict=True), strict=True)
    )


def expected_pairs(mesh: TriangleMesh, *, weld: bool = True) -> list[list[int]]:
    scale = max(x.as_integer_ratio()[1] for x in mesh.vertices.flat)
    places = [
        (scale * Fraction(x), scale * Fraction(y), scale * Fraction(z))
        for x, y, z in mesh.vertices.tolist()
    ]
    found = []
    for (i, one), (j, other) in combinations(enumerate(mesh.triangles.tolist()), 2):
        first, second = [places[v] for v in one], [places[v] for v in other]
        if not boxes_meet(first, second):
            continue
        if weld:
            shared = [p for p in dict.fromkeys(first) if p in second]
        else:
            shared = [places[v] for v in dict.fromkeys(one) if v in other]
        if len(shared) == 3 or meet_outside(first, second, shared):
            found.append([i, j])
    return found


@st.composite
def soups(draw: st.DrawFn) -> TriangleMesh:
    """Draw triangles on a small grid: most are degenerate or touch, or fail to by an ulp."""
    grid = st.integers(0, draw(st.integers(1, 3)))
    places = draw(st.lists(st.tuples(grid, grid, grid), min_size=3, max_size=9))
    offset, scale = draw(st.sampled_from([(0.0, 1.0), (7.0, 2.0**-20), (-1.0, 0.1), (1e6, 1e-3)]))
    vertices = np.array(places) * scale + offset
    for nudged in draw(st.lists(st.integers(0, vertices.size - 1), max_size=3)):
        vertices.flat[nudged] = np.nextafter(vertices.flat[nudged], np.inf)
    corner = st.integers(0, len(vertices) - 1)
    triangles = draw(st.lists(st.tuples(corner, corner, corner), min_size=2, max_size=5))
    return TriangleMesh(vertices, np.array(triangles))


@given(soups(), st.booleans())
@settings(max_examples=100)
def test_the_pairs_are_those_of_exact_arithmetic(mesh: TriangleMesh, weld: bool) -> None:
    assert self_intersections(mesh, weld=weld).tolist() == expected_pairs(mesh, weld=weld)


@pytest.mark.parametrize("scale", [1.0, 2.0**-357, 2.0**220])
@pytest.mark.parametrize("shared", [0, 1])
def test_triangles_that_touch_but_for_rounding_errors_are_decided(
    shared: int, scale: float
) -> None:
    generator = np.random.default_rng(1)
    meeting = 0
    for _ in range(100):
        first, second = generator.normal(size=(2, 3, 3))
        second[:shared] = first[:shared]
        # A place inside the first triangle or on an edge, for a corner or an edge of the second.
        weights = generator.dirichlet(np.ones(3))
        weights[generator.integers(3)] *= generator.integers(0, 2)
        place = weights @ first / weights.sum()
        beyond = generator.integers(0, 2) * generator.uniform()
        second[2] = second[1] + (1 + beyond) * (place - second[1])
        mesh = soup(scale * first, scale * second)
        pairs = self_intersections(mesh).tolist()
        assert pairs == expected_pairs(mesh)
        meeting += len(pairs)
    assert 50 < meeting < 100


# ---------------------------------------------------------------------------------------------
# Two triangles by hand
# ---------------------------------------------------------------------------------------------

FLOOR = [[0.0, 0, 0], [4, 0, 0], [0, 4, 0]]
"""A triangle in the plane z = 0."""

ULP = np.nextafter(0.0, 1.0)


def soup(*triangles: ArrayLike) -> TriangleMesh:
    """Return triangles given by their corners, none with a vertex of another."""
    corners = np.concatenate([np.asarray(triangle, dtype=float) for triangle in triangles])
    return TriangleMesh(corners, np.arange(len(corners)).reshape(-1, 3))


def pair_count(*triangles: ArrayLike) -> int:
    """Return the number of pairs, which no order of the triangles or their corners may change."""
    counts = {
        len(self_intersections(soup(*(np.roll(triangle, turn, axis=0) for triangle in some))))
        for some in (triangles, triangles[::-1])
        for turn in range(3)
    }
    assert len(counts) == 1
    return counts.pop()


@pytest.mark.parametrize(
    "other",
    [
        pytest.param([[1, 1, -1], [1, 1, 1], [9, 9, 0]], id="an edge pierces the face"),
        pytest.param([[1, 1, 0], [1, 1, 1], [2, 1, 1]], id="a corner touches the face"),
        pytest.param([[2, -1, 1], [2, 1, -1], [2, -9, -9]], id="two edges touch"),
        pytest.param([[4, 0, 1], [4, 0, -1], [9, 0, 0]], id="an edge touches a corner"),
        pytest.param([[1, 1, 0], [2, 1, 0], [9, 9, 5]], id="an edge lies in the face"),
        pytest.param([[1, 0, 0], [2, 0, 0], [1, -1, 0]], id="edges overlap in one plane"),
        pytest.param([[1, 1, 0], [9, 1, 0], [9, 2, 0]], id="faces overlap in one plane"),
        pytest.param([[1, 1, 0], [2, 1, 0], [1, 2, 0]], id="one face holds the other"),
        pytest.param([[1, 1, 0], [1, 1, 1], [1, 1, 2]], id="a segment touches the face"),
        pytest.param([[1, 1, 0], [1, 1, 0], [1, 1, 0]], id="a point lies in the face"),
    ],
)
def test_triangles_without_common_corner_may_not_even_touch(other: ArrayLike) -> None:
    assert pair_count(FLOOR, other) == 1


@pytest.mark.parametrize(
    "other",
    [
        pytest.param([[1, 1, ULP], [1, 1, 1], [2, 1, 1]], id="above the face"),
        pytest.param([[1, 1, ULP], [9, 1, ULP], [9, 2, ULP]], id="parallel"),
        pytest.param([[1, -ULP, 0], [2, -ULP, 0], [1, -1, 0]], id="beside it in its plane"),
        pytest.param([[2, -1 - 1e-15, 1], [2, 1 - 1e-15, -1], [2, -9, -9]], id="edge past edge"),
        pytest.param([[3, 3, -9], [3, 3, 9], [9, 9, 0]], id="through the plane outside"),
        pytest.param([[5, 0, 0], [6, 0, 0], [7, 0, 0]], id="a segment on the line of an edge"),
        pytest.param([[5, 5, 5], [5, 5, 5], [5, 5, 5]], id="a point elsewhere"),
    ],
)
def test_triangles_that_nearly_touch_do_not_meet(other: ArrayLike) -> None:
    assert pair_count(FLOOR, other) == 0


@pytest.mark.parametrize(
    ("other", "count"),
    [
        pytest.param([[0, 0, 0], [-1, 0, 0], [0, -1, 0]], 0, id="opposite, in line with it"),
        pytest.param([[0, 0, 0], [0, 0, 4], [-1, 0, 4]], 0, id="upright"),
        pytest.param([[0, 0, 0], [1, 1, ULP], [1, 1, 1]], 0, id="above it by an ulp"),
        pytest.param([[0, 0, 0], [1, 1, 0], [1, 1, 1]], 1, id="an edge lies in the face"),
        pytest.param([[0, 0, 0], [9, 0, 0], [9, 0, 1]], 1, id="an edge lies along an edge"),
        pytest.param([[0, 0, 0], [1, 1, -1], [1, 1, 1]], 1, id="through the face"),
        pytest.param([[0, 0, 0], [1, 1, 0], [-1, 1, 0]], 1, id="overlapping in its plane"),
        pytest.param([[0, 0, 0], [1, 1, 0], [2, 2, 0]], 1, id="a segment in the face"),
        pytest.param([[0, 0, 0], [0, 0, 1], [0, 0, -1]], 0, id="a segment through the corner"),
        pytest.param([[0, 0, 0], [0, 0, 0], [0, 0, 1]], 0, id="an edge collapsed at the corner"),
        pytest.param([[0, 0, 1], [0, 0, 0], [0, 0, 0]], 0, id="the same, the corner last"),
        pytest.param([[0, 0, 0], [0, 0, 0], [0, 0, 0]], 0, id="collapsed into the corner"),
    ],
)
def test_triangles_with_a_common_corner_may_share_nothing_else(
    other: ArrayLike, count: int
) -> None:
    assert pair_count(FLOOR, other) == count


@pytest.mark.parametrize(
    ("tip", "count"),
    [
        pytest.param([1, -1, 0], 0, id="flat"),
        pytest.param([1, 1, 5], 0, id="sharp"),
        pytest.param([1, 1, ULP], 0, id="all but closed"),
        pytest.param([1, 1, 0], 1, id="folded back"),
        pytest.param([0, 9, 0], 1, id="folded back along another edge"),
        pytest.param([0, 4, 0], 1, id="folded onto the same triangle"),
        pytest.param([2, 0, 0], 0, id="collapsed onto the edge"),
        pytest.param([6, 0, 0], 0, id="collapsed onto its line"),
        pytest.param([4, 0, 0], 0, id="collapsed into its end"),
    ],
)
def test_triangles_with_a_common_edge_may_not_be_folded_together(
    tip: list[float], count: int
) -> None:
    assert pair_count(FLOOR, [[0, 0, 0], tip, [4, 0, 0]]) == count
    assert pair_count(FLOOR, [[0, 0, 0], [4, 0, 0], tip]) == count


def test_the_tip_of_a_triangle_may_not_lie_between_the_corners_of_a_common_edge() -> None:
    thin = [[0, 0, 0], [2, 0, 0], [4, 0, 0]]
    half = [[0, 0, 0], [0, -1, 0], [2, 0, 0]]
    assert pair_count(FLOOR, thin) == 0
    assert pair_count(thin, half) == 0
    assert pair_count(FLOOR, half) == 1


# ---------------------------------------------------------------------------------------------
# Options
# ---------------------------------------------------------------------------------------------


def test_parts_may_touch_at_equal_positions_if_these_are_welded() -> None:
    tent = [[0, 0, 0], [4, 0, 0], [2, 0, 3]]
    assert len(self_intersections(soup(FLOOR, tent))) == 0
    assert len(self_intersections(soup(FLOOR, tent), weld=False)) == 1


@pytest.mark.parametrize(
    ("first", "second"),
    [
        pytest.param(FLOOR, [[1, 1, -0.25], [0.5, 1, 5], [2, 1, 5]], id="corner and face"),
        pytest.param(
            [[-5, 0, 0], [5, 0, 0], [0, 5, 9]],
            [[0, -5, 0.25], [0, 5, 0.25], [5, 0, -9]],
            id="edges",
        ),
    ],
)
def test_a_tolerance_leaves_out_what_penetrates_no_deeper(
    first: ArrayLike, second: ArrayLike
) -> None:
    mesh = soup(first, second)
    for tolerance, count in ((None, 1), (0.0, 1), (0.249, 1), (0.251, 0)):
        assert len(self_intersections(mesh, tolerance=tolerance)) == count


@pytest.mark.parametrize(
    "other",
    [
        pytest.param([[1, 1, 0], [1, 1, 1], [2, 1, 1]], id="touching"),
        pytest.param([[1, 1, 0], [9, 1, 0], [9, 2, 0]], id="in the same plane"),
        pytest.param(FLOOR, id="the same"),
    ],
)
def test_a_tolerance_leaves_out_what_only_touches(other: ArrayLike) -> None:
    mesh = soup(FLOOR, other)
    assert len(self_intersections(mesh)) == 1
    assert len(self_intersections(mesh, tolerance=1e-9)) == 0


@pytest.mark.parametrize("tilt", [0.0, 1e-3])
def test_a_limit_gives_so_many_of_the_pairs(tilt: float) -> None:
    # Without a tilt all faces are in one plane, and whole numbers must decide.
    layers = [np.array(FLOOR) + 0.01 * k * np.array([1, 1, 0]) for k in range(10)]
    for k, layer in enumerate(layers):
        layer[0, 2] = tilt * k
        layer[1, 2] = -tilt * k
    mesh = soup(*layers)
    pairs = self_intersections(mesh).tolist()
    assert pairs == sorted(pairs)
    assert len(pairs) == 45
    for limit in (1, 7, 45, 99):
        some = self_intersections(mesh, limit=limit).tolist()
        assert len(some) == min(limit, 45)
        assert all(pair in pairs for pair in some)


def test_options_out_of_range_are_refused() -> None:
    with pytest.raises(OptionError, match=r"limit is 0; need 1 or more"):
        self_intersections(soup(FLOOR), limit=0)
    with pytest.raises(OptionError, match=r"tolerance is -1 mm; need >= 0"):
        self_intersections(soup(FLOOR), tolerance=-1.0)
    with pytest.raises(OptionError, match=r"tolerance is nan mm; need >= 0"):
        self_intersections(soup(FLOOR), tolerance=np.nan)


def test_meshes_out_of_range_are_refused() -> None:
    with pytest.raises(MeshError, match=r"vertex 1 is at \[2e\+70, .*need at most 1e\+70"):
        self_intersections(soup([[0, 0, 0], [2e70, 0, 0], [0, 1, 0]]))
    wrong = SimpleNamespace(vertices=np.zeros((3, 3)), triangles=np.full((1, 3), 0.5))
    with pytest.raises(MeshError, match=r"need whole numbers"):
        self_intersections(wrong)


def test_a_mesh_without_triangles_has_no_pairs() -> None:
    empty = TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=int))
    assert self_intersections(empty).shape == (0, 2)
    assert self_intersections(soup(FLOOR)).shape == (0, 2)


# ---------------------------------------------------------------------------------------------
# Surfaces
# ---------------------------------------------------------------------------------------------


def tube(centers: Points, radius: float, sides: int = 6) -> QuadMesh:
    """Return a closed tube around the closed path through `centers` (n, 3) in mm."""
    count = len(centers)
    ahead = normalize(np.roll(centers, -1, axis=0) - np.roll(centers, 1, axis=0))
    across = normalize(np.cross(ahead, [0.3, 0.2, 1.0]))
    upward = np.cross(ahead, across)
    angles = 2 * np.pi * np.arange(sides) / sides
    rings = across[:, None] * np.cos(angles)[:, None] + upward[:, None] * np.sin(angles)[:, None]
    vertices = (centers[:, None] + radius * rings).reshape(-1, 3)
    ring, side = np.divmod(np.arange(count * sides), sides)
    quads = [
        ((ring + down) % count) * sides + (side + right) % sides
        for down, right in ((0, 0), (0, 1), (1, 1), (1, 0))
    ]
    return QuadMesh(vertices, np.stack(quads, axis=1))


def figure_of_eight(count: int, height: float) -> Points:
    """Return points on a figure of eight whose strands pass each other at ± `height` mm."""
    angle = 2 * np.pi * (np.arange(count) + 0.5) / count
    return np.stack([10 * np.sin(angle), 5 * np.sin(2 * angle), height * np.cos(angle)], axis=1)


def test_a_tube_meets_itself_only_where_its_strands_are_too_close() -> None:
    apart = tube(figure_of_eight(48, 1.2), radius=1.0)
    assert len(self_intersections(apart)) == 0
    crossed = tube(figure_of_eight(48, 0.5), radius=1.0)
    crossed.check_closed()
    pairs = self_intersections(crossed)
    centers = crossed.vertices[crossed.triangles].mean(axis=1)
    assert len(pairs) > 20
    assert np.abs(centers[pairs, :2]).max() < 3.0


def test_one_needle_in_a_fine_surface_is_found() -> None:
    angle = 2 * np.pi * np.arange(200) / 200
    ring = tube(10 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1), 3.0, sides=60)
    assert len(self_intersections(ring)) == 0
    count = len(ring.vertices)
    mesh = TriangleMesh(
        np.concatenate([ring.vertices, [[8, 0.1, -9], [8, 0.1, 9], [8.001, 0.1, 9]]]),
        np.concatenate([ring.triangles, [[count, count + 1, count + 2]]]),
    )
    pairs = self_intersections(mesh)
    assert set(pairs[:, 1]) == {len(ring.triangles)}
    centers = ring.vertices[ring.triangles[pairs[:, 0]]].mean(axis=1)
    assert np.abs(centers[:, :2] - [8, 0.1]).max() < 0.5
    height = np.sqrt(3.0**2 - 2.0**2)  # of the ring at 8 mm from its axis
    assert {1.0, -1.0} == set(np.round(centers[:, 2] / height, 1))


def test_triangles_of_very_different_sizes_are_compared() -> None:
    generator = np.random.default_rng(7)
    sizes = 10.0 ** generator.uniform(-3, 0, (60, 1, 1))
    places = generator.uniform(0, 1, (60, 1, 3))
    corners = places + sizes * generator.normal(size=(60, 3, 3))
    mesh = soup(*np.round(corners * 2**16))  # short numbers keep the oracle fast
    pairs = self_intersections(mesh).tolist()
    assert len(pairs) > 10
    assert pairs == expected_pairs(mesh)


@given(soups(), st.randoms(use_true_random=False), st.integers(0, 30))
@settings(max_examples=50)
def test_order_and_scale_do_not_matter(mesh: TriangleMesh, random: Random, power: int) -> None:
    order = list(range(len(mesh.triangles)))
    random.shuffle(order)
    turns = [np.roll(mesh.triangles[k], random.randrange(3)) for k in order]
    other = TriangleMesh(mesh.vertices[:, [1, 2, 0]] * -(2.0**power), np.array(turns))
    pairs = np.sort(np.array(order)[self_intersections(other)], axis=1).reshape(-1, 2)
    assert sorted(pairs.tolist()) == self_intersections(mesh).tolist()


# ---------------------------------------------------------------------------------------------
# Against other programs
# ---------------------------------------------------------------------------------------------


def as_mesh(manifold: Manifold) -> TriangleMesh:
    mesh = manifold.to_mesh64()
    return TriangleMesh(mesh.vert_properties[:, :3], mesh.tri_verts.astype(np.intp))


def crossed_bars() -> list[Manifold]:
    """Return three bars through the origin in general position."""
    bar = Manifold.cylinder(10.0, 1.0, circular_segments=12, center=True)
    return [bar, bar.rotate([80.0, 10.0, 0.0]), bar.rotate([10.0, 70.0, 50.0])]


def side_by_side(parts: list[TriangleMesh]) -> TriangleMesh:
    """Return all parts in one mesh, as they are."""
    starts = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    return TriangleMesh(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.triangles + start for part, start in zip(parts, starts, strict=True)]),
    )


def test_a_union_does_not_cross_itself_but_its_parts_do() -> None:
    bars = crossed_bars()
    assert len(self_intersections(as_mesh(Manifold.batch_boolean(bars, OpType.Add)))) == 0
    assert len(self_intersections(side_by_side([as_mesh(bar) for bar in bars]))) > 20


def test_boxes_that_stand_on_each_other_cross_by_rounding_errors_only() -> None:
    turn = [10.0, 20.0, 30.0]
    cubes = [
        Manifold.cube([2.0, 1.0, 1.0]),
        Manifold.cube([1.0, 3.0, 1.0]).translate([0.7, 0.4, 1.0]),
    ]
    apart = side_by_side([as_mesh(cube.rotate(turn)) for cube in cubes])
    assert len(self_intersections(apart)) > 0
    assert len(self_intersections(apart, tolerance=1e-9)) == 0


def test_an_edge_that_a_union_splits_in_two_is_no_crossing() -> None:
    cube = Manifold.cube([1.0, 1.0, 1.0])
    union = as_mesh(cube + cube.translate([1.0, 1.0, 0.0]))
    assert len(union.vertices) == 16
    assert len(self_intersections(union)) == 0
    assert len(self_intersections(union, weld=False)) > 0


@pytest.mark.skipif(not INSTALLED, reason="CGAL has no wheel here")
def test_cgal_finds_a_crossing_where_one_is_found() -> None:
    bars = side_by_side([as_mesh(bar) for bar in crossed_bars()])
    crossing = tube(figure_of_eight(48, 0.5), radius=1.0)
    for mesh in (bars, crossing, as_mesh(Manifold.cube([1.0, 1.0, 1.0]))):
        found = faults_by_cgal(mesh.vertices, mesh.triangles) == "crosses itself"
        assert found == (len(self_intersections(mesh)) > 0)
    assert faults_by_cgal(crossing.vertices, crossing.triangles[1:]) == "not closed"


def test_only_pairs_within_a_part_are_found_if_parts_are_given() -> None:
    random = np.random.default_rng(7)
    mesh = TriangleMesh(random.random((90, 3)), np.arange(90).reshape(-1, 3))
    everything = self_intersections(mesh)
    parts = random.integers(0, 3, 30)
    together = parts[everything[:, 0]] == parts[everything[:, 1]]
    assert 0 < together.sum() < len(together)
    np.testing.assert_array_equal(self_intersections(mesh, parts=parts), everything[together])
