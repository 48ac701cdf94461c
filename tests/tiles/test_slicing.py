"""Layers of tiles, joined, are those of the whole."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from scaffold_cad import (
    Layer,
    PeriodicLattice,
    Skeleton,
    TriangleMesh,
    read_skeleton,
    round_struts,
    slices,
    tile,
    voronoi_foam,
    write_layers,
)
from scaffold_cad.errors import OptionError
from scaffold_cad.layers.regions import Region
from scaffold_cad.layers.uniting import united
from scaffold_cad.tiles import LatticeTiles, SkeletonTiles, Slice, run_tiles, tiles
from scaffold_cad.tiles.slicing import Planes, joined_layers

TREE = "examples/skeletons/tree.json"
THICK = tile("bcc", 4.0, (2, 1, 1), radius=0.95)
"""Its nodes are crowded."""


def check_equal(found: Layer, wanted: Layer) -> None:
    assert found.height == wanted.height
    assert len(found.loops) == len(wanted.loops)
    assert found.area == pytest.approx(wanted.area, abs=1e-6)
    first, second = united(found.loops), united(wanted.loops)
    assert ((first - second) + (second - first)).area() < 1e-5


def check_layers(
    parts: SkeletonTiles | LatticeTiles, whole: Skeleton, folder: Path, **options: Any
) -> None:
    wanted = slices(round_struts(whole, **options), thickness=0.31, sides=12)
    bottom = float(wanted.heights[0]) - 0.31 / 2
    work = Slice(thickness=0.31, bottom=bottom, sides=12, options=options)
    manifest = run_tiles(parts, work, folder)
    assert len(manifest.files) > 1
    found = joined_layers(
        [folder / file.name for file in manifest.files], Planes(bottom, 0.31), None
    )
    np.testing.assert_array_equal(found.heights, wanted.heights)
    np.testing.assert_allclose(found.box, wanted.box, atol=1e-9)
    for one, other in zip(found, wanted, strict=True):
        check_equal(one, other)


@pytest.mark.parametrize(
    "options", [{}, {"blend": 0.4, "ends": "round"}, {"wall": 0.15, "ends": "open"}]
)
def test_layers_of_a_lattice_by_tiles_are_those_of_the_whole(
    options: dict[str, Any], tmp_path: Path
) -> None:
    lattice = PeriodicLattice("bcc", 5.0, (3, 2, 2), radius=0.4, origin=[1, 2, -3.0])
    check_layers(tiles(lattice, block=(1, 2, 1)), lattice.skeleton(), tmp_path, **options)


def test_layers_of_skeletons_by_tiles_are_those_of_the_whole(tmp_path: Path) -> None:
    foam = voronoi_foam(12, [[0, 0, 0], [16, 16, 16]], 0.4, seed=5)
    check_layers(tiles(foam, block=9.0), foam, tmp_path / "foam")
    tree = read_skeleton(TREE, radius=1.0)
    check_layers(tiles(tree, block=8.0), tree, tmp_path / "tree")


def test_fillets_of_crowded_nodes_are_those_of_the_whole(tmp_path: Path) -> None:
    assert round_struts(THICK).crowded.any()
    check_layers(tiles(THICK, block=4.0), THICK, tmp_path)


def test_a_file_of_all_layers_is_that_of_the_whole(tmp_path: Path) -> None:
    lattice = PeriodicLattice("diamond", 5.0, 2, radius=0.4, blend=0.3)
    layers = slices(lattice, thickness=0.5)
    work = Slice(thickness=0.5, bottom=float(layers.heights[0]) - 0.25, text=True)
    made = run_tiles(tiles(lattice, block=1), work, tmp_path / "cube")
    made.joined(work, tmp_path / "tiles.cli")
    made.joined(work, tmp_path / "again.cli")
    assert (tmp_path / "tiles.cli").read_bytes() == (tmp_path / "again.cli").read_bytes()
    write_layers(layers, tmp_path / "whole.cli", text=True, label="cube")
    found, wanted = (
        (tmp_path / f"{name}.cli").read_text("ascii").splitlines() for name in ("tiles", "whole")
    )
    assert len(found) == len(wanted)
    heads = ("$$LABEL", "$$LAYER", "$$DIMENSION", "$$UNITS")
    for name in heads:
        assert [line for line in found if line.startswith(name)] == [
            line for line in wanted if line.startswith(name)
        ]


@pytest.mark.parametrize("skin", [None, 0.7])
def test_layers_are_cut_to_a_body_with_its_wall(skin: float | None, tmp_path: Path) -> None:
    lattice = PeriodicLattice("bcc", 5.0, 3, radius=0.5)
    ball = trimesh.creation.icosphere(subdivisions=3, radius=6.0)
    body = TriangleMesh(ball.vertices + 7.3, ball.faces)
    whole = slices(lattice, thickness=0.25, region=body, skin=skin)
    bottom = float(whole.heights[0]) - 0.125
    work = Slice(thickness=0.25, bottom=bottom, region=body, skin=skin)
    manifest = run_tiles(tiles(lattice, block=2), work, tmp_path / "parts")
    manifest.joined(work, tmp_path / "tiles.cli")
    found = joined_layers(
        [tmp_path / "parts" / file.name for file in manifest.files],
        Planes(bottom, 0.25),
        Region(body, skin),
    )
    np.testing.assert_allclose(found.heights, whole.heights)
    areas = [[layer.area for layer in layers] for layers in (found, whole)]
    np.testing.assert_allclose(*areas, atol=1e-5)


def test_options_are_looked_at_before_any_work() -> None:
    with pytest.raises(OptionError, match="thickness is 0"):
        Slice(thickness=0.0)
    with pytest.raises(OptionError, match="sides is 6; need a multiple of 4"):
        Slice(thickness=0.1, sides=6)
    with pytest.raises(OptionError, match="skin is given without a region"):
        Slice(thickness=0.1, skin=1.0)
