"""Wires of CAD files, which OCCT reads in a process of its own."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scaffold_cad.base.apart import Arrays, run_apart
from scaffold_cad.base.arrays import Points
from scaffold_cad.base.backends import need
from scaffold_cad.base.files import check_there
from scaffold_cad.base.packed import unpacked
from scaffold_cad.errors import FormatError


@dataclass(frozen=True, eq=False)
class Wires:
    """What a CAD file holds beside solids."""

    lines: list[Points]
    """Points along each edge that bounds no face, each of shape (k, 3), mm."""
    faces: int
    """Number of faces."""


def read_wires(path: Path, sagitta: float) -> Wires:
    """Return the edges in a STEP, IGES or BREP file that bound no face, and how many faces it has.

    Parameters
    ----------
    sagitta : how far a chord may be from its curve, as a fraction of the curve's size

    Raises
    ------
    FormatError
        If the file cannot be read.
    """
    check_there(path)
    need("build123d", f"a {path.suffix[1:].upper()} file")
    found = run_apart(wire_arrays, path, repr(sagitta))
    ends = found["ends"]
    lines = np.split(found["points"], ends[:-1]) if len(ends) else []
    return Wires(lines, int(found["faces"]))


def wire_arrays(path: Path, sagitta: str) -> Arrays:
    """Return the points of all lines, where each ends among them, and the number of faces."""
    from scaffold_cad.brep import occtcurves

    with unpacked(path) as plain:
        try:
            shape = occtcurves.read_shape(plain)
            lines = occtcurves.polylines(shape, float(sagitta))
            faces = occtcurves.face_count(shape)
        except (OSError, RuntimeError, ValueError) as error:
            raise FormatError(f"{path} cannot be read: {error}; need a sound file") from None
    return {
        "points": np.concatenate([np.zeros((0, 3)), *lines]),
        "ends": np.cumsum([len(line) for line in lines], dtype=np.intp),
        "faces": np.array(faces),
    }
