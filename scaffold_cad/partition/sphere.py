"""partition_sphere and partition_spheres: certified partitions, each distinct star done once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scaffold_cad.base.arguments import check_choice, checks_keywords
from scaffold_cad.base.arrays import Floats, Ints, UnitVectors, as_floats
from scaffold_cad.base.blocks import blocks
from scaffold_cad.errors import OptionError, PartitionError
from scaffold_cad.partition.certificate import (
    MIN_CLEARANCE,
    arc_normals,
    certify,
    clearances,
    corners_of,
)
from scaffold_cad.partition.dual import dual_partitions
from scaffold_cad.partition.guidance import as_neighbors, guided_partition
from scaffold_cad.partition.insertion import insertion_partitions
from scaffold_cad.partition.lune import lune_partitions
from scaffold_cad.partition.partitions import Partition, Partitions
from scaffold_cad.partition.reuse import Models, as_models, placed
from scaffold_cad.partition.star import (
    MIN_VALENCY,
    DistinctStars,
    as_stars,
    check_separated,
    distinct_stars,
    each_alone,
    ordered_stars,
)

COPY_BYTES = 3200
"""What a quad of a repeated star takes where its clearance is measured."""
METHODS: dict[str, Callable[[UnitVectors], tuple[UnitVectors, Ints]]] = {
    "dual": dual_partitions,
    "insertion": insertion_partitions,
    "lune": lune_partitions,
}
"""Vertices (M, N + 2, 3) and quads (M, N, 4), certified or not, of stars (M, N, 3)."""


@checks_keywords()
def partition_sphere(
    directions: ArrayLike, method: str = "dual", *, neighbors: ArrayLike | None = None
) -> Partition:
    """Return a certified partition of the sphere around N directions.

    Parameters
    ----------
    directions : (N, 3) float64
        Directions of any length > 0; N ≥ 3.
    method : "dual", "insertion" or "lune"
        See `partition_spheres`, which does many at once.
    neighbors : (k, 2) intp, optional
        Pairs of directions whose quads must share an arc; with the method "dual" only.

    Raises
    ------
    PartitionError
        If a direction is not finite or zero, if two are less than 0.01° apart, or if no
        certified partition is found in which the `neighbors` are so.
    OptionError
        If there is no such method, or `neighbors` are given with another than "dual".

    Examples
    --------
    >>> from scaffold_cad import partition_sphere
    >>> axes = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
    >>> partition = partition_sphere(axes)  # the cube
    >>> partition.quads.shape, round(partition.relative_clearance, 6)
    ((6, 4), 1.0)
    """
    alone = as_floats(directions, "directions", PartitionError)[None]  # (1, N, 3)
    if neighbors is None:
        return partition_spheres(alone, method)[0]
    if method != "dual":
        raise OptionError(f"method is {method!r}; need 'dual' to choose neighbors")
    star = as_stars(alone)
    check_separated(star, np.zeros(1, dtype=np.intp), np.arange(star.shape[1])[None])
    pairs = as_neighbors(neighbors, star.shape[1])
    if star.shape[1] == MIN_VALENCY:
        return partition_spheres(alone, method)[0]  # each is everyone's neighbor
    vertices, quads = guided_partition(star[0], pairs)
    clearance = certify(star, vertices[None], quads[None]).clearance
    return Partition(star[0], vertices, quads, clearance[0], method)


@checks_keywords()
def partition_spheres(
    directions: ArrayLike,
    method: str = "dual",
    *,
    like: ArrayLike | None = None,
    near: ArrayLike | None = None,
) -> Partitions:
    """Return certified partitions around the directions of M stars of valency N.

    Each distinct star is partitioned once: stars whose directions agree within some 1e-9, in
    whatever order, get the same vertices. The result for a star does not depend on the others,
    nor on the order of its directions.

    Parameters
    ----------
    directions : (M, N, 3) float64
        Directions of each star, of any length > 0; N ≥ 3.
    method : "dual", "insertion" or "lune"
        "dual" is the good one. "lune" always has an answer, and is taken for the stars where
        another method finds none that is certified.
    like : (M, N, 4) intp, optional
        Quads to use instead of choosing them, those of other `Partitions`: the vertices are
        placed again, and `method` does not matter.
    near : (M, N + 2, 3) float64, optional
        With `like`: the vertices of those partitions. Where they will still do, the new ones
        stay beside them, so that small moves of the directions make small moves of the vertices.

    Raises
    ------
    PartitionError
        If a direction is not finite or zero, if two directions of a star are less than 0.01°
        apart, or if no certified vertices are found for the quads of `like`; the star is named.
    OptionError
        If there is no such method, or `near` is given without `like`.

    Examples
    --------
    >>> from scaffold_cad import partition_spheres
    >>> star = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, -1, -1]]
    >>> partition_spheres([star, star]).quads.shape
    (2, 4, 4)
    """
    check_choice(method, "method", METHODS)
    if like is None and near is not None:
        raise OptionError("near is given without like; need the quads that its vertices belong to")
    stars = as_stars(directions)
    if like is None:
        models, groups = None, distinct_stars(stars)
    else:
        models = as_models(like, near, stars.shape[:2])
        groups = ordered_stars(stars, models.keys)
    found = _partitions(stars, method, models, groups, np.arange(len(stars)))
    lost = np.flatnonzero((found.clearance <= MIN_CLEARANCE).any(axis=1))
    if len(lost):
        # Rare: these differ from the star they were grouped with by more than they can bear.
        part = None if models is None else models[lost]
        own = _partitions(stars[lost], method, part, each_alone(stars[lost]), lost)
        for name in ("vertices", "quads", "clearance", "methods"):
            getattr(found, name)[lost] = getattr(own, name)
    return Partitions(stars, found.vertices, found.quads, found.clearance, found.methods)


@dataclass(frozen=True, eq=False)
class _Found:
    """Fields of Partitions that may still be written."""

    vertices: UnitVectors
    quads: Ints
    clearance: Floats
    methods: NDArray[np.str_]


def _partitions(
    stars: UnitVectors, method: str, models: Models | None, groups: DistinctStars, names: Ints
) -> _Found:
    """Return partitions of `stars` (M, N, 3), each of `groups` done once, errors by `names`."""
    common = groups.representatives(stars)
    check_separated(common, names[groups.first], groups.order[groups.first])
    if models is None:
        vertices, quads, methods = _certified(common, method, names[groups.first])
    else:
        vertices, quads, methods = _placed(common, models[groups.first], names[groups.first])
    ranks, group = groups.ranks(), groups.group
    clearance = _clearances_of_copies(stars, ranks, group, vertices, quads)
    return _Found(vertices[group], quads[group[:, None], ranks], clearance, methods[group])


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
            raise PartitionError(
                f"no certified partition found for star {names[failed[np.argmin(valid)]]}"
            )
    return vertices, quads, methods


def _placed(
    stars: UnitVectors, models: Models, names: Ints
) -> tuple[UnitVectors, Ints, NDArray[np.str_]]:
    """Return certified vertices and the quads of `models`, and what made them.

    Raises
    ------
    PartitionError
        If no certified vertices are found for a star; it is named by `names`.
    """
    vertices, certified = placed(stars, models)
    if not certified.all():
        raise PartitionError(
            f"no certified vertices found for the quads that star {names[np.argmin(certified)]} "
            "is to keep; its directions moved too far"
        )
    return vertices, models.quads, np.full(len(stars), "like", dtype="<U9")


def _clearances_of_copies(
    stars: UnitVectors, ranks: Ints, group: Ints, vertices: UnitVectors, quads: Ints
) -> Floats:
    """Return the clearances of `stars` (M, N, 3) in the partitions of their groups, (M, N).

    The quads of a group tile the sphere whatever star they are used for, so that positive
    clearances alone certify the copy.
    """
    normals = arc_normals(corners_of(vertices, quads))  # (U, N, 4, 3)
    clearance = np.empty(stars.shape[:2])
    for block in blocks(len(stars), stars.shape[1] * COPY_BYTES):
        own = normals[group[block, None], ranks[block]]
        clearance[block] = clearances(stars[block], own)
    return clearance
