"""Lattices: a unit cell repeated along x, y and z, and bent into any other shape."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import check_kind
from scaffold_cad.base.arrays import Floats, Ints, Points, as_floats
from scaffold_cad.base.radii import Radius
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice.registry import as_cell
from scaffold_cad.lattice.repetition import as_counts, repeated
from scaffold_cad.lattice.unitcell import UnitCell, as_three
from scaffold_cad.skeleton import Skeleton


def tile(
    cell: str | UnitCell, size: ArrayLike, counts: int | tuple[int, int, int], *, radius: Radius
) -> Skeleton:
    """Return the lattice of `counts` cells along x, y and z from the origin.

    Nodes and struts that cells share appear once.

    Parameters
    ----------
    cell : a unit cell or its name, see `cells`
    size : of one cell, mm: three numbers, or one for a cell that is not distorted
    counts : cells along x, y and z, or one number for all three
    radius : mm; one number, or a function of positions (n, 3) that returns radii (n,)

    Raises
    ------
    OptionError
        If the cell is not known, a size, a count or a radius is not > 0, or there are more than
        1e8 struts.
    """
    cell = as_cell(cell)
    struts = repeated(cell, cell_size(cell, size), as_counts(cell, _three(counts)))
    return struts.skeleton(radius)


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
        If `skeleton` is none, or `mapping` returns another shape.
    SkeletonError
        If a position that it returns is not finite.
    """
    check_kind(skeleton, Skeleton)
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


def _three(counts: int | tuple[int, int, int]) -> Ints:
    """Return `counts` as three whole numbers, shape (3,)."""
    values = np.asarray(counts)
    if values.shape not in {(), (3,)} or values.dtype.kind not in "iu" or (values < 1).any():
        raise OptionError(f"counts are {counts}; need three whole numbers >= 1")
    return np.broadcast_to(values, 3)
