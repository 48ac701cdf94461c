"""Reading a file as a program would, and what may come of it."""

from __future__ import annotations

import time
import traceback
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
    fault: str
    """What is wrong with how it was read or refused; empty if nothing."""


def outcome(path: Path) -> Outcome:
    """Read and clean the file at `path`."""
    start = time.process_time()
    edges, message, fault = 0, "", ""
    try:
        has_radii = read_raw(path).has_radii
        cleaning = read_with_repairs(path, None if has_radii else 1.0)
        edges = len(cleaning.skeleton.edges)
    except ScaffoldCadError as error:
        message = str(error)
        if str(path) not in message:
            fault = f"no file in: {message[:200]}"
    except Exception as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        fault = f"{type(error).__name__}: {error} in {place.filename}:{place.lineno}"[:300]
    if not fault and time.process_time() - start > LONGEST:
        fault = "slow"
    return Outcome(edges, message, fault)
