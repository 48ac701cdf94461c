"""3MF slice stacks: the polygons of each layer, written one after another into the archive.

The object has a box for its mesh, and says that it is only a coarse stand-in for the slices.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scaffold_cad.errors import FormatError
from scaffold_cad.io._rows import Columns, decimal, rows_of, whole
from scaffold_cad.io.stacks.precision import DECIMALS
from scaffold_cad.io.threemf.model import CORE
from scaffold_cad.io.threemf.package import model_part
from scaffold_cad.layers import Layer, Layers

SLICES = "http://schemas.microsoft.com/3dmanufacturing/slice/2015/07"
"""Namespace of the Slice Extension."""

_HEAD = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    f'<model xmlns="{CORE}" xmlns:s="{SLICES}" unit="millimeter" xml:lang="en-US" '
    'requiredextensions="s">\n<resources>\n'
)

_BOX = "021 123 456 576 014 154 263 367 042 246 135 375"  # corners by x, y and z, x fastest
"""Triangles of a box."""


def write_slice_stack(layers: Layers, path: Path) -> None:
    """Write layers as one object.

    Raises
    ------
    FormatError
        If the layers have no thickness.
    """
    if not layers.thickness > 0:
        raise FormatError(
            "3MF slices need the thickness of the layers, which sections at heights do not have "
            "(slices(..., thickness=))"
        )
    bottom = float(layers.heights[0]) - layers.thickness / 2
    top = float(layers.heights[-1]) + layers.thickness / 2
    with model_part(path, _HEAD) as file:
        file.write(f'<s:slicestack id="1" zbottom="{bottom:.{DECIMALS}f}">\n'.encode())
        for layer in layers:
            file.write(f'<s:slice ztop="{layer.top:.{DECIMALS}f}">'.encode())
            file.write(_polygons(layer))
            file.write(b"</s:slice>\n")
        file.write(b"</s:slicestack>\n")
        file.write(_box(layers, bottom, top).encode())
        file.write(b'</resources>\n<build><item objectid="2"/></build>\n')


def _polygons(layer: Layer) -> bytes:
    """Return the corners of a layer and which of them each polygon joins."""
    count = len(layer.points)
    if count == 0:
        return b""
    x, y = (decimal(layer.points[:, axis], DECIMALS) for axis in (0, 1))
    corners = rows_of(b'<s:vertex x="', x, b'" y="', y, b'"/>')
    # Each corner is the end of a segment from the one before; the first begins and ends a polygon.
    after = np.arange(1, count + 1)
    after[layer.offsets[1:] - 1] = layer.offsets[:-1]
    start = b'<s:polygon startv="'
    starts: Columns = np.zeros((count, len(start)), dtype=np.uint8)
    first = layer.offsets[:-1]
    starts[first] = np.frombuffer(start, dtype=np.uint8)
    numbers = whole(np.arange(count))
    named: Columns = np.zeros((count, numbers.shape[1] + 2), dtype=np.uint8)
    named[first, :-2] = numbers[first]
    named[first, -2:] = np.frombuffer(b'">', dtype=np.uint8)
    end = b"</s:polygon>"
    ends: Columns = np.zeros((count, len(end)), dtype=np.uint8)
    ends[layer.offsets[1:] - 1] = np.frombuffer(end, dtype=np.uint8)
    segments = rows_of(starts, named, b'<s:segment v2="', whole(after), b'"/>', ends)
    return b"<s:vertices>" + corners + b"</s:vertices>" + segments


def _box(layers: Layers, bottom: float, top: float) -> str:
    """Return the object, with the box around all layers for its mesh."""
    (x, y), (far_x, far_y) = layers.box.tolist()
    vertices = "".join(
        f'<vertex x="{a:.6f}" y="{b:.6f}" z="{c:.6f}"/>'
        for c in (bottom, top)
        for b in (y, far_y)
        for a in (x, far_x)
    )
    triangles = "".join(
        f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in map(tuple, _BOX.split())
    )
    return (
        '<object id="2" type="model" s:slicestackid="1" s:meshresolution="lowres"><mesh>'
        f"<vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh></object>\n"
    )
