"""UnitCell: the block of struts that a lattice repeats, and its motif, where each counts once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arrays import (
    Bools,
    Edges,
    Floats,
    Frozen,
    Ints,
    Points,
    as_floats,
    as_points,
    read_only,
)
from scaffold_cad.base.topology import valencies
from scaffold_cad.base.vectors import length
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.lattice.cellpictures import graph_picture
from scaffold_cad.skeleton import Skeleton, check_skeleton

FACE_TOLERANCE = 1e-9
"""Difference below which two coordinates in the unit cube are the same; no unit."""


@dataclass(frozen=True, eq=False)
class UnitCell(Frozen):
    """A block of struts in the unit cube, repeated along x, y and z to make a lattice.

    Struts and nodes on the faces are shared with the neighbouring cells. List a strut that lies
    in a face in the opposite face too, as it belongs there: in a lattice it appears once.

    Examples
    --------
    >>> from scaffold_cad import UnitCell, tile
    >>> diagonal = UnitCell("diagonal", [[0, 0, 0], [1, 1, 1]], [[0, 1]])
    >>> len(tile(diagonal, 5.0, 2, radius=0.5).edges)
    8
    """

    name: str
    """What the cell is called."""
    nodes: Points
    """Node positions in the unit cube, shape (n, 3), all in 0..1."""
    edges: Edges
    """Node pairs, shape (m, 2), each strut once."""
    description: str
    """One sentence on what the cell is."""
    proportions: Floats
    """Size along x, y and z of a cell of size 1 that is not distorted, shape (3,)."""

    def __init__(
        self,
        name: str,
        nodes: ArrayLike,
        edges: ArrayLike,
        description: str = "",
        proportions: ArrayLike = (1.0, 1.0, 1.0),
    ) -> None:
        if not isinstance(name, str) or not name.strip():
            raise OptionError(f"a unit cell's name is {name!r}; need a text that is not blank")
        try:
            struts = Skeleton(_snapped(as_points(nodes, "nodes")), edges, 1.0)
            check_skeleton(struts)
        except SkeletonError as error:
            raise SkeletonError(f"unit cell {name!r}: {error}") from None
        self._keep(
            name=name,
            nodes=struts.nodes,
            edges=struts.edges,
            description=description,
            proportions=as_three(proportions, f"proportions of unit cell {name!r}"),
        )

    def __str__(self) -> str:
        valency = " and ".join(str(n) for n in self.valencies)
        return (
            f"{self.name}: {self.description} Struts a cell {self.strut_count}, "
            f"nodes a cell {self.site_count}, valency {valency}, "
            f"relative density about {self.density_coefficient:.4g} (r/a)²."
        )

    def _repr_svg_(self) -> str:
        """Return a picture for notebooks."""
        return cell_picture(self)

    @cached_property
    def motif(self) -> Motif:
        """The nodes and struts of one cell of an endless lattice, each of them once."""
        return _motif(self.nodes, self.edges)

    @property
    def strut_count(self) -> int:
        """Number of struts a cell of an endless lattice."""
        return len(self.motif.struts)

    @property
    def site_count(self) -> int:
        """Number of nodes a cell of an endless lattice."""
        return len(self.motif.sites)

    @property
    def valencies(self) -> tuple[int, ...]:
        """Valencies that nodes of an endless lattice have, ascending."""
        return tuple(np.unique(valencies(self.motif.struts, self.site_count)).tolist())

    @property
    def density_coefficient(self) -> float:
        """C in the relative density ρ ≈ C (r/a)² of thin round struts of radius r, cell size a.

        It is π times the strut length in a cell of size 1 over the cell's volume; the overlaps
        at the nodes, of order (r/a)³, are neglected.
        """
        lengths = self.motif.strut_lengths(self.proportions)
        return float(np.pi * lengths.sum() / self.proportions.prod())


@dataclass(frozen=True, eq=False)
class Motif(Frozen):
    """What one cell adds to an endless lattice: sites (nodes) and struts, none shared.

    Any node of the lattice is a site moved by whole cells. A strut joins two sites, each moved
    by 0 or 1 cells along x, y and z, with 0 for at least one of the two along each axis.
    """

    sites: Points
    """Positions in the unit cube, coordinates in [0, 1), shape (k, 3)."""
    site_of_node: Ints
    """Site of which each node of the unit cell is a copy, shape (n,)."""
    struts: Edges
    """Sites that each strut joins, shape (s, 2)."""
    moves: Ints
    """Cells by which each strut's two sites are moved, 0 or 1, shape (s, 2, 3)."""
    copies: Bools
    """Whether the unit cell lists the strut moved by i, j, k cells, shape (s, 2, 2, 2)."""

    def strut_lengths(self, size: Floats) -> Floats:
        """Return the length of each strut in a cell of `size` (3,), shape (s,), in its unit."""
        ends = self.sites[self.struts] + self.moves  # (s, 2, 3)
        return length((ends[:, 1] - ends[:, 0]) * size)


def check_periodic(cell: UnitCell) -> None:
    """Raise unless neighbouring cells meet on all of their common faces.

    Raises
    ------
    SkeletonError
        If a node on a face has no copy on the opposite face, where the neighbour's struts would
        go on, or a strut in a face is not listed in the opposite face.
    """
    motif = cell.motif
    for site, position in enumerate(motif.sites):
        copies = np.flatnonzero(motif.site_of_node == site)
        on_far_face = np.asarray(cell.nodes[copies] == 1.0)  # (c, 3)
        both_faces = on_far_face.any(axis=0) & ~on_far_face.all(axis=0)
        one_sided = (position == 0.0) & ~both_faces
        if one_sided.any():
            raise SkeletonError(
                f"unit cell {cell.name!r}: node {copies[0]} at {cell.nodes[copies[0]].tolist()} "
                f"lies on a face normal to {'xyz'[int(np.argmax(one_sided))]}; "
                "need a copy of it on the opposite face"
            )
    ends: Floats = motif.sites[motif.struts] + motif.moves  # (s, 2, 3)
    in_face = ends.max(axis=1) == 0.0  # (s, 3)
    steps = np.argwhere(np.ones((2, 2, 2)))  # (8, 3)
    needed = (steps <= in_face[:, None]).min(axis=2)  # (s, 8)
    missing = np.argwhere(needed & ~motif.copies.reshape(-1, 8))
    if len(missing):
        strut, step = missing[0]
        start, end = (ends[strut] + steps[step]).tolist()
        raise SkeletonError(
            f"unit cell {cell.name!r}: no strut from {start} to {end}; need one there as in the "
            "opposite face"
        )


def as_three(values: ArrayLike, name: str) -> Floats:
    """Return a read-only copy of `values` as (3,) float64, all finite and > 0.

    Raises
    ------
    OptionError
        If they are not three such numbers.
    """
    three = as_floats(values, name, OptionError)
    if three.shape != (3,) or not (np.isfinite(three) & (three > 0)).all():
        raise OptionError(f"{name} = {three.tolist()}; need three numbers > 0")
    return read_only(three)


def _snapped(nodes: Points) -> Points:
    """Return `nodes` with coordinates that are almost 0 or 1 put there; refuse others outside."""
    snapped = nodes.copy()
    for value in (0.0, 1.0):
        snapped[np.abs(nodes - value) <= FACE_TOLERANCE] = value
    outside = np.flatnonzero(((snapped < 0) | (snapped > 1)).any(axis=1))
    if len(outside):
        place = nodes[outside[0]].tolist()
        raise SkeletonError(f"node {outside[0]} is at {place}; need coordinates in 0..1")
    return snapped


def _motif(nodes: Points, edges: Edges) -> Motif:
    on_far_face = nodes == 1.0
    sites, site_of_node = _sites(np.where(on_far_face, 0.0, nodes))
    moves = on_far_face[edges].astype(np.intp)  # (m, 2, 3)
    cell = moves.min(axis=1)  # (m, 3)
    moves -= cell[:, None]
    # One number an end, whatever cell the strut is listed in; the lower one first.
    ends = site_of_node[edges] * 8 + moves @ np.array([4, 2, 1])  # (m, 2)
    ends.sort(axis=1)
    struts, strut_of_edge = np.unique(ends, axis=0, return_inverse=True)
    copies = np.zeros((len(struts), 2, 2, 2), dtype=np.bool_)
    copies[strut_of_edge.reshape(-1), cell[:, 0], cell[:, 1], cell[:, 2]] = True
    moves = struts[:, :, None] >> np.array([2, 1, 0]) & 1
    return Motif(sites, site_of_node, struts >> 3, moves, copies)


def _sites(positions: Points) -> tuple[Points, Ints]:
    """Return the distinct rows of `positions` (n, 3) and which of them each row is."""
    ranks = np.stack([_ranks(column) for column in positions.T], axis=1)
    _, first, site = np.unique(ranks, axis=0, return_index=True, return_inverse=True)
    return positions[first], site.reshape(-1)


def _ranks(values: Floats) -> Ints:
    """Return the ranks of `values` (n,), the same for values that differ by the tolerance."""
    order = np.argsort(values, kind="stable")
    steps = np.diff(values[order], prepend=values[order[:1]]) > FACE_TOLERANCE
    ranks = np.empty(len(values), dtype=np.intp)
    ranks[order] = np.cumsum(steps)
    return ranks


def cell_picture(cell: UnitCell) -> str:
    """Return an SVG picture of one cell in its box."""
    return graph_picture(cell.name, cell.nodes, cell.edges, cell.proportions)
