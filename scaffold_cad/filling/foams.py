"""Foams in boxes, parts, meshes and wherever a function is negative."""

from __future__ import annotations

from typing import get_args

from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import check_choice, checks_keywords
from scaffold_cad.base.placements import BoxLike
from scaffold_cad.base.radii import Radius
from scaffold_cad.base.regions import Keep
from scaffold_cad.filling.fill import FillRegion, as_region
from scaffold_cad.lattice.foampoints import CellSizes, as_stretch, seeds_in
from scaffold_cad.lattice.foams import delaunay_struts, foam_of, voronoi_struts
from scaffold_cad.skeleton import Skeleton


@checks_keywords()
def voronoi_foam(
    count: int | ArrayLike | None,
    region: FillRegion,
    radius: Radius,
    seed: int = 0,
    *,
    size: CellSizes | None = None,
    regularity: float = 0.0,
    stretch: ArrayLike = (1.0, 1.0, 1.0),
    periodic: bool = False,
    bounds: BoxLike | None = None,
    keep: Keep = "clip",
    dangling: bool = True,
    shortest: float | None = None,
) -> Skeleton:
    """Return the edges of the Voronoi cells of random points: an open-cell foam.

    Nodes inside have valency 4, but for those that short struts were shrunk to. The foam is in one
    piece: others, which the surface cuts loose, are left out.

    Parameters
    ----------
    count : random points in the region, one per cell; or your own points (n, 3), mm
    region : a box (its lowest and highest corner, mm), a build123d solid, a closed triangle mesh,
        or a function, see `fill`
    radius : mm; one number, or a function of positions (n, 3) that returns radii (n,)
    seed : of the random points; the same seed gives the same foam
    size : in place of a count: side of a cube as large as a cell, mm; or a function of positions
        (n, 3) that returns sizes (n,), such as a `Field`: points are then as dense as it asks, and
        the cells are Laguerre cells, larger where they are to be
    regularity : least distance of two points, as a fraction of that in a lattice of as many
        Kelvin cells, in 0..0.7: 0 is fully random, 0.7 gives cells of similar size
    stretch : how much longer cells are along x, y and z
    periodic : whether the foam of a box meets itself on opposite faces, to be repeated; what the
        box cuts loose then stays, as it hangs on the next one
    bounds : lowest and highest corner of a box around the region; for a function only
    keep : "clip" cuts struts at the surface, "whole" drops those that leave it
    dangling : whether struts that end free stay
    shortest : struts shorter than this are shrunk to a node, mm; by default 1/1000 of the mean
        spacing of the points

    Raises
    ------
    OptionError
        If an argument is out of its range.
    MeshError
        If a mesh is not closed.
    SkeletonError
        If no strut is in the region.

    References
    ----------
    Zhu, Hobdell, Windle, Effects of cell irregularity on the elastic properties of open-cell
    foams, 2000: the regularity. Redenbach, Microstructure models for cellular materials, 2009:
    Laguerre cells.

    Examples
    --------
    >>> import numpy as np
    >>> ball = lambda points: np.linalg.norm(points, axis=1) - 10
    >>> foam = voronoi_foam(60, ball, 0.4, bounds=[[-10] * 3, [10] * 3])
    >>> foam.component_count
    1
    """
    check_choice(keep, "keep", get_args(Keep))
    space, factors = as_region(region, bounds), as_stretch(stretch)
    seeds = seeds_in(count, space, seed, regularity, size, factors)
    struts, on_surface = voronoi_struts(
        seeds, space, factors, periodic=periodic, keep=keep, dangling=dangling
    )
    return foam_of(
        struts,
        seeds,
        space,
        radius,
        shortest=shortest,
        on_surface=on_surface,
        whole=periodic,
    )


@checks_keywords()
def delaunay_foam(
    count: int | ArrayLike | None,
    region: FillRegion,
    radius: Radius,
    seed: int = 0,
    *,
    size: CellSizes | None = None,
    regularity: float = 0.0,
    stretch: ArrayLike = (1.0, 1.0, 1.0),
    bounds: BoxLike | None = None,
    shortest: float | None = None,
) -> Skeleton:
    """Return the edges of the Delaunay tetrahedra of random points: a random truss.

    Tetrahedra count that have their circumcenter in the region: the others are flat ones at its
    surface. Struts that leave the region are dropped. The truss is in one piece: others are left
    out.

    Parameters
    ----------
    count : random points in the region, or your own points (n, 3), mm
    region, radius, seed, size, regularity, stretch, bounds, shortest : as for `voronoi_foam`

    Raises
    ------
    OptionError
        If an argument is out of its range.
    MeshError
        If a mesh is not closed.
    SkeletonError
        If no tetrahedron is in the region.

    Examples
    --------
    >>> from scaffold_cad import delaunay_foam
    >>> delaunay_foam(9, [[0, 0, 0], [9, 9, 9]], radius=0.3).component_count
    1
    """
    space, factors = as_region(region, bounds), as_stretch(stretch)
    seeds = seeds_in(count, space, seed, regularity, size, factors)
    struts = delaunay_struts(seeds, space, factors)
    return foam_of(struts, seeds, space, radius, shortest=shortest)
