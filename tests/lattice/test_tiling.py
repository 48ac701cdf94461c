"""Tiled lattices: counts in closed form, welding, graded radii, bent lattices."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.filling import fill
from scaffold_cad.lattice import UnitCell, cells, mapped, tile, unit_cell
from scaffold_cad.skeleton import Skeleton, check_skeleton

COUNTED = (
    *("sc", "bcc", "bcc_sc", "bccz", "fcc", "octet", "kelvin", "diamond", "rhombic_dodecahedron"),
    *("truncated_cube", "cuboctahedron", "auxetic", "hexagonal_prism", "fbcc", "star"),
)
"""Cells whose blocks were counted by hand."""


def nodes_and_struts(name: str, n: int) -> tuple[int, int]:
    """Return how many nodes and struts n³ cells have, counted by hand."""
    corners, edges, faces, volumes = (n + 1) ** 3, 3 * n * (n + 1) ** 2, 3 * n**2 * (n + 1), n**3
    layer_nodes, layer_struts = (n + 1) ** 2 + n * (n + 1) + 2 * n**2, n * (n + 1) + 5 * n**2
    return {
        "sc": (corners, edges),
        "bcc": (corners + volumes, 8 * volumes),
        "bcc_sc": (corners + volumes, 8 * volumes + edges),
        "bccz": (corners + volumes, 8 * volumes + edges // 3),
        "fcc": (corners + faces, 4 * faces),
        "octet": (corners + faces, 4 * faces + 12 * volumes),
        "kelvin": (4 * faces, 4 * faces + 12 * volumes),
        # Four of the block's corners have no bond: one of every two corners of a cell has.
        "diamond": (corners - 4 + faces + 4 * volumes, 16 * volumes),
        "rhombic_dodecahedron": (corners + faces + 8 * volumes, 32 * volumes),
        "truncated_cube": (2 * edges, edges + 4 * faces),
        "cuboctahedron": (edges, 4 * faces),
        "auxetic": (2 * edges // 3 + 2 * volumes + faces // 3, edges // 3 + 10 * volumes),
        "fbcc": (corners + faces + volumes, 4 * faces + 8 * volumes),
        "star": (corners + faces + volumes, 14 * volumes),
        "hexagonal_prism": ((n + 1) * layer_nodes, (n + 1) * layer_struts + n * layer_nodes),
    }[name]


@pytest.mark.parametrize("n", [1, 2, 3, 5])
@pytest.mark.parametrize("name", sorted(COUNTED))
def test_a_block_of_cells_has_the_counted_nodes_struts_and_loops(name: str, n: int) -> None:
    nodes, struts = nodes_and_struts(name, n)
    lattice = tile(name, 10.0, n, radius=0.7)
    assert (len(lattice.nodes), len(lattice.edges)) == (nodes, struts)
    if lattice.component_count == 1:
        assert lattice.loop_count == struts - nodes + 1


@given(
    name=st.sampled_from(sorted(name for name, cell in cells().items() if not cell.is_net)),
    counts=st.tuples(*[st.integers(1, 3)] * 3),
    size=st.tuples(*[st.floats(0.5, 50.0)] * 3),
)
@settings(max_examples=40)
def test_any_block_is_valid_fits_its_box_and_has_the_valencies_of_its_cell(
    name: str, counts: tuple[int, int, int], size: tuple[float, float, float]
) -> None:
    lattice = tile(name, size, counts, radius=0.1)
    check_skeleton(lattice)
    box = np.multiply(size, counts)
    assert (lattice.nodes >= 0).all()
    assert (lattice.nodes <= box).all()
    inside = ((lattice.nodes > 1e-9 * box) & (lattice.nodes < (1 - 1e-9) * box)).all(axis=1)
    assert set(lattice.valency[inside].tolist()) <= set(unit_cell(name).valencies)


@st.composite
def own_cells(draw: st.DrawFn) -> UnitCell:
    """Draw a cell with nodes on a coarse grid, on faces or not, periodic or not."""
    steps = st.tuples(*[st.integers(0, 3)] * 3)
    places = draw(st.lists(steps, min_size=2, max_size=8, unique=True))
    pairs = st.tuples(*[st.integers(0, len(places) - 1)] * 2).filter(lambda pair: pair[0] < pair[1])
    edges = np.array(draw(st.lists(pairs, min_size=1, max_size=10, unique=True)))
    used = np.unique(edges)
    nodes, edges = np.array(places)[used] / 3, np.searchsorted(used, edges)
    skeleton = Skeleton(nodes, edges, np.array(1.0)).cleaned(weld_distance=0.0).skeleton
    return UnitCell("own", skeleton.nodes, skeleton.edges)


@given(cell=own_cells(), counts=st.tuples(*[st.integers(1, 3)] * 3))
@settings(max_examples=60)
def test_a_block_is_the_union_of_its_moved_cells(
    cell: UnitCell, counts: tuple[int, int, int]
) -> None:
    expected = set()
    for step in product(*map(range, counts)):
        for a, b in np.rint(3 * (cell.nodes + np.array(step)))[cell.edges].tolist():
            expected.add(frozenset([tuple(a), tuple(b)]))
    lattice = tile(cell, 3.0, counts, radius=0.1)
    struts = np.rint(lattice.nodes)[lattice.edges].tolist()
    found = [frozenset([tuple(a), tuple(b)]) for a, b in struts]
    assert len(found) == len(expected)
    assert set(found) == expected
    assert len(lattice.nodes) == len({node for strut in expected for node in strut})


@pytest.mark.parametrize(("name", "beyond"), [("weaire_phelan", 5 / 32), ("triangular_prism", 0.5)])
def test_struts_that_leave_their_cell_stay_whole_unless_a_box_is_filled(
    name: str, beyond: float
) -> None:
    assert tile(name, 10.0, counts=3, radius=0.3).nodes[:, 0].max() == pytest.approx(
        30 + 10 * beyond, abs=0.01
    )
    assert fill([[0] * 3, [30] * 3], name, 10.0, 0.3).nodes.max() == pytest.approx(30)


def test_struts_have_the_length_of_their_cell() -> None:
    np.testing.assert_allclose(tile("bcc", 10.0, 3, radius=1.0).lengths, 5 * np.sqrt(3))
    np.testing.assert_allclose(tile("octet", 10.0, 3, radius=1.0).lengths, np.sqrt(50))
    np.testing.assert_allclose(tile("truncated_cube", 10.0, 2, radius=1.0).lengths, 4.1421356237)
    stretched = tile("sc", (1.0, 2.0, 3.0), 2, radius=0.1).lengths
    assert np.unique(stretched).tolist() == [1.0, 2.0, 3.0]


def test_one_number_is_the_size_along_x_of_an_undistorted_cell() -> None:
    lattice = tile("hexagonal_prism", 6.0, (2, 1, 1), radius=0.5)
    np.testing.assert_allclose(np.ptp(lattice.nodes, axis=0), [12.0, 6 * np.sqrt(3), 6.0])


def test_the_same_call_gives_the_same_arrays() -> None:
    one, other = (tile("kelvin", 7.0, (3, 2, 4), radius=0.5) for _ in range(2))
    assert np.array_equal(one.nodes, other.nodes)
    assert np.array_equal(one.edges, other.edges)


def test_a_large_lattice_has_the_counted_nodes_and_struts() -> None:
    lattice = tile("bcc", 10, (20, 30, 40), radius=0.7)
    assert len(lattice.edges) == 8 * 20 * 30 * 40
    assert len(lattice.nodes) == 21 * 31 * 41 + 20 * 30 * 40
    assert np.array_equal(lattice.nodes.max(axis=0), [200, 300, 400])


def test_a_radius_may_depend_on_the_place() -> None:
    def radius(points: Points) -> Floats:
        return 0.5 + points[:, 2] / 100

    lattice = tile("bcc", 10.0, 2, radius=radius)
    np.testing.assert_allclose(lattice.radii, 0.5 + lattice.nodes[:, 2] / 100)


def test_a_radius_that_is_no_length_is_refused() -> None:
    with pytest.raises(OptionError, match="radius is -1 mm; need > 0"):
        tile("bcc", 10.0, 2, radius=-1.0)
    with pytest.raises(OptionError, match=r"returned shape \(35, 3\) for points \(35, 3\); need"):
        tile("bcc", 10.0, 2, radius=lambda points: points)
    with pytest.raises(SkeletonError, match="has radius 0 mm; need > 0"):
        tile("bcc", 10.0, 2, radius=lambda points: points[:, 0])


def test_options_of_maps_are_refused_without_one() -> None:
    with pytest.raises(OptionError, match="dangling is False without a map"):
        tile("bcc", 10.0, 2, radius=1.0, dangling=False)
    for size, found in ((None, "None"), (len, "a builtin_function_or_method")):
        with pytest.raises(OptionError, match=f"cell size in mm is {found}; need one number"):
            tile("bcc", size, 2, radius=1.0)


@pytest.mark.parametrize("size", [0.0, -1.0, np.nan, (1.0, 2.0), (1.0, 2.0, 0.0)])
def test_a_size_that_is_no_length_is_refused(size: float | tuple[float, ...]) -> None:
    with pytest.raises(OptionError, match=r"cell size in mm = .*; need three numbers > 0"):
        tile("bcc", size, 1, radius=1.0)


@pytest.mark.parametrize("counts", [0, (1, 2), (1, 2, 0), (1.5, 1, 1)])
def test_counts_that_are_no_counts_are_refused(counts: tuple[int, int, int]) -> None:
    with pytest.raises(OptionError, match=r"counts are .*; need three whole numbers >= 1"):
        tile("bcc", 1.0, counts, radius=1.0)


@pytest.mark.parametrize("counts", [(10**5, 10**5, 10**5), (1, 10**9, 1), 2**62])
def test_more_struts_than_memory_holds_are_refused_before_it_is_taken(
    counts: int | tuple[int, int, int],
) -> None:
    with pytest.raises(OptionError, match=r"cells of 'bcc' have .* struts; need at most 1e\+08"):
        tile("bcc", 1.0, counts, radius=0.1)


# ---------------------------------------------------------------------------------------------
# Bent lattices
# ---------------------------------------------------------------------------------------------


def bent_to_a_ring(points: Points) -> Points:
    """Take (angle, height, distance from the inner wall) to a ring of inner radius 20 mm."""
    angle, height, depth = points.T
    return np.stack([(20 + depth) * np.cos(angle), (20 + depth) * np.sin(angle), height], axis=1)


def test_a_block_bent_to_a_ring_is_welded_at_its_seam() -> None:
    block = tile("sc", (2 * np.pi / 16, 10.0, 5.0), (16, 3, 2), radius=1.0)
    ring = mapped(block, bent_to_a_ring)
    check_skeleton(ring)
    assert len(ring.nodes) == 16 * 4 * 3
    assert len(ring.edges) == 16 * 4 * 3 + 16 * 3 * 3 + 16 * 4 * 2
    reach = np.hypot(ring.nodes[:, 0], ring.nodes[:, 1])
    assert np.unique(reach.round(9)).tolist() == [20.0, 25.0, 30.0]


def test_a_seam_may_stay_open() -> None:
    block = tile("sc", (2 * np.pi / 16, 10.0, 5.0), (16, 3, 2), radius=1.0)
    ring = mapped(block, bent_to_a_ring, weld=False)
    assert np.array_equal(ring.edges, block.edges)
    np.testing.assert_array_equal(ring.nodes, bent_to_a_ring(block.nodes))


def test_a_mapping_that_returns_no_positions_is_refused() -> None:
    block = tile("sc", 1.0, 1, radius=0.1)
    with pytest.raises(OptionError, match=r"mapping returned shape \(8,\); need \(8, 3\)"):
        mapped(block, lambda points: points[:, 0])
    with pytest.raises(SkeletonError, match=r"nodes\[0\] is \[nan, nan, nan\]; need finite"):
        mapped(block, lambda points: points * np.nan)
