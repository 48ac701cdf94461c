"""VTK XML files of skeletons: lines with the radii of nodes and of members."""

from __future__ import annotations

import base64
from pathlib import Path

import numpy as np

from scaffold_cad.io.content import Content
from scaffold_cad.io.register import register_writer

LINE = 3
"""VTK's number of a straight line."""


@register_writer(".vtu", name="VTK XML", solids=False, radii="nodes and means")
def write_vtu(content: Content, path: Path) -> None:
    """Write a Skeleton as lines, mm; nodes exact to the last bit.

    Point data ``radius`` are the radii of nodes, cell data ``radius`` the mean radii of members.
    """
    skeleton = content.skeleton("a .vtu file")
    count = len(skeleton.edges)
    of_points = _array("Float64", "radius", skeleton.radii)
    of_cells = _array("Float64", "radius", skeleton.edge_radii.mean(axis=1))
    ends = _array("Int64", "offsets", 2 * np.arange(1, count + 1))
    types = _array("UInt8", "types", np.full(count, LINE, dtype=np.uint8))
    path.write_text(
        '<?xml version="1.0"?>\n'
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
        f'header_type="UInt64">\n<!-- scaffold_cad, unit: {content.unit} -->\n<UnstructuredGrid>\n'
        f'<Piece NumberOfPoints="{len(skeleton.nodes)}" NumberOfCells="{count}">\n'
        f"<PointData>{of_points}</PointData>\n<CellData>{of_cells}</CellData>\n"
        f"<Points>{_array('Float64', 'Points', skeleton.nodes, 3)}</Points>\n"
        f"<Cells>{_array('Int64', 'connectivity', skeleton.edges)}{ends}{types}</Cells>\n"
        "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n",
        encoding="ascii",
    )


def _array(kind: str, name: str, values: np.ndarray, width: int = 1) -> str:
    """Return an array in base64, after the number of its bytes."""
    dtype = {"Float64": "<f8", "Int64": "<i8", "UInt8": "u1"}[kind]
    data = np.ascontiguousarray(values, dtype=dtype).tobytes()
    header = np.array([len(data)], dtype="<u8").tobytes()
    return (
        f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{width}" format="binary">'
        f"{base64.b64encode(header + data).decode('ascii')}</DataArray>"
    )
