"""Functions run in a process of their own, which C++ libraries may end on damaged files."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.errors import FormatError, ScaffoldCadError

Arrays: TypeAlias = dict[str, NDArray[Any]]
"""What such a function returns."""

LONGEST, LONGEST_BYTE = 60.0, 2e-5
"""Time that a file may take, s, and what each of its bytes adds: a library may never end."""

PROGRAM = "import sys; from scaffold_cad.base.apart import main; sys.exit(main())"

REFUSED = 3
"""Exit code of the process when the function refuses the file."""


def run_apart(function: Callable[..., Arrays], path: Path, *arguments: str) -> Arrays:
    """Return ``function(path, *arguments)``, run in a process of its own.

    Parameters
    ----------
    function : of a module of the package, by whose name it is found there; its arrays have no
        objects
    path : of the file that it reads

    Raises
    ------
    FormatError
        If the function raises an error of the package, takes too long, or ends the process.
    """
    # The program of a host, such as a CAD system that runs Python within, starts no Python.
    if not Path(sys.executable or "").name.lower().startswith("python"):
        return function(path, *arguments)
    with TemporaryDirectory() as folder:
        found = Path(folder) / "arrays.npz"
        name = f"{function.__module__}:{function.__qualname__}"
        command = [sys.executable, "-c", PROGRAM, name, str(path), str(found), *arguments]
        longest = LONGEST + LONGEST_BYTE * path.stat().st_size
        try:
            run = subprocess.run(command, capture_output=True, timeout=longest, check=False)
        except subprocess.TimeoutExpired:
            why = f"it takes too long; need a sound file, read within {longest:.0f} s"
            raise FormatError(f"{path} cannot be read: {why}") from None
        if run.returncode == 0 and found.is_file():
            with np.load(found, allow_pickle=False) as arrays:
                return dict(arrays)
        said = run.stderr.decode("utf-8", errors="replace").strip().splitlines()[-1:]
        if run.returncode == REFUSED and said:
            raise FormatError(said[0])
        raise FormatError(
            f"{path} cannot be read: the library that reads it crashed; need a sound file"
        )


def main() -> int:
    """Run a function and write its arrays; return `REFUSED`, with the reason, if it refuses."""
    name, path, out, *arguments = sys.argv[1:]
    module, _, function = name.partition(":")
    try:
        arrays = getattr(import_module(module), function)(Path(path), *arguments)
    except ScaffoldCadError as error:
        sys.stderr.write(" ".join(str(error).split("\n")) + "\n")
        return REFUSED
    np.savez(out, **arrays)
    return 0
