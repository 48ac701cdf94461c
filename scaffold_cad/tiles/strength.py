"""Strength by tiles: stiffness assembled of all tiles, solved once, and stresses tile by tile.

What a strut carries depends on all others, so the equations are solved for all nodes at once, in
one process: but no skeleton of the whole is made there, and no array of all struts. Condensing each
tile to the nodes that it shares would not be less: a block of n³ BCC cells keeps full matrices of
some 1.3 n kB per strut, and the whole matrix has 0.65 kB: `docs/large.md` has what is measured.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import lru_cache
from hashlib import sha256
from io import BytesIO
from itertools import islice
from pathlib import Path
from typing import IO, Any

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from scaffold_cad.base.arguments import check_kind, checks_keywords
from scaffold_cad.base.arrays import Bools, Floats, Ints
from scaffold_cad.errors import OptionError
from scaffold_cad.mechanics.beams import BeamModel
from scaffold_cad.mechanics.loading import Load, Support, check_held, held, load_of
from scaffold_cad.mechanics.materials import Material, as_material
from scaffold_cad.mechanics.sections import as_hollow
from scaffold_cad.mechanics.solvers import solve_sparse
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.tiles.tile import Tile

COLUMNS = (
    *("x1_mm", "y1_mm", "z1_mm", "x2_mm", "y2_mm", "z2_mm", "radius1_mm", "radius2_mm"),
    *("moved1_mm", "moved2_mm", "axial1_N", "axial2_N"),
    *("stress_MPa", "buckling_utilization", "utilization"),
)
"""What is known of each strut: its ends, how far they move, and what it carries."""

SHOWN = 10
"""Struts that a summary names: those that are used most."""


@checks_keywords()
@dataclass(frozen=True)
class LoadCase:
    """What struts are made of, what holds them and what loads them, see `beam_model`.

    A tile knows its own nodes only: supports and loads say where they are by `Between`, or by
    another function of positions, which must be one of a module. A load that nodes share is shared
    by all of the whole.
    """

    material: Material | str
    supports: tuple[Support, ...]
    loads: tuple[Load, ...] = ()
    gravity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Acceleration, m/s²."""
    hollow: float = 0.0
    """Inner over outer radius of tubes."""

    def __post_init__(self) -> None:
        as_material(self.material)
        as_hollow(self.hollow)
        for support in self.supports:
            check_kind(support, Support)
        for load in self.loads:
            check_kind(load, Load)
        items: list[Support | Load] = [*self.supports, *self.loads]
        for item in items:
            if not callable(item.where):
                raise OptionError(
                    f"{item} names nodes by number, which tiles do not know; need a function of "
                    "positions"
                )

    def marks(self, items: tuple[Support, ...] | tuple[Load, ...], skeleton: Skeleton) -> Bools:
        """Return which nodes each support or load is on, shape (items, n)."""
        rows = [_marked(item.where, skeleton) for item in items]
        return np.array(rows, dtype=np.bool_).reshape(len(items), len(skeleton.nodes))

    def model(self, skeleton: Skeleton) -> BeamModel:
        """Return some struts as beams, with what holds them but without loads on nodes."""
        on = self.marks(self.supports, skeleton)
        pairs = zip(self.supports, on, strict=True)
        here = [replace(item, where=np.flatnonzero(row)) for item, row in pairs if row.any()]
        fastened = held(skeleton, here)
        return BeamModel(
            skeleton=skeleton,
            material=as_material(self.material),
            edge_radii=skeleton.edge_radii,
            hollow=as_hollow(self.hollow),
            rigid=np.zeros((len(skeleton.edges), 2)),
            fixed=fastened.fixed,
            displacement=fastened.displacement,
            forces=np.zeros((len(skeleton.nodes), 6)),
            gravity=np.asarray(self.gravity, dtype=np.float64),
            effective_length=1.0,
        )


def _marked(where: Any, skeleton: Skeleton) -> Bools:
    found = np.asarray(where(skeleton.nodes))
    if found.dtype == np.bool_:
        return found
    marks = np.zeros(len(skeleton.nodes), dtype=np.bool_)
    marks[found.astype(np.intp)] = True
    return marks


@checks_keywords()
@dataclass(frozen=True)
class Stiffness:
    """The stiffness of each tile's own struts; joined, where the nodes of the whole move to.

    `Strength` makes stresses of that.
    """

    case: LoadCase

    suffix = ".stiffness"

    def made(self, tile: Tile) -> bytes:
        """Return the equations of the tile's own struts as arrays one after the other."""
        skeleton = tile.skeleton.with_edges(tile.own)
        model = self.case.model(skeleton)
        matrix = model.stiffness_matrix()
        loaded = self.case.marks(self.case.loads, skeleton)
        places: list[np.ndarray] = [skeleton.nodes, matrix.indptr, matrix.indices]
        held_and_loaded = [model.fixed, model.displacement, loaded, model.weight_at_nodes()]
        return _saved([*places, *held_and_loaded, matrix.data])

    def join(self, files: Iterable[Path], path: Path) -> None:
        """Solve the equations of all tiles, and write how nodes move, for `Strength`."""
        paths = list(files)
        parts = [_Part(*_arrays_of(file, 7)) for file in paths]
        nodes, place = np.unique(
            np.concatenate([part.nodes for part in parts]), axis=0, return_inverse=True
        )
        offsets = np.concatenate([[0], np.cumsum([len(part.nodes) for part in parts])])
        places = np.split(place.reshape(-1), offsets[1:-1])
        fixed = np.zeros((len(nodes), 6), dtype=np.bool_)
        given, forces = np.zeros((2, len(nodes), 6))
        loaded = np.zeros((len(self.case.loads), len(nodes)), dtype=np.bool_)
        for part, at in zip(parts, places, strict=True):
            fixed[at] |= part.fixed
            given[at] = np.where(part.fixed, part.displacement, given[at])
            loaded[:, at] |= part.loaded
            forces[at] -= part.weight
        for number, (load, marks) in enumerate(zip(self.case.loads, loaded, strict=True)):
            if not marks.any():
                raise OptionError(f"load {number} is on no node; need one or more")
            forces[marks] += load_of(load, number, int(marks.sum()))
        matrix = _assembled(paths, parts, places, len(nodes))
        del parts
        pattern = (np.ones(len(matrix.indices)), matrix.indices, matrix.indptr)
        label = connected_components(sparse.csr_array(pattern, shape=(len(nodes),) * 2))[1]
        check_held(nodes, label.astype(np.intp), fixed)
        right = forces.reshape(-1) - matrix @ given.reshape(-1)
        moved = given.reshape(-1) + solve_sparse(matrix, nodes, fixed, right)
        arrays = [moved.reshape(-1, 6), place.reshape(-1), offsets]
        path.write_bytes(_saved(arrays))


@checks_keywords()
@dataclass(frozen=True)
class Strength:
    """What each tile's own struts carry, once it is known how all nodes move."""

    case: LoadCase
    moved: str
    """File of the joined `Stiffness`."""
    digest: str = field(default="", repr=False)
    """Hash of its content, which is taken from the file."""

    suffix = ".npy"

    def __post_init__(self) -> None:
        object.__setattr__(self, "digest", sha256(Path(self.moved).read_bytes()).hexdigest())

    def made(self, tile: Tile) -> bytes:
        """Return a row of `COLUMNS` for each of the tile's own struts, as an array."""
        freedoms, place, offsets = _moved(self.moved, self.digest)
        skeleton = tile.skeleton.with_edges(tile.own)
        mine = freedoms[place[offsets[tile.number] : offsets[tile.number + 1]]]
        model = self.case.model(skeleton)
        found = model.solution(mine)
        edges = skeleton.edges
        ways = np.linalg.norm(found.displacements, axis=1)[edges]
        ends = skeleton.nodes[edges].reshape(-1, 6)
        carried = [found.stresses, found.buckling_utilization, found.utilization]
        rows = [ends, model.edge_radii, ways, found.axial, np.stack(carried, axis=1)]
        return _saved([np.concatenate(rows, axis=1)])

    def join(self, files: Iterable[Path], path: Path) -> None:
        """Write the rows of all struts as .npy, or their sums and extremes as JSON."""
        tables = (np.load(file, mmap_mode="r") for file in files)
        if path.suffix == ".npy":
            np.save(path, np.concatenate(list(tables)))
            return
        path.write_text(json.dumps(self._summary(tables), indent=1) + "\n", "utf-8")

    def _summary(self, tables: Iterator[np.ndarray]) -> dict[str, Any]:
        count, overloaded = 0, 0
        most = np.zeros(len(COLUMNS))
        worst = np.zeros((0, len(COLUMNS)))
        for table in tables:
            count += len(table)
            overloaded += int((table[:, -1] > 1.0).sum())
            most = np.maximum(most, np.abs(table).max(axis=0))
            both = np.concatenate([worst, table])
            worst = both[np.argsort(-both[:, -1], kind="stable")[:SHOWN]]
        named = dict(zip(COLUMNS, most.tolist(), strict=True))
        return {
            "struts": count,
            "overloaded_struts": overloaded,
            "largest_displacement_mm": max(named["moved1_mm"], named["moved2_mm"]),
            "largest_stress_MPa": named["stress_MPa"],
            "buckling_utilization": named["buckling_utilization"],
            "utilization": named["utilization"],
            "most_used": [dict(zip(COLUMNS, row, strict=True)) for row in worst.tolist()],
        }


@dataclass(frozen=True, eq=False)
class _Part:
    """The equations of a tile's own struts, but for their numbers."""

    nodes: Floats
    indptr: Ints
    indices: Ints
    fixed: Bools
    displacement: Floats
    loaded: Bools
    """Nodes that each load is on, shape (loads, n)."""
    weight: Floats
    """What struts push back with that carry their weight, shape (n, 6)."""


def _assembled(
    paths: list[Path], parts: list[_Part], places: list[Ints], count: int
) -> sparse.bsr_array:
    """Return the stiffness of all `count` nodes, of which one tile's is read at a time."""
    keys = []
    for part, at in zip(parts, places, strict=True):
        row = np.repeat(np.arange(len(part.nodes)), np.diff(part.indptr))
        keys.append(at[row] * count + at[part.indices])
    every = np.unique(np.concatenate(keys))
    data = np.zeros((len(every), 6, 6))
    for path, key in zip(paths, keys, strict=True):
        data[np.searchsorted(every, key)] += _arrays_of(path)[-1]  # a tile has each key once
    row, column = np.divmod(every, count)
    offsets = np.concatenate([[0], np.cumsum(np.bincount(row, minlength=count))])
    return sparse.bsr_array((data, column, offsets), shape=(6 * count, 6 * count))


@lru_cache(maxsize=1)
def _moved(path: str, digest: str) -> tuple[np.ndarray, ...]:  # noqa: ARG001  (of its content)
    """Return what `Stiffness.join` wrote."""
    return tuple(_arrays_of(Path(path)))


def _saved(arrays: list[np.ndarray]) -> bytes:
    file = BytesIO()
    for array in arrays:
        np.save(file, array)
    return file.getvalue()


def _arrays_of(path: Path, count: int | None = None) -> list[np.ndarray]:
    """Return the first `count` arrays of a file, or all of them."""
    with path.open("rb") as file:
        return list(islice(_arrays(file), count))


def _arrays(file: IO[bytes]) -> Iterator[np.ndarray]:
    while file.peek(1):  # type: ignore[attr-defined]  # files that are read are buffered
        yield np.load(file)
