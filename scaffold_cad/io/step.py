"""STEP files (ISO 10303-21, AP214) of Bézier meshes, written straight from their arrays.

The entities are those that OCCT writes for the B-rep of `to_brep`, without curves in parameters,
in a tenth of the time: every table of entities is formatted at once, and no B-rep is made.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import TextIO, TypeAlias

import numpy as np

from scaffold_cad import brep
from scaffold_cad.base.arrays import Bools, Floats, Ints
from scaffold_cad.base.vectors import normalize
from scaffold_cad.brep.beziermesh import BezierMesh, side_indices
from scaffold_cad.io._cad import read_cad_triangles, read_cad_wires
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io.content import Content
from scaffold_cad.io.register import register_mesh_reader, register_reader, register_writer
from scaffold_cad.mesh.shells import check_solid, quads_of_shells
from scaffold_cad.mesh.trianglemesh import TriangleMesh

STEP_SUFFIXES = (".step", ".stp")

CHUNK = 8192
"""Rows of a table that are formatted at once: bounds the memory that their texts take."""

REFERENCES_PER_LINE = 16
"""References on a line of a long list."""

HEADER = """\
ISO-10303-21;
HEADER;
FILE_DESCRIPTION(('{name}'),'2;1');
FILE_NAME('{name}','{time}',(''),(''),'scaffold_cad','scaffold_cad','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));
ENDSEC;
DATA;
#1=APPLICATION_CONTEXT('core data for automotive mechanical design processes');
#2=APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#1);
#3=PRODUCT_CONTEXT('',#1,'mechanical');
#4=PRODUCT('{name}','{name}','',(#3));
#5=PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#4));
#6=PRODUCT_DEFINITION_FORMATION('','',#4);
#7=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');
#8=PRODUCT_DEFINITION('design','',#6,#7);
#9=PRODUCT_DEFINITION_SHAPE('','',#8);
#10=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#11=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#12=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());
#13=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),#10,'distance_accuracy_value',\
'confusion accuracy');
#14=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#13))\
GLOBAL_UNIT_ASSIGNED_CONTEXT((#10,#11,#12))REPRESENTATION_CONTEXT('',''));
#15=CARTESIAN_POINT('',(0.,0.,0.));
#16=DIRECTION('',(0.,0.,1.));
#17=DIRECTION('',(1.,0.,0.));
#18=AXIS2_PLACEMENT_3D('',#15,#16,#17);
"""
HEADER_ENTITIES = 18
PRODUCT_SHAPE, CONTEXT, PLACEMENT = 9, 14, 18  # entities of the header that others refer to

POINT = "CARTESIAN_POINT('',(%s,%s,%s))"
DIRECTION = "DIRECTION('',(%s,%s,%s))"


@register_writer(*STEP_SUFFIXES, name="STEP", names_unit=True)
def write_step_content(content: Content, path: Path) -> None:
    """Write a build123d shape by OCCT, and meshes of quads straight from their arrays."""
    patches = content.patches()
    if patches is None or content.write_pcurves:
        brep.export_step(content.shape(), path, write_pcurves=content.write_pcurves)
        return
    check_solid(patches.mesh)
    brep.check_sizes(patches)
    write_step(patches, path, name=content.name, face_names=content.face_names())


@register_mesh_reader("STEP", *STEP_SUFFIXES, names_unit=True)
def read_step_triangles(path: Path) -> TriangleMesh:
    """Read the solids of a STEP file as triangles within 0.01 mm; none if it holds wires only."""
    return read_cad_triangles(path)


def _recognises(head: bytes) -> bool:
    return head.lstrip().startswith(b"ISO-10303-21")


@register_reader("STEP", *STEP_SUFFIXES, recognises=_recognises)
def read_step_wires(path: Path) -> RawSkeleton:
    """Read the edges and wires of a STEP file that bound no face; it has no radii.

    Curves become edges within 1/1000 of their size, and join where they have equal points.
    """
    return read_cad_wires(path)


def write_step(
    patches: BezierMesh, path: Path, *, name: str, face_names: Sequence[str] | None = None
) -> None:
    """Write a solid for each shell of `patches`, in mm.

    Parameters
    ----------
    patches : closed and outward, as `check_solid` asks
    path : of the file
    name : of the product
    face_names : of the quads' faces; empty by default
    """
    time = datetime.now().replace(microsecond=0).isoformat()
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write(HEADER.format(name=_escaped(name), time=time))
        tables = _Tables(file)
        faces = _write_faces(tables, patches, face_names)
        shells = [
            tables.add_list("CLOSED_SHELL('',", faces[quads], ")")
            for quads in quads_of_shells(patches.mesh)
        ]
        solids = tables.add("MANIFOLD_SOLID_BREP('',#%d)", np.asarray(shells))
        shape = tables.add_list(
            "ADVANCED_BREP_SHAPE_REPRESENTATION('',",
            np.append(PLACEMENT, solids),
            f",#{CONTEXT})",
        )
        tables.add(f"SHAPE_DEFINITION_REPRESENTATION(#{PRODUCT_SHAPE},#%d)", np.asarray([shape]))
        file.write("ENDSEC;\nEND-ISO-10303-21;\n")


@dataclass(frozen=True, eq=False)
class _PointNumbers:
    """The numbers of the CARTESIAN_POINT entities."""

    vertices: Ints
    """Those of the vertices, shape (v,)."""
    edges: Ints
    """Those of the control points of each edge from its lower vertex on, shape (e, d + 1)."""
    patches: Ints
    """Those of the control points of each patch, shape (f, d + 1, d + 1)."""


def _write_faces(tables: _Tables, patches: BezierMesh, face_names: Sequence[str] | None) -> Ints:
    """Write the faces and all that they are made of; return their numbers, shape (f,)."""
    points = _write_points(tables, patches)
    edges = _write_edges(tables, patches, points)
    senses = np.where(patches.runs_forward.reshape(-1), "T", "F").tolist()
    uses = tables.add(
        "ORIENTED_EDGE('',*,*,#%d,.%s.)", edges[patches.mesh.edge_of_half_edge], senses
    )
    loops = tables.add("EDGE_LOOP('',(#%d,#%d,#%d,#%d))", *uses.reshape(-1, 4).T)
    bounds = tables.add("FACE_OUTER_BOUND('',#%d,.T.)", loops)
    surfaces = _write_surfaces(tables, patches, points)
    names = [""] * len(bounds) if face_names is None else [_escaped(name) for name in face_names]
    return tables.add("ADVANCED_FACE('%s',(#%d),#%d,.T.)", names, bounds, surfaces)


def _write_points(tables: _Tables, patches: BezierMesh) -> _PointNumbers:
    """Write the vertices' positions and the control points inside edges and patches."""
    mesh, order = patches.mesh, patches.degree + 1
    vertices = tables.add(POINT, *_columns(mesh.vertices))
    inner = tables.add(POINT, *_columns(patches.edge_control_points[:, 1:-1]))
    low, high = vertices[mesh.edges].T[:, :, None]
    edges = np.hstack([low, inner.reshape(len(mesh.edges), order - 2), high])  # (e, d + 1)

    grid = np.zeros((len(mesh.quads), order, order), dtype=np.intp)
    inside = tables.add(POINT, *_columns(patches.control_points[:, 1:-1, 1:-1]))
    grid[:, 1:-1, 1:-1] = inside.reshape(len(mesh.quads), order - 2, order - 2)
    rows = edges[mesh.edge_of_half_edge].reshape(-1, 4, order)
    rows = np.where(patches.runs_forward[:, :, None], rows, rows[:, :, ::-1])
    grid.reshape(-1, order**2)[:, side_indices(patches.degree)] = rows
    return _PointNumbers(vertices, edges, grid)


def _write_edges(tables: _Tables, patches: BezierMesh, points: _PointNumbers) -> Ints:
    """Write the edges from lower to higher vertex; return their numbers, shape (e,)."""
    if patches.degree == 1:
        ends = patches.edge_control_points
        directions = tables.add(DIRECTION, *_columns(normalize(ends[:, 1] - ends[:, 0])))
        vectors = tables.add("VECTOR('',#%d,1.)", directions)
        curves = tables.add("LINE('',#%d,#%d)", points.edges[:, 0], vectors)
    else:
        order = patches.degree + 1
        curves = tables.add(
            f"B_SPLINE_CURVE_WITH_KNOTS('',{patches.degree},({_references(order)}),"
            f".UNSPECIFIED.,.F.,.F.,({order},{order}),(0.,1.),.PIECEWISE_BEZIER_KNOTS.)",
            *points.edges.T,
        )
    vertices = tables.add("VERTEX_POINT('',#%d)", points.vertices)
    low, high = vertices[patches.mesh.edges].T
    return tables.add("EDGE_CURVE('',#%d,#%d,#%d,.T.)", low, high, curves)


def _write_surfaces(tables: _Tables, patches: BezierMesh, points: _PointNumbers) -> Ints:
    """Write a plane for each flat patch and a B-spline for the rest; return their numbers (f,)."""
    order = patches.degree + 1
    flat: Bools = np.asarray(patches.plane_normals.any(axis=1))
    numbers = np.empty(len(flat), dtype=np.intp)

    corners = points.patches[:, 0, 0]
    sides = patches.control_points[:, 1, 0] - patches.control_points[:, 0, 0]
    normals = tables.add(DIRECTION, *_columns(patches.plane_normals[flat]))
    along = tables.add(DIRECTION, *_columns(normalize(sides[flat])))
    axes = tables.add("AXIS2_PLACEMENT_3D('',#%d,#%d,#%d)", corners[flat], normals, along)
    numbers[flat] = tables.add("PLANE('',#%d)", axes)

    grid = ",".join([f"({_references(order)})"] * order)
    numbers[~flat] = tables.add(
        f"B_SPLINE_SURFACE_WITH_KNOTS('',{patches.degree},{patches.degree},({grid}),"
        f".UNSPECIFIED.,.F.,.F.,.F.,({order},{order}),({order},{order}),(0.,1.),(0.,1.),"
        ".PIECEWISE_BEZIER_KNOTS.)",
        *points.patches[~flat].reshape(-1, order**2).T,
    )
    return numbers


Column: TypeAlias = Ints | Floats | list[str]
"""References, real numbers or texts, one a row."""


@dataclass
class _Tables:
    """A file being written, entity after entity."""

    file: TextIO
    count: int = HEADER_ENTITIES
    """Number of entities written so far, which is the number of the last one."""

    def add(self, template: str, *columns: Column) -> Ints:
        """Write an entity for each row of `columns`, (n,) each; return their numbers, (n,)."""
        numbers = np.arange(len(columns[0])) + self.count + 1
        width = len(columns) + 1
        for start in range(0, len(numbers), CHUNK):
            chunk = slice(start, start + CHUNK)
            rows = len(numbers[chunk])
            cells: list[object] = [None] * (rows * width)
            for i, column in enumerate((numbers, *columns)):
                cells[i::width] = _cells(column[chunk])
            self.file.write(f"#%d={template};\n" * rows % tuple(cells))
        self.count += len(numbers)
        return numbers

    def add_list(self, before: str, members: Ints, after: str) -> int:
        """Write one entity around the list of `members`; return its number."""
        texts = [f"#{member}" for member in members.tolist()]
        rows = range(0, len(texts), REFERENCES_PER_LINE)
        body = ",\n".join(",".join(texts[i : i + REFERENCES_PER_LINE]) for i in rows)
        self.count += 1
        self.file.write(f"#{self.count}={before}({body}){after};\n")
        return self.count


def _references(count: int) -> str:
    return ",".join(["#%d"] * count)


def _columns(points: Floats) -> Floats:
    """Return the x, y and z of `points` (..., 3), shape (3, n)."""
    return points.reshape(-1, 3).T


def _cells(column: Column) -> Sequence[object]:
    """Return what a template takes: whole numbers as such, and real ones as text."""
    if isinstance(column, list):
        return column
    if column.dtype == np.float64:
        return _real_texts(np.asarray(column, dtype=np.float64))
    numbers: list[int] = column.tolist()
    return numbers


def _real_texts(values: Floats) -> list[str]:
    """Return the shortest decimals that give `values` (n,) back; STEP asks for a point in each."""
    texts = list(map(repr, values.tolist()))
    size = np.abs(values)
    for i in np.flatnonzero((size > 0) & (size < 1e-4) | (size >= 1e16)).tolist():
        texts[i] = f"{values[i]:.16E}"
    return texts


def _escaped(text: str) -> str:
    """Return `text` as a string of ISO 10303-21, which is ASCII."""
    return "".join(map(_escaped_character, text))


def _escaped_character(character: str) -> str:
    code = ord(character)
    if character in "'\\":
        return 2 * character
    if " " <= character <= "~":
        return character
    return f"\\X2\\{code:04X}\\X0\\" if code < 0x10000 else f"\\X4\\{code:08X}\\X0\\"
