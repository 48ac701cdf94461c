"""More cells that the field uses, and families of cells with parameters."""

from __future__ import annotations

from itertools import product

import numpy as np

from scaffold_cad.base.arguments import as_real, checks_keywords
from scaffold_cad.base.arrays import Points
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice.nets import (
    CENTER,
    CORNER,
    FACE_CENTERS,
    cell_of,
    merged,
    net,
    spaced_net,
    two_nets,
)
from scaffold_cad.lattice.unitcell import UnitCell


def more_cells() -> list[UnitCell]:
    """Return the cells."""
    bcc = two_nets("bcc", CENTER, CORNER, np.sqrt(3) / 2, "")
    fcc = two_nets("fcc", CORNER, FACE_CENTERS, np.sqrt(0.5), "")
    spokes = two_nets("spokes", CENTER, FACE_CENTERS, 0.5, "")
    return [
        merged(
            "fbcc",
            fcc,
            bcc,
            description="Face- and body-centered cubic together: diagonals of faces and of space.",
        ),
        merged(
            "star",
            bcc,
            spokes,
            description="From the center of a cube to its corners and the middles of its faces.",
        ),
        _pyrochlore(),
        _weaire_phelan(),
        _triangular_prism(),
        reentrant_honeycomb(),
    ]


@checks_keywords()
def reentrant_cell(depth: float = 0.25, height: float = 0.75, name: str = "reentrant") -> UnitCell:
    """Return a re-entrant cell: wider in x and y when it is pulled along z.

    At each corner of the square of x and y stands a column of length `height`, from whose ends
    arms lead to a column in the middle of the square, `depth` further in. The cell `auxetic` has
    the defaults.

    Parameters
    ----------
    depth : how far arms slant inwards along z, in cells, in (0, height / 2); more depth makes a
        Poisson's ratio closer to 0, arms that lie flat one that is large and negative
    height : length of the columns at the corners, in cells, in (0, 1)
    name : of the cell

    Raises
    ------
    OptionError
        If a number is out of its range.

    References
    ----------
    Evans, Nkansah, Hutchinson, Rogers, Molecular network design, Nature 353, 1991.
    """
    if not 0 < as_real(height, "height") < 1:
        raise OptionError(f"height is {height:g}; need more than 0, less than 1")
    if not 0 < as_real(depth, "depth") < height / 2:
        raise OptionError(f"depth is {depth:g}; need more than 0, less than half the height")
    low, high = (1 - height) / 2, (1 + height) / 2
    corners = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (low, high)]
    axis = [[0.5, 0.5, z] for z in (0, low + depth, high - depth, 1)]
    columns = [[k, k + 1] for k in (0, 2, 4, 6)]
    arms = [[k + end, 9 + end] for k in (0, 2, 4, 6) for end in (0, 1)]
    return cell_of(
        name,
        corners + axis,
        np.array([*columns, [8, 9], [10, 11], *arms]),
        f"Re-entrant: arms {depth:g} deep between columns {height:g} high.",
    )


@checks_keywords()
def reentrant_honeycomb(
    angle: float = np.pi / 6, ratio: float = 2.0, name: str = "reentrant_honeycomb"
) -> UnitCell:
    """Return layers of bow-tie hexagons, joined along z: wider in x when they are pulled along y.

    Parameters
    ----------
    angle : by which the slanted sides lean inwards from the x axis, rad, in (0, π/2)
    ratio : length of the upright sides over that of the slanted ones, > 2 sin(angle)
    name : of the cell

    Raises
    ------
    OptionError
        If a number is out of its range.

    References
    ----------
    Gibson, Ashby, Schajer, Robertson, The mechanics of two-dimensional cellular materials, 1982.
    """
    if not 0 < as_real(angle, "angle") < np.pi / 2:
        raise OptionError(f"angle is {angle:g} rad; need more than 0, less than pi/2")
    sine = float(np.sin(angle))
    if not 2 * sine < as_real(ratio, "ratio") < np.inf:
        raise OptionError(f"ratio is {ratio:g}; need more than {2 * sine:g} at this angle")
    width, tall = 2 * float(np.cos(angle)), 2 * (ratio - sine)
    # Uprights stand in x = 0 and in the middle, half a period apart along y.
    upright = ratio / tall
    # In the middle the upright passes through y = 0: half of it at each end.
    flat = [
        [0, 0.5 - upright / 2],
        [0, 0.5 + upright / 2],
        [1, 0.5 - upright / 2],
        [1, 0.5 + upright / 2],
        [0.5, 0],
        [0.5, upright / 2],
        [0.5, 1 - upright / 2],
        [0.5, 1],
    ]
    ring = np.array([[0, 1], [2, 3], [4, 5], [6, 7], [0, 5], [2, 5], [1, 6], [3, 6]])
    nodes = [[*place, z] for z in (0, 1) for place in flat]
    uprights = np.array([0, 1, 2, 3, 5, 6])[:, None] + np.array([0, len(flat)])
    return cell_of(
        name,
        nodes,
        np.concatenate([ring, ring + len(flat), uprights]),
        "Re-entrant honeycomb in layers, joined along z: gets wider when it is pulled along y.",
        proportions=(1.0, tall / width, 1.0),
    )


def _pyrochlore() -> UnitCell:
    quarter = np.array([[0, 0, 0], [1, 1, 0], [1, 0, 1], [0, 1, 1]]) / 4
    moves = np.array(CORNER + FACE_CENTERS)
    sites = (quarter[:, None] + moves).reshape(-1, 3) % 1
    return net(
        "pyrochlore",
        sites,
        np.sqrt(2) / 4,
        "Tetrahedra that share their corners, as in Laves phases: as stiff as its struts allow.",
    )


def _weaire_phelan() -> UnitCell:
    """Return the edges of the Voronoi cells of the structure A15: 46 nodes, 92 struts.

    Weaire, Phelan, A counter-example to Kelvin's conjecture on minimal surfaces, 1994. Corners of
    cells: equally far from four sites of A15, in closed form.
    """
    thirds = 5 / 24 * np.array(list(product([-1, 1], repeat=3)))
    eighths = np.concatenate([thirds, thirds + 0.5])  # (x, x, x) and around the center
    flat = (_turned(5 / 32, 5 / 16), _turned(5 / 16, 5 / 32) + 0.5)
    middles = np.array([[0, 1, 2], [0, 3, 2], [2, 0, 1], [2, 0, 3], [1, 2, 0], [3, 2, 0]]) / 4
    sites = np.concatenate([eighths, *flat, middles]) % 1
    _, first = np.unique(np.round(sites, 9) % 1, axis=0, return_index=True)
    spans = [np.sqrt(3) / 12, np.sqrt(525) / 96, 5 / 16, np.sqrt(45) / 32]
    return spaced_net(
        "weaire_phelan",
        sites[first],
        spans,
        "Weaire and Phelan's foam: two kinds of cells of less area than Kelvin's.",
    )


def _turned(y: float, z: float) -> Points:
    """Return (0, ±y, ±z) with its coordinates turned round, shape (12, 3)."""
    first = np.array([[0.0, y * a, z * b] for a in (-1, 1) for b in (-1, 1)])
    return np.concatenate([np.roll(first, k, axis=1) for k in range(3)])


def _triangular_prism() -> UnitCell:
    sites = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0]]
    along = [(site, site, move) for site in (0, 1) for move in ((1, 0, 0), (0, 0, 1))]
    slanted = [(0, 1, (-a, -b, 0)) for a in (0, 1) for b in (0, 1)]
    return UnitCell.of_net(
        "triangular_prism",
        sites,
        [(one, other) for one, other, _ in along + slanted],
        [move for _, _, move in along + slanted],
        "Equilateral triangles in layers, joined along z.",
        proportions=(1.0, np.sqrt(3), 1.0),
    )
