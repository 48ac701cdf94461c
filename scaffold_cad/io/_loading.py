"""RawLoading: what holds and loads the nodes of a file, before any repair."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, check_believable, read_only

PLANAR = (2, 3, 4)
"""Freedoms that are held at each node of a model in the plane of x and y."""


@dataclass(frozen=True, eq=False)
class RawLoading(Frozen):
    """The six freedoms of each node, displacements along and rotations about x, y and z."""

    fixed: Bools
    """Which are held, shape (n, 6)."""
    displacement: Floats
    """Where they are moved to, mm and rad, shape (n, 6)."""
    forces: Floats
    """Forces and moments, N and N mm, shape (n, 6)."""

    @property
    def is_empty(self) -> bool:
        """Whether nothing is held or loaded."""
        return not (self.fixed.any() or self.forces.any())

    def scaled(self, factor: float) -> RawLoading:
        """Return the same for lengths times `factor`; forces stay."""
        lengths, moments = np.repeat([factor, 1.0], 3), np.repeat([1.0, factor], 3)
        return RawLoading(
            self.fixed, read_only(self.displacement * lengths), read_only(self.forces * moments)
        )


class Gathered:
    """Supports and loads taken from a file one by one, by number of node."""

    def __init__(self) -> None:
        self._held: list[tuple[int, int, float]] = []
        self._pulls: list[tuple[int, int, float]] = []

    def hold(self, node: int, freedoms: Iterable[int], value: float = 0.0) -> None:
        """Hold freedoms 0..5 of a node, or move them by `value`; the last one counts."""
        self._held += [(node, freedom, value) for freedom in freedoms]

    def pull(self, node: int, freedom: int, value: float) -> None:
        """Add a force along, or a moment about, an axis of a node."""
        self._pulls.append((node, freedom, value))

    def loading(self, count: int) -> RawLoading | None:
        """Return what was taken, for `count` nodes; None for nothing.

        Raises
        ------
        SkeletonError
            If a number is beyond what is believable.
        """
        if not self._held and not self._pulls:
            return None
        fixed = np.zeros((count, 6), dtype=np.bool_)
        moved, forces = np.zeros((count, 6)), np.zeros((count, 6))
        for node, freedom, value in self._held:
            fixed[node, freedom], moved[node, freedom] = True, value
        for node, freedom, value in self._pulls:
            forces[node, freedom] += value
        check_believable(moved, "is moved by")
        check_believable(forces, "has the load")
        return RawLoading(read_only(fixed), read_only(moved), read_only(forces))
