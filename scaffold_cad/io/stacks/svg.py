"""SVG drawings of layers: a group per layer, and in it one path with all polygons, in mm.

Groups carry their height as Slic3r's drawings do, and are layers in Inkscape.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scaffold_cad.io._rows import Columns, decimal, rows_of
from scaffold_cad.io.stacks.precision import DECIMALS
from scaffold_cad.layers import Layer, Layers


def write_svg(layers: Layers, path: Path) -> None:
    """Write layers as a drawing with y upward."""
    (x, y), (far_x, far_y) = layers.box.tolist()
    wide, high = far_x - x, far_y - y
    with path.open("wb") as file:
        file.write(
            '<?xml version="1.0" encoding="UTF-8"?>\n'
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide:.6f}mm" height="{high:.6f}mm" '
            f'viewBox="{x:.6f} {-far_y:.6f} {wide:.6f} {high:.6f}" '
            'xmlns:slic3r="http://slic3r.org/namespaces/slic3r" '
            'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape">\n'.encode()
        )
        for number, layer in enumerate(layers):
            file.write(
                f'<g id="layer{number}" slic3r:z="{layer.top:.6f}" inkscape:groupmode="layer">'
                '<path fill-rule="evenodd" d="'.encode()
            )
            file.write(_path(layer))
            file.write(b'"/></g>\n')
        file.write(b"</svg>\n")


def _path(layer: Layer) -> bytes:
    """Return the polygons of a layer as the data of a path; y is downward there."""
    if len(layer.points) == 0:
        return b""
    starts: Columns = np.full((len(layer.points), 1), ord("L"), dtype=np.uint8)
    starts[layer.offsets[:-1]] = ord("M")
    ends: Columns = np.zeros((len(layer.points), 1), dtype=np.uint8)
    ends[layer.offsets[1:] - 1] = ord("Z")
    x, y = decimal(layer.points[:, 0], DECIMALS), decimal(-layer.points[:, 1], DECIMALS)
    return rows_of(starts, x, b" ", y, ends)
