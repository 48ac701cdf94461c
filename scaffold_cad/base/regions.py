"""Regions of space that struts are cut to: a box, or where a function is negative."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, Protocol, TypeAlias, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arrays import (
    LARGEST_COORDINATE,
    Bools,
    Edges,
    Floats,
    Ints,
    Points,
    as_floats,
    read_only,
)
from scaffold_cad.base.placements import BoxLike
from scaffold_cad.base.vectors import length
from scaffold_cad.errors import OptionError

Keep: TypeAlias = Literal["clip", "whole"]
"""What becomes of struts that the surface crosses: cut there, or kept if their middle is inside."""

SURFACE_FRACTION = 1e-9
"""Distance within which a point is on the surface, as a fraction of the bounds' diagonal."""

HALVINGS = 40
"""How often the interval that holds a crossing is halved: to 1e-12 of the strut."""

PROBES = 6
"""How often a strut is halved in search of crossings that its ends do not tell of."""


@runtime_checkable
class Region(Protocol):
    """A part of space, its surface included."""

    @property
    def bounds(self) -> Floats:
        """Lowest and highest corner of a box around the region, shape (2, 3), mm."""

    @property
    def tolerance(self) -> float:
        """Distance within which a point counts as on the surface, mm."""

    def crossings(self, nodes: Points, edges: Edges) -> tuple[Ints, Floats]:
        """Return edges that meet the surface, and where from 0 to 1 along them, both (k,).

        In any order, and with repeats; too many do no harm.

        Parameters
        ----------
        nodes, edges : (n, 3) float64, mm, and (m, 2) intp
        """

    def contains(self, points: Points) -> Bools:
        """Return whether each of `points` (n, 3) is in the region or on its surface, (n,)."""


class BoxRegion:
    """A box along the axes."""

    def __init__(self, box: BoxLike) -> None:
        self.bounds = as_box(box)
        self.tolerance = surface_tolerance(self.bounds, SURFACE_FRACTION)

    def crossings(self, nodes: Points, edges: Edges) -> tuple[Ints, Floats]:
        """Return where edges meet the six planes, within the faces or not."""
        start = nodes[edges[:, 0]]
        span = nodes[edges[:, 1]] - start
        found_strut, found_along = [], []
        for bound in self.bounds:
            with np.errstate(divide="ignore", invalid="ignore"):
                along = (bound - start) / span  # (m, 3)
            strut, axis = np.nonzero((along > 0) & (along < 1))
            found_strut.append(strut)
            found_along.append(along[strut, axis])
        return np.concatenate(found_strut), np.concatenate(found_along)

    def contains(self, points: Points) -> Bools:
        """Return whether each of `points` (n, 3) is in the box or on its faces, (n,)."""
        low, high = self.bounds
        inside: Bools = ((points >= low - self.tolerance) & (points <= high + self.tolerance)).all(
            axis=1
        )
        return inside


class ImplicitRegion:
    """Where a function of positions, like a signed distance, is negative."""

    def __init__(self, function: Callable[[Points], ArrayLike], bounds: BoxLike) -> None:
        self.function = function
        self.bounds = as_box(bounds)
        self.tolerance = surface_tolerance(self.bounds, SURFACE_FRACTION)

    def crossings(self, nodes: Points, edges: Edges) -> tuple[Ints, Floats]:
        """Return where edges meet the surface, by halving.

        Where the ends of a strut are on one side, but not as far out as it is long, its parts
        are looked at; a true signed distance so hides nothing longer than 1/64 of a strut.
        """
        value = self.values(nodes)
        start = nodes[edges[:, 0]]
        span = nodes[edges[:, 1]] - start
        size = length(span)
        strut = np.arange(len(edges))
        low, high = np.zeros(len(strut)), np.ones(len(strut))
        at_low, at_high = value[edges[:, 0]], value[edges[:, 1]]
        crossed = []
        for depth in range(PROBES + 1):
            change = (at_low > self.tolerance) != (at_high > self.tolerance)
            falls = at_low[change] > self.tolerance
            crossed.append((strut[change], low[change], high[change], falls))
            near = ~change & (np.abs(at_low) + np.abs(at_high) < (high - low) * size[strut])
            if depth == PROBES or not near.any():
                break
            strut, low, high = strut[near], low[near], high[near]
            middle = (low + high) / 2
            at_middle = self.values(start[strut] + middle[:, None] * span[strut])
            low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
            at_low = np.concatenate([at_low[near], at_middle])
            at_high = np.concatenate([at_middle, at_high[near]])
            strut = np.concatenate([strut, strut])
        strut, low, high, falls = (np.concatenate(column) for column in zip(*crossed, strict=True))
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            outside = self.values(start[strut] + middle[:, None] * span[strut]) > 0
            low = np.where(outside == falls, middle, low)
            high = np.where(outside == falls, high, middle)
        return strut, (low + high) / 2

    def contains(self, points: Points) -> Bools:
        """Return whether each of `points` (n, 3) is in the region or on its surface, (n,)."""
        inside: Bools = self.values(points) <= self.tolerance
        return inside

    def values(self, points: Points) -> Floats:
        """Return the function at `points` (n, 3), shape (n,).

        Raises
        ------
        OptionError
            If the function returns another shape or a number that is nan.
        """
        values = as_floats(
            self.function(points), "what the region's function returned", OptionError
        )
        if values.shape != (len(points),):
            raise OptionError(
                f"the region's function returned shape {values.shape} for points "
                f"({len(points)}, 3); need ({len(points)},)"
            )
        unknown = np.flatnonzero(np.isnan(values))
        if len(unknown):
            place = points[unknown[0]].tolist()
            raise OptionError(f"the region's function is nan at {place} mm; need a number")
        return values


def as_box(box: BoxLike) -> Floats:
    """Return a read-only copy of `box` as (2, 3) float64, lowest and highest corner.

    Raises
    ------
    OptionError
        If it is not two corners, the first one lower along each axis.
    """
    corners = as_floats(box, "box", OptionError)
    if corners.shape != (2, 3):
        raise OptionError(f"box has shape {corners.shape}; need (2, 3), its two corners")
    if not np.isfinite(corners).all() or not (corners[0] < corners[1]).all():
        low, high = corners.tolist()
        raise OptionError(f"box is from {low} to {high} mm; need the first below the second")
    if (np.abs(corners) > LARGEST_COORDINATE).any():
        reach = np.abs(corners).max()
        raise OptionError(f"box reaches {reach:g} mm; need at most {LARGEST_COORDINATE:g}")
    read_only(corners)
    return corners


def surface_tolerance(bounds: Floats, fraction: float) -> float:
    """Return `fraction` of the diagonal of `bounds` (2, 3)."""
    return fraction * float(np.linalg.norm(bounds[1] - bounds[0]))
