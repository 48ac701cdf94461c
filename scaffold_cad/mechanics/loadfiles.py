"""Supports and loads as files have them, on the nodes of a skeleton."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arguments import check_kind, checks_keywords
from scaffold_cad.base.arrays import Bools, Floats, Ints, Points
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.vectors import sums_by_row
from scaffold_cad.errors import FormatError
from scaffold_cad.io.reading import in_millimeters, read_raw
from scaffold_cad.mechanics.loading import FREEDOMS, Load, Support
from scaffold_cad.skeleton import Skeleton

NEAR = 1e-5
"""Distance within which a node of a file is one of the skeleton, in diagonals of its box."""


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Loading:
    """What holds and loads a skeleton, as a file says."""

    supports: tuple[Support, ...]
    """Each on all nodes that are held alike; none where the file has no support."""
    loads: tuple[Load, ...]
    """Each on all nodes that are loaded alike; none where the file has no load."""

    def __str__(self) -> str:
        return (
            f"Loading: {counted(len(self.supports), 'support')}, {counted(len(self.loads), 'load')}"
        )


@checks_keywords()
def read_loading(
    path: str | PathLike[str],
    skeleton: Skeleton,
    *,
    units: str | None = None,
    scale: float | None = None,
) -> Loading:
    r"""Return the supports and loads of a file, for `beam_model`.

    ================  ===================================================================
    Abaqus, CalculiX  ``*BOUNDARY`` and ``*CLOAD`` of the model and its first step
    Nastran           SPC, SPC1, SPCADD, FORCE, MOMENT, LOAD, and the supports in GRID
    OpenSees          ``fix``, ``sp`` and ``load``
    ================  ===================================================================

    Other formats, and weight, pressures and line loads, give none.

    Parameters
    ----------
    path : the file; forces are taken as N, moments as N mm
    skeleton : of the same file, however it was repaired: nodes are found by their places
    units, scale : as they were given to `read_skeleton`

    Raises
    ------
    FormatError
        If the file cannot be read, or what it holds or loads is on no node of the skeleton.
    OptionError
        If `skeleton` is not a Skeleton, or an option is out of range.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from scaffold_cad import read_skeleton
    >>> from scaffold_cad.mechanics import beam_model, read_loading
    >>> lines = ["node 1 0 0 0", "node 2 100 0 0", "element elasticBeamColumn 1 1 2 78.5 210e3"]
    >>> lines += ["fix 1 1 1 1 1 1 1", "load 2 0 0 -100 0 0 0"]
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "arm.tcl")
    ...     _ = path.write_text("\n".join(lines))
    ...     arm = read_skeleton(path)
    ...     loading = read_loading(path, arm)
    >>> solution = beam_model(arm, "steel", loading.supports, loading.loads).solved()
    >>> round(solution.largest_displacement, 2)
    0.33
    """
    check_kind(skeleton, Skeleton, name="skeleton")
    raw = in_millimeters(path, read_raw(path), units, scale)
    if raw.loading is None or raw.loading.is_empty:
        return Loading((), ())
    fixed, moved, forces = raw.loading.fixed, raw.loading.displacement, raw.loading.forces
    used = np.flatnonzero(fixed.any(axis=1) | forces.any(axis=1))
    used = used[_is_on_strut(raw.edges, len(raw.nodes))[used] | forces[used].any(axis=1)]
    node = _found(path, raw.nodes[used], skeleton)
    return Loading(
        tuple(_supports(node, fixed[used], moved[used])),
        tuple(_loads(sums_by_row(forces[used], node, len(skeleton.nodes)))),
    )


def _is_on_strut(edges: Ints, count: int) -> Bools:
    """Return which nodes have an edge, (n,): others may orient sections, or be of solids."""
    marked = np.zeros(count, dtype=np.bool_)
    marked[edges] = True
    return marked


def _found(path: str | PathLike[str], places: Points, skeleton: Skeleton) -> Ints:
    """Return the skeleton's node at each of `places`, (k,).

    Raises
    ------
    FormatError
        If one is at none.
    """
    reach = NEAR * float(np.linalg.norm(np.ptp(skeleton.nodes, axis=0)))
    distance, node = cKDTree(skeleton.nodes).query(places)
    far = np.flatnonzero(distance > reach)
    if len(far):
        place = places[far[0]].tolist()
        raise FormatError(
            f"{path} has a support or a load at {place} mm, where the skeleton has no node; "
            "need one there (the same units and scale, and no thinning)"
        )
    return np.asarray(node, dtype=np.intp)


def _supports(node: Ints, fixed: Bools, moved: Floats) -> list[Support]:
    """Return a support for each way in which nodes (k,) are held."""
    held = fixed.any(axis=1)
    node, table = node[held], np.concatenate([fixed[held], moved[held]], axis=1)  # (k, 12)
    kinds, kind = np.unique(table, axis=0, return_inverse=True)
    found = []
    for number, row in enumerate(kinds):
        columns = np.flatnonzero(row[:6])
        names = " ".join(FREEDOMS[k] for k in columns.tolist())
        where = node[kind.reshape(-1) == number]
        found.append(Support(where, names, displacement=row[6 + columns]))
    return found


def _loads(forces: Floats) -> list[Load]:
    """Return a load for each force and moment on nodes, (n, 6)."""
    loaded = np.flatnonzero(forces.any(axis=1))
    kinds, kind = np.unique(forces[loaded], axis=0, return_inverse=True)
    return [
        Load(loaded[kind.reshape(-1) == number], row[:3], row[3:], each=True)
        for number, row in enumerate(kinds)
    ]
