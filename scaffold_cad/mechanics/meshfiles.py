"""Meshes for analysis, most written through meshio: Abaqus and CalculiX, Gmsh, VTK, Nastran."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import numpy as np

from scaffold_cad.base.arguments import as_path, check_kind, checks_keywords
from scaffold_cad.base.arrays import Ints, Points
from scaffold_cad.base.backends import need
from scaffold_cad.base.files import replacing, unknown_suffix
from scaffold_cad.mechanics.calculix import hexahedra_lines
from scaffold_cad.mechanics.hexahedra.builder import Hexahedra
from scaffold_cad.mechanics.nastran import hexahedra_cards

ENDINGS = {".msh": "gmsh22", ".vtu": "vtu"}
"""Endings, and what meshio calls their formats."""

# meshio writes numbers and elements that CalculiX does not read, and no sets for Nastran.
LINES = {".inp": hexahedra_lines, ".bdf": hexahedra_cards}
"""Endings of the formats that are written without meshio."""

_log = logging.getLogger(__name__)


@checks_keywords()
def write_hexahedra(mesh: Hexahedra, path: str | Path) -> None:
    """Write hexahedra for an analysis, with what each of them belongs to.

    ========  =======================================================================
    .inp      Abaqus, CalculiX (C3D8I): element sets STRUT_e and NODE_v, node sets END_v
    .msh      Gmsh 2.2: physical groups STRUT_e of hexahedra, END_v of the faces there
    .vtu      ParaView: cell data strut, node and quality, point data end
    .bdf      Nastran (CHEXA): one PSOLID per strut, from 1; material 1 is a stand-in; SETs of
              elements NODE_v and grid points END_v, named in comments
    ========  =======================================================================

    Raises
    ------
    OptionError
        If `mesh` is not a mesh of hexahedra.
    FormatError
        If the ending is not one of these, or the file cannot be written.
    MissingBackendError
        If meshio is not installed, which .msh and .vtu need.

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
    if ending in LINES:
        with replacing(place) as fresh:
            fresh.write_text("\n".join([*LINES[ending](mesh), ""]), encoding="utf-8")
        _log.info("%s written", place)
    elif ending == ".msh":
        _write_gmsh(mesh, place)
    else:
        write_meshio(
            place,
            mesh.points,
            [("hexahedron", mesh.hexahedra)],
            at_points={"end": mesh.end_of_point},
            at_cells={
                "strut": [mesh.edge_of_hexahedron],
                "node": [mesh.node_of_hexahedron],
                "quality": [mesh.quality],
            },
        )


def _write_gmsh(mesh: Hexahedra, path: Path) -> None:
    """Write hexahedra and the faces of their ends, each in its physical group."""
    ends = mesh.end_of_point[mesh.boundary]  # (f, 4)
    flat = (ends[:, 0] >= 0) & (ends == ends[:, :1]).all(axis=1)
    struts = (mesh.edge_of_hexahedron + 1).astype(np.int32)
    faces = (ends[flat, 0] + 1).astype(np.int32)
    names = {f"STRUT_{one - 1}": (one, 3) for one in np.unique(struts).tolist()}
    names |= {f"END_{one - 1}": (one, 2) for one in np.unique(faces).tolist()}
    write_meshio(
        path,
        mesh.points,
        [("hexahedron", mesh.hexahedra), ("quad", mesh.boundary[flat])],
        at_points={},
        at_cells={
            "gmsh:physical": [struts, faces],
            "gmsh:geometrical": [struts, faces],
        },
        names={name: np.array(pair) for name, pair in names.items()},
    )


def write_meshio(
    path: Path,
    points: Points,
    cells: list[tuple[str, Ints]],
    *,
    at_points: dict[str, Any],
    at_cells: dict[str, list[Any]],
    names: dict[str, Ints] | None = None,
) -> None:
    """Write a mesh; the format is that of the path's ending.

    Parameters
    ----------
    at_cells : data, an array a block of cells
    names : of physical groups: their number and dimension
    """
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        raise unknown_suffix(path, [*LINES, *ENDINGS], "meshes for analysis")
    need("meshio", f"a mesh as {ending}")
    import meshio

    mesh = meshio.Mesh(
        points,
        cells,
        point_data=at_points,
        cell_data=at_cells,
        field_data=names,
    )
    with replacing(path) as fresh:
        meshio.write(fresh, mesh, file_format=ENDINGS[ending])
    _log.info("%s written", path)
