"""3MF files of one surface, written as text: readers get the coordinates that were checked.

lib3mf multiplies coordinates by a power of ten in single precision before it writes them, which
puts many of them one step of 32 bits off.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scaffold_cad.base.arrays import Triangles
from scaffold_cad.base.blocks import blocks
from scaffold_cad.base.positions import in_single_precision
from scaffold_cad.io._rows import rows_of, whole
from scaffold_cad.io.threemf.model import CORE
from scaffold_cad.io.threemf.package import model_part, vertex_rows
from scaffold_cad.mesh.trianglemesh import TriangleMesh

DIGITS = 11
"""Digits behind the first one of the greatest coordinate: those of 32-bit numbers, and four more
for coordinates that are smaller."""

MOST_DECIMALS = 16
"""Of a number with fewer than 64 bits in units of the last place."""

ROW_BYTES = 280
"""Bytes taken per vertex or triangle while its row is made."""

_HEAD = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    f'<model xmlns="{CORE}" unit="millimeter" xml:lang="en-US">\n<resources>\n'
)


def write_3mf(mesh: TriangleMesh, path: Path) -> None:
    """Write `mesh` with its 32-bit coordinates; the same mesh always gives the same bytes."""
    vertices = in_single_precision(mesh.vertices)
    decimals = _decimals(float(np.abs(vertices).max(initial=0.0)))
    with model_part(path, _HEAD) as file:
        file.write(b'<object id="1" type="model"><mesh>\n<vertices>\n')
        for part in blocks(len(vertices), ROW_BYTES):
            file.write(vertex_rows(vertices[part], decimals))
        file.write(b"</vertices>\n<triangles>\n")
        for part in blocks(len(mesh.triangles), ROW_BYTES):
            file.write(_triangles(mesh.triangles[part]))
        file.write(b"</triangles></mesh></object>\n</resources>\n")
        file.write(b'<build><item objectid="1"/></build>\n')


def _decimals(extent: float) -> int:
    return int(np.clip(DIGITS - np.floor(np.log10(max(extent, 1e-9))), 0, MOST_DECIMALS))


def _triangles(triangles: Triangles) -> bytes:
    one, two, three = (whole(triangles[:, corner]) for corner in range(3))
    return rows_of(b'<triangle v1="', one, b'" v2="', two, b'" v3="', three, b'"/>\n')
