"""Lattices: a unit cell repeated along x, y and z, and bent into any other shape."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_flag, check_kind, checks_keywords, described
from scaffold_cad.base.arrays import Floats, Points, as_floats
from scaffold_cad.base.radii import Radius
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice.maps.cellmap import CellMap
from scaffold_cad.lattice.maps.grading import CellSize
from scaffold_cad.lattice.maps.placing import Counts, lattice_on, three_counts
from scaffold_cad.lattice.registry import as_cell
from scaffold_cad.lattice.repetition import as_counts, repeated
from scaffold_cad.lattice.unitcell import UnitCell, as_three
from scaffold_cad.skeleton import Skeleton


@checks_keywords()
def tile(
    cell: str | UnitCell,
    size: CellSize | None = None,
    counts: Counts | None = None,
    *,
    radius: Radius,
    on: CellMap | None = None,
    dangling: bool = True,
) -> Skeleton:
    """Return the lattice of `counts` cells along x, y and z from the origin, or cells on a map.

    Nodes and struts that cells share appear once. Struts that leave their cell stay whole: those of
    `weaire_phelan` and `triangular_prism` reach past the last cells by 0.16 and 0.5 of one; `fill`
    cuts them.

    Parameters
    ----------
    cell : a unit cell or its name, see `cells`
    size : of one cell, mm: three numbers, or one for a cell that is not distorted
    counts : cells along x, y and z, or one number for all three
    radius : mm; one number, or a function of positions (n, 3) that returns radii (n,)
    on : a map of cells, such as `CylinderMap` or `face_map` of a build123d face; it needs either
        the size of a cell, which may then be a function of positions, or counts along u, v and w.
        `lattice_on` returns the same with its stretch
    dangling : whether struts that end free at the border of a trimmed map stay

    Raises
    ------
    OptionError
        If the cell is not known, a size, a count or a radius is not > 0, or there are more than
        1e8 struts.
    SkeletonError
        If a map folds cells, or they do not meet between its patches.

    Examples
    --------
    >>> from scaffold_cad import tile
    >>> len(tile("bcc", 8.0, counts=2, radius=0.5).edges)  # 8 cells of 8 struts
    64
    """
    if on is not None:
        return lattice_on(
            on, cell, radius=radius, size=size, counts=counts, dangling=dangling
        ).skeleton
    if not as_flag(dangling, "dangling"):
        raise OptionError("dangling is False without a map, whose border cuts struts; need a map")
    if size is None or callable(size):
        raise OptionError(
            f"cell size in mm is {described(size)}; need one number or three without a map"
        )
    cell = as_cell(cell)
    struts = repeated(cell, cell_size(cell, size), as_counts(cell, three_counts(counts)))
    return struts.skeleton(radius)


@checks_keywords()
def mapped(
    skeleton: Skeleton, mapping: Callable[[Points], ArrayLike], *, weld: bool = True
) -> Skeleton:
    """Return `skeleton` with its nodes moved by `mapping`; struts stay straight.

    So a lattice follows a surface or fills a bent body: tile it in the coordinates of the body
    and map these to positions.

    Parameters
    ----------
    skeleton : of any kind
    mapping : function of positions (n, 3) that returns positions (n, 3), mm
    weld : whether nodes that come to lie on each other become one, as at the seam of a ring

    Raises
    ------
    OptionError
        If `skeleton` is not a Skeleton, or `mapping` returns another shape.
    SkeletonError
        If a position that it returns is not finite.

    Examples
    --------
    >>> from scaffold_cad import mapped, tile
    >>> box = tile("sc", 5.0, 2, radius=0.5)
    >>> float(mapped(box, lambda points: points * [1, 1, 2]).nodes.max())
    20.0
    """
    check_kind(skeleton, Skeleton)
    if not callable(mapping):
        check_kind(mapping, "function of positions", name="mapping")
    nodes = np.asarray(mapping(skeleton.nodes))
    if nodes.shape != skeleton.nodes.shape:
        raise OptionError(f"mapping returned shape {nodes.shape}; need {skeleton.nodes.shape}")
    moved = skeleton.moved(nodes)
    return moved.cleaned().skeleton if weld else moved


def cell_size(cell: UnitCell, size: ArrayLike) -> Floats:
    """Return `size` as three numbers; one number is the size along x of an undistorted cell.

    Raises
    ------
    OptionError
        If a number is not finite and > 0.
    """
    sizes = as_floats(size, "cell size in mm", OptionError)
    if sizes.ndim == 0:
        sizes = sizes * cell.proportions / cell.proportions[0]
    return as_three(sizes, "cell size in mm")
