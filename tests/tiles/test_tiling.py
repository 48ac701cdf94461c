"""Tiles own each strut once, and what they own is in them as in the whole, to the last bit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from scaffold_cad import (
    PeriodicLattice,
    Skeleton,
    UnitCell,
    build_scaffold,
    cells,
    delaunay_foam,
    round_struts,
    voronoi_foam,
)
from scaffold_cad.errors import OptionError
from scaffold_cad.struts import RoundStruts
from scaffold_cad.struts.meshes.surface import triangulated
from scaffold_cad.tiles import LatticeTiles, SkeletonTiles, Tile, tiles
from scaffold_cad.tiles.surfaces import round_triangles

CHAIN = UnitCell.of_net("chain", [[0.2, 0.5, 0.5]], [[0, 0], [0, 0]], [[1, 0, 0], [2, 1, -1]])
"""A net whose struts reach two cells on."""
PILLARS = UnitCell("pillars", [[0.5, 0.5, 0], [0.5, 0.5, 0.4], [0.5, 0.5, 1]], [[0, 1], [1, 2]])
"""Branches that are as long as the whole lattice."""

BOX = [[0, 0, 0], [30, 30, 30]]
FOAMS = {
    "Voronoi 1": lambda: voronoi_foam(80, BOX, 0.3, seed=1),
    "Voronoi 2": lambda: voronoi_foam(80, BOX, 0.3, seed=2),
    "Voronoi 3": lambda: voronoi_foam(80, BOX, 0.3, seed=3),
    "Delaunay 4": lambda: delaunay_foam(12, BOX, 0.2, seed=4),
}


def name_of(cell: str | UnitCell) -> str:
    return cell if isinstance(cell, str) else cell.name


def test_tiles_of_a_lattice_own_each_strut_once() -> None:
    lattice = PeriodicLattice("octet", 4.0, (5, 3, 4), radius=0.3)
    assert owned(tiles(lattice, block=(2, 2, 3))) == ends_of(lattice.skeleton())


@pytest.mark.parametrize("cell", [CHAIN, PILLARS], ids=lambda cell: cell.name)
def test_tiles_of_cells_with_long_struts_own_each_strut_once(cell: UnitCell) -> None:
    lattice = PeriodicLattice(cell, 4.0, (5, 3, 6), radius=0.2)
    assert owned(tiles(lattice, block=2)) == ends_of(lattice.skeleton())


def test_tiles_of_a_skeleton_own_each_strut_once() -> None:
    foam = FOAMS["Voronoi 1"]()
    parts = tiles(foam, block=(11, 12, 16))
    assert 2 * 2 < len(parts) <= 3 * 3 * 2  # blocks without a strut are not tiles
    assert owned(parts) == ends_of(foam)


def test_a_tile_of_a_huge_lattice_is_made_alone() -> None:
    parts = tiles(PeriodicLattice("bcc", 1.0, 500, radius=0.1), block=10)
    assert len(parts) == 125_000
    assert parts[60_025].own.sum() == 8 * 10**3


def owned(parts: LatticeTiles | SkeletonTiles) -> list[tuple[tuple[float, ...], ...]]:
    return sorted(strut for tile in parts for strut in ends_of(tile.skeleton.with_edges(tile.own)))


def ends_of(skeleton: Skeleton) -> list[tuple[tuple[float, ...], ...]]:
    """Return the ends of all struts to the last bit, in an order of their own."""
    ends = skeleton.nodes[skeleton.edges].tolist()
    return sorted(tuple(sorted(tuple(end) for end in strut)) for strut in ends)


@pytest.mark.parametrize("collars", [False, True])
@pytest.mark.parametrize("cell", [*cells(), CHAIN, PILLARS], ids=name_of)
def test_own_quads_are_those_of_the_whole_lattice(cell: str | UnitCell, collars: bool) -> None:
    lattice = PeriodicLattice(cell, 8.0, (3, 3, 1), radius=0.3)
    check_quads(tiles(lattice, block=(2, 2, 1)), lattice.skeleton(), collars)


@pytest.mark.parametrize("collars", [False, True])
@pytest.mark.parametrize("foam", FOAMS)
def test_own_quads_are_those_of_the_whole_foam(foam: str, collars: bool) -> None:
    skeleton = FOAMS[foam]()
    check_quads(tiles(skeleton, block=11.0), skeleton, collars)


def test_own_quads_of_bent_branches_are_those_of_the_whole() -> None:
    turns = np.linspace(0, 9, 60)
    helix = np.column_stack([8 * np.cos(turns), 8 * np.sin(turns), 3 * turns])
    arms = np.array([[20.0, 0, 0], [8, 0, -9], [-20, 5, 30]])
    links = [[k, k + 1] for k in range(59)] + [[0, 60], [0, 61], [30, 62]]
    skeleton = Skeleton(np.vstack([helix, arms]), links, 1.0)
    for collars in (False, True):
        check_quads(tiles(skeleton, block=7.0), skeleton, collars)


def check_quads(parts: Sequence[Tile] | Any, whole: Skeleton, collars: bool) -> None:
    wanted = build_scaffold(whole, collars=collars)
    corners = wanted.mesh.vertices[wanted.mesh.quads]
    found = []
    for tile in parts:
        scaffold = build_scaffold(tile.skeleton, collars=collars)
        own = tile.own[scaffold.edge_of_quad]
        found.append(scaffold.mesh.vertices[scaffold.mesh.quads[own]])
    np.testing.assert_array_equal(in_order(np.concatenate(found)), in_order(corners))


def in_order(polygons: np.ndarray) -> np.ndarray:
    """Return polygons (k, c, 3) in an order of their own, their bits untouched."""
    rows = np.ascontiguousarray(polygons).reshape(len(polygons), -1)
    return np.sort(rows.view(np.dtype((np.void, rows.itemsize * rows.shape[1]))).reshape(-1))


QUICK = [name for name, cell in cells().items() if max(cell.valencies) <= 6]
"""Cells whose blends are made soon; `python -m tests.validation.tiles` takes them all."""


@pytest.mark.parametrize("cell", QUICK)
def test_own_round_nodes_are_those_of_the_whole_lattice(cell: str) -> None:
    lattice = PeriodicLattice(cell, 8.0, (2, 2, 1), radius=0.25)
    check_nodes(tiles(lattice, block=1), lattice.skeleton())


def test_own_round_nodes_are_those_of_the_whole_foam() -> None:
    foam = voronoi_foam(8, BOX, 0.3, seed=6)
    check_nodes(tiles(foam, block=20.0), foam)


def check_nodes(parts: Sequence[Tile] | Any, whole: Skeleton) -> None:
    """Check the blends of two tiles' own nodes, and all they are made of."""
    struts = round_struts(whole)
    wanted = dict(blends_of(struts, np.ones(len(whole.nodes), dtype=np.bool_)))
    compared = 0
    for tile in (parts[0], parts[len(parts) // 2]):
        made = round_struts(tile.skeleton)
        for place, blend in blends_of(made, tile.own_nodes):
            compared += 1
            for one, other in zip(blend, wanted[place], strict=True):
                np.testing.assert_array_equal(one, other)
        assert struts.crowded.any() or not made.crowded[tile.own_nodes].any()
    assert compared > 0


def blends_of(struts: RoundStruts, chosen: np.ndarray) -> list[tuple[Any, ...]]:
    """Return the place of each chosen node that has a blend, and control points and collars."""
    found = []
    for group in struts.blended:
        for node, shape in zip(group.nodes.tolist(), group.shape_of.tolist(), strict=True):
            made = group.shapes
            parts = (made.control, made.collar_distances, made.collar_corners, made.rho)
            if chosen[node]:
                place = tuple(struts.skeleton.nodes[node].tolist())
                found.append((place, tuple(part[shape] for part in parts)))
    return found


@pytest.mark.parametrize(
    "options", [{}, {"ends": "round"}, {"wall": 0.1, "ends": "open"}], ids=["flat", "round", "open"]
)
def test_own_triangles_of_round_struts_are_those_of_the_whole(options: dict[str, Any]) -> None:
    lattice = PeriodicLattice("kelvin", 8.0, (3, 2, 1), radius=0.3)
    mesh = triangulated(round_struts(lattice.skeleton(), **options), 8).mesh
    wanted = mesh.vertices.astype(np.float32)[mesh.triangles]
    parts = tiles(lattice, block=1)
    found = np.concatenate([round_triangles(tile, options, 8) for tile in parts])
    np.testing.assert_array_equal(in_order(found), in_order(wanted))


def test_what_cannot_be_cut_is_refused() -> None:
    lattice = PeriodicLattice("bcc", 8.0, 2, radius=0.3)
    with pytest.raises(OptionError, match=r"got 3\.0; need a Skeleton or a PeriodicLattice"):
        tiles(3.0, block=1)  # type: ignore[arg-type]
    with pytest.raises(OptionError, match=r"counts are 0\.5; need three whole numbers"):
        tiles(lattice, block=0.5)
    with pytest.raises(OptionError, match="block size in mm"):
        tiles(lattice.skeleton(), block=-1.0)
    with pytest.raises(IndexError, match="tile 8 of 8; need 0 to 7"):
        tiles(lattice, block=1)[8]
