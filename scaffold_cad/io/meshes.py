"""Triangles read from files as they are, faults included; those of CAD files are made."""

from __future__ import annotations

from os import PathLike

from scaffold_cad.base.arguments import as_path, checks_keywords
from scaffold_cad.base.files import reading
from scaffold_cad.errors import FormatError, MeshError, OptionError, SkeletonError
from scaffold_cad.io._units import factor_of
from scaffold_cad.io.register import mesh_format_of
from scaffold_cad.mesh.trianglemesh import TriangleMesh


@checks_keywords()
def read_triangles(
    path: str | PathLike[str], *, units: str | None = None, scale: float | None = None
) -> TriangleMesh | None:
    """Return the triangles that a file holds, or None where it is of no such format or has none.

    Vertices are neither merged nor dropped. Numbers are taken as mm, but for 3MF, which says.
    Solids of STEP and BREP files are met within 0.01 mm, large ones within 2e-5 of their diagonal,
    small ones within 1e-3.
    A 3MF file that is beams and nothing else has none: it is a skeleton. Where it holds more beside
    beams, the solid of all is made.

    Parameters
    ----------
    units : of the file's lengths, where its format names none: "um", "mm", "cm", "m", "in", ...
    scale : > 0; what lengths are multiplied with besides

    Raises
    ------
    OptionError
        If an option is out of range, or units are given for a format that names its own.
    FormatError
        If the file cannot be read, is a STEP or a BREP file without a solid, or an IGES file.
    MissingBackendError
        If the package that reads the format is not installed.
    """
    path = as_path(path)
    known = mesh_format_of(path)
    if known is None:
        return None
    factor = factor_of(units, scale)
    if units is not None and known.names_unit:
        raise OptionError(f"{known.name} files say in which unit they are; need no units= ({path})")
    try:
        with reading(path):
            mesh = known.read(path)
    except (MeshError, SkeletonError) as error:
        raise FormatError(f"{path}: {error}") from None
    if len(mesh.triangles) == 0:
        return None  # lines or beams: a skeleton
    return mesh if factor == 1.0 else TriangleMesh(mesh.vertices * factor, mesh.triangles)
