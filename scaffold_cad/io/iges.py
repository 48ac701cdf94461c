"""IGES: faces on surfaces, which are not read."""

from __future__ import annotations

from pathlib import Path
from typing import NoReturn

from scaffold_cad.errors import FormatError
from scaffold_cad.io.register import register_mesh_reader


@register_mesh_reader("IGES", ".iges", ".igs")
def read_iges_triangles(path: Path) -> NoReturn:
    """Refuse the file, whose faces need not join, and name what to use instead."""
    raise FormatError(f"{path} is an IGES file; need STEP, BREP or STL")
