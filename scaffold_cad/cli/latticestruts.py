"""The struts that `scaffold-cad lattice` asks for, in a box, in a part or on a face."""

from __future__ import annotations

import argparse
import logging
import math
from pathlib import Path
from typing import Any

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.base.summaries import counted
from scaffold_cad.cli import borders, foams, source
from scaffold_cad.cli.maps import map_of
from scaffold_cad.errors import FormatError
from scaffold_cad.filling import fill
from scaffold_cad.filling.fill import cells_around
from scaffold_cad.io import read_triangles
from scaffold_cad.lattice import CellMap, UnitCell, lattice_on
from scaffold_cad.lattice.maps import BoxMap
from scaffold_cad.lattice.maps.cellmap import extents
from scaffold_cad.lattice.maps.grading import mean_size
from scaffold_cad.lattice.registry import as_cell
from scaffold_cad.lattice.tiling import cell_size
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.skeleton import Skeleton

BOX_QUADS = np.array(
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
)
"""Faces of a box whose corners are numbered by x, y and z, x fastest."""

_log = logging.getLogger(__name__)


def part_of(options: argparse.Namespace) -> TriangleMesh | None:
    """Return the triangles of the part to be filled, or None where it is something else."""
    if options.inside is None:
        return None
    path: Path = options.inside
    mesh = read_triangles(path)
    if mesh is None:
        raise FormatError(f"{path} holds no closed part; need .step, .brep, .stl, .3mf, .obj, .ply")
    return mesh


def box_mesh(box: Floats) -> TriangleMesh:
    """Return the surface of a box (2, 3)."""
    corners = np.stack(np.meshgrid(*box.T[::-1], indexing="ij"), axis=-1).reshape(-1, 3)[:, ::-1]
    mesh = QuadMesh(corners, BOX_QUADS)
    return TriangleMesh(mesh.vertices, mesh.triangles)


def skeleton(part: TriangleMesh | None, options: argparse.Namespace) -> Skeleton:
    """Return the struts that are asked for; refuse what memory may not hold."""
    mapping = map_of(options)
    if mapping is not None:
        return _on_map(mapping, options)
    where = options.box if part is None else part
    if options.foam is not None:
        made = foams.foam(where, options)
    else:
        check_cells(part, options)
        on = map_of_sizes(part, options)
        given = borders.borders(options)
        made = fill(where, options.cell, options.size, options.radius, on=on, **given)
    _log.info("%s", counted(len(made.edges), "strut"))
    return made


def foam_around(part: TriangleMesh | None, options: argparse.Namespace) -> Skeleton:
    """Return the foam that is asked for, which goes on beyond the part or the box."""
    made = foams.foam_around(options.box if part is None else part, options)
    _log.info("%s, before they are cut", counted(len(made.edges), "strut"))
    return made


def map_of_sizes(part: TriangleMesh | None, options: argparse.Namespace) -> BoxMap | None:
    """Return the box that cells of sizes that vary are put in, or None where they are alike."""
    if not callable(options.size):
        return None
    low, high = _bounds(part, options)
    return BoxMap(high - low, low)


def check_cells(part: TriangleMesh | None, options: argparse.Namespace) -> int:
    """Return how many cells a box or a part meets; refuse what memory may not hold."""
    mapping = map_of_sizes(part, options)
    if mapping is not None:
        return _check_mapped(mapping, options)
    cell = as_cell(options.cell)
    counts, _ = cells_around(_bounds(part, options), cell, cell_size(cell, options.size))
    return _check_memory(math.prod(counts), cell, options)


def _bounds(part: TriangleMesh | None, options: argparse.Namespace) -> Floats:
    """Return the lowest and the highest corner of a part or a box, (2, 3), mm."""
    corners = options.box if part is None else part.vertices
    return np.stack([corners.min(axis=0), corners.max(axis=0)])


def _on_map(mapping: CellMap, options: argparse.Namespace) -> Skeleton:
    """Return the lattice on a map."""
    _check_mapped(mapping, options)
    given: dict[str, Any] = (
        {"size": options.size} if options.surface is None else _counts(mapping, options)
    )
    given |= borders.borders(options)
    lattice = lattice_on(mapping, options.cell, radius=options.radius, **given)
    _log.info(
        "%s, %.3g to %.3g times as long as in a cell of the mean size",
        counted(len(lattice.skeleton.edges), "strut"),
        lattice.least_stretch,
        lattice.largest_stretch,
    )
    return lattice.skeleton


def _counts(mapping: CellMap, options: argparse.Namespace) -> dict[str, tuple[int, int, int]]:
    """Return how many cells each quad of a remeshed surface has: one, and some upwards."""
    high = _cell_sizes(mapping, options)[2]
    return {"counts": (1, 1, max(1, round(float(extents(mapping)[2] / high))))}


def _cell_sizes(mapping: CellMap, options: argparse.Namespace) -> Floats:
    """Return the size of a cell, (3,), mm; the mean one where sizes vary."""
    size = options.size
    return mean_size(mapping, size) if callable(size) else cell_size(as_cell(options.cell), size)


def _check_mapped(mapping: CellMap, options: argparse.Namespace) -> int:
    """Return how many cells go on a map; refuse what memory may not hold."""
    cell, sizes = as_cell(options.cell), _cell_sizes(mapping, options)
    return _check_memory(mapping.patches * int(np.prod(extents(mapping) / sizes)), cell, options)


def _check_memory(cells: int, cell: UnitCell, options: argparse.Namespace) -> int:
    source.check_memory(options, cells, cells * cell.site_count, cells * cell.strut_count)
    return cells
