"""Layers of a tile's own struts as a file, and the layers of all tiles read from these.

A file holds the polygons of what is solid, united, and of what is taken out of hollow struts, from
the lowest layer up. What two tiles have reaches a little into each other, as the parts of the whole
do, so that the layers of all tiles united are those of the whole.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints
from scaffold_cad.layers.layer import Layer, Layers
from scaffold_cad.layers.loops import Loops
from scaffold_cad.layers.regions import Region
from scaffold_cad.layers.slicing import ENOUGH
from scaffold_cad.layers.struts import Own, sections_of
from scaffold_cad.layers.uniting import Solid
from scaffold_cad.struts import round_struts
from scaffold_cad.tiles.tile import Tile

HEAD = 4096
"""Bytes of the first line of a file."""


@dataclass(frozen=True)
class Planes:
    """Planes in the middle of layers: number k is at `bottom` + (k + 1/2) `thickness`, mm."""

    bottom: float
    thickness: float

    def heights(self, numbers: Ints) -> Floats:
        """Return the heights of planes (n,), mm."""
        return np.asarray(self.bottom + self.thickness * (numbers + 0.5), dtype=np.float64)

    def numbers(self, heights: Floats) -> Ints:
        """Return the planes that are at some heights (n,)."""
        found: Ints = np.rint((heights - self.bottom) / self.thickness - 0.5).astype(np.intp)
        return found

    def within(self, low: float, high: float) -> Ints:
        """Return the planes between two heights, (n,)."""
        if not low < high:
            return np.zeros(0, dtype=np.intp)
        first = int(np.floor((low - self.bottom) / self.thickness))
        last = int(np.ceil((high - self.bottom) / self.thickness))
        numbers = np.arange(first, last + 1)
        heights = self.heights(numbers)
        return numbers[(heights >= low) & (heights <= high)]

    def layers(self, low: float, high: float) -> Ints:
        """Return the planes of all layers of what reaches from `low` to `high`, (n,)."""
        first = np.floor((low - self.bottom) / self.thickness + ENOUGH)
        last = np.ceil((high - self.bottom) / self.thickness - ENOUGH)
        return np.arange(int(first), max(int(last), int(first)))


@dataclass(frozen=True)
class _Head:
    """What the first line of a file says."""

    first: int
    """Number of its lowest plane."""
    counts: tuple[int, ...]
    """Of the layers, of all polygons and all corners outside, and of these inside."""
    bounds: tuple[float, float] | None
    """Lowest and highest point, mm; None where there is nothing."""
    box: tuple[tuple[float, float], tuple[float, float]] | None
    """Lowest and highest corner of a box around all polygons, mm."""
    hollow: bool


def sliced(tile: Tile, planes: Planes, options: dict[str, object], sides: int) -> bytes:
    """Return the polygons of a tile's own round struts and nodes as the content of a file.

    Parameters
    ----------
    options : of `round_struts`, in place of those of the whole
    sides : of the polygons that stand for circles, a multiple of 4
    """
    struts = round_struts(tile.skeleton, **{**tile.strut_options, **options})
    own = Own(tile.own_runs(struts.runs.run_of_edge), tile.own_nodes)
    outside, inside = sections_of(struts, sides, own)
    low, high = outside.bounds
    numbers = planes.within(low, high)
    heights = planes.heights(numbers)
    parts = [list(Solid(outside).layers(heights, planes.thickness))]
    parts.append([] if inside is None else list(Solid(inside).layers(heights, planes.thickness)))
    arrays = [array for layers in parts for array in _arrays(layers, len(numbers))]
    counts = len(numbers), *(len(arrays[k]) for k in (1, 2, 4, 5))
    some = low < high
    box = outside.box.tolist() if some else None
    head = _Head(
        int(numbers[0]) if len(numbers) else 0,
        counts,
        (low, high) if some else None,
        box,
        inside is not None,
    )
    text = json.dumps(asdict(head)).encode()
    return text.ljust(HEAD - 1) + b"\n" + b"".join(array.tobytes() for array in arrays)


def _arrays(layers: list[Layer], count: int) -> list[np.ndarray]:
    """Return how many polygons `count` layers have, how many corners these, and the corners."""
    polygons = np.array([len(layer.offsets) - 1 for layer in layers] or np.zeros(count), "<i8")
    none = [np.zeros(0, dtype=np.intp)]
    corners = np.concatenate([*none, *(np.diff(layer.offsets) for layer in layers)])
    points = np.concatenate([np.zeros((0, 2)), *(layer.points for layer in layers)])
    return [polygons, corners.astype("<i8"), points.astype("<f8")]


@dataclass(frozen=True)
class _Polygons:
    """Where polygons of a tile are in its file."""

    path: Path
    first: int
    """Number of the lowest plane."""
    before: Ints
    """Polygons before each layer and before the end, shape (layers + 1,)."""
    at: int
    """Where the numbers of corners are in the file, in bytes."""
    starts: Ints
    """Corners before each layer and before the end, shape (layers + 1,)."""

    @property
    def end(self) -> int:
        """Number of the plane after the highest."""
        return self.first + len(self.before) - 1

    def loops(self, first: int, last: int, start: int) -> Loops | None:
        """Return the polygons at planes from `first` to `last`, of which `start` is level 0."""
        low, high = max(first, self.first), min(last + 1, self.end)
        if low >= high:
            return None
        a, b = self.before[[low - self.first, high - self.first]].tolist()
        p, q = self.starts[[low - self.first, high - self.first]].tolist()
        with self.path.open("rb") as file:
            file.seek(self.at + 8 * a)
            corners = np.frombuffer(file.read(8 * (b - a)), "<i8").astype(np.intp)
            file.seek(self.at + 8 * int(self.before[-1]) + 16 * p)
            points = np.frombuffer(file.read(16 * (q - p)), "<f8").reshape(-1, 2)
        layers = np.diff(self.before[low - self.first : high - self.first + 1])
        levels = np.repeat(np.arange(low, high) - start, layers)
        return Loops(points, np.concatenate([[0], np.cumsum(corners)]), levels)


class TileSections:
    """The polygons of all tiles, as parts of the whole; at each height those of that plane."""

    def __init__(self, files: list[_Polygons], planes: Planes, bounds: Floats, box: Floats) -> None:
        """Take files, and what is around all of them, (2,) and (2, 2), mm."""
        self._files, self._planes = files, planes
        self.bounds: tuple[float, float] = (float(bounds[0]), float(bounds[1]))
        """Lowest and highest point, mm."""
        self.box = box
        """Lowest and highest corner of a box that holds all polygons, shape (2, 2), mm."""
        self._first = min((file.first for file in files), default=0)
        end = max((file.end for file in files), default=0)
        self._counts = np.zeros(end - self._first, dtype=np.intp)
        for file in files:
            some = slice(file.first - self._first, file.end - self._first)
            self._counts[some] += np.diff(file.before)

    def count(self, heights: Floats) -> Ints:
        """Return how many polygons there are at each height, shape (h,)."""
        place = self._planes.numbers(heights) - self._first
        inside = (place >= 0) & (place < len(self._counts))
        counts = np.zeros(len(place), dtype=np.intp)
        counts[inside] = self._counts[place[inside]]
        return counts

    def loops(self, heights: Floats) -> list[Loops]:
        """Return the polygons at ascending heights (h,) that follow each other."""
        numbers = self._planes.numbers(heights)
        first, last = int(numbers[0]), int(numbers[-1])
        found = (file.loops(first, last, first) for file in self._files)
        some = [loops for loops in found if loops is not None]
        return some or [Loops(np.zeros((0, 2)), np.zeros(1, np.intp), np.zeros(0, np.intp))]


def joined_layers(paths: Sequence[Path], planes: Planes, region: Region | None) -> Layers:
    """Return the layers of all tiles, cut to a region, each made when it is asked for."""
    outside: list[_Polygons] = []
    inside: list[_Polygons] = []
    bounds = np.array([np.inf, -np.inf])
    box = np.array([[np.inf] * 2, [-np.inf] * 2])
    is_hollow = False
    for path in paths:
        with path.open("rb") as file:
            head = _Head(**json.loads(file.read(HEAD)))
            if head.bounds is None or head.box is None:
                continue
            layers, *sizes = head.counts
            at = HEAD
            for found, (polygons, corners) in zip(
                (outside, inside), (sizes[:2], sizes[2:]), strict=True
            ):
                file.seek(at)
                before = _running(np.frombuffer(file.read(8 * layers), "<i8"))
                counts = _running(np.frombuffer(file.read(8 * polygons), "<i8"))
                found.append(_Polygons(path, head.first, before, at + 8 * layers, counts[before]))
                at += 8 * layers + 8 * polygons + 16 * corners
        low, high = head.bounds
        bounds = np.array([min(bounds[0], low), max(bounds[1], high)])
        box = np.stack([np.minimum(box[0], head.box[0]), np.maximum(box[1], head.box[1])])
        is_hollow |= head.hollow
    whole = TileSections(outside, planes, bounds, box)
    hollow = TileSections(inside, planes, bounds, box) if is_hollow else None
    solid = Solid(whole, hollow)
    step = planes.thickness
    bounds_of_all = solid.bounds if region is None else region.bounds(solid)
    heights = planes.heights(planes.layers(*bounds_of_all) if outside else np.zeros(0, np.intp))
    if region is None:
        return Layers(solid.layers(heights, step), heights, step, box)
    return Layers(region.layers(solid, heights, step), heights, step, region.box(solid))


def _running(counts: np.ndarray) -> Ints:
    """Return the sum of the numbers (n,) before each and of all, (n + 1,)."""
    return np.concatenate([[0], np.cumsum(counts)]).astype(np.intp)
