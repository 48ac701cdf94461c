"""A small valid file of every format that is read, most in several dialects."""

from __future__ import annotations

import base64
import io
import json
import struct
import zipfile
import zlib
from collections.abc import Callable

import ezdxf
import numpy as np

from scaffold_cad.io import skeleton_to_json
from tests.fuzz.members import MEMBERS
from tests.skeletons import ELBOW

POINTS = np.array([[0, 0, 0], [10, 0, 0], [10, 10, 0], [10, 10, 5]], dtype=np.float64)
"""Nodes of a path; all samples hold this or a part of a cube."""

OBJ = b"v 0 0 0\nv 10 0 0\nv 10 10 0\nv 10 10 5\nl 1 2 3\nl -2 -1\n"
RHINO = b"v 0 0 0\nv 10 0 0\ncstype bspline\ndeg 1\ncurv 0 1 1 2\nparm u 0 0 1 1\nend\n"
SWC = b"# neuron\n1 1 0 0 0 2.5 -1\n2 3 10 0 0 1.5 1\n3 3 10 10 0 1.25 2\n"
GEL = b"n 0 0 0\nn nan nan nan\nn 10 0 0\nn 10 10 0\nc 0 2\nc 2 3\n"
CGAL = b"3 0.5 0 0 10.5 0 0 10 10 0\n2 10 10 0 10 10 5\n"
TGF = b"a 0 0 0 1\nb 10, 0, 0 1.5\nc (10 10 0) 2\n#\na b strut\nb c\n"
CGD = b"""CRYSTAL
  NAME pcu
  GROUP P1
  CELL 5.0 5.0 5.0 90.0 90.0 90.0
  NODE 1 6  0 0 0
  EDGE  0 0 0   0 0 1
  EDGE  0 0 0   0 1 0
  EDGE  0 0 0   1 0 0
END
"""
XYZ = b"3 water\n1 O 0 0 0 1 2 3\n2 H 1 0 0 2 1\n3 H 0 1 0 2 1\n"
CJSON = (
    b'{"chemicalJson": 1, "atoms": {"coords": {"3d": [0, 0, 0, 1.5, 0, 0, 1.5, 1.5, 0]}},'
    b' "bonds": {"connections": {"index": [0, 1, 1, 2]}, "order": [1, 1]}}'
)
BVH = b"""HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Chest
  {
    OFFSET 0 10 0
    End Site
    {
      OFFSET 0 5 1
    }
  }
}
MOTION
Frames: 1
Frame Time: 0.03
0 0 0 0 0 0
"""
GXL = b"""<?xml version="1.0"?><!DOCTYPE gxl SYSTEM "http://www.gupro.de/GXL/gxl-1.0.dtd">
<gxl><graph id=" VascularTree">
<node id="n1"><attr name=" position"><tup><float>0</float><float> 0</float><float>0</float></tup>
</attr></node>
<node id="n2"><attr name=" position"><tup><float>10</float><float>0</float><float>1e0</float></tup>
</attr></node>
<edge id="e1" to="n2" from="n1"><attr name=" radius"><float>1.5</float></attr></edge>
</graph></gxl>
"""
OLD_FRAME = json.dumps(
    {
        "unit": "centimeter",
        "material_properties": {"cross_sec_area": 3.0, "cross_sec_area_unit": "millimeter^2"},
        "node_list": [{"point": {"X": x, "Y": y, "Z": z}} for x, y, z in POINTS.tolist()],
        "element_list": [{"end_node_ids": [k, k + 1]} for k in range(3)],
    }
).encode()
NEW_FRAME = json.dumps(
    {
        "unit": "meter",
        "nodes": [{"point": place, "node_ind": k} for k, place in enumerate(POINTS.tolist())],
        "elements": [{"end_node_inds": [k, k + 1], "elem_tag": "bar"} for k in range(3)],
        "cross_secs": [{"elem_tags": ["bar"], "A": 3e-6, "A_unit": "m2"}],
    }
).encode()

VTK_TEXT = b"""# vtk DataFile Version 3.0
a path
ASCII
DATASET POLYDATA
POINTS 4 float
0 0 0 10 0 0
10 10 0 10 10 5
LINES 2 7
3 0 1 2
2 2 3
POINT_DATA 4
SCALARS radius float 1
LOOKUP_TABLE default
1 1.5 2 1
"""
VTK_5 = b"""# vtk DataFile Version 5.1
a path
ASCII
DATASET POLYDATA
POINTS 3 double
0 0 0 10 0 0 10 10 0
METADATA
INFORMATION 0

LINES 2 3
OFFSETS vtktypeint64
0 3
CONNECTIVITY vtktypeint64
0 1 2
POINT_DATA 3
FIELD FieldData 1
MaximumInscribedSphereRadius 1 3 double
1 2 3
"""


def _vtk_binary() -> bytes:
    cells = struct.pack(">6i", 2, 0, 1, 2, 1, 2)
    return (
        b"# vtk DataFile Version 3.0\na path\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 float\n"
        + POINTS[:3].astype(">f4").tobytes()
        + b"\nCELLS 2 6\n"
        + cells
        + b"\nCELL_TYPES 2\n"
        + struct.pack(">2i", 3, 3)
        + b"\nPOINT_DATA 3\nSCALARS Radius float\nLOOKUP_TABLE default\n"
        + struct.pack(">3f", 1, 2, 1)
        + b"\n"
    )


def _vtp(encode: Callable[[np.ndarray], str], form: str, root: str = "", tail: str = "") -> bytes:
    """Return poly data whose arrays are encoded by `encode`, in their element or as an offset."""

    def array(kind: str, name: str, values: np.ndarray, width: int = 1) -> str:
        text = encode(values)
        where = f'offset="{text}"/>' if form == "appended" else f">{text}</DataArray>"
        return (
            f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{width}" '
            f'format="{form}" {where}'
        )

    points = array("Float64", "Points", POINTS, 3)
    links = array("Int64", "connectivity", np.array([0, 1, 2, 2, 3]))
    ends = array("Int64", "offsets", np.array([3, 5]))
    radii = array("Float64", "Radius", np.array([1.0, 1.5, 2.0, 1.0]))
    return (
        f'<?xml version="1.0"?><VTKFile type="PolyData" byte_order="LittleEndian" {root}><PolyData>'
        f'<Piece NumberOfPoints="4" NumberOfLines="2"><PointData>{radii}</PointData>'
        f"<Points>{points}</Points><Lines>{links}{ends}</Lines></Piece></PolyData>{tail}</VTKFile>"
    ).encode("latin-1")


def _text(values: np.ndarray) -> str:
    return " ".join(map(str, values.reshape(-1).tolist()))


def _base64(values: np.ndarray) -> str:
    return base64.b64encode(struct.pack("<I", values.nbytes) + values.tobytes()).decode()


def _packed(values: np.ndarray) -> str:
    block = zlib.compress(values.tobytes())
    header = struct.pack("<4I", 1, values.nbytes, values.nbytes, len(block))
    return (base64.b64encode(header) + base64.b64encode(block)).decode()


def _vtp_appended() -> bytes:
    parts: list[bytes] = []

    def offset(values: np.ndarray) -> str:
        at = sum(map(len, parts))
        parts.append(struct.pack("<I", values.nbytes) + values.tobytes())
        return str(at)

    before = _vtp(offset, "appended")
    tail = b'<AppendedData encoding="raw">_' + b"".join(parts) + b"</AppendedData>"
    return before.replace(b"</VTKFile>", tail + b"</VTKFile>")


VTU = b"""<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece NumberOfPoints="3">
<Points><DataArray type="Float32" format="ascii">0 0 0 9 0 0 9 9 0</DataArray></Points>
<Cells><DataArray type="Int32" Name="connectivity" format="ascii">0 1 0 1 2 1 2</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">2 5 7</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">3 5 3</DataArray></Cells>
</Piece></UnstructuredGrid></VTKFile>
"""

_ARM = {
    "asset": {"version": "2.0"},
    "skins": [{"joints": [1, 2, 3]}],
    "nodes": [
        {"children": [1, 4], "translation": [0, 0, 1]},
        {"children": [2], "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476]},
        {"children": [3], "translation": [0.01, 0, 0], "scale": [2, 2, 2]},
        {"matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.005, 0, 0, 1]},
        {"mesh": 0, "skin": 0},
    ],
}
GLTF = json.dumps(_ARM).encode()


def _glb() -> bytes:
    text = GLTF + b" " * (-len(GLTF) % 4)
    return struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text), len(text), b"JSON") + text


def _dxf(binary: bool) -> bytes:
    document = ezdxf.new("R2000", units=ezdxf.units.CM)
    space = document.modelspace()
    space.add_line((0, 0, 0), (1, 0, 0))
    space.add_polyline3d([(1, 0, 0), (1, 1, 0), (1, 1, 1)])
    space.add_lwpolyline([(0, 0, 0, 0, 0.5), (0, 1)], format="xyseb")
    if not binary:
        stream = io.StringIO()
        document.write(stream)
        return stream.getvalue().encode()
    buffer = io.BytesIO()
    document.write(buffer, fmt="bin")
    return buffer.getvalue()


DXF_R12 = b"0\nSECTION\n2\nENTITIES\n" + b"".join(
    b"0\nLINE\n8\n0\n10\n%d\n20\n%d\n30\n%d\n11\n%d\n21\n%d\n31\n%d\n" % (*a, *b)
    for a, b in zip(POINTS[:-1].astype(int).tolist(), POINTS[1:].astype(int).tolist(), strict=True)
)
DXF_R12 += b"0\nENDSEC\n0\nEOF\n"

OFF = b"OFF\n4 4 6\n0 0 0\n10 0 0\n0 10 0\n0 0 10\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"
_CORNERS = np.array([[0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 10]], dtype="<f4")
_FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


def _stl(binary: bool) -> bytes:
    if binary:
        facets = np.zeros(4, dtype=[("n", "<f4", 3), ("c", "<f4", (3, 3)), ("a", "<u2")])
        facets["c"] = _CORNERS[_FACES]
        return b"a tetrahedron".ljust(80) + struct.pack("<I", 4) + facets.tobytes()
    rows = ["solid tetrahedron"]
    for corners in _CORNERS[_FACES].tolist():
        rows += ["facet normal 0 0 0", "outer loop"]
        rows += ["vertex {} {} {}".format(*corner) for corner in corners]
        rows += ["endloop", "endfacet"]
    return "\n".join([*rows, "endsolid tetrahedron", ""]).encode()


PLY_EDGES = b"""ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element edge 2
property int vertex1
property int vertex2
end_header
0 0 0
10 0 0
10 10 0
0 1
1 2
"""


def _ply_faces() -> bytes:
    header = (
        b"ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\n"
        b"property float y\nproperty float z\nelement face 4\n"
        b"property list uchar int vertex_indices\nend_header\n"
    )
    rows = b"".join(struct.pack("<B3i", 3, *face) for face in _FACES.tolist())
    return header + _CORNERS.tobytes() + rows


def _3mf_model() -> bytes:
    core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    beams = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02"
    places = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in POINTS.tolist())
    return (
        f'<model unit="millimeter" xmlns="{core}" xmlns:b="{beams}"><resources><object id="1">'
        f"<mesh><vertices>{places}</vertices><triangles/>"
        '<b:beamlattice radius="1.5" minlength="0.1"><b:beams><b:beam v1="0" v2="1" r1="1"/>'
        '<b:beam v1="1" v2="2"/></b:beams></b:beamlattice></mesh></object>'
        '<object id="2"><components><component objectid="1" transform="1 0 0 0 1 0 0 0 1 9 9 9"/>'
        '</components></object></resources><build><item objectid="2"/></build></model>'
    ).encode()


def packed_3mf(model: bytes) -> bytes:
    """Return a 3MF file whose model part is `model`."""
    relations = "http://schemas.openxmlformats.org/package/2006/relationships"
    start = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(
            "_rels/.rels",
            f'<Relationships xmlns="{relations}"><Relationship Type="{start}" '
            'Target="/3D/3dmodel.model" Id="r"/></Relationships>',
        )
        archive.writestr("3D/3dmodel.model", model)
    return buffer.getvalue()


MODEL_3MF = _3mf_model()
"""What is packed in a 3MF file."""

SAMPLES: dict[str, bytes] = MEMBERS | {
    "lines.obj": OBJ,
    "rhino.obj": RHINO,
    "cell.wire": OBJ,
    "neuron.swc": SWC,
    "removed.graph": GEL,
    "path.cgal": CGAL,
    "path.polylines.txt": CGAL,
    "ours.json": skeleton_to_json(ELBOW).encode(),
    "old_frame.json": OLD_FRAME,
    "new_frame.json": NEW_FRAME,
    "path.tgf": TGF,
    "net.cgd": CGD,
    "water.xyz": XYZ,
    "water.txyz": XYZ,
    "molecule.cjson": CJSON,
    "mocap.bvh": BVH,
    "vessels.gxl": GXL,
    "text.vtk": VTK_TEXT,
    "version_5.vtk": VTK_5,
    "binary.vtk": _vtk_binary(),
    "text.vtp": _vtp(_text, "ascii"),
    "base64.vtp": _vtp(_base64, "binary"),
    "packed.vtp": _vtp(_packed, "binary", 'compressor="vtkZLibDataCompressor"'),
    "raw.vtp": _vtp_appended(),
    "cells.vtu": VTU,
    "arm.gltf": GLTF,
    "arm.glb": _glb(),
    "r12.dxf": DXF_R12,
    "r2000.dxf": _dxf(binary=False),
    "binary.dxf": _dxf(binary=True),
    "tetrahedron.off": OFF,
    "text.stl": _stl(binary=False),
    "binary.stl": _stl(binary=True),
    "edges.ply": PLY_EDGES,
    "faces.ply": _ply_faces(),
    "beams.3mf": packed_3mf(MODEL_3MF),
}
"""Content by file name."""
