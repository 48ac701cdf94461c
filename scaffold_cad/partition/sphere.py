"""partition_sphere and partition_spheres: certified partitions, each distinct star done once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scaffold_cad.arrays import Floats, Ints, UnitVectors
from scaffold_cad.errors import OptionError, PartitionError
from scaffold_cad.partition.certificate import (
    BLOCK,
    MIN_CLEARANCE,
    arc_normals,
    certify,
    clearances,
    corners_of,
)
from scaffold_cad.partition.lune import lune_partitions
from scaffold_cad.partition.partitions import Partition, Partitions
from scaffold_cad.partition.star import as_stars, check_separated, distinct_stars

METHODS: dict[str, Callable[[UnitVectors], tuple[UnitVectors, Ints]]] = {
    "dual": lune_partitions,
    "lune": lune_partitions,
}
"""Vertices (M, N + 2, 3) and quads (M, N, 4), certified or not, of stars (M, N, 3)."""


def partition_sphere(directions: ArrayLike, method: str = "dual") -> Partition:
    """Return a certified partition of the sphere around N `directions` (N, 3).

    See `partition_spheres`, which does many at once.
    """
    return partition_spheres(np.asarray(directions)[None], method)[0]


def partition_spheres(directions: ArrayLike, method: str = "dual") -> Partitions:
    """Return certified partitions around the directions of M stars of valency N."""
    if method not in METHODS:
        raise OptionError(f"method is {method!r}; need one of {', '.join(METHODS)}")
    stars = as_stars(directions)
    distinct = distinct_stars(stars)
    common = distinct.representatives(stars)
    check_separated(common, distinct.first, distinct.order[distinct.first])
    vertices, quads, methods = _certified(common, method, distinct.first)
    ranks, group = distinct.ranks(), distinct.group
    clearance = _clearances_of_copies(stars, ranks, group, vertices, quads)
    lost = np.flatnonzero((clearance <= MIN_CLEARANCE).any(axis=1))
    if len(lost):
        raise PartitionError(f"star {lost[0]} lost its certificate")
    return Partitions(
        stars, vertices[group], quads[group[:, None], ranks], clearance, methods[group]
    )


def _certified(
    stars: UnitVectors, method: str, names: Ints
) -> tuple[UnitVectors, Ints, NDArray[np.str_]]:
    """Return certified vertices and quads of `stars`, and the method that made each.

    Raises
    ------
    PartitionError
        If even the lune partition of a star is not certified; it is named by `names`.
    """
    vertices, quads = METHODS[method](stars)
    methods = np.full(len(stars), method, dtype="<U9")
    failed = np.flatnonzero(~certify(stars, vertices, quads).valid)
    if len(failed):
        vertices[failed], quads[failed] = lune_partitions(stars[failed])
        methods[failed] = "lune"
        valid = certify(stars[failed], vertices[failed], quads[failed]).valid
        if not valid.all():
            worst = names[failed[~valid]].min()
            raise PartitionError(f"no certified partition found for star {worst}")
    return vertices, quads, methods


def _clearances_of_copies(
    stars: UnitVectors, ranks: Ints, group: Ints, vertices: UnitVectors, quads: Ints
) -> Floats:
    """Return the clearances of `stars` (M, N, 3) in the partitions of their groups, (M, N).

    The quads of a group tile the sphere whatever star they are used for, so that positive
    clearances alone certify the copy.
    """
    normals = arc_normals(corners_of(vertices, quads))  # (U, N, 4, 3)
    clearance = np.empty(stars.shape[:2])
    rows = max(1, BLOCK // (10 * stars.shape[1]))
    for start in range(0, len(stars), rows):
        block = slice(start, start + rows)
        own = normals[group[block, None], ranks[block]]
        clearance[block] = clearances(stars[block], own)
    return clearance
