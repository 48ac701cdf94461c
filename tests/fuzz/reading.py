"""Reading a file as a program would, and what may come of it."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

from scaffold_cad.errors import ScaffoldCadError
from scaffold_cad.io import read_raw, read_with_repairs

LONGEST = 2.0
"""How much time of the processor it may take to read or refuse a small file, s."""


@dataclass(frozen=True)
class Outcome:
    """What became of a file."""

    edges: int
    """Edges of the skeleton; 0 if the file was refused."""
    message: str
    """Why it was refused; empty if it was read."""
    seconds: float


def outcome(path: Path) -> Outcome:
    """Read and clean the file at `path`; any error but the package's own is let through."""
    start = time.process_time()
    edges, message = 0, ""
    try:
        has_radii = read_raw(path).radii is not None
        cleaning = read_with_repairs(path, None if has_radii else 1.0)
        edges = len(cleaning.skeleton.edges)
    except ScaffoldCadError as error:
        message = str(error)
    return Outcome(edges, message, time.process_time() - start)
