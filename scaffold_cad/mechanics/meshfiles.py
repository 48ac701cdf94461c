"""Meshes for analysis, most written through meshio: Abaqus and CalculiX, Gmsh, VTK, Nastran."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import numpy as np

from scaffold_cad.base.arguments import as_path, check_kind, checks_keywords
from scaffold_cad.base.arrays import Ints, Points
from scaffold_cad.base.backends import need
from scaffold_cad.base.files import replacing
from scaffold_cad.errors import FormatError
from scaffold_cad.mechanics.hexahedra import Hexahedra
from scaffold_cad.mechanics.nastran import hexahedra_cards

ENDINGS = {".inp": "abaqus", ".msh": "gmsh22", ".vtu": "vtu"}
"""Endings, and what meshio calls their formats."""

_log = logging.getLogger(__name__)


@checks_keywords()
def write_hexahedra(mesh: Hexahedra, path: str | Path) -> None:
    """Write hexahedra for an analysis, with what each of them belongs to.

    ========  =======================================================================
    .inp      Abaqus, CalculiX (C3D8): element sets STRUT_e and NODE_v, node sets END_v
    .msh      Gmsh 2.2: a physical group a strut, numbered from 1
    .vtu      ParaView: cell data strut, node and quality, point data end
    .bdf      Nastran (CHEXA): a PSOLID a strut, numbered from 1; material 1 is a stand-in
    ========  =======================================================================

    Raises
    ------
    OptionError
        If `mesh` is not a mesh of hexahedra.
    FormatError
        If the ending is none of these, or the file cannot be written.
    MissingBackendError
        If meshio is not installed, which all but .bdf need.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold
    >>> from scaffold_cad.mechanics import hexahedra
    >>> arm = Skeleton([[0, 0, 0], [100, 0, 0]], [[0, 1]], 5.0)
    >>> write_hexahedra(hexahedra(build_scaffold(arm), along=20), "arm.inp")  # doctest: +SKIP
    """
    check_kind(mesh, Hexahedra)
    place = as_path(path)
    ending = place.suffix.lower()
    if ending == ".bdf":  # meshio's writer has no sets, and fails on some negative numbers
        with replacing(place) as fresh:
            fresh.write_text("\n".join([*hexahedra_cards(mesh), ""]), encoding="utf-8")
        _log.info("%s written", place)
        return
    strut, node = mesh.edge_of_hexahedron, mesh.node_of_hexahedron
    at_cells: dict[str, Any] = {}
    if ending == ".vtu":
        at_cells = {"strut": strut, "node": node, "quality": mesh.quality}
    elif ending == ".msh":
        tags = (strut + 1).astype(np.int32)
        at_cells = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    named = ending == ".inp"
    write_meshio(
        place,
        mesh.points,
        [("hexahedron", mesh.hexahedra)],
        at_points={"end": mesh.end_of_point} if ending == ".vtu" else {},
        at_cells=at_cells,
        point_sets=_sets("END", mesh.end_of_point) if named else {},
        cell_sets=_sets("STRUT", strut) | _sets("NODE", node) if named else {},
    )


def write_meshio(
    path: Path,
    points: Points,
    cells: list[tuple[str, Ints]],
    *,
    at_points: dict[str, Any],
    at_cells: dict[str, Any],
    point_sets: dict[str, Ints] | None = None,
    cell_sets: dict[str, Ints] | None = None,
) -> None:
    """Write a mesh of one kind of cells; the format is that of the path's ending."""
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        known = ", ".join([*ENDINGS, ".bdf"])
        raise FormatError(f"{path}: cannot write a mesh as {ending!r}; need one of {known}")
    need("meshio", f"a mesh as {ending}")
    import meshio

    mesh = meshio.Mesh(
        points,
        cells,
        point_data=at_points,
        cell_data={name: [values] for name, values in at_cells.items()},
        point_sets=point_sets,
        cell_sets={name: [rows] for name, rows in (cell_sets or {}).items()},
    )
    with replacing(path) as fresh:
        meshio.write(fresh, mesh, file_format=ENDINGS[ending])
    _log.info("%s written", path)


def _sets(prefix: str, owner: Ints) -> dict[str, Ints]:
    """Return the items of each owner that is not -1 by a name."""
    order = np.argsort(owner, kind="stable")
    kept = order[owner[order] >= 0]
    owners, first = np.unique(owner[kept], return_index=True)
    parts = np.split(kept, first[1:]) if len(owners) else []
    return {f"{prefix}_{one}": part for one, part in zip(owners.tolist(), parts, strict=True)}
