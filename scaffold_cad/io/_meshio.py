"""Lines of the meshes that meshio reads."""

from __future__ import annotations

import contextlib
import io
import logging
from importlib import import_module
from pathlib import Path

import numpy as np

from scaffold_cad.base.apart import Arrays, run_apart
from scaffold_cad.base.arrays import Floats
from scaffold_cad.base.backends import need
from scaffold_cad.errors import FormatError
from scaffold_cad.io._binary import as_doubles
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import check_size
from scaffold_cad.io.vtk.lines import radii_among

LARGEST_MESH = 2**28
"""Most bytes of a mesh that meshio reads: it keeps several copies."""

ORDER = {"line": (0, 1), "line3": (0, 2, 1), "line4": (0, 2, 3, 1)}
"""Points of a line element, from one end to the other."""

_log = logging.getLogger(__name__)


def lines_of(path: Path, kind: str) -> RawSkeleton:
    """Return the line elements of a mesh, those with inner points in pieces.

    Parameters
    ----------
    kind : the module of meshio that reads the format

    Raises
    ------
    FormatError
        If meshio cannot read it, or it has no lines.
    MissingBackendError
        If meshio, or what it reads the format with, is not installed.
    """
    need("meshio", f"a {path.suffix} file")
    check_size(path, LARGEST_MESH)
    found = run_apart(line_arrays, path, kind)
    if str(found["said"]):
        _log.warning("%s: %s", path, str(found["said"]))
    points, edges = found["points"], found["edges"]
    if not len(edges):
        raise FormatError(f"{path} has no line elements; need at least one")
    used, compact = np.unique(edges, return_inverse=True)
    if used[0] < 0 or used[-1] >= len(points):
        raise FormatError(f"{path} has a line to point {used[-1]}; need 0 to {len(points) - 1}")
    of_nodes, of_edges = found["of_nodes"], found["of_edges"]
    return RawSkeleton(
        points[used],
        compact.reshape(-1, 2),
        of_nodes[used] if len(of_nodes) == len(points) else None,
        None if np.isnan(of_edges).all() else of_edges,
    )


def line_arrays(path: Path, kind: str) -> Arrays:
    """Return the points and lines of a mesh, their radii, and what meshio printed.

    Run in a process of its own: HDF5 may end it on damaged files, and meshio take any time.
    """
    reader = import_module(f"meshio.{kind}")
    said = io.StringIO()
    try:
        # meshio prints its warnings; its general reader would end the whole process.
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            mesh = reader.read(path)
    except (Exception, SystemExit) as error:  # of the many things that meshio raises
        raise FormatError(
            f"{path} is not a sound file: meshio ends at it with {error!r:.200}; need one"
        ) from None
    points = as_doubles(np.asarray(mesh.points))
    if points.ndim != 2 or points.shape[1] > 3:
        raise FormatError(f"{path} has points of shape {points.shape}; need (n, 3)")
    edges, of_edges = [np.zeros((0, 2), dtype=np.intp)], [np.zeros(0)]
    for k, block in enumerate(mesh.cells):
        if block.type not in ORDER:
            continue
        data = np.asarray(block.data)
        order = ORDER[block.type]
        if data.ndim != 2 or data.shape[1] != len(order):
            need = f"need {len(order)} per line"
            raise FormatError(f"{path} has lines of {data.shape} points; {need}")
        rows = data[:, list(order)].astype(np.intp)
        edges.append(np.stack([rows[:, :-1], rows[:, 1:]], axis=2).reshape(-1, 2))
        named = {name: np.asarray(values[k]) for name, values in mesh.cell_data.items()}
        of_edges.append(_repeated(radii_among(named), len(rows), len(order) - 1))
    of_nodes = radii_among({name: np.asarray(values) for name, values in mesh.point_data.items()})
    return {
        "points": np.pad(points, ((0, 0), (0, 3 - points.shape[1]))),
        "edges": np.concatenate(edges),
        "of_edges": np.concatenate(of_edges),
        "of_nodes": np.zeros(0) if of_nodes is None else of_nodes,
        "said": np.array(said.getvalue().strip()[:200]),
    }


def _repeated(values: Floats | None, count: int, pieces: int) -> Floats:
    if values is None or values.shape != (count,):
        return np.full(count * pieces, np.nan)
    return np.repeat(values, pieces)
