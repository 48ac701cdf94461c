"""Common Layer Interface 2.0: polylines layer by layer, as binary numbers or as text, in mm.

Polylines are closed: their last point is the first. Around what is solid they run
counter-clockwise, direction 1; holes run clockwise, direction 0. The height of a layer is that of
its upper side.
"""

from __future__ import annotations

from pathlib import Path
from struct import pack

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints
from scaffold_cad.io._rows import Columns, decimal, rows_of, whole
from scaffold_cad.io.stacks.precision import DECIMALS
from scaffold_cad.layers import Layer, Layers

LAYER, POLYLINE = 127, 130
"""Commands of binary files: a layer, a polyline; with long numbers."""

PART = 1
"""Identifier of the one part."""


def write_cli(layers: Layers, path: Path, name: str, text: bool) -> None:
    """Write layers of a part called `name`."""
    with path.open("wb") as file:
        file.write(_header(layers, name, text))
        for layer in layers:
            file.write(_text(layer) if text else _binary(layer))
        if text:
            file.write(b"$$GEOMETRYEND\n")


def _header(layers: Layers, name: str, text: bool) -> bytes:
    """Return the header; of a binary file the first layer follows it directly."""
    (x, y), (far_x, far_y) = layers.box.tolist()
    half = layers.thickness / 2
    low, high = float(layers.heights[0]) - half, float(layers.heights[-1]) + half
    plain = "".join(sign if sign.isascii() and sign not in '",/$' else "_" for sign in name)
    lines = [
        "$$HEADERSTART",
        "$$ASCII" if text else "$$BINARY",
        "$$UNITS/1.0",
        "$$VERSION/200",
        f"$$LABEL/{PART},{plain}",
        f"$$DIMENSION/{x:.6f},{y:.6f},{low:.6f},{far_x:.6f},{far_y:.6f},{high:.6f}",
        f"$$LAYERS/{len(layers)}",
        "$$HEADEREND",
    ]
    end = "\n$$GEOMETRYSTART\n" if text else ""
    return ("\n".join(lines) + end).encode("ascii")


def _closed(layer: Layer) -> tuple[Floats, Ints, Ints]:
    """Return the corners of polygons, each with its first one again (p + l, 2), and their counts.

    Returns
    -------
    The corners; how many each polygon has (l,); whether it runs counter-clockwise, 0 or 1, (l,)
    """
    counts = np.diff(layer.offsets)
    place = np.insert(np.arange(len(layer.points)), layer.offsets[1:], layer.offsets[:-1])
    return layer.points[place], counts + 1, (layer.areas > 0).astype(np.intp)


def _binary(layer: Layer) -> bytes:
    """Return a layer as binary commands: numbers of 16 and 32 bits, the lowest byte first."""
    points, counts, turns = _closed(layer)
    if len(counts) == 0:
        return pack("<Hf", LAYER, layer.top)
    # In words of 16 bits: command 1, identifier, direction and count 2 each, a corner 4.
    starts = np.cumsum(7 + 4 * counts) - (7 + 4 * counts)
    words = np.empty(int((7 + 4 * counts).sum()), dtype="<u2")
    words[starts] = POLYLINE
    numbers = np.stack([np.full_like(counts, PART), turns, counts], axis=1).astype("<i4")
    words[starts[:, None] + np.arange(1, 7)] = numbers.view("<u2")
    polygon = np.repeat(np.arange(len(counts)), counts)
    place = 7 * (polygon + 1) + 4 * np.arange(len(points))
    words[place[:, None] + np.arange(4)] = points.astype("<f4").view("<u2")
    return pack("<Hf", LAYER, layer.top) + words.tobytes()


def _text(layer: Layer) -> bytes:
    """Return a layer as text, a polyline a line."""
    start = f"$$LAYER/{layer.top:.{DECIMALS}f}\n".encode()
    points, counts, turns = _closed(layer)
    if len(counts) == 0:
        return start
    rows = np.cumsum(counts) - counts
    before = rows_of(b"$$POLYLINE/%d," % PART, whole(turns), b",", whole(counts), b"\n")
    words = before.split(b"\n")[:-1]
    width = max(map(len, words))
    heads: Columns = np.zeros((len(points), width), dtype=np.uint8)
    heads[rows] = np.frombuffer(
        b"".join(word.ljust(width, b"\0") for word in words), dtype=np.uint8
    ).reshape(-1, width)
    ends: Columns = np.zeros((len(points), 1), dtype=np.uint8)
    ends[rows + counts - 1] = ord("\n")
    x, y = (decimal(points[:, axis], DECIMALS) for axis in (0, 1))
    return start + rows_of(heads, b",", x, b",", y, ends)
