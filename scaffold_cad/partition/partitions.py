"""Partition and Partitions: spheres cut into one quad per direction."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.arrays import Floats, Frozen, Ints, UnitVectors
from scaffold_cad.partition.star import nearest_angles


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Partition(Frozen):
    """A sphere cut into N quads, each star-shaped around one of N directions: certified.

    Examples
    --------
    >>> from scaffold_cad import partition_sphere
    >>> partition = partition_sphere([[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> partition.vertices.shape, partition.method
    ((5, 3), 'dual')
    """

    directions: UnitVectors
    """Unit vectors, shape (N, 3)."""
    vertices: UnitVectors
    """Corners of the quads, unit vectors, shape (N + 2, 3)."""
    quads: Ints
    """Vertices of the quad around each direction, counter-clockwise from outside, (N, 4)."""
    clearance: Floats
    """Angle from each direction to the nearest great circle of its quad, rad, shape (N,)."""
    method: str
    """What made it: "dual", "insertion", "lune" or "like"."""

    def __str__(self) -> str:
        quads = f"{len(self.quads)} quads by {self.method}"
        return f"Partition: {quads}, relative clearance {self.relative_clearance:.4g}"

    @property
    def relative_clearance(self) -> float:
        """Smallest clearance over half the angle to the nearest direction: at most 1."""
        return float((2 * self.clearance / nearest_angles(self.directions[None])[0]).min())


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Partitions(Frozen):
    """M partitions of one valency N, each certified."""

    directions: UnitVectors
    """Unit vectors, shape (M, N, 3)."""
    vertices: UnitVectors
    """Corners of the quads, unit vectors, shape (M, N + 2, 3)."""
    quads: Ints
    """Vertices of the quad around each direction, counter-clockwise from outside, (M, N, 4)."""
    clearance: Floats
    """Angle from each direction to the nearest great circle of its quad, rad, shape (M, N)."""
    methods: NDArray[np.str_]
    """What made each: "dual", "insertion", "lune" or "like", shape (M,)."""

    def __str__(self) -> str:
        counts = f"Partitions: {len(self)} of {self.directions.shape[1]} quads"
        if len(self) == 0:
            return counts
        return f"{counts}, relative clearance {self.relative_clearance.min():.4g} or more"

    def __len__(self) -> int:
        return len(self.directions)

    def __getitem__(self, item: int) -> Partition:
        return Partition(
            self.directions[item],
            self.vertices[item],
            self.quads[item],
            self.clearance[item],
            str(self.methods[item]),
        )

    @cached_property
    def relative_clearance(self) -> Floats:
        """Smallest clearance of each over half the angle to the nearest direction, shape (M,)."""
        smallest: Floats = (2 * self.clearance / nearest_angles(self.directions)).min(axis=1)
        return smallest
