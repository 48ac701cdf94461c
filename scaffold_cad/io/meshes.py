"""Triangles read from files as they are, faults included; those of CAD files are made."""

from __future__ import annotations

from os import PathLike

from scaffold_cad.base.arguments import as_path
from scaffold_cad.errors import FormatError, MeshError, SkeletonError
from scaffold_cad.io.register import mesh_reader_of
from scaffold_cad.mesh.trianglemesh import TriangleMesh


def read_triangles(path: str | PathLike[str]) -> TriangleMesh | None:
    """Return the triangles that a file holds, or None where it is of no such format or has none.

    Vertices are neither merged nor dropped. Numbers are taken as mm, but for 3MF, which says.
    Solids of STEP and BREP files are met within 0.01 mm. A 3MF file that is beams and nothing else
    has none: it is a skeleton. Where it holds more beside beams, the solid of all is made.

    Raises
    ------
    FormatError
        If the file cannot be read, is a STEP or a BREP file without a solid, or an IGES file.
    MissingBackendError
        If the package that reads the format is not installed.
    """
    path = as_path(path)
    read = mesh_reader_of(path)
    if read is None:
        return None
    try:
        mesh = read(path)
    except OSError as error:
        raise FormatError(f"{path} cannot be read: {error.strerror or error}") from None
    except (MeshError, SkeletonError) as error:
        raise FormatError(f"{path}: {error}") from None
    return mesh if len(mesh.triangles) else None  # lines or beams: a skeleton
