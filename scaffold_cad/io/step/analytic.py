"""STEP files of analytic B-reps, written straight from their arrays.

Planes, cylinders, cones, spheres and tori are what they are, circles and ellipses are these, and
spline patches share the control points of their edges.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scaffold_cad.base.arrays import Ints
from scaffold_cad.brep.analytic import AnalyticBrep, Axes, Knots, SplinePatches, Surface
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

DIGITS = 1e-10
"""Step that coordinates are rounded to, as a part of the least radius or edge."""

ANALYTIC = {
    Surface.PLANE: "PLANE('',#%d)",
    Surface.CYLINDER: "CYLINDRICAL_SURFACE('',#%d,%s)",
    Surface.CONE: "CONICAL_SURFACE('',#%d,%s,%s)",
    Surface.SPHERE: "SPHERICAL_SURFACE('',#%d,%s)",
    Surface.TORUS: "TOROIDAL_SURFACE('',#%d,%s,%s)",
}
SIZES = {
    Surface.PLANE: 0,
    Surface.CYLINDER: 1,
    Surface.CONE: 2,
    Surface.SPHERE: 1,
    Surface.TORUS: 2,
}


def write_analytic(brep: AnalyticBrep, path: Path, *, name: str) -> None:
    """Write the solids of `brep`, in mm; its faces have their names.

    Parameters
    ----------
    brep : closed, as `AnalyticBrep.check_closed` asks
    path : of the file
    name : of the product
    """
    with path.open("w", encoding="ascii", newline="\n") as file:
        tables = write_header(file, name)
        write_end(tables, _write_solids(tables, brep, _write_faces(tables, brep)))


def _write_solids(tables: Tables, brep: AnalyticBrep, faces: Ints) -> Ints:
    """Write the solids, the first shell of each around its voids; return their numbers."""
    order = np.argsort(brep.faces.shell, kind="stable")
    bounds = np.searchsorted(brep.faces.shell[order], np.arange(len(brep.solid) + 1))
    shells = np.array(
        [
            tables.add_list("CLOSED_SHELL('',", faces[order[start:end]], ")")
            for start, end in zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True)
        ]
    )
    solids = []
    for solid in range(int(brep.solid.max()) + 1):
        outer, *voids = shells[brep.solid == solid].tolist()
        if not voids:
            solids += tables.add("MANIFOLD_SOLID_BREP('',#%d)", np.array([outer])).tolist()
            continue
        turned = tables.add("ORIENTED_CLOSED_SHELL('',*,#%d,.F.)", np.array(voids))
        solids.append(tables.add_list(f"BREP_WITH_VOIDS('',#{outer},", turned, ")"))
    return np.array(solids)


def _write_faces(tables: Tables, brep: AnalyticBrep) -> Ints:
    """Write the faces and all that they are made of; return their numbers, shape (f,)."""
    faces = brep.faces
    decimals = _decimals(brep)
    vertices = tables.add(POINT, *columns(np.round(brep.vertices, decimals)))
    placements, place = _write_axes(tables, brep.edges.circles, faces.axes)
    poles = _write_curve_points(tables, brep, vertices, decimals)
    edges = _write_edges(tables, brep, vertices, placements[place[: len(brep.edges.radii)]], poles)
    surfaces = _write_surfaces(
        tables, brep, placements[place[len(brep.edges.radii) :]], poles, decimals
    )
    senses = np.where(faces.forward, "T", "F").tolist()
    uses = tables.add("ORIENTED_EDGE('',*,*,#%d,.%s.)", edges[faces.edge], senses)
    loops = _write_loops(tables, faces.uses, uses)
    loop_face = np.repeat(np.arange(len(faces.kinds)), np.diff(faces.loops))
    turned = np.where(faces.outward, "T", "F")
    bounds = np.empty(len(loops), dtype=np.intp)
    is_outer = np.zeros(len(loops), dtype=np.bool_)
    is_outer[faces.loops[:-1]] = True
    for marked, kind in ((is_outer, "FACE_OUTER_BOUND"), (~is_outer, "FACE_BOUND")):
        chosen = np.flatnonzero(marked)
        bounds[chosen] = tables.add(
            f"{kind}('',#%d,.%s.)", loops[chosen], turned[loop_face[chosen]].tolist()
        )
    names = [escaped(name) for name in brep.face_names]
    counts = np.diff(faces.loops)
    numbers = np.empty(len(faces.kinds), dtype=np.intp)
    for count in np.unique(counts).tolist():
        chosen = np.flatnonzero(counts == count)
        rows = bounds[faces.loops[chosen][:, None] + np.arange(count)]
        numbers[chosen] = tables.add(
            f"ADVANCED_FACE('%s',({references(count)}),#%d,.%s.)",
            [names[face] for face in chosen.tolist()],
            *rows.T,
            surfaces[chosen],
            turned[chosen].tolist(),
        )
    return numbers


def _decimals(brep: AnalyticBrep) -> int:
    """Return to how many decimals coordinates are rounded: enough for the smallest thing."""
    sizes = [brep.edges.radii, brep.faces.sizes[:, 0]]
    least = min((float(size[size > 0].min()) for size in sizes if (size > 0).any()), default=1.0)
    return int(np.ceil(-np.log10(DIGITS * least)))


def _write_axes(tables: Tables, *axes: Axes) -> tuple[Ints, Ints]:
    """Write the placements, equal ones once; return their numbers and that of each row."""
    rows = np.concatenate([np.hstack([each.origin, each.z, each.x]) for each in axes]) + 0.0
    distinct, place = np.unique(rows, axis=0, return_inverse=True)
    origin = tables.add(POINT, *columns(distinct[:, :3]))
    directions, which = np.unique(
        np.concatenate([distinct[:, 3:6], distinct[:, 6:]]), axis=0, return_inverse=True
    )
    numbers = tables.add(DIRECTION, *columns(directions))[which.reshape(-1)]
    count = len(distinct)
    placements = tables.add(
        "AXIS2_PLACEMENT_3D('',#%d,#%d,#%d)", origin, numbers[:count], numbers[count:]
    )
    return placements, place.reshape(-1)


def _write_curve_points(
    tables: Tables, brep: AnalyticBrep, vertices: Ints, decimals: int
) -> list[Ints]:
    """Write the inner control points of splines; return all of theirs, (b, n) a table."""
    edges, first, numbers = brep.edges, sum(brep.edges.counts[:2]), []
    for table in edges.curves:
        count, wide = table.control.shape[:2]
        inner = tables.add(POINT, *columns(np.round(table.control[:, 1:-1], decimals)))
        ends = vertices[edges.ends[first : first + count]]
        numbers.append(np.hstack([ends[:, :1], inner.reshape(count, wide - 2), ends[:, 1:]]))
        first += count
    return numbers


def _write_edges(
    tables: Tables, brep: AnalyticBrep, vertices: Ints, circle_axes: Ints, poles: list[Ints]
) -> Ints:
    """Write the edges; return their numbers, shape (e,)."""
    edges = brep.edges
    count = edges.counts[0]
    ends = brep.vertices[edges.ends[:count]]
    spans = ends[:, 1] - ends[:, 0]
    spans = spans / np.linalg.norm(spans, axis=1, keepdims=True)
    vectors = tables.add("VECTOR('',#%d,1.)", tables.add(DIRECTION, *columns(spans)))
    curves = [tables.add("LINE('',#%d,#%d)", vertices[edges.ends[:count, 0]], vectors)]
    # The arcs of a ring lie on one circle.
    rows, which = np.unique(
        np.stack([circle_axes.astype(np.float64), edges.radii, edges.lesser_radii], axis=1),
        axis=0,
        return_inverse=True,
    )
    is_circle = rows[:, 1] == rows[:, 2]
    circles = np.empty(len(rows), dtype=np.intp)
    for chosen, template in (
        (is_circle, "CIRCLE('',#%d,%s)"),
        (~is_circle, "ELLIPSE('',#%d,%s,%s)"),
    ):
        axes, *sizes = rows[chosen].T
        sizes = sizes[: template.count("%s")]
        circles[chosen] = tables.add(template, axes.astype(np.intp), *sizes)
    curves.append(circles[which.reshape(-1)])
    for table, numbers in zip(edges.curves, poles, strict=True):
        knots = table.knots
        curves.append(
            tables.add(
                f"B_SPLINE_CURVE_WITH_KNOTS('',{knots.degree},({references(knots.count)}),"
                f".UNSPECIFIED.,.F.,.F.,{_knots(knots)},.UNSPECIFIED.)",
                *numbers.T,
            )
        )
    corner = tables.add("VERTEX_POINT('',#%d)", vertices)
    return tables.add(
        "EDGE_CURVE('',#%d,#%d,#%d,.T.)",
        corner[edges.ends[:, 0]],
        corner[edges.ends[:, 1]],
        np.concatenate(curves),
    )


def _knots(*knots: Knots) -> str:
    """Return how often knots count, and then the knots."""
    counts = [f"({','.join(map(str, each.counts.tolist()))})" for each in knots]
    values = [f"({','.join(map(repr, each.values.tolist()))})" for each in knots]
    return ",".join(counts + values)


def _write_surfaces(
    tables: Tables, brep: AnalyticBrep, placements: Ints, poles: list[Ints], decimals: int
) -> Ints:
    """Write the surfaces; return their numbers, shape (f,)."""
    faces = brep.faces
    numbers = np.empty(len(faces.kinds), dtype=np.intp)
    analytic = faces.kinds[: len(placements)]
    for kind, template in ANALYTIC.items():
        chosen = np.flatnonzero(analytic == kind)
        sizes = faces.sizes[chosen].T[: SIZES[kind]]
        numbers[chosen] = tables.add(template, placements[chosen], *sizes)
    first = len(placements)
    for table in faces.patches:
        grid = _write_patch_points(tables, brep, table, first, poles, decimals)
        rows = ",".join([f"({references(table.v.count)})"] * table.u.count)
        numbers[first : first + len(grid)] = tables.add(
            f"B_SPLINE_SURFACE_WITH_KNOTS('',{table.u.degree},{table.v.degree},({rows}),"
            f".UNSPECIFIED.,.F.,.F.,.F.,{_knots(table.u, table.v)},.UNSPECIFIED.)",
            *grid.reshape(len(grid), table.u.count * table.v.count).T,
        )
        first += len(grid)
    return numbers


def _write_patch_points(
    tables: Tables,
    brep: AnalyticBrep,
    table: SplinePatches,
    first: int,
    poles: list[Ints],
    decimals: int,
) -> Ints:
    """Write what control points patches do not share with edges; return all, (p, n_u, n_v).

    Parameters
    ----------
    first : number of the first face of the table
    poles : of splines, see `_write_curve_points`
    """
    faces, edges = brep.faces, brep.edges
    grid = np.zeros(table.control.shape[:3], dtype=np.intp)
    patch = faces.face_of_use - first
    start_of_curves = sum(edges.counts[:2])
    for numbers in poles:
        curve = faces.edge - start_of_curves
        uses = np.flatnonzero(
            (patch >= 0) & (patch < len(grid)) & (curve >= 0) & (curve < len(numbers))
        )
        start, end = faces.parameters[uses, 0], faces.parameters[uses, 1]
        share = np.linspace(0.0, 1.0, numbers.shape[1])
        along = start[:, :, None] + (end - start)[:, :, None] * share  # (u, 2, n)
        i, j = (
            np.rint((wide - 1) * along[:, axis]).astype(np.intp)
            for axis, wide in enumerate(table.control.shape[1:3])
        )
        grid[patch[uses, None], i, j] = numbers[curve[uses]]
        start_of_curves += len(numbers)
    missing = grid == 0
    grid[missing] = tables.add(POINT, *columns(np.round(table.control[missing], decimals)))
    return grid


def _write_loops(tables: Tables, starts: Ints, uses: Ints) -> Ints:
    """Write the loops; return their numbers, shape (l,)."""
    counts = np.diff(starts)
    numbers = np.empty(len(counts), dtype=np.intp)
    for count in np.unique(counts).tolist():
        chosen = np.flatnonzero(counts == count)
        rows: Ints = uses[starts[chosen][:, None] + np.arange(count)]
        numbers[chosen] = tables.add(f"EDGE_LOOP('',({references(count)}))", *rows.T)
    return numbers
