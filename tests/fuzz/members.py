"""Small valid files of the formats of engineers, chemists and graph programs."""

from __future__ import annotations

import gzip
import json
import tempfile
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

CORNERS = np.array([[0, 0, 0], [10, 0, 0], [10, 10, 0]], dtype=np.float64)
"""Nodes of an elbow; most samples hold it."""

CSV_MEMBERS = b"x1,y1,z1,x2,y2,z2,radius\n0,0,0,10,0,0,0.5\n10,0,0,10,10,0,0.75\n"
CSV_GERMAN = b"x1;y1;z1;x2;y2;z2;diameter [cm]\n0;0;0;10,0;0;0;0,1\n10;0;0;10;1e1;0;0,15\n"
CSV_TABLES = (
    b"# a truss\nnode,x [m],y [m],z [m]\n1,0,0,0\n2,.01,0,0\n3,0.01,0.01,0\n\n"
    b"member,start,end,area (mm2)\n1,1,2,3.141592653589793\n2,2,3,3.141592653589793\n"
)
CSV_SAMPLES = b"x\ty\tz\tr\tbranch\n0\t0\t0\t1\ta\n10\t0\t0\t1.5\ta\n10\t10\t0\t2\ta\n"
CSV_TREE = b"id,x,y,z,radius,parent\n1,0,0,0,1,-1\n2,10,0,0,1.5,1\n3,10,10,0,2,2\n"

ABAQUS = b"""*HEADING
 an elbow
** a comment
*Node, nset=ALL
1, 0., 0., 0.
2, 10., 0., 0.
3, 10., 10., 0.
4, 10., 5., 0.
*Element, type=B31, elset=BEAMS
1, 1, 2
*ELEMENT, TYPE=B32
2, 2, 4, 3
*ELEMENT, TYPE=C3D4
9, 1, 2, 3, 4
*ELSET, ELSET=CURVED, GENERATE
2, 2, 1
*BEAM SECTION, ELSET=BEAMS, MATERIAL=M, SECTION=CIRC
0.5
0., 0., -1.
*BEAM GENERAL SECTION, ELSET=CURVED, SECTION=GENERAL
3.141592653589793, 1., 0., 1., 2.
*NSET, NSET=FEET
1, 4
*BOUNDARY
FEET, ENCASTRE
2, 2, 3, 0.5
*STEP
*CLOAD
3, 2, -100.
*END STEP
"""
ABAQUS_PARTS = b"""*Part, name=Bar
*Node
1, 0., 0.
2, 10., 0.
*Element, type=T3D2, elset=All
1, 1, 2
*Solid Section, elset=All, material=Steel
3.141592653589793,
*End Part
*Assembly, name=A
*Instance, name=I-1, part=Bar
*End Instance
*Instance, name=I-2, part=Bar
10., 0., 0.
10., 0., 0., 10., 0., 1., 90.
*End Instance
*Nset, nset=Tip, instance=I-2
 2,
*End Assembly
*Boundary
I-1.1, 1, 6
*Step
*Cload
Tip, 3, 1e2
*End Step
"""
NASTRAN = b"""SOL 101
CEND
BEGIN BULK
$ fields of eight
GRID    1               0.      0.      0.
GRID    2               1.+1    0.      0.
GRID*   3                               10.             10.
*       0.
CROD    1       21      1       2
CBAR    2       22      2       3       0.      0.      1.
PROD    21      22      .785398 0.
PBARL   22      22              ROD
        .75
ENDDATA
"""
NASTRAN_FREE = b"""SPC = 3
LOAD = 5
BEGIN BULK
GRID,1,,0.,0.,0.,,123
GRID,2,,10.,0.,0.
GRID,3,,10.,10.,0.
CONROD,1,1,2,9,3.14159
CTUBE,2,31,2,3
PTUBE,31,9,1.5,.1
SPC1,4,456,1,THRU,2
SPC,4,3,3,.5
SPCADD,3,4
FORCE,6,3,0,9.,1.,0.,0.
MOMENT,6,2,0,9.,0.,1.,0.
LOAD,5,1.,2.,6
ENDDATA
"""
GMSH = b"""$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
3
1 0 0 0
2 10 0 0
3 10 10 0
$EndNodes
$Elements
2
1 1 2 0 1 1 2
2 1 2 0 1 2 3
$EndElements
"""
GRAPHML = b"""<?xml version="1.0" encoding="UTF-8"?>
<graphml xmlns="http://graphml.graphdrawing.org/xmlns">
<key id="d0" for="node" attr.name="x" attr.type="double"/>
<key id="d1" for="node" attr.name="y" attr.type="double"/>
<key id="d2" for="node" attr.name="z" attr.type="double"/>
<key id="d3" for="edge" attr.name="Radius" attr.type="double"/>
<graph edgedefault="undirected">
<node id="a"><data key="d0">0</data><data key="d1">0</data><data key="d2">0</data></node>
<node id="b"><data key="d0">10</data><data key="d1">0</data><data key="d2">0</data></node>
<node id="c"><data key="d0">10</data><data key="d1">1e1</data><data key="d2">0</data></node>
<edge source="a" target="b"><data key="d3">0.5</data></edge>
<edge source="b" target="c"><data key="d3">0.75</data></edge>
</graph></graphml>
"""
GML = b"""# by networkx
graph [
  node [ id 0 label "0" pos 0 pos 0 pos 0.0 radius 1.0 ]
  node [ id 1 label "1" pos 10 pos 0 pos 0 radius 1.5 ]
  node [ id 2 label "2" graphics [ x 10 y 10 z 0 ] ]
  edge [ source 0 target 1 ]
  edge [ source 1 target 2 ]
]
"""
SVG = b"""<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 50 50">
<g transform="translate(5 0)"><path d="M0 0 L5 0 V5" fill="none" stroke="black"/></g>
<circle cx="20" cy="20" r="5"/></svg>
"""
MOL = b"""elbow
  test

  3  2  0  0  0  0  0  0  0  0999 V2000
    0.0000    0.0000    0.0000 C   0  0
    1.4000    0.0000    0.0000 C   0  0
    1.4000    1.4000    0.0000 O   0  0
  1  2  1  0
  2  3  1  0
M  END
"""
MOL_V3000 = b"""elbow
  test

  0  0  0     0  0            999 V3000
M  V30 BEGIN CTAB
M  V30 COUNTS 3 2 0 0 0
M  V30 BEGIN ATOM
M  V30 1 C 0 0 0 0
M  V30 2 C 1.4 0 0 0
M  V30 3 O 1.4 1.4 0 0
M  V30 END ATOM
M  V30 BEGIN BOND
M  V30 1 1 1 2
M  V30 2 1 2 3
M  V30 END BOND
M  V30 END CTAB
M  END
"""
MOL2 = b"""@<TRIPOS>MOLECULE
elbow
 3 2 0 0 0
SMALL
NO_CHARGES

@<TRIPOS>ATOM
1 C1 0 0 0 C.3 1 LIG 0
2 C2 1.4 0 0 C.3 1 LIG 0
3 O1 1.4 1.4 0 O.3 1 LIG 0
@<TRIPOS>BOND
1 1 2 1
2 2 3 ar
"""
_PDB_ATOMS = b"""HETATM    1  C1  LIG A   1       0.000   0.000   0.000  1.00  0.00           C
HETATM    2  C2  LIG A   1       1.400   0.000   0.000  1.00  0.00           C
HETATM    3  O1  LIG A   1       1.400   1.400   0.000  1.00  0.00           O
"""
PDB = _PDB_ATOMS + b"CONECT    1    2\nCONECT    2    1    3\nEND\n"
PDB_BARE = _PDB_ATOMS + b"END\n"
OPENSEES = b"""# an elbow
model BasicBuilder -ndm 3 -ndf 6
set A 3.14159; set height 10
node 1 0 0 0
node 2 10 0 0
node 3 10 $height \\
  0
element truss 1 1 2 $A 1
element elasticBeamColumn 2 2 3 $A 2e5 8e4 1 1 1 1
fix 1 1 1 1 1 1 1
pattern Plain 1 Linear { load 3 0 0 -9 0 0 0 }
sp 2 1 0.5
"""
TUBETK = b"""ObjectType = Scene
NDims = 3
NObjects = 2
ObjectType = Tube
NDims = 3
ID = 1
ParentPoint = -1
ElementSpacing = 2 2 2
PointDim = x y z r rn mn
NPoints = 2
Points =
0 0 0 0.5 0 0
5 0 0 0.75 0 0
ObjectType = Tube
NDims = 3
ID = 2
ParentID = 1
ParentPoint = 1
PointDim = x y z r
NPoints = 1
Points =
10 10 0 1
"""
SLICER = json.dumps(
    {
        "@schema": "markups-schema-v1.0.3.json#",
        "markups": [
            {
                "type": "Curve",
                "coordinateSystem": "LPS",
                "coordinateUnits": "mm",
                "controlPoints": [{"id": "1", "position": place} for place in CORNERS.tolist()],
                "measurements": [{"name": "Radius", "controlPointValues": [1, 1.5, 2]}],
            }
        ],
    }
).encode()
NML = b"""<?xml version="1.0"?><things><parameters><scale x="10" y="10" z="25"/></parameters>
<thing id="1"><nodes><node id="1" x="0" y="0" z="0" radius="500"/>
<node id="2" x="1000" y="0" z="0" radius="500"/><node id="3" x="1000" y="1000" z="0" radius="750"/>
</nodes><edges><edge source="1" target="2"/><edge source="2" target="3"/></edges></thing></things>
"""
NODE_LINK = json.dumps(
    {
        "directed": False,
        "multigraph": False,
        "graph": {},
        "nodes": [{"id": f"n{k}", "pos": place} for k, place in enumerate(CORNERS.tolist())],
        "links": [
            {"source": "n0", "target": "n1", "radius": 0.5},
            {"source": "n1", "target": "n2", "radius": 0.75},
        ],
    }
).encode()
COMPAS = json.dumps(
    {
        "dtype": "compas.datastructures/Graph",
        "data": {
            "node": {str(k): {"x": x, "y": y} for k, (x, y, _) in enumerate(CORNERS.tolist())},
            "edge": {"0": {"1": {}}, "1": {"2": {"radius": 0.5}}},
        },
    }
).encode()
POINTS_EDGES = json.dumps(
    {
        "unit": "cm",
        "Points": (CORNERS / 10).tolist(),
        "Lines": [[0, 1], [1, 2]],
        "areas": [0.0314159265, 0.0706858347],
    }
).encode()
PYSKELTON = b"""# by PySkelton
nodes
0 0 0
10 0 0
10 10 0
edges
0 1
arcs
1 2
radii
1
1.5
2
"""
TGF_LIBIGL = b"1 0 0 0 0.5 0.25 7\n2 10 0 0 0 1 7\n3 10 10 0 1 1 7\n#\n1 2 1 0 0\n2 3 1 0 0\n"
WIRE_2D = b"v 0 0\nv 10 0\nv 10 10\nl 1 2\nl 2 3\n"


def _by_meshio(kind: str, suffix: str, **options: Any) -> bytes:
    """Return the elbow as meshio writes it."""
    meshio = import_module("meshio")
    writer = import_module(f"meshio.{kind}")
    mesh = meshio.Mesh(CORNERS, [("line", np.array([[0, 1], [1, 2]]))])
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"elbow{suffix}"
        writer.write(path, mesh, **options)
        return path.read_bytes()


def _rhino() -> bytes:
    """Return the elbow as two curves of Rhino, in centimeters."""
    rhino3dm = import_module("rhino3dm")
    document = rhino3dm.File3dm()
    document.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Centimeters
    places = [rhino3dm.Point3d(*place) for place in (CORNERS / 10).tolist()]
    document.Objects.AddLine(places[0], places[1])
    curve = rhino3dm.NurbsCurve.Create(False, 1, places[1:])
    document.Objects.AddCurve(curve)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "elbow.3dm"
        document.Write(str(path), 7)
        return path.read_bytes()


CAD = ("wire.step", "wire.stp", "wire.stpz", "wire.brep", "wire.igs", "wire.iges")
"""Names of wires in CAD files."""

APART = (*CAD, "text.msh", "binary.msh", "elbow.med", "curves.3dm")
"""Names of files that libraries read, each in a process of its own, which takes a second."""


@cache
def sample_apart(name: str) -> bytes:
    """Return the elbow in a file of `APART`; the libraries are imported when it is asked for."""
    if name in CAD:
        return _cad()[name]
    if name == "curves.3dm":
        return _rhino()
    if name == "text.msh":
        return GMSH
    if name == "elbow.med":
        return _by_meshio("med", ".med")
    return _by_meshio("gmsh", ".msh", fmt_version="4.1", binary=True)


@cache
def _cad() -> dict[str, bytes]:
    """Return the elbow as wires, in files of CAD formats."""
    build123d = import_module("build123d")
    iges = import_module("OCP.IGESControl")
    wire = build123d.Polyline(*[tuple(place) for place in CORNERS.tolist()])
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / f"elbow.{suffix}" for suffix in ("step", "brep", "igs")]
        build123d.export_step(wire, paths[0])
        build123d.export_brep(wire, paths[1])
        writer = iges.IGESControl_Writer()
        writer.AddShape(wire.wrapped)
        writer.Write(str(paths[2]))
        step, brep, igs = (path.read_bytes() for path in paths)
    return {
        "wire.step": step,
        "wire.stp": step,
        "wire.stpz": gzip.compress(step, mtime=0),
        "wire.brep": brep,
        "wire.igs": igs,
        "wire.iges": igs,
    }


MEMBERS: dict[str, bytes] = {
    "members.csv": CSV_MEMBERS,
    "german.csv": CSV_GERMAN,
    "tables.csv": CSV_TABLES,
    "path.tsv": CSV_SAMPLES,
    "tree.csv": CSV_TREE,
    "beams.inp": ABAQUS,
    "parts.inp": ABAQUS_PARTS,
    "rods.bdf": NASTRAN,
    "rods.nas": NASTRAN,
    "free.dat": NASTRAN_FREE,
    "graph.graphml": GRAPHML,
    "graph.gml": GML,
    "drawing.svg": SVG,
    "elbow.mol": MOL,
    "elbow.sdf": MOL + b"$$$$\n",
    "extended.sd": MOL_V3000,
    "elbow.mol2": MOL2,
    "elbow.pdb": PDB,
    "bare.ent": PDB_BARE,
    "model.tcl": OPENSEES,
    "vessels.tre": TUBETK,
    "curve.mrk.json": SLICER,
    "neuron.nml": NML,
    "node_link.json": NODE_LINK,
    "compas.json": COMPAS,
    "points.json": POINTS_EDGES,
    "pyskelton.graph": PYSKELTON,
    "libigl.tgf": TGF_LIBIGL,
    "plane.wire": WIRE_2D,
}
"""Content by file name."""
