"""The unit cells known by name, and how more of them are made known.

Most are nets of nearest neighbours: all sites in the unit cube, struts between those at one
distance.
"""

from __future__ import annotations

from difflib import get_close_matches
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import check_kind
from scaffold_cad.base.arrays import Edges, Ints, Points
from scaffold_cad.base.vectors import length
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice.repetition import repeated
from scaffold_cad.lattice.unitcell import UnitCell, check_periodic
from scaffold_cad.skeleton import check_skeleton

CORNER = [[0, 0, 0]]
CENTER = [[0.5, 0.5, 0.5]]
FACE_CENTERS = [[0, 0.5, 0.5], [0.5, 0, 0.5], [0.5, 0.5, 0]]
EDGE_CENTERS = [[0.5, 0, 0], [0, 0.5, 0], [0, 0, 0.5]]
QUARTERS = list(product([0.25, 0.75], repeat=3))


def cells() -> dict[str, UnitCell]:
    """Return all known unit cells by name; `print` one to see what it is.

    Examples
    --------
    >>> from scaffold_cad import cells
    >>> cells()["bcc"].edges.shape
    (8, 2)
    """
    return dict(_CELLS)


def unit_cell(name: str) -> UnitCell:
    """Return the known unit cell called `name`; case does not matter, nor which of " -+_" it has.

    Raises
    ------
    OptionError
        If no cell has that name, or it is no text.
    """
    check_kind(name, str)
    key = _key(name)
    if key not in _CELLS:
        near = get_close_matches(key, _CELLS, n=1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise OptionError(f"unit cell is {name!r}; need one of {', '.join(_CELLS)}{hint}")
    return _CELLS[key]


def register_cell(cell: UnitCell, *, periodic: bool = True) -> None:
    """Make `cell` known by its name.

    Parameters
    ----------
    cell : unit cell
    periodic : whether neighbouring cells must meet on all faces; without it, only that a
        lattice of it is a valid skeleton

    Raises
    ------
    OptionError
        If it is no unit cell, or another one has that name.
    SkeletonError
        If the cell is not periodic, or a lattice of it is not a valid skeleton.

    Examples
    --------
    >>> from scaffold_cad import UnitCell, cells, register_cell
    >>> register_cell(UnitCell("pillar", [[0, 0, 0], [0, 0, 1]], [[0, 1]]), periodic=False)
    >>> "pillar" in cells()
    True
    """
    check_kind(cell, UnitCell)
    key = _key(cell.name)
    if key in _CELLS:
        raise OptionError(f"a unit cell called {key!r} exists already; need another name")
    if periodic:
        check_periodic(cell)
    check_skeleton(repeated(cell, cell.proportions, (2, 2, 2)).skeleton(1.0))
    _CELLS[key] = cell


def as_cell(cell: str | UnitCell) -> UnitCell:
    """Return `cell`, looked up if it is a name; refuse anything else."""
    if isinstance(cell, str):
        return unit_cell(cell)
    check_kind(cell, UnitCell, "name of one")
    return cell


def _key(name: str) -> str:
    return name.strip().lower().translate(str.maketrans(" -+", "___"))


# ---------------------------------------------------------------------------------------------
# How the cells below are made
# ---------------------------------------------------------------------------------------------


def _copies(sites: ArrayLike) -> Points:
    """Return all copies of `sites` (k, 3) in the closed unit cube."""
    steps = np.array(list(product([0, 1], repeat=3)))
    moved = (np.asarray(sites, dtype=np.float64)[:, None] + steps).reshape(-1, 3)
    copies: Points = moved[(moved <= 1 + 1e-12).all(axis=1)]
    return copies


def _pairs(a: Points, b: Points, distance: float) -> Edges:
    """Return pairs of a row of `a` and a row of `b` that are `distance` apart, (m, 2)."""
    gaps = length(a[:, None] - b)
    return np.argwhere(np.abs(gaps - distance) < 1e-9)


def _net(name: str, sites: ArrayLike, distance: float, description: str) -> UnitCell:
    """Return the cell with struts between all copies of `sites` that are `distance` apart."""
    nodes = _copies(sites)
    edges = _pairs(nodes, nodes, distance)
    return _cell(name, nodes, edges[edges[:, 0] < edges[:, 1]], description)


def _two_nets(
    name: str, sites: ArrayLike, others: ArrayLike, distance: float, description: str
) -> UnitCell:
    """Return the cell with struts between `sites` and `others` that are `distance` apart."""
    a, b = _copies(sites), _copies(others)
    edges = _pairs(a, b, distance) + np.array([0, len(a)])
    return _cell(name, np.concatenate([a, b]), edges, description)


def _cell(
    name: str,
    nodes: ArrayLike,
    edges: Ints,
    description: str,
    proportions: ArrayLike = (1.0, 1.0, 1.0),
) -> UnitCell:
    """Return the cell without the nodes that no strut reaches."""
    used = np.unique(edges)
    kept = np.asarray(nodes, dtype=np.float64)[used]
    return UnitCell(
        name, kept, np.searchsorted(used, edges), description, np.asarray(proportions, dtype=float)
    )


def _merged(name: str, *parts: UnitCell, description: str) -> UnitCell:
    """Return the cell with the struts of all `parts`."""
    nodes, edges = parts[0].nodes, parts[0].edges
    for part in parts[1:]:
        gaps = length(part.nodes[:, None] - nodes)
        known = gaps.min(axis=1) < 1e-9
        rank = np.where(known, gaps.argmin(axis=1), len(nodes) + np.cumsum(~known) - 1)
        nodes = np.concatenate([nodes, part.nodes[~known]])
        edges = np.concatenate([edges, rank[part.edges]])
    return _cell(name, nodes, edges, description)


def _kelvin() -> UnitCell:
    steps = [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)]
    signs = np.array(list(product([-1, 1], repeat=3)))
    nodes = np.unique((np.array(steps)[:, None] * signs).reshape(-1, 3), axis=0) / 4 + 0.5
    edges = _pairs(nodes, nodes, np.sqrt(2) / 4)
    return _cell(
        "kelvin",
        nodes,
        edges[edges[:, 0] < edges[:, 1]],
        "Truncated octahedron, the cell of Kelvin's foam.",
    )


def _truncated_cube() -> UnitCell:
    cut = 1 / (2 + np.sqrt(2))
    sites = [cut * np.eye(3), (1 - cut) * np.eye(3)]
    return _net(
        "truncated_cube",
        np.concatenate(sites),
        1 - 2 * cut,
        "Cube with its corners cut off, so that all struts have one length.",
    )


def _auxetic() -> UnitCell:
    corners = [[x, y, z / 8] for x in (0, 1) for y in (0, 1) for z in (1, 7)]
    axis = [[0.5, 0.5, z / 8] for z in (0, 3, 5, 8)]
    columns = [[k, k + 1] for k in (0, 2, 4, 6)]
    arms = [[k + high, 9 + high] for k in (0, 2, 4, 6) for high in (0, 1)]
    return _cell(
        "auxetic",
        corners + axis,
        np.array([*columns, [8, 9], [10, 11], *arms]),
        "Re-entrant: gets wider in x and y when it is pulled along z.",
    )


def _hexagonal_prism() -> UnitCell:
    # One row of hexagons' vertical sides lies in the faces x = 0 and 1, the next row's in the
    # middle: the rectangle that repeats holds two hexagons.
    flat: list[list[float]] = [
        [0, 0],
        [0, 1 / 3],
        [1, 0],
        [1, 1 / 3],
        [0.5, 0.5],
        [0.5, 5 / 6],
        [0, 1],
        [1, 1],
    ]
    ring = np.array([[0, 1], [2, 3], [1, 4], [3, 4], [4, 5], [5, 6], [5, 7]])
    nodes = [[*place, z] for z in (0, 1) for place in flat]
    uprights = np.arange(len(flat))[:, None] + np.array([0, len(flat)])
    return _cell(
        "hexagonal_prism",
        nodes,
        np.concatenate([ring, ring + len(flat), uprights]),
        "Honeycomb of regular hexagons in layers, joined along z.",
        proportions=(1.0, np.sqrt(3), 1.0),
    )


def _gyroid() -> UnitCell:
    # The net srs: sites 8a of space group I4₁32, moved by an eighth so that no strut passes
    # through a face of the cube.
    first = np.array([[0, 0, 0], [2, 6, 4], [6, 4, 2], [4, 2, 6]]) / 8
    sites = np.concatenate([first, (first + 0.5) % 1])
    return _net(
        "gyroid",
        sites,
        np.sqrt(2) / 4,
        "Skeleton of the gyroid, the net of least valency.",
    )


def _known() -> list[UnitCell]:
    sc = _net("sc", CORNER, 1.0, "Simple cubic: the edges of a cube.")
    bcc = _two_nets(
        "bcc",
        CENTER,
        CORNER,
        np.sqrt(3) / 2,
        "Body-centred cubic: from the centre of a cube to its corners.",
    )
    uprights = _cell(
        "uprights",
        [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)],
        np.arange(8).reshape(4, 2),
        "",
    )
    return [
        sc,
        bcc,
        _merged("bcc_sc", bcc, sc, description="Body-centred and simple cubic together."),
        _merged("bccz", bcc, uprights, description="Body-centred cubic with struts along z."),
        _two_nets(
            "fcc",
            CORNER,
            FACE_CENTERS,
            np.sqrt(0.5),
            "Face-centred cubic: the diagonals of a cube's faces.",
        ),
        _net(
            "octet",
            CORNER + FACE_CENTERS,
            np.sqrt(0.5),
            "Octet truss: face-centred cubic with an octahedron inside.",
        ),
        _kelvin(),
        _net(
            "diamond",
            CORNER + FACE_CENTERS + [QUARTERS[k] for k in (0, 3, 5, 6)],
            np.sqrt(3) / 4,
            "Bonds of diamond: every strut meets three others at tetrahedral angles.",
        ),
        _two_nets(
            "rhombic_dodecahedron",
            CORNER + FACE_CENTERS,
            QUARTERS,
            np.sqrt(3) / 4,
            "Rhombic dodecahedra that fill space.",
        ),
        _truncated_cube(),
        _net(
            "cuboctahedron",
            EDGE_CENTERS,
            np.sqrt(0.5),
            "Cuboctahedron: the middles of a cube's edges joined.",
        ),
        _auxetic(),
        _hexagonal_prism(),
        _gyroid(),
    ]


_CELLS = {cell.name: cell for cell in _known()}
