"""UnitCell: the block of struts that a lattice repeats, and its motif, where each counts once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import checks_keywords, described
from scaffold_cad.base.arrays import (
    LARGEST_COORDINATE,
    Edges,
    Floats,
    Frames,
    Frozen,
    Points,
    as_floats,
    as_points,
    read_only,
)
from scaffold_cad.base.topology import valencies
from scaffold_cad.base.vectors import length
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.lattice.cellpictures import graph_picture
from scaffold_cad.lattice.motifs import FACE_TOLERANCE, Motif, motif_of, net_motif
from scaffold_cad.skeleton import Skeleton, check_skeleton

RIGHT_ANGLE = 1e-9
"""Difference below which an angle is a right one, rad."""

LEAST_HEIGHT = 1e-6
"""Least square of the height of a slanted cell whose sides are 1 long."""


@checks_keywords()
@dataclass(frozen=True, eq=False)
class UnitCell(Frozen):
    """A block of struts in the unit cube, repeated along x, y and z to make a lattice.

    Struts and nodes on the faces are shared with the neighboring cells. List a strut that lies
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
    """Size along its three sides of a cell of size 1 that is not distorted, shape (3,)."""
    axes: Frames
    """Unit directions of its three sides, rows, shape (3, 3): those of x, y and z, or slanted."""

    def __init__(
        self,
        name: str,
        nodes: ArrayLike,
        edges: ArrayLike,
        description: str = "",
        proportions: ArrayLike = (1.0, 1.0, 1.0),
        angles: ArrayLike = (np.pi / 2, np.pi / 2, np.pi / 2),
    ) -> None:
        """Take a cell.

        Parameters
        ----------
        name : of the cell
        nodes : positions in the unit cube (n, 3), fractions of the sides
        edges : node pairs (m, 2)
        description : one sentence on what the cell is
        proportions : lengths of its sides a, b and c
        angles : between b and c, c and a, a and b (α, β, γ as in crystallography), rad
        """
        if not isinstance(name, str) or not name.strip():
            raise OptionError(
                f"a unit cell's name is {described(name)}; need a text that is not blank"
            )
        try:
            struts = Skeleton(_snapped(as_points(nodes, "nodes")), edges, 1.0)
            check_skeleton(struts)
        except SkeletonError as error:
            raise SkeletonError(f"unit cell {name!r}, as a cube of 1 mm: {error}") from None
        self._keep(
            name=name,
            nodes=struts.nodes,
            edges=struts.edges,
            description=description,
            proportions=as_three(proportions, f"proportions of unit cell {name!r}"),
            axes=cell_axes(angles, name),
        )

    def __str__(self) -> str:
        valency = " and ".join(str(n) for n in self.valencies)
        return (
            f"{self.name}: {self.description} Struts a cell {self.strut_count}, "
            f"nodes per cell {self.site_count}, valency {valency}, "
            f"Maxwell's count {self.maxwell_number}, "
            f"relative density about {self.density_coefficient:.4g} (r/a)²."
        )

    def _repr_svg_(self) -> str:
        """Return a picture for notebooks."""
        return cell_picture(self)

    @cached_property
    def motif(self) -> Motif:
        """The nodes and struts of one cell of an endless lattice, each of them once."""
        return motif_of(self.nodes, self.edges)

    @property
    def strut_count(self) -> int:
        """Number of struts per cell of an endless lattice."""
        return len(self.motif.struts)

    @property
    def site_count(self) -> int:
        """Number of nodes per cell of an endless lattice."""
        return len(self.motif.sites)

    @property
    def valencies(self) -> tuple[int, ...]:
        """Valencies that nodes of an endless lattice have, ascending."""
        return tuple(np.unique(valencies(self.motif.struts, self.site_count)).tolist())

    @classmethod
    def of_net(
        cls,
        name: str,
        sites: ArrayLike,
        edges: ArrayLike,
        moves: ArrayLike,
        description: str = "",
        proportions: ArrayLike = (1.0, 1.0, 1.0),
        angles: ArrayLike = (np.pi / 2, np.pi / 2, np.pi / 2),
    ) -> UnitCell:
        """Return the cell of a periodic net, whose struts may go through the faces of the box.

        A block of such cells keeps these struts whole: they stand out of it on the far sides.

        Parameters
        ----------
        name, description, proportions, angles : as for a cell
        sites : positions (k, 3), fractions of the sides, of the nodes of one cell
        edges : pairs of sites (m, 2), each strut of one cell once
        moves : whole cells (m, 3) by which the second site of each strut is moved

        Raises
        ------
        SkeletonError
            If a strut has no length, is listed twice, or leaves a node in the direction of another.

        Examples
        --------
        >>> from scaffold_cad import tile
        >>> chain = UnitCell.of_net("chain", [[0, 0, 0]], [[0, 0]], [[1, 0, 0]])
        >>> len(tile(chain, 10.0, (5, 1, 1), radius=1.0).edges)
        5
        """
        box = cls(name, [[0, 0, 0], [1, 1, 1]], [[0, 1]], description, proportions, angles)
        motif = net_motif(name, sites, edges, moves)
        ends = (motif.sites[motif.struts] + motif.moves).reshape(-1, 3)
        nodes, number = np.unique(ends, axis=0, return_inverse=True)
        cell = object.__new__(cls)
        values = {field: getattr(box, field) for field in box.__dataclass_fields__}
        cell._keep(**{**values, "nodes": nodes, "edges": number.reshape(-1, 2), "motif": motif})
        _check_net(cell)
        return cell

    @property
    def is_net(self) -> bool:
        """Whether struts may go through the faces of the box, see `of_net`."""
        return bool(self.nodes.max() > 1.0)

    def strut_lengths(self, size: Floats) -> Floats:
        """Return the length of each strut of the motif in a cell of `size` (3,), shape (s,), mm."""
        motif = self.motif
        ends = motif.sites[motif.struts] + motif.moves  # (s, 2, 3)
        return length(((ends[:, 1] - ends[:, 0]) * size) @ self.axes)

    def volume(self, size: Floats) -> float:
        """Return the volume of a cell of `size` (3,), mm³."""
        return float(size.prod() * np.linalg.det(self.axes))

    @property
    def maxwell_number(self) -> int:
        """Maxwell's count of an endless lattice: struts − 3 nodes + 3 translations − 6 strains.

        Below 0 some strain or motion is resisted by bending alone, however the struts are
        arranged; 0 or more is needed, but does not suffice, for pull and push to carry all.

        References
        ----------
        Deshpande, Ashby, Fleck, Foam topology: bending versus stretching dominated architectures,
        Acta Mater. 49, 2001; Hutchinson, Fleck, JMPS 54, 2006.
        """
        return self.strut_count - 3 * self.site_count - 3

    @property
    def density_coefficient(self) -> float:
        """C in the relative density ρ ≈ C (r/a)² of thin round struts of radius r, cell size a.

        It is π times the strut length in a cell of size 1 over the cell's volume; the overlaps
        at the nodes, of order (r/a)³, are neglected.
        """
        return self.density_coefficient_of(self.proportions)

    def density_coefficient_of(self, size: Floats) -> float:
        """Return the first-order relative density of struts of radius 1 mm, size (3,) in mm."""
        return float(np.pi * self.strut_lengths(size).sum() / self.volume(size))


def check_periodic(cell: UnitCell) -> None:
    """Raise unless neighboring cells meet on all of their common faces.

    Raises
    ------
    SkeletonError
        If a node on a face has no copy on the opposite face, where the neighbor's struts would
        go on, or a strut in a face is not listed in the opposite face.
    """
    if cell.is_net:
        return
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


def _check_net(cell: UnitCell) -> None:
    """Raise unless all struts around each node of a net's lattice are proper.

    Raises
    ------
    SkeletonError
        If one has no length, or leaves a node in the direction of another.
    """
    motif, size = cell.motif, cell.proportions
    ends = (motif.sites[motif.struts] + motif.moves) * size @ cell.axes  # (s, 2, 3)
    spans = ends[:, 1] - ends[:, 0]
    none = np.flatnonzero(~spans.any(axis=1))
    if len(none):
        one, other = motif.struts[none[0]].tolist()
        raise SkeletonError(
            f"net {cell.name!r}: the strut from site {one} to {other} has no length; need one"
        )
    # One node a site, in its middle; its struts end at nodes of their own.
    both = np.concatenate([spans, -spans])
    at = motif.struts.T.reshape(-1)
    middles = 4 * float(np.abs(spans).max(initial=1.0)) * np.arange(len(motif.sites))
    nodes = np.column_stack([middles, np.zeros((len(middles), 2))])
    star = Skeleton(
        np.concatenate([nodes, nodes[at] + both]),
        np.stack([at, len(nodes) + np.arange(len(at))], axis=1),
        1.0,
    )
    unused = np.flatnonzero(np.bincount(at, minlength=len(nodes)) == 0)
    if len(unused):
        raise SkeletonError(f"net {cell.name!r}: site {unused[0]} has no strut; need one")
    try:
        check_skeleton(star)
    except SkeletonError as error:
        raise SkeletonError(f"net {cell.name!r}: {error}") from None


def cell_axes(angles: ArrayLike, name: str) -> Frames:
    """Return the unit directions of a cell's sides, a along x and b in the plane of x and y.

    Parameters
    ----------
    angles : α, β and γ, between b and c, c and a, a and b, rad

    Raises
    ------
    OptionError
        If no cell has these angles.
    """
    three = as_three(angles, f"angles of unit cell {name!r}, rad,")
    right = np.abs(three - np.pi / 2) < RIGHT_ANGLE
    a, b, c = np.where(right, 0.0, np.cos(three)).tolist()
    sine = float(np.sqrt(max(1 - c**2, 0.0)))
    across = (a - b * c) / sine if sine else 0.0
    up = 1 - b**2 - across**2
    if not (sine > 0 and up > LEAST_HEIGHT and (three < np.pi).all()):
        degrees = np.round(np.degrees(three), 6).tolist()
        raise OptionError(
            f"unit cell {name!r} has angles of {degrees} degrees; need three that span space"
        )
    return np.array([[1.0, 0.0, 0.0], [c, sine, 0.0], [b, across, np.sqrt(up)]])


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
    if (three > LARGEST_COORDINATE).any():
        raise OptionError(f"{name} = {three.tolist()}; need at most {LARGEST_COORDINATE:g}")
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


def cell_picture(cell: UnitCell) -> str:
    """Return an SVG picture of one cell in its box."""
    return graph_picture(cell.name, cell.nodes, cell.edges, cell.proportions, cell.axes)
