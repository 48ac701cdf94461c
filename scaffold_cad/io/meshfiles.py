"""Triangles read from files as they are, faults included; those of CAD files are made."""

from __future__ import annotations

import logging
from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import TypeAlias

import numpy as np

from scaffold_cad.base.arguments import as_path
from scaffold_cad.base.backends import need
from scaffold_cad.brep import BREP_SUFFIXES, read_brep, tessellated
from scaffold_cad.errors import FormatError, MeshError, SkeletonError
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.manifolds import meshes_in

Reader: TypeAlias = Callable[[Path], TriangleMesh]

MILLIMETRES = {
    "MicroMeter": 0.001,
    "MilliMeter": 1.0,
    "CentiMeter": 10.0,
    "Inch": 25.4,
    "Foot": 304.8,
    "Meter": 1000.0,
}
"""Length of each unit of lib3mf, mm."""

IGES_SUFFIXES = (".iges", ".igs")
"""Suffixes of a format that holds faces on surfaces, and is not read."""

_log = logging.getLogger(__name__)


def read_triangles(path: str | PathLike[str]) -> TriangleMesh | None:
    """Return the triangles that a file holds, or None where it is of no such format or has none.

    Vertices are neither merged nor dropped. Numbers are taken as mm, but for 3MF, which says.
    Solids of STEP and BREP files are met within 0.01 mm. A 3MF file with beams has none: it is a
    skeleton, and triangles beside the beams, such as those that they are clipped to, are not taken.

    Raises
    ------
    FormatError
        If the file is an STL or a PLY file and cannot be read or holds no triangles, a STEP or a
        BREP file without a solid, or an IGES file.
    MissingBackendError
        If the package that reads the format is not installed.
    """
    path = as_path(path)
    suffix = path.suffix.lower()
    if suffix in IGES_SUFFIXES:
        raise FormatError(f"{path} is an IGES file; need STEP, BREP or STL")
    if suffix not in _READERS:
        return None
    try:
        mesh = _READERS[suffix](path)
    except OSError as error:
        raise FormatError(f"{path} cannot be read: {error.strerror or error}") from None
    except (MeshError, SkeletonError) as error:
        raise FormatError(f"{path}: {error}") from None
    if len(mesh.triangles):
        return mesh
    if suffix in (".stl", ".ply"):
        raise FormatError(f"{path} holds no triangles; need at least one")
    return None  # lines or beams: a skeleton


def _read_by_trimesh(path: Path) -> TriangleMesh:
    return _joined(meshes_in(path))


def _read_3mf(path: Path) -> TriangleMesh:
    need("lib3mf", "a 3MF file")
    import lib3mf

    path.stat()  # its errors have names
    model = lib3mf.Wrapper().CreateModel()
    try:
        model.QueryReader("3mf").ReadFromFile(str(path))
        merged = model.MergeToModel()
    except lib3mf.ELib3MFException as error:
        raise FormatError(f"{path} cannot be read: {error}") from None
    unit = MILLIMETRES[model.GetUnit().name]
    meshes = []
    beams, found = 0, merged.GetMeshObjects()
    while found.MoveNext():
        body = found.GetCurrentMeshObject()
        beams += body.BeamLattice().GetBeamCount()
        places = np.array([list(vertex.Coordinates) for vertex in body.GetVertices()])
        rows = np.array([list(row.Indices) for row in body.GetTriangleIndices()], dtype=np.intp)
        meshes.append(TriangleMesh(places.reshape(-1, 3) * unit, rows))
    mesh = _joined(meshes)
    if beams == 0:
        return mesh
    if len(mesh.triangles):
        _log.warning(
            "%s: %d beams are taken, not the %d triangles beside them",
            path,
            beams,
            len(mesh.triangles),
        )
    return _joined([])


def _joined(meshes: list[TriangleMesh]) -> TriangleMesh:
    """Return the triangles of all meshes, one after the other."""
    if not meshes:
        return TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.intp))
    first = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    return TriangleMesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.triangles + n for mesh, n in zip(meshes, first[:-1], strict=True)]),
    )


def _read_cad(path: Path) -> TriangleMesh:
    return tessellated(read_brep(path))


_READERS: dict[str, Reader] = {
    **dict.fromkeys(BREP_SUFFIXES, _read_cad),
    ".stl": _read_by_trimesh,
    ".obj": _read_by_trimesh,
    ".ply": _read_by_trimesh,
    ".3mf": _read_3mf,
}
