"""Images of layers: black-and-white PNG files in a ZIP archive, all of one size."""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterator
from pathlib import Path
from struct import pack
from zipfile import ZIP_STORED, ZipFile, ZipInfo

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.base.arrays import Bools, Floats, Ints
from scaffold_cad.base.ranges import ranges
from scaffold_cad.errors import OptionError
from scaffold_cad.io.stacks.precision import DECIMALS
from scaffold_cad.layers import Layer, Layers

BAND = 2**22
"""Pixels that are worked on together."""

MOST_PIXELS = 2**34
"""Most pixels of an image: half a meter each way at 4 µm."""

LONGEST = 2**31 - 1
"""Most pixels along a side of a PNG image."""

PACKING = 1
"""Level of compression: images of layers are mostly runs of one color."""


def write_images(layers: Layers, path: Path, pixel: float) -> None:
    """Write an image a layer, and what they show.

    Raises
    ------
    OptionError
        If there are too many pixels for an image.
    """
    low, high = layers.box
    sides = np.maximum(np.ceil((high - low) / pixel), 1)
    wide, tall = (high - low).tolist()
    if sides.prod() > MOST_PIXELS or sides.max() > LONGEST:
        least = pixel * max(float((sides.prod() / MOST_PIXELS) ** 0.5), sides.max() / LONGEST)
        raise OptionError(
            f"pixel is {pixel:g} mm, which makes images of {sides[0]:.3g} x {sides[1]:.3g} pixels "
            f"for layers of {wide:.4g} x {tall:.4g} mm; need {1.01 * least:.2g} mm or more"
        )
    columns, rows = int(sides[0]), int(sides[1])
    files, tops = [], []
    with ZipFile(path, "w", ZIP_STORED) as archive:
        for number, layer in enumerate(layers):
            files.append(f"layer{number:05d}.png")
            tops.append(round(layer.top, DECIMALS))
            with archive.open(ZipInfo(files[-1]), "w", force_zip64=True) as file:
                for part in png(raster(layer, low, pixel, columns, rows), columns, rows):
                    file.write(part)
        about = {
            "pixel_mm": pixel,
            "columns": columns,
            "rows": rows,
            "lower_left_mm": low.tolist(),
            "layer_thickness_mm": layers.thickness,
            "tops_mm": tops,
            "files": files,
        }
        archive.writestr(ZipInfo("layers.json"), json.dumps(about, indent=1) + "\n")


def raster(layer: Layer, low: Floats, pixel: float, columns: int, rows: int) -> Iterator[Bools]:
    """Yield rows of pixels, the uppermost first, a few at a time, each (r, columns).

    A pixel is set where a line from its center to the left crosses an odd number of sides.

    Parameters
    ----------
    low : lower left corner of the image, shape (2,), mm
    """
    places = (layer.points - low) / pixel - 0.5  # in pixels from the center of the lowest left one
    after = np.arange(1, len(places) + 1)
    after[layer.offsets[1:] - 1] = layer.offsets[:-1]
    row, column = _crossings(places, places[after], columns, rows)
    order = np.argsort(-row, kind="stable")
    row, column = row[order], column[order]
    band = max(1, BAND // columns)
    for top in range(rows - 1, -1, -band):
        count = min(band, top + 1)
        some = slice(*np.searchsorted(-row, [-top, -top + count]).tolist())
        toggles: NDArray[np.uint8] = np.zeros((count, columns + 1), dtype=np.uint8)
        np.add.at(toggles, (top - row[some], column[some]), np.uint8(1))
        inside = np.cumsum(toggles[:, :-1], axis=1, dtype=np.uint8) & 1
        yield inside.astype(np.bool_)


def _crossings(start: Floats, end: Floats, columns: int, rows: int) -> tuple[Ints, Ints]:
    """Return where sides cross the middles of rows: the row, and the first column to the right."""
    low, high = np.minimum(start[:, 1], end[:, 1]), np.maximum(start[:, 1], end[:, 1])
    first = np.clip(np.ceil(low), 0, rows).astype(np.intp)
    last = np.clip(np.ceil(high), 0, rows).astype(np.intp)
    side = np.repeat(np.arange(len(first)), last - first)
    row = ranges(first, last - first)
    span = end[side] - start[side]
    x = start[side, 0] + (row - start[side, 1]) / span[:, 1] * span[:, 0]
    return row, np.clip(np.ceil(x), 0, columns).astype(np.intp)


def png(bands: Iterator[Bools], columns: int, rows: int) -> Iterator[bytes]:
    """Yield a PNG image of one bit a pixel, white where pixels are set (PNG 1.2)."""
    yield b"\x89PNG\r\n\x1a\n"
    yield _chunk(b"IHDR", pack(">IIBBBBB", columns, rows, 1, 0, 0, 0, 0))
    packer = zlib.compressobj(PACKING)
    for band in bands:
        bits = np.packbits(band, axis=1)
        lines = np.zeros((len(band), bits.shape[1] + 1), dtype=np.uint8)  # filter 0 of each row
        lines[:, 1:] = bits
        packed = packer.compress(lines.tobytes())
        if packed:
            yield _chunk(b"IDAT", packed)
    yield _chunk(b"IDAT", packer.flush())
    yield _chunk(b"IEND", b"")


def _chunk(kind: bytes, data: bytes) -> bytes:
    return pack(">I", len(data)) + kind + data + pack(">I", zlib.crc32(kind + data))
