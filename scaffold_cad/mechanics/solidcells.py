"""Homogenized cells by hexahedra: right for thick struts too, where beams are too soft."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse
from scipy.spatial import KDTree

from scaffold_cad.base.arguments import as_count, checks_keywords
from scaffold_cad.base.arrays import Floats, Ints, Points
from scaffold_cad.base.vectors import sums_by_row
from scaffold_cad.errors import MeshError
from scaffold_cad.lattice import UnitCell, tile
from scaffold_cad.mechanics.cells import VOIGT_PAIRS, Homogenized, beam_law
from scaffold_cad.mechanics.hexahedra.builder import hexahedra
from scaffold_cad.mechanics.hexahedra.quality import boundary_faces
from scaffold_cad.mechanics.hexahedra.stiffness import elasticity, hexahedron_stiffnesses
from scaffold_cad.mechanics.materials import Material
from scaffold_cad.mechanics.solvers import factor
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton

LEAST_QUALITY = 0.05
"""Scaled Jacobian below which points of hexahedra are moved."""

MEETING = 0.02
"""Distance, in radii, within which points of neighboring cells are one."""


@checks_keywords()
def homogenized_solid(
    cell: str | UnitCell,
    radius: float,
    material: Material | str,
    *,
    size: ArrayLike = 1.0,
    layers: int = 2,
    along: int = 6,
) -> Homogenized:
    """Return the elastic law of an endless lattice of `cell`, by hexahedra of its struts.

    The struts of one cell are cut out of the hexahedra of 3 × 3 × 3 cells; points that are alike
    but for whole cells move alike. Nodes are as stiff as they are, so that the result holds for
    thick struts; for slender ones `homogenized` gives the same in less time.

    Parameters
    ----------
    cell, radius, material, size : as those of `homogenized`
    layers, along : as those of `hexahedra`: more of them, and it is more exact

    Raises
    ------
    OptionError
        If an argument is out of its range.
    MeshError
        If the struts overlap beyond their nodes, or hexahedra are inverted or do not
        repeat from cell to cell.

    Examples
    --------
    >>> from scaffold_cad.mechanics import homogenized, homogenized_solid
    >>> solid = homogenized_solid("sc", 0.15, "steel", layers=1, along=2)
    >>> beams = homogenized("sc", 0.15, "steel")
    >>> bool(solid.shear_axes[0] > beams.shear_axes[0])  # real nodes are stiffer
    True
    """
    beams = beam_law(cell, radius, material, size)
    lattice = tile(beams.cell, beams.size, (3, 3, 3), radius=beams.radius)
    scaffold = build_scaffold(lattice, collars=True)
    struts = _middle_struts(beams, lattice)
    if np.isin(scaffold.embedding().left_out, struts).any():
        raise MeshError(
            f"struts of cell {beams.cell.name!r} of radius {radius:g} mm overlap beyond their "
            "nodes, so that they have no hexahedra; need thinner ones"
        )
    count, pieces = as_count(layers, "layers"), as_count(along, "along", 1)
    # Equal nodes stay equal if nothing moves.
    mesh = hexahedra(scaffold, layers=count, along=pieces, relax=0)
    chosen = np.isin(mesh.edge_of_hexahedron, struts)
    if mesh.quality[chosen].min() < LEAST_QUALITY:
        mesh = hexahedra(scaffold, layers=count, along=pieces)
    bad = int((mesh.quality[chosen] <= 0).sum())
    if bad:
        raise MeshError(
            f"{bad} hexahedra of cell {beams.cell.name!r} are inverted at radius {radius:g} mm; "
            "need thinner struts"
        )
    used, cells = np.unique(mesh.hexahedra[chosen], return_inverse=True)
    points, cells = mesh.points[used], cells.reshape(-1, 8)
    along_sides = points @ np.linalg.inv(beams.cell.axes)
    freedom = _repeating(along_sides, beams.size, MEETING * beams.radius)
    sides = 8 * (int(chosen.sum()) // (8 * count + 4))  # faces on the struts' surfaces
    if len(boundary_faces(freedom[cells])) != sides:
        raise MeshError(
            f"the hexahedra of cell {beams.cell.name!r} do not repeat at radius {radius:g} mm; "
            "need thinner struts"
        )
    stiffness = _condensed(points, cells, freedom, elasticity(beams.material))
    volume = beams.cell.volume(beams.size)
    stiffness = (stiffness + stiffness.T) / (2.0 * volume)
    filled = float(mesh.volumes[chosen].sum() / volume)
    return replace(beams, stiffness=stiffness, relative_density=filled)


def _middle_struts(law: Homogenized, lattice: Skeleton) -> Ints:
    """Return the struts of the middle one of 3 × 3 × 3 cells, each of an endless lattice once."""
    motif = law.cell.motif
    ends = (motif.sites[motif.struts] + motif.moves + 1.0) * law.size @ law.cell.axes  # (s, 2, 3)
    middles = lattice.nodes[lattice.edges].mean(axis=1)
    distance, edge = KDTree(middles).query(ends.mean(axis=1))
    if np.max(distance) > 1e-6 * law.size.max():
        raise MeshError(f"cell {law.cell.name!r} has a strut that is missing in its tiling")
    return np.asarray(edge, dtype=np.intp)


def _repeating(points: Points, size: Floats, tolerance: float) -> Ints:
    """Return a number for each point, the same for those that are whole cells apart, (p,).

    Parameters
    ----------
    points : along the sides of cells, (p, 3), mm
    """
    wrapped = np.mod(points / size, 1.0)
    # A point just below 1 is one just above 0: the tree closes at its box's sides.
    wrapped[wrapped >= 1.0] = 0.0
    scaled = wrapped * size
    pairs = KDTree(scaled, boxsize=size * (1.0 + 1e-15)).query_pairs(
        tolerance, output_type="ndarray"
    )
    count = len(points)
    links = sparse.coo_array(
        (np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count)
    )
    return sparse.csgraph.connected_components(links, directed=False)[1].astype(np.intp)


def _condensed(points: Points, cells: Ints, freedom: Ints, law: Floats) -> Floats:
    """Return the energy of a unit of each strain while points find their places, (6, 6)."""
    blocks = hexahedron_stiffnesses(points, cells, law)  # (k, 24, 24)
    strained = np.zeros((len(points), 3, 6))
    for k, (i, j) in enumerate(VOIGT_PAIRS):
        strained[:, i, k] += points[:, j] * (1.0 if i == j else 0.5)
        if i != j:
            strained[:, j, k] += points[:, i] * 0.5
    given = strained[cells].reshape(len(cells), 24, 6)
    pulls = blocks @ given
    direct = np.einsum("kri,krj->ij", given, pulls)
    count = int(freedom.max()) + 1
    rows = (3 * freedom[cells][:, :, None] + np.arange(3)).reshape(len(cells), 24)
    matrix = sparse.coo_array(
        (
            blocks.reshape(-1),
            (np.repeat(rows, 24, axis=1).reshape(-1), np.tile(rows, (1, 24)).reshape(-1)),
        ),
        shape=(3 * count, 3 * count),
    ).tocsc()
    right = sums_by_row(pulls, rows, 3 * count)
    # The first point is held: the lattice as a whole may not move.
    moves = np.zeros((3 * count, 6))
    moves[3:] = factor(matrix[3:, 3:]).solve(-right[3:])
    condensed: Floats = direct + right.T @ moves
    return condensed
