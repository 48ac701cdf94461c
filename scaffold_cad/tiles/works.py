"""What can be done with a tile: its surface built, its struts checked or loaded, each as a file.

A work is a frozen dataclass, so that it can be sent to another process and told apart from others
by its fields. It makes the content of a tile's file, and puts the files of all tiles together.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol, get_args

import numpy as np

from scaffold_cad.base.arguments import as_flag, as_number, as_real, check_choice, checks_keywords
from scaffold_cad.base.backends import need
from scaffold_cad.errors import OptionError
from scaffold_cad.io.stacks import write_layers
from scaffold_cad.io.stl import facets_of, join_stl
from scaffold_cad.layers.regions import Region, closed
from scaffold_cad.printability.gaps import free_ends, narrow_gaps
from scaffold_cad.printability.processes import process_named
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.solid.rounds import SIDES, check_sides
from scaffold_cad.tiles.slicing import Planes, joined_layers, sliced
from scaffold_cad.tiles.surfaces import (
    TileOverlaps,
    overlapping_struts,
    round_triangles,
    square_triangles,
)
from scaffold_cad.tiles.tile import Tile


class Work(Protocol):
    """What is done with each tile."""

    @property
    def suffix(self) -> str:
        """Of the tiles' files."""

    def made(self, tile: Tile) -> bytes:
        """Return the content of a tile's file; the same tile gives the same bytes."""

    def join(self, files: Iterable[Path], path: Path) -> None:
        """Put the files of all tiles, in their order, together in one."""


@checks_keywords()
@dataclass(frozen=True)
class Build:
    """The surface of all struts as one STL file: the triangles that the whole has."""

    round: bool = False
    """Whether struts are round, with blends, or square."""
    options: dict[str, Any] = field(default_factory=dict)
    """Of `round_struts`, in place of those of a lattice, or of `build_scaffold`."""
    sides: int = SIDES
    """Of the polygons that stand for the circles of round struts, a multiple of 4."""
    overlaps: TileOverlaps = "refuse"
    """What becomes of struts that overlap, which tiles do not unite: "refuse" them, or "allow"
    faces that cross, which slicers unite."""

    suffix = ".stl"

    def __post_init__(self) -> None:
        as_flag(self.round, "round")
        check_choice(self.overlaps, "overlaps", get_args(TileOverlaps))
        check_sides(self.sides)

    def made(self, tile: Tile) -> bytes:
        """Return a binary STL file of the tile's own triangles, open where others go on."""
        if self.round:
            return facets_of(round_triangles(tile, self.options, self.sides, self.overlaps))
        return facets_of(square_triangles(tile, self.options, self.overlaps))

    def join(self, files: Iterable[Path], path: Path) -> None:
        """Write the triangles of all tiles as one STL file."""
        join_stl(files, path)


@checks_keywords()
@dataclass(frozen=True)
class Slice:
    """The layers of all round struts as one file: those that `slices` cuts of the whole.

    Layers are equal but for some 1e-8 mm where struts of two tiles meet.
    """

    thickness: float
    """Of a layer, mm."""
    bottom: float = 0.0
    """Height where a layer begins, mm; those of the whole begin at its lowest point."""
    options: dict[str, Any] = field(default_factory=dict)
    """Of `round_struts`, in place of those of a lattice."""
    sides: int = SIDES
    """Of the polygons that stand for circles, a multiple of 4."""
    text: bool = False
    """Whether a .cli file is one of text."""
    pixel: float | None = None
    """Side of the pixels of a .zip file, mm."""
    region: Any = None
    """A closed body that the layers are cut to when they are joined."""
    skin: float | None = None
    """Thickness of a wall inside its surface, which is solid too, mm."""

    suffix = ".layers"

    def __post_init__(self) -> None:
        as_number(self.thickness, "thickness")
        as_real(self.bottom, "bottom")
        if self.skin is not None and self.region is None:
            raise OptionError("skin is given without a region; need one")
        check_sides(self.sides)

    def made(self, tile: Tile) -> bytes:
        """Return the polygons of the tile's own struts, layer by layer."""
        need("manifold3d", "layers")
        return sliced(tile, Planes(self.bottom, self.thickness), self.options, self.sides)

    def join(self, files: Iterable[Path], path: Path) -> None:
        """Write the layers of all tiles as one file, see `write_layers`."""
        places = list(files)
        region = None if self.region is None else Region(closed(self.region), self.skin)
        layers = joined_layers(places, Planes(self.bottom, self.thickness), region)
        # The file's own name is one for the time being.
        label = places[0].parent.name if path.suffix.lower() == ".cli" else None
        write_layers(layers, path, text=self.text, pixel=self.pixel, label=label)


@checks_keywords()
@dataclass(frozen=True)
class Check:
    """Checks of struts for a printing process: thickness, slenderness, gaps, overlaps.

    Struts have the radii asked for: no mesh is made in which they could be measured.
    """

    process: str = "sls"
    """A name in `PROCESSES`."""
    options: dict[str, Any] = field(default_factory=dict)
    """Of `build_scaffold`, by which struts are found that overlap."""

    suffix = ".json"

    def __post_init__(self) -> None:
        process_named(self.process)

    def made(self, tile: Tile) -> bytes:
        """Return numbers and extremes of the tile's own struts, as JSON."""
        process, skeleton = process_named(self.process), tile.skeleton
        thickness = 2.0 * skeleton.edge_radii.min(axis=1)  # (m,)
        slenderness = skeleton.lengths / thickness
        gaps = narrow_gaps(skeleton, process.least_gap, free_ends(skeleton))
        # A pair belongs to the tile of its first strut.
        widths = gaps.widths[tile.own[np.minimum(gaps.first, gaps.second)]]
        overlapping = overlapping_struts(build_scaffold(skeleton, **self.options))
        own = tile.own
        thin = thickness[own] < process.least_diameter * (1 - 1e-9)
        slender = slenderness[own] > process.greatest_slenderness
        found = {
            "struts": int(own.sum()),
            "thin": int(thin.sum()),
            "slender": int(slender.sum()),
            "narrow_gaps": int((widths > 0).sum()),
            "touching": int((widths <= 0).sum()),
            "overlapping": int(overlapping[own].sum()),
            "least_diameter_mm": float(thickness[own].min()),
            "greatest_slenderness": float(slenderness[own].max()),
            "least_gap_mm": float(widths[widths > 0].min()) if (widths > 0).any() else None,
        }
        return _json(found)

    def join(self, files: Iterable[Path], path: Path) -> None:
        """Write numbers and extremes of all struts, as JSON."""
        rows = [json.loads(file.read_text("utf-8")) for file in files]
        joined: dict[str, Any] = {"process": self.process}
        for name in rows[0]:
            values = [row[name] for row in rows if row[name] is not None]
            if name.startswith("least"):
                joined[name] = min(values, default=None)
            else:
                joined[name] = max(values) if name.startswith("greatest") else sum(values)
        joined["printable"] = joined["thin"] == 0
        path.write_bytes(_json(joined))


def _json(found: dict[str, Any]) -> bytes:
    return (json.dumps(found, indent=1, allow_nan=False) + "\n").encode()
