"""The unit cells known by name from the start.

Most are nets of nearest neighbors: all sites in the unit cube, struts between those at one
distance.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from scaffold_cad.lattice.nets import (
    CENTER,
    CORNER,
    EDGE_CENTERS,
    FACE_CENTERS,
    QUARTERS,
    cell_of,
    merged,
    net,
    pairs_apart,
    two_nets,
)
from scaffold_cad.lattice.unitcell import UnitCell


def _kelvin() -> UnitCell:
    steps = [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)]
    signs = np.array(list(product([-1, 1], repeat=3)))
    nodes = np.unique((np.array(steps)[:, None] * signs).reshape(-1, 3), axis=0) / 4 + 0.5
    edges = pairs_apart(nodes, nodes, np.sqrt(2) / 4)
    return cell_of(
        "kelvin",
        nodes,
        edges[edges[:, 0] < edges[:, 1]],
        "Truncated octahedron, the cell of Kelvin's foam.",
    )


def _truncated_cube() -> UnitCell:
    cut = 1 / (2 + np.sqrt(2))
    sites = [cut * np.eye(3), (1 - cut) * np.eye(3)]
    return net(
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
    return cell_of(
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
    return cell_of(
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
    return net(
        "gyroid",
        sites,
        np.sqrt(2) / 4,
        "Skeleton of the gyroid, the net of least valency.",
    )


def named_cells() -> list[UnitCell]:
    """Return the cells."""
    sc = net("sc", CORNER, 1.0, "Simple cubic: the edges of a cube.")
    bcc = two_nets(
        "bcc",
        CENTER,
        CORNER,
        np.sqrt(3) / 2,
        "Body-centered cubic: from the center of a cube to its corners.",
    )
    uprights = cell_of(
        "uprights",
        [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)],
        np.arange(8).reshape(4, 2),
        "",
    )
    return [
        sc,
        bcc,
        merged("bcc_sc", bcc, sc, description="Body-centered and simple cubic together."),
        merged("bccz", bcc, uprights, description="Body-centered cubic with struts along z."),
        two_nets(
            "fcc",
            CORNER,
            FACE_CENTERS,
            np.sqrt(0.5),
            "Face-centered cubic: the diagonals of a cube's faces.",
        ),
        net(
            "octet",
            CORNER + FACE_CENTERS,
            np.sqrt(0.5),
            "Octet truss: face-centered cubic with an octahedron inside.",
        ),
        _kelvin(),
        net(
            "diamond",
            CORNER + FACE_CENTERS + [QUARTERS[k] for k in (0, 3, 5, 6)],
            np.sqrt(3) / 4,
            "Bonds of diamond: every strut meets three others at tetrahedral angles.",
        ),
        two_nets(
            "rhombic_dodecahedron",
            CORNER + FACE_CENTERS,
            QUARTERS,
            np.sqrt(3) / 4,
            "Rhombic dodecahedra that fill space.",
        ),
        _truncated_cube(),
        net(
            "cuboctahedron",
            EDGE_CENTERS,
            np.sqrt(0.5),
            "Cuboctahedron: the middles of a cube's edges joined.",
        ),
        _auxetic(),
        _hexagonal_prism(),
        _gyroid(),
    ]
