"""Field solids: the zero set of a filleted union of struts as a watertight triangle mesh.

They are the fallback for round struts that overlap: closed and free of crossings by construction.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.arrays import Floats, Frozen, Ints
from scaffold_cad.base.summaries import counted, range_text, size_text
from scaffold_cad.errors import OptionError
from scaffold_cad.mesh.pieces import Pieces, pieces_of
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.field.cells import check_size, levels_of, memory_of
from scaffold_cad.solid.field.chords import evened
from scaffold_cad.solid.field.creases import with_creases
from scaffold_cad.solid.field.estimates import Estimate, estimated
from scaffold_cad.solid.field.grid import grid_of
from scaffold_cad.solid.field.lattice import (
    FEW_STEPS,
    LEAST_STEPS,
    MOST_CELLS_ASIDE,
    Lattice,
    lattice_over,
    spacing_exponents,
)
from scaffold_cad.solid.field.struts import FieldStruts
from scaffold_cad.solid.field.surface import surface_of
from scaffold_cad.solid.field.union import filleted_union

SIDES = 16
"""How many vertices a ring around a strut has where no number is given, about."""

CELL_SIDES = 9.6
"""Size of a cell times that number, in radii of the struts there."""

MOST_FRACTION, LEAST_FRACTION = 0.6, 0.15
"""Largest and least size of a cell where none is given, as a part of these radii: larger ones fill
what is left between struts of a field that are cut off and face each other, and these are off the
surface by 1e-3 of the radius at most already."""

LARGEST_FRACTION = 1.0
"""Largest cell, as a part of the radius of the struts there: no strut falls between grid points."""

SWELL = 0.0219
"""A mesh with its vertices on a cylinder of radius r, in cells of size h, has the volume of a
cylinder that is thinner by this times h² / r; twice of it for a ball (both measured). Where struts
meet it is another one, see `evened`."""

MOST_SWELL = 2.0 * SWELL * LARGEST_FRACTION**2
"""Most that struts are thicker by for that, as a part of their radius."""

OCTAVE_MEAN = 0.66
"""Size of cells along a cone, as a part of those wanted: sizes are doubled from level to level."""


UNSURE = 0.3
"""What estimates may be too large by."""

QUIET_SECONDS = 10.0
"""Work that takes less is not told, s."""

_log = logging.getLogger(__name__)


@checks_keywords()
@dataclass(frozen=True, eq=False)
class FieldSolid(Frozen):
    """The solid of a filleted union of struts, and how it was made."""

    mesh: TriangleMesh
    """Closed, manifold and free of crossings; every coordinate is a 32-bit number, mm."""
    cells: Floats
    """Size of the finest and of the coarsest cell at the surface, shape (2,), mm."""
    cell_count: int
    """Number of cells at the surface."""
    blend: Floats
    """Fillet radius of each strut, shape (m,), mm."""
    thickened: Ints
    """Struts that are thicker than asked for, as 32-bit numbers are too far apart there or the
    whole is too large for such small cells, shape (k,)."""

    def __str__(self) -> str:
        size = size_text(self.mesh.vertices)
        triangles = counted(len(self.mesh.triangles), "triangle")
        return f"FieldSolid: {triangles}, {size}, cells of {range_text(self.cells)}"

    @cached_property
    def pieces(self) -> Pieces:
        """The connected surfaces of the mesh."""
        return pieces_of(self.mesh)

    @property
    def components(self) -> int:
        """Number of bodies that do not touch."""
        return int((self.pieces.volumes > 0).sum())

    @property
    def cavities(self) -> int:
        """Number of closed voids inside."""
        return int((self.pieces.volumes < 0).sum())


@checks_keywords()
def field_solid(
    struts: FieldStruts,
    *,
    cell: float | None = None,
    sides: int = SIDES,
    sag: float | Floats = np.inf,
    equal_volume: bool = True,
) -> FieldSolid:
    """Return the solid of the filleted union of struts.

    Parameters
    ----------
    struts : from `field_struts`
    cell : mm
        Size of grid cells, at most; smaller where a strut is thinner than this. By default as
        `sides` says. Sizes are m 2^k mm, m in 4..7, so cells may be up to half as large where
        radii differ.
    sides : int
        About how many vertices a ring around a strut has; 16 to 64.
    sag : mm, or (m,)
        How far the sides of triangles may be inside of round surfaces, at most, for each strut:
        cells are smaller for that.
    equal_volume : bool
        Whether vertices stand outside of round surfaces by as much as gives the mesh their
        volume; otherwise they are on them.

    Raises
    ------
    OptionError
        If `cell` is not > 0, or the solid does not fit into memory; the estimate is given.

    Notes
    -----
    The mesh is cut from tetrahedra that share all their faces, and its vertices are on their
    edges exactly, also in 32 bits: so it is closed, manifold and does not cross itself, as built
    and as written. Time and memory grow with the area over the cells' size squared.

    Examples
    --------
    >>> from scaffold_cad.solid.field import field_solid, field_struts
    >>> solid = field_solid(field_struts([[[0, 0, 0], [10, 0, 0]], [[5, -4, 0], [5, 4, 0]]], 1.0))
    >>> solid.components, solid.cavities
    (1, 0)
    """
    if cell is not None and not (np.isfinite(cell) and cell > 0):
        raise OptionError(f"cell is {cell:g} mm; need > 0")
    struts, thickened = held_by_grids(struts)
    sags = np.broadcast_to(np.asarray(sag, dtype=np.float64), len(struts.radii))  # (m,)
    largest = partial(largest_cells, cell, cell_fraction(sides))
    wanted = largest(struts.radii, sags[:, None])  # (m, 2)
    lattice = _lattice(struts, wanted)
    swell = _swell(struts, lattice, wanted) if equal_volume else np.zeros(len(struts.radii))
    union = filleted_union(struts, lattice.origin, swell)
    _foretell(estimated(union, struts, lattice, wanted))
    levels = levels_of(union, lattice, lambda radii, of: largest(radii, sags[of]))
    grid = grid_of(union, lattice, levels)
    surface = surface_of(union, grid)
    vertices = evened(union, surface, swell) if equal_volume else surface.vertices
    mesh = TriangleMesh(vertices + lattice.origin, surface.triangles)
    mesh = with_creases(union, grid, mesh, surface.groups)
    used = np.flatnonzero([len(level.groups) > 0 for level in levels])
    return FieldSolid(
        mesh=mesh,
        cells=np.array([lattice.cell * 2.0**k for k in used[[0, -1]].tolist()]),
        cell_count=grid.cells,
        blend=struts.blend,
        thickened=thickened,
    )


def _foretell(estimate: Estimate | None) -> None:
    """Log what a long work takes; raise at once if it surely does not fit into memory."""
    if estimate is None:
        return
    check_size((1.0 - UNSURE) * estimate.cells / 8)
    if estimate.seconds > QUIET_SECONDS:
        _log.info(
            "a field of some %.2g million cells: %.2g GB of memory and some %.0f s",
            estimate.cells / 1e6,
            memory_of(estimate.cells / 8),
            estimate.seconds,
        )


def cell_fraction(sides: int) -> float:
    """Return the size of a cell as a part of the radius of the struts there, at most."""
    return min(max(CELL_SIDES / sides, LEAST_FRACTION), MOST_FRACTION)


def largest_cells(cell: float | None, fraction: float, radii: Floats, sag: Floats) -> Floats:
    """Return the largest cells where struts have some radii, and sides so much room, mm.

    A side of length h between two points of a circle of radius r is h² / 8 r inside of it.

    Parameters
    ----------
    cell : size that is given, mm
    fraction : part of a radius where none is
    """
    usual = fraction * radii if cell is None else np.minimum(LARGEST_FRACTION * radii, cell)
    return np.minimum(usual, np.sqrt(8.0 * sag * radii))


def held_by_grids(struts: FieldStruts) -> tuple[FieldStruts, Ints]:
    """Return the struts with radii that the grid can hold, and which were too thin."""
    low, high = struts.box()
    extent = float((high - low).max())
    steps = np.ldexp(1.0, spacing_exponents(struts.ends))  # (m, 2)
    least = np.maximum(
        2 * LEAST_STEPS * steps, 2.0 * extent / MOST_CELLS_ASIDE / cell_fraction(SIDES)
    )
    thin = struts.radii < least
    if not thin.any():
        return struts, np.zeros(0, dtype=np.intp)
    radii = np.maximum(struts.radii, least)
    blend = np.maximum(struts.blend, 1e-3 * radii.min(axis=1))
    return replace(struts, radii=radii, blend=blend), np.flatnonzero(thin.any(axis=1))


def _lattice(struts: FieldStruts, wanted: Floats) -> Lattice:
    sizes = struts.fineness.min(axis=1, keepdims=True) * wanted
    steps = np.ldexp(1.0, spacing_exponents(struts.ends))
    few = bool((sizes < FEW_STEPS * steps).any())
    room = np.maximum(struts.blend, MOST_SWELL * struts.radii.max(axis=1))
    low, high = replace(struts, blend=room).box()
    least = max(
        LEAST_STEPS * float(steps.min()), 2.0 * float((high - low).max()) / MOST_CELLS_ASIDE
    )
    return lattice_over(low, high, max(float(sizes.min()), least), few)


def _swell(struts: FieldStruts, lattice: Lattice, wanted: Floats) -> Floats:
    """Return by which part of their radii struts are thicker, for equal volume, shape (m,)."""
    level = np.floor(np.log2(wanted[:, 0] / lattice.cell) + 1e-9)
    even = lattice.cell * 2.0 ** np.maximum(level, 0) / struts.radii[:, 0]
    tapered = OCTAVE_MEAN * (wanted / struts.radii).mean(axis=1)
    parts = np.where(struts.radii[:, 0] == struts.radii[:, 1], even, tapered)
    return SWELL * parts**2 * np.where(struts.lengths > 0, 1, 2)
