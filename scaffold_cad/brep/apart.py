"""Wires of CAD files, read in a process of its own: OCCT may end the process on damaged files.

`main` is what that process does.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from scaffold_cad.base.arrays import Points
from scaffold_cad.base.backends import need
from scaffold_cad.errors import FormatError

LONGEST, LONGEST_BYTE = 20.0, 2e-5
"""Time that a file may take, s, and what each of its bytes adds: OCCT may never end."""


PROGRAM = "import sys; from scaffold_cad.brep.apart import main; sys.exit(main())"


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
    if not path.is_file():
        raise FormatError(f"{path} cannot be read: there is no such file")
    need("build123d", f"a {path.suffix[1:].upper()} file")
    # The program of a host, such as a CAD system that runs Python within, starts no Python.
    if not Path(sys.executable or "").name.lower().startswith("python"):
        return _wires(path, sagitta)
    with TemporaryDirectory() as folder:
        found = Path(folder) / "wires.npz"
        command = [sys.executable, "-c", PROGRAM, str(path), repr(sagitta), str(found)]
        longest = LONGEST + LONGEST_BYTE * path.stat().st_size
        try:
            run = subprocess.run(command, capture_output=True, timeout=longest, check=False)
        except subprocess.TimeoutExpired:
            raise FormatError(
                f"{path} cannot be read within {longest:.0f} s; need a sound file"
            ) from None
        if run.returncode == 0 and found.is_file():
            return _unpacked(found)
        said = run.stderr.decode("utf-8", errors="replace").strip().splitlines()[-1:]
        why = said[0] if said and run.returncode > 0 else "OCCT ended at it"
        raise FormatError(f"{path} cannot be read: {why}; need a sound file")


def _unpacked(found: Path) -> Wires:
    with np.load(found) as arrays:
        points, ends = arrays["points"], arrays["ends"]
        return Wires(np.split(points, ends[:-1]) if len(ends) else [], int(arrays["faces"]))


def _wires(path: Path, sagitta: float) -> Wires:
    """Read the file in this process."""
    from scaffold_cad.brep import occtcurves

    try:
        shape = occtcurves.read_shape(path)
        return Wires(occtcurves.polylines(shape, sagitta), occtcurves.face_count(shape))
    except (OSError, RuntimeError, ValueError) as error:
        raise FormatError(f"{path} cannot be read: {error}") from None


def main() -> int:
    """Read a file and write what it holds; return 1, with the reason, if it cannot be read."""
    path, sagitta, out = sys.argv[1:]
    try:
        wires = _wires(Path(path), float(sagitta))
    except FormatError as error:
        sys.stderr.write(str(error).removeprefix(f"{path} cannot be read: ") + "\n")
        return 1
    ends = np.cumsum([len(line) for line in wires.lines], dtype=np.intp)
    points = np.concatenate([np.zeros((0, 3)), *wires.lines])
    np.savez(out, points=points, ends=ends, faces=wires.faces)
    return 0
