"""The surface of a tile's own struts and nodes: triangles as the whole's, open where others go on.

What the whole would unite, a tile refuses: struts that overlap have no surface of their own.
"""

from __future__ import annotations

from typing import Any, Literal, TypeAlias

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints
from scaffold_cad.errors import MeshError
from scaffold_cad.products.overlaps import described
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.rounds import SIDES, faulty_runs
from scaffold_cad.struts import round_struts
from scaffold_cad.struts.meshes.surface import triangulated
from scaffold_cad.tiles.tile import Tile

TileOverlaps: TypeAlias = Literal["refuse", "allow"]
"""What becomes of struts that overlap: an error, or faces that cross."""


def square_triangles(
    tile: Tile, options: dict[str, Any], overlaps: TileOverlaps = "refuse"
) -> np.ndarray:
    """Return the triangles of a tile's own square struts, 32-bit corners (t, 3, 3), mm.

    Parameters
    ----------
    options : of `build_scaffold`
    overlaps : see `Build`

    Raises
    ------
    MeshError
        If an own strut overlaps another, and that is refused.
    """
    scaffold = build_scaffold(tile.skeleton, **options)
    if overlaps == "refuse":
        _refuse(overlapping_struts(scaffold) & tile.own, tile.skeleton)
    chosen = tile.own[scaffold.edge_of_quad]  # (f,)
    triangles = scaffold.mesh.triangles.reshape(-1, 2, 3)[chosen]
    return _corners(scaffold.mesh.vertices, triangles.reshape(-1, 3))


def round_triangles(
    tile: Tile,
    options: dict[str, Any],
    sides: int = SIDES,
    overlaps: TileOverlaps = "refuse",
) -> np.ndarray:
    """Return the triangles of a tile's own round struts and nodes, 32-bit corners (t, 3, 3), mm.

    A strut that passes a joint without a bend belongs to the tile that owns its first edge.

    Parameters
    ----------
    options : of `round_struts`, in place of those of the whole
    sides : of the polygons that stand for circles, a multiple of 4
    overlaps : see `Build`

    Raises
    ------
    MeshError
        If an own strut overlaps another, and that is refused.
    """
    struts = round_struts(tile.skeleton, **{**tile.strut_options, **options})
    run = struts.runs.run_of_edge
    own_runs, own_nodes = tile.own_runs(run), tile.own_nodes
    made = triangulated(struts, sides)
    if overlaps == "refuse":
        touched = own_runs | own_nodes[struts.runs.edges].any(axis=1)  # (k,)
        _refuse((faulty_runs(struts, made, sides) & touched)[run], tile.skeleton)
    # Nodes are numbered from the front, runs from the back: -1 is the first run.
    chosen = np.concatenate([own_nodes, own_runs[::-1]])[made.owner]
    return _corners(made.mesh.vertices, made.mesh.triangles[chosen])


def overlapping_struts(scaffold: Scaffold) -> Bools:
    """Return which struts break a condition of the proof that a scaffold is embedded, (m,).

    Those at the rim of a tile, which are cut short, may be among them.
    """
    found = scaffold.embedding()
    overlapping = ~(found.within_cone.all(axis=1) & found.uncrossed)
    overlapping[found.conflicts] = True
    return overlapping


def _refuse(faulty: Bools, skeleton: Skeleton) -> None:
    edges = np.flatnonzero(faulty)
    if len(edges):
        raise MeshError(
            f"{described(edges, skeleton)}; need struts apart where tiles are built (smaller "
            "radii, larger cells), or overlaps='allow' for faces that cross"
        )


def _corners(vertices: Floats, triangles: Ints) -> np.ndarray:
    """Return 32-bit corners (t, 3, 3), without triangles that rounding leaves no three corners."""
    corners = vertices.astype(np.float32)[triangles]
    flat = (corners == np.roll(corners, 1, axis=1)).all(axis=2).any(axis=1)
    return np.asarray(corners[~flat])
