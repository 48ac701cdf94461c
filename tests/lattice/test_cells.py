"""Unit cells: what they hold, what they refuse, and how they are found by name."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.base.vectors import angle_between
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.lattice import UnitCell, cells, check_periodic, register_cell, tile, unit_cell
from scaffold_cad.lattice.morecells import reentrant_cell, reentrant_honeycomb
from scaffold_cad.lattice.registry import _CELLS
from scaffold_cad.skeleton import check_skeleton

# name: (nodes per cell, struts per cell, valencies, strut lengths in a cell of size 1)
KNOWN = {
    "sc": (1, 3, (6,), {1.0}),
    "bcc": (2, 8, (8,), {np.sqrt(3) / 2}),
    "bcc_sc": (2, 11, (8, 14), {np.sqrt(3) / 2, 1.0}),
    "bccz": (2, 9, (8, 10), {np.sqrt(3) / 2, 1.0}),
    "fcc": (4, 12, (4, 12), {np.sqrt(0.5)}),
    "octet": (4, 24, (12,), {np.sqrt(0.5)}),
    "kelvin": (12, 24, (4,), {np.sqrt(2) / 4}),
    "diamond": (8, 16, (4,), {np.sqrt(3) / 4}),
    "rhombic_dodecahedron": (12, 32, (4, 8), {np.sqrt(3) / 4}),
    "truncated_cube": (6, 15, (5,), {np.sqrt(2) - 1}),
    "cuboctahedron": (3, 12, (8,), {np.sqrt(0.5)}),
    "auxetic": (5, 11, (2, 5), {0.75, 0.375}),
    "hexagonal_prism": (4, 10, (5,), {1 / np.sqrt(3), 1.0}),
    "gyroid": (8, 12, (3,), {np.sqrt(2) / 4}),
    "fbcc": (5, 20, (4, 8, 20), {np.sqrt(3) / 2, np.sqrt(0.5)}),
    "star": (5, 14, (2, 8, 14), {np.sqrt(3) / 2, 0.5}),
    "pyrochlore": (16, 48, (6,), {np.sqrt(2) / 4}),
    "weaire_phelan": (
        46,
        92,
        (4,),
        {np.sqrt(3) / 12, np.sqrt(525) / 96, 5 / 16, np.sqrt(45) / 32},
    ),
    "triangular_prism": (2, 8, (8,), {1.0}),
    "reentrant_honeycomb": (
        5,
        11,
        (2, 5),
        {1 / np.sqrt(3), 2 / np.sqrt(3), 1.0},
    ),
}
NETS = ("triangular_prism", "weaire_phelan")
"""Cells with struts through the faces of their boxes."""

by_name = pytest.mark.parametrize("name", KNOWN)


def test_every_known_cell_is_tested() -> None:
    assert set(KNOWN) == set(cells())


@by_name
def test_a_cell_has_its_nodes_struts_valencies_and_lengths(name: str) -> None:
    nodes, struts, valencies, lengths = KNOWN[name]
    cell = unit_cell(name)
    assert (cell.site_count, cell.strut_count, cell.valencies) == (nodes, struts, valencies)
    found = cell.strut_lengths(cell.proportions)
    nearest = np.abs(found[:, None] - list(lengths)).min(axis=1)
    np.testing.assert_allclose(nearest, 0.0, atol=1e-12)


@by_name
def test_a_cell_is_periodic_and_its_lattice_is_one_valid_skeleton(name: str) -> None:
    check_periodic(unit_cell(name))
    lattice = tile(name, 10.0, (2, 3, 2), radius=0.5)
    check_skeleton(lattice)
    assert lattice.component_count == 1


@pytest.mark.parametrize("name", sorted(set(KNOWN) - set(NETS)))
def test_nodes_on_opposite_faces_match_in_a_lattice(name: str) -> None:
    lattice = tile(name, 1.0, 3, radius=0.1)
    size = unit_cell(name).proportions
    for axis in range(3):
        x = lattice.nodes[:, axis] / size[axis]
        face = np.abs(x - 1) < 1e-9  # between the first and the second cells
        moved = np.abs(x - 2) < 1e-9
        near = lattice.nodes[face] + np.eye(3)[axis] * size
        gaps = np.linalg.norm(near[:, None] - lattice.nodes[moved], axis=2)
        assert len(near) == moved.sum() > 0
        assert gaps.min(axis=1).max() < 1e-12


@by_name
def test_a_cell_tells_its_name_valency_and_density(name: str) -> None:
    cell = unit_cell(name)
    assert str(cell).startswith(f"{name}: {cell.description} Struts a cell {cell.strut_count}, ")
    assert f"valency {' and '.join(map(str, cell.valencies))}, " in str(cell)
    assert f"{cell.density_coefficient:.4g} (r/a)²" in str(cell)


def test_hexagons_of_the_hexagonal_prism_are_regular() -> None:
    lattice = tile("hexagonal_prism", 10.0, 3, radius=0.5)
    at_node = lattice.directions[
        lattice.incidence.at_nodes(np.flatnonzero(lattice.valency == 5), 5)
    ]
    flat = at_node[np.abs(at_node[:, :, 2]) < 0.5].reshape(-1, 3, 3)
    angles = [angle_between(flat[:, k], flat[:, k - 1]) for k in range(3)]
    np.testing.assert_allclose(angles, 2 * np.pi / 3)


def test_bonds_of_diamond_meet_at_tetrahedral_angles() -> None:
    lattice = tile("diamond", 10.0, 2, radius=0.5)
    at_node = lattice.directions[
        lattice.incidence.at_nodes(np.flatnonzero(lattice.valency == 4), 4)
    ]
    products = np.einsum("nai,nbi->nab", at_node, at_node)
    np.testing.assert_allclose(products, np.eye(4) * 4 / 3 - 1 / 3 + np.zeros_like(products))


def test_the_auxetic_cell_gets_wider_when_it_gets_longer() -> None:
    # Arms of fixed length turn about their ends: a higher cell makes them flatter, so longer
    # across. An arm from a column's top leads down to the next column's lower end.
    lattice = tile("auxetic", 1.0, 2, radius=0.01)
    spans = lattice.nodes[lattice.edges[:, 1]] - lattice.nodes[lattice.edges[:, 0]]
    arms = np.flatnonzero(np.abs(spans[:, 0]) > 0.1)
    upright = lattice.directions[
        lattice.incidence.at_nodes(np.flatnonzero(lattice.valency == 5), 5)
    ]
    column = np.abs(upright[:, :, 2]).argmax(axis=1)
    toward = upright[np.arange(len(upright)), column]  # from the node into its own column
    slopes = np.einsum("ni,nki->nk", toward, upright)
    assert len(arms) > 0
    assert (slopes > 0).all()  # all arms fold back beside the column: re-entrant


@pytest.mark.parametrize("name", NETS)
def test_nets_go_through_the_faces_of_their_boxes(name: str) -> None:
    cell = unit_cell(name)
    assert cell.is_net
    block = tile(name, 10.0, (3, 2, 2), radius=0.2)
    assert len(block.edges) == 12 * cell.strut_count
    deep = tile(name, 10.0, 3, radius=0.2)
    size = 10 * cell.proportions
    inside = ((deep.nodes > 0.99 * size) & (deep.nodes < 2.01 * size)).all(axis=1)
    assert set(deep.valency[inside].tolist()) == set(cell.valencies)


def test_corners_of_weaire_and_phelans_cells_are_those_of_the_voronoi_diagram() -> None:
    sites = (
        np.array(
            [[0, 0, 0], [2, 2, 2], [1, 0, 2], [3, 0, 2], [2, 1, 0], [2, 3, 0], [0, 2, 1], [0, 2, 3]]
        )
        / 4
    )
    steps = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3), axis=-1).reshape(-1, 3)
    everywhere = (sites[:, None] + steps).reshape(-1, 3)
    gaps = np.linalg.norm(unit_cell("weaire_phelan").motif.sites[:, None] - everywhere, axis=2)
    gaps.sort(axis=1)
    np.testing.assert_allclose(gaps[:, :4], gaps[:, :1] + np.zeros((46, 4)))
    assert (gaps[:, 4] > gaps[:, 0] + 1e-3).all()


def test_a_slanted_net_has_its_lengths_valency_and_volume() -> None:
    close_packed = UnitCell.of_net(
        "hcp",
        [[0, 0, 0], [1 / 3, 2 / 3, 0.5]],
        [[0, 1]] * 6,
        [[0, 0, 0], [0, 0, -1], [0, -1, 0], [0, -1, -1], [-1, -1, 0], [-1, -1, -1]],
        proportions=[1, 1, np.sqrt(8 / 3)],
        angles=np.radians([90, 90, 120]),
    )
    assert close_packed.valencies == (6,)
    size = 10 * close_packed.proportions
    np.testing.assert_allclose(close_packed.strut_lengths(size), 10.0)
    assert close_packed.volume(size) == pytest.approx(np.sqrt(2) * 1000)
    block = tile(close_packed, 10.0, 3, radius=0.5)
    check_skeleton(block)
    np.testing.assert_allclose(block.lengths, 10.0)


@pytest.mark.parametrize(
    ("sites", "edges", "moves", "message"),
    [
        ([[0, 0, 0]], [[0, 0]], [[0, 0, 0]], "from site 0 to 0 has no length"),
        ([[0, 0, 0]], [[0, 0], [0, 0]], [[1, 0, 0], [-1, 0, 0]], "is listed twice"),
        ([[0, 0, 0]], [[0, 0], [0, 0]], [[1, 0, 0], [2, 0, 0]], "in the same direction"),
        ([[0, 0, 0], [0.5, 0, 0]], [[0, 0]], [[1, 0, 0]], "site 1 has no strut"),
        ([[0, 0, 0]], [[0, 1]], [[1, 0, 0]], "need 0 to 0"),
        ([[0, 0, 0]], [[0, 0]], [[1, 0, 0]] * 2, "2 moves of 1 edges"),
    ],
)
def test_nets_that_are_none_are_refused(
    sites: object, edges: object, moves: object, message: str
) -> None:
    with pytest.raises(SkeletonError, match=message):
        UnitCell.of_net("net", sites, edges, moves)  # type: ignore[arg-type]


@pytest.mark.parametrize("degrees", [(90, 90, 0), (60, 60, 130), (90, 90, 180)])
def test_angles_of_no_cell_are_refused(degrees: tuple[float, float, float]) -> None:
    with pytest.raises(OptionError, match=r"three that span space|need three numbers > 0"):
        UnitCell("rod", [[0, 0, 0], [1, 1, 1]], [[0, 1]], angles=np.radians(degrees))


@pytest.mark.parametrize(("depth", "height"), [(0.1, 0.9), (0.25, 0.75), (0.2, 0.5)])
def test_re_entrant_cells_of_any_depth_are_periodic(depth: float, height: float) -> None:
    cell = reentrant_cell(depth, height)
    check_periodic(cell)
    arm = np.sqrt(0.5 + depth**2)
    assert np.isclose(cell.strut_lengths(np.ones(3)), arm).sum() >= 8
    if (depth, height) == (0.25, 0.75):
        np.testing.assert_allclose(
            np.sort(cell.strut_lengths(np.ones(3))),
            np.sort(unit_cell("auxetic").strut_lengths(np.ones(3))),
        )
    with pytest.raises(OptionError, match="less than half the height"):
        reentrant_cell(height / 2, height)


@pytest.mark.parametrize("angle", [0.2, np.pi / 6, 0.9])
def test_re_entrant_honeycombs_have_slanted_sides_of_one_length(angle: float) -> None:
    cell = reentrant_honeycomb(angle, 2.5)
    check_periodic(cell)
    lattice = tile(cell, 2 * np.cos(angle), 2, radius=0.05)
    spans = np.abs(np.diff(lattice.nodes[lattice.edges], axis=1)[:, 0])
    slanted = (spans[:, 0] > 1e-9) & (spans[:, 1] > 1e-9)
    np.testing.assert_allclose(lattice.lengths[slanted], 1.0)
    np.testing.assert_allclose(spans[slanted, 1], np.sin(angle))
    with pytest.raises(OptionError, match=r"ratio is 0.1; need more than"):
        reentrant_honeycomb(angle, 0.1)


def test_cells_are_found_by_their_other_names() -> None:
    assert unit_cell("Laves") is unit_cell("gyroid")
    assert unit_cell("truncated octahedron") is unit_cell("kelvin")
    with pytest.raises(OptionError, match="called 'laves' exists already"):
        register_cell(UnitCell("laves", [[0, 0, 0], [1, 0, 0]], [[0, 1]]), periodic=False)


@pytest.mark.parametrize("name", ["bcc_sc", "BCC+SC", " bcc sc ", "Bcc-Sc"])
def test_names_may_be_written_in_several_ways(name: str) -> None:
    assert unit_cell(name) is cells()["bcc_sc"]


def test_an_unknown_name_is_refused_with_the_known_ones() -> None:
    with pytest.raises(OptionError, match=r"'kelvn'; need one of sc, bcc, .*mean 'kelvin'\?"):
        unit_cell("kelvn")
    with pytest.raises(OptionError, match=r"'xyzzy'; need one of .*gyroid, fbcc.*honeycomb$"):
        unit_cell("xyzzy")


def test_the_listing_is_a_copy() -> None:
    listing = cells()
    listing.clear()
    assert len(cells()) == len(KNOWN)


def test_nodes_almost_on_a_face_are_put_on_it() -> None:
    cell = UnitCell(
        "rod", np.array([[0.5, 0.5, -1e-12], [0.5, 0.5, 1 + 1e-12]]), np.array([[0, 1]])
    )
    assert cell.nodes[:, 2].tolist() == [0.0, 1.0]
    assert (cell.site_count, cell.valencies) == (1, (2,))


# ---------------------------------------------------------------------------------------------
# Cells of one's own
# ---------------------------------------------------------------------------------------------

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
STAR = np.array([[k, 8] for k in range(8)])


@pytest.fixture
def registry(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scaffold_cad.lattice.registry._CELLS", dict(_CELLS))


@pytest.mark.usefixtures("registry")
def test_a_registered_cell_is_found_by_name() -> None:
    nodes = np.concatenate([CORNERS, [[0.5, 0.5, 0.25]]])
    cell = UnitCell("My Star", nodes, STAR)
    register_cell(cell)
    assert unit_cell("my_star") is cell
    assert len(tile("my star", 5.0, 2, radius=0.2).edges) == 64


@pytest.mark.usefixtures("registry")
def test_a_second_cell_of_one_name_is_refused() -> None:
    with pytest.raises(OptionError, match="called 'bcc' exists already; need another name"):
        register_cell(UnitCell("BCC", np.concatenate([CORNERS, [[0.5, 0.5, 0.5]]]), STAR))


@pytest.mark.usefixtures("registry")
def test_a_node_without_its_copy_on_the_opposite_face_is_refused() -> None:
    lonely = UnitCell("lonely", np.array([[0.5, 0.5, 0], [0.5, 0.3, 1]]), np.array([[0, 1]]))
    with pytest.raises(SkeletonError, match=r"'lonely': node 1 at \[0.5, 0.3, 1.0\] .* to z; need"):
        register_cell(lonely)
    register_cell(lonely, periodic=False)
    assert tile("lonely", 1.0, (1, 1, 3), radius=0.1).component_count == 3


def test_a_strut_in_a_face_needs_one_in_the_opposite_face() -> None:
    cube = [[a, a | bit] for a in range(8) for bit in (1, 2, 4) if not a & bit]
    check_periodic(UnitCell("cube", CORNERS, np.array(cube)))
    for missing, where in (
        ([0, 1], r"\[0.0, 0.0, 0.0\] to \[0.0, 0.0, 1.0\]"),
        ([3, 7], r"\[0.0, 1.0, 1.0\] to \[1.0, 1.0, 1.0\]"),
    ):
        rest = np.array([pair for pair in cube if pair != missing])
        with pytest.raises(SkeletonError, match=f"'open': no strut from {where}; need one"):
            check_periodic(UnitCell("open", CORNERS, rest))


@pytest.mark.parametrize(
    ("nodes", "edges", "message"),
    [
        ([[0, 0, 0], [1, 1, 1.5]], [[0, 1]], r"node 1 is at \[1.0, 1.0, 1.5\]; need coordinates"),
        ([[0, 0, 0], [1, 1, 1]], [[0, 2]], r"edges\[0\] joins nodes \[0, 2\]; need 0 to 1"),
        ([[0, 0, 0], [1, 1, 1], [1, 0, 0]], [[0, 1]], r"node 2 at \[1, 0, 0\] mm has no edge"),
        ([[0, 0, 0], [1, 1, 1]], [[0, 1], [1, 0]], r"edges 0 and 1 near \[.*\] mm both join"),
        ([[0, 0, 0], [1, 1, 1]], np.zeros((0, 2), dtype=int), "no edges"),
    ],
)
def test_a_cell_that_is_no_graph_in_the_unit_cube_is_refused(
    nodes: list[list[float]], edges: list[list[int]], message: str
) -> None:
    with pytest.raises(SkeletonError, match=f"unit cell 'bad', as a cube of 1 mm: .*{message}"):
        UnitCell("bad", np.array(nodes), np.array(edges))


def test_a_cell_without_name_or_with_bad_proportions_is_refused() -> None:
    rod = (np.array([[0, 0, 0], [1, 1, 1]]), np.array([[0, 1]]))
    with pytest.raises(OptionError, match="name is ''; need a text"):
        UnitCell("", *rod)
    with pytest.raises(OptionError, match="name is 3; need a text"):
        UnitCell(3, *rod)  # type: ignore[arg-type]
    with pytest.raises(OptionError, match=r"proportions of unit cell 'rod' = \[1.0, 0.0, 1.0\]"):
        UnitCell("rod", *rod, proportions=np.array([1.0, 0.0, 1.0]))


def test_the_arrays_of_a_cell_cannot_be_changed() -> None:
    cell = unit_cell("bcc")
    for array in (cell.nodes, cell.edges, cell.proportions):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
