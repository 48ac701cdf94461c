"""STEP files of Bézier meshes, written straight from their arrays.

The entities are those that OCCT writes for the B-rep of `to_brep`, without curves in parameters,
in a tenth of the time: every table of entities is formatted at once, and no B-rep is made.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scaffold_cad.base.arrays import Bools, Ints
from scaffold_cad.base.vectors import normalize
from scaffold_cad.brep.beziermesh import BezierMesh, side_indices
from scaffold_cad.io.step.tables import (
    DIRECTION,
    POINT,
    Tables,
    columns,
    escaped,
    references,
    write_end,
    write_header,
)
from scaffold_cad.mesh.shells import quads_of_shells


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
    with path.open("w", encoding="ascii", newline="\n") as file:
        tables = write_header(file, name)
        faces = _write_faces(tables, patches, face_names)
        shells = [
            tables.add_list("CLOSED_SHELL('',", faces[quads], ")")
            for quads in quads_of_shells(patches.mesh)
        ]
        write_end(tables, tables.add("MANIFOLD_SOLID_BREP('',#%d)", np.asarray(shells)))


@dataclass(frozen=True, eq=False)
class _PointNumbers:
    """The numbers of the CARTESIAN_POINT entities."""

    vertices: Ints
    """Those of the vertices, shape (v,)."""
    edges: Ints
    """Those of the control points of each edge from its lower vertex on, shape (e, d + 1)."""
    patches: Ints
    """Those of the control points of each patch, shape (f, d + 1, d + 1)."""


def _write_faces(tables: Tables, patches: BezierMesh, face_names: Sequence[str] | None) -> Ints:
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
    names = [""] * len(bounds) if face_names is None else [escaped(name) for name in face_names]
    return tables.add("ADVANCED_FACE('%s',(#%d),#%d,.T.)", names, bounds, surfaces)


def _write_points(tables: Tables, patches: BezierMesh) -> _PointNumbers:
    """Write the vertices' positions and the control points inside edges and patches."""
    mesh, order = patches.mesh, patches.degree + 1
    vertices = tables.add(POINT, *columns(mesh.vertices))
    inner = tables.add(POINT, *columns(patches.edge_control_points[:, 1:-1]))
    low, high = vertices[mesh.edges].T[:, :, None]
    edges = np.hstack([low, inner.reshape(len(mesh.edges), order - 2), high])  # (e, d + 1)

    grid = np.zeros((len(mesh.quads), order, order), dtype=np.intp)
    inside = tables.add(POINT, *columns(patches.control_points[:, 1:-1, 1:-1]))
    grid[:, 1:-1, 1:-1] = inside.reshape(len(mesh.quads), order - 2, order - 2)
    rows = edges[mesh.edge_of_half_edge].reshape(-1, 4, order)
    rows = np.where(patches.runs_forward[:, :, None], rows, rows[:, :, ::-1])
    grid.reshape(-1, order**2)[:, side_indices(patches.degree)] = rows
    return _PointNumbers(vertices, edges, grid)


def _write_edges(tables: Tables, patches: BezierMesh, points: _PointNumbers) -> Ints:
    """Write the edges from lower to higher vertex; return their numbers, shape (e,)."""
    if patches.degree == 1:
        ends = patches.edge_control_points
        directions = tables.add(DIRECTION, *columns(normalize(ends[:, 1] - ends[:, 0])))
        vectors = tables.add("VECTOR('',#%d,1.)", directions)
        curves = tables.add("LINE('',#%d,#%d)", points.edges[:, 0], vectors)
    else:
        order = patches.degree + 1
        curves = tables.add(
            f"B_SPLINE_CURVE_WITH_KNOTS('',{patches.degree},({references(order)}),"
            f".UNSPECIFIED.,.F.,.F.,({order},{order}),(0.,1.),.PIECEWISE_BEZIER_KNOTS.)",
            *points.edges.T,
        )
    vertices = tables.add("VERTEX_POINT('',#%d)", points.vertices)
    low, high = vertices[patches.mesh.edges].T
    return tables.add("EDGE_CURVE('',#%d,#%d,#%d,.T.)", low, high, curves)


def _write_surfaces(tables: Tables, patches: BezierMesh, points: _PointNumbers) -> Ints:
    """Write a plane for each flat patch and a B-spline for the rest; return their numbers (f,)."""
    order = patches.degree + 1
    flat: Bools = np.asarray(patches.plane_normals.any(axis=1))
    numbers = np.empty(len(flat), dtype=np.intp)

    corners = points.patches[:, 0, 0]
    sides = patches.control_points[:, 1, 0] - patches.control_points[:, 0, 0]
    normals = tables.add(DIRECTION, *columns(patches.plane_normals[flat]))
    along = tables.add(DIRECTION, *columns(normalize(sides[flat])))
    axes = tables.add("AXIS2_PLACEMENT_3D('',#%d,#%d,#%d)", corners[flat], normals, along)
    numbers[flat] = tables.add("PLANE('',#%d)", axes)

    grid = ",".join([f"({references(order)})"] * order)
    numbers[~flat] = tables.add(
        f"B_SPLINE_SURFACE_WITH_KNOTS('',{patches.degree},{patches.degree},({grid}),"
        f".UNSPECIFIED.,.F.,.F.,.F.,({order},{order}),({order},{order}),(0.,1.),(0.,1.),"
        ".PIECEWISE_BEZIER_KNOTS.)",
        *points.patches[~flat].reshape(-1, order**2).T,
    )
    return numbers
