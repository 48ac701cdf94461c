"""Tiles: work on lattices too large for one process, each tile as it is in the whole."""

from scaffold_cad.tiles.strength import LoadCase, Stiffness, Strength
from scaffold_cad.tiles.tasks import Manifest, TileFile, run_tiles
from scaffold_cad.tiles.tile import Tile
from scaffold_cad.tiles.tiling import LatticeTiles, SkeletonTiles, tiles
from scaffold_cad.tiles.works import Build, Check, Slice, Work

__all__ = [
    "Build",
    "Check",
    "LatticeTiles",
    "LoadCase",
    "Manifest",
    "SkeletonTiles",
    "Slice",
    "Stiffness",
    "Strength",
    "Tile",
    "TileFile",
    "Work",
    "run_tiles",
    "tiles",
]
