"""Maps in closed form: a box placed and turned, a cylinder, a sphere, and any function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import (
    as_direction,
    as_number,
    as_vector,
    checks_keywords,
    described,
)
from scaffold_cad.base.arrays import Floats, Frames, Frozen, Ints, Points, UnitVectors, as_floats
from scaffold_cad.base.placements import (
    AxesLike,
    DirectionLike,
    OriginLike,
    PositionLike,
    placed_by,
    placement_of,
)
from scaffold_cad.base.vectors import normalize
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice.maps.cellmap import CellMap
from scaffold_cad.lattice.unitcell import as_three

FULL_TURN = 1e-9
"""How far from 2 π an arc may be and still close, rad."""

NEAREST_POLE = np.pi / 2 - 1e-3
"""Greatest latitude of a band, rad."""


@checks_keywords()
@dataclass(frozen=True, eq=False)
class BoxMap(Frozen, CellMap):
    """A box of any place and orientation.

    >>> from scaffold_cad import tile
    >>> len(tile("bcc", counts=2, radius=0.5, on=BoxMap([20, 20, 20])).edges)
    64
    """

    size: Floats
    """Length along its three sides, shape (3,), mm."""
    origin: Points
    """Position of the corner where u = v = w = 0, shape (3,), mm."""
    axes: Frames
    """Unit directions of its sides, rows, shape (3, 3)."""

    def __init__(
        self,
        size: PositionLike,
        origin: OriginLike | None = None,
        axes: AxesLike | None = None,
    ) -> None:
        """Place a box.

        Parameters
        ----------
        size : lengths of its three sides, mm
        origin : its corner, mm; by default that of `axes`, or 0
        axes : directions of its sides as rows (3, 3), at right angles or not, or those of a Plane
            or Location of build123d; by default those of `origin`, or x, y, z

        Raises
        ------
        OptionError
            If a size is not > 0, or the axes lie in a plane.
        """
        origin, axes = placed_by(origin, axes)
        self._keep(
            size=as_three(size, "size of the box in mm"),
            origin=as_vector(origin, "origin"),
            axes=as_axes(axes),
        )

    def positions(self, places: Points, patch: Ints) -> Points:  # noqa: ARG002
        """Return where places are; see `CellMap`."""
        moved: Points = self.origin + (places * self.size) @ self.axes
        return moved


@checks_keywords()
@dataclass(frozen=True, eq=False)
class CylinderMap(Frozen, CellMap):
    """The wall of a tube: u runs around, v along the axis, w outwards.

    A full turn closes: cells at its seam share their nodes.

    Examples
    --------
    >>> from scaffold_cad import CylinderMap, tile
    >>> tube = tile("bcc", 3.0, radius=0.3, on=CylinderMap(10.0, height=12.0, thickness=3.0))
    >>> tube.component_count
    1
    """

    radius: float
    """Inner radius, mm."""
    height: float
    """Length along the axis, mm."""
    thickness: float
    """Of the wall, mm."""
    origin: Points
    """Position of the axis at v = 0, shape (3,), mm."""
    axes: Frames
    """Unit vectors toward u = 0, a quarter turn on, and along the axis, rows, shape (3, 3)."""
    angle: float
    """How far around it goes, rad, in (0, 2 π]."""

    def __init__(
        self,
        radius: float,
        height: float,
        thickness: float,
        *,
        origin: OriginLike | None = None,
        axis: DirectionLike | None = None,
        angle: float = 2 * np.pi,
    ) -> None:
        turn = _as_turn(angle)
        origin, axis = placed_by(origin, axis)
        self._keep(
            radius=as_number(radius, "radius of the cylinder"),
            height=as_number(height, "height of the cylinder"),
            thickness=as_number(thickness, "thickness of the wall"),
            origin=as_vector(origin, "origin"),
            axes=frame_along(axis),
            angle=turn,
            wraps=(turn > 2 * np.pi - FULL_TURN, False, False),
        )

    def positions(self, places: Points, patch: Ints) -> Points:  # noqa: ARG002
        """Return where places are; see `CellMap`."""
        u, v, w = places.T
        away = self.radius + w * self.thickness
        turn = u * self.angle
        local = np.stack([away * np.cos(turn), away * np.sin(turn), v * self.height], axis=1)
        moved: Points = self.origin + local @ self.axes
        return moved


@checks_keywords()
@dataclass(frozen=True, eq=False)
class SphereMap(Frozen, CellMap):
    """A spherical wall, w outwards: whole, or a band of it.

    The whole sphere is the six sides of a cube blown up, which has no pole; a band has u around
    the axis and v from south to north, and its cells narrow toward the poles.

    Examples
    --------
    >>> from scaffold_cad import SphereMap, tile
    >>> ball = tile("sc", 5.0, radius=0.3, on=SphereMap(10.0, thickness=5.0))
    >>> ball.component_count
    1
    """

    radius: float
    """Inner radius, mm."""
    thickness: float
    """Of the wall, mm."""
    origin: Points
    """Center, shape (3,), mm."""
    axes: Frames
    """Unit vectors toward u = 0, a quarter turn on, and the north pole, rows, shape (3, 3)."""
    latitudes: Floats | None
    """Least and greatest latitude of a band, shape (2,), rad; None for the whole sphere."""
    angle: float
    """How far around a band goes, rad, in (0, 2 π]."""

    def __init__(
        self,
        radius: float,
        thickness: float,
        *,
        latitudes: ArrayLike | None = None,
        origin: OriginLike | None = None,
        axis: DirectionLike | None = None,
        angle: float = 2 * np.pi,
    ) -> None:
        whole = latitudes is None
        turn = _as_turn(angle)
        closes = turn > 2 * np.pi - FULL_TURN
        if whole and not closes:
            raise OptionError(f"angle is {turn:g} rad without latitudes; need them for a band")
        origin, axis = placed_by(origin, axis)
        self._keep(
            radius=as_number(radius, "radius of the sphere"),
            thickness=as_number(thickness, "thickness of the wall"),
            origin=as_vector(origin, "origin"),
            axes=frame_along(axis),
            latitudes=None if latitudes is None else _as_latitudes(latitudes),
            angle=turn,
            wraps=(closes and not whole, False, False),
            patches=6 if whole else 1,
        )

    def positions(self, places: Points, patch: Ints) -> Points:
        """Return where places are; see `CellMap`."""
        u, v, w = places.T
        if self.latitudes is None:
            outward = _blown_up_cube(u, v, patch)
        else:
            south, north = self.latitudes
            turn, up = u * self.angle, south + v * (north - south)
            ring = np.stack([np.cos(turn), np.sin(turn)], axis=1) * np.cos(up)[:, None]
            outward = np.concatenate([ring, np.sin(up)[:, None]], axis=1)
        away = (self.radius + w * self.thickness)[:, None]
        moved: Points = self.origin + (away * outward) @ self.axes
        return moved


@checks_keywords()
@dataclass(frozen=True, eq=False)
class FunctionMap(Frozen, CellMap):
    """Any function of coordinates that returns positions.

    Examples
    --------
    >>> from scaffold_cad import FunctionMap, tile
    >>> sheared = FunctionMap(lambda uvw: uvw + uvw[:, 2:] * [0.5, 0, 0], size=(10.0, 10.0, 10.0))
    >>> float(tile("sc", counts=2, radius=0.3, on=sheared).nodes.max())
    15.0
    """

    function: Callable[[Points], ArrayLike]
    """Of coordinates (n, 3), from 0 to `size`, that returns positions (n, 3), mm."""
    size: Floats
    """Largest coordinates, shape (3,)."""

    def __init__(
        self,
        function: Callable[[Points], ArrayLike],
        size: ArrayLike = (1.0, 1.0, 1.0),
        wraps: tuple[bool, bool, bool] = (False, False, False),
    ) -> None:
        """Take a function.

        Parameters
        ----------
        function : of coordinates (n, 3), each from 0 to that of `size`, that returns positions
            (n, 3), mm
        size : largest coordinates
        wraps : along which of them the end is the beginning again
        """
        if not callable(function):
            raise OptionError(f"the map is {described(function)}; need a function")
        if len(wraps) != 3:
            raise OptionError(f"wraps is {wraps}; need three flags")
        self._keep(
            function=function,
            size=as_three(size, "largest coordinates of the map"),
            wraps=(bool(wraps[0]), bool(wraps[1]), bool(wraps[2])),
        )

    def positions(self, places: Points, patch: Ints) -> Points:  # noqa: ARG002
        """Return where places are; see `CellMap`.

        Raises
        ------
        OptionError
            If the function returns another shape, or a number that is not finite.
        """
        given = places * self.size
        moved = as_floats(self.function(given), "what the map returned", OptionError)
        if moved.shape != places.shape:
            raise OptionError(f"the map returned shape {moved.shape}; need {places.shape}")
        bad = np.flatnonzero(~np.isfinite(moved).all(axis=1))
        if len(bad):
            raise OptionError(
                f"the map returned {moved[bad[0]].tolist()} at {given[bad[0]].tolist()}; "
                "need finite numbers"
            )
        return moved


def as_axes(axes: AxesLike | None) -> Floats:
    """Return unit directions (3, 3), rows, or those of a Plane; by default those of x, y and z.

    Raises
    ------
    OptionError
        If they are not three directions that span space.
    """
    if axes is None:
        return np.eye(3)
    placement = placement_of(axes)
    rows = as_floats(axes, "axes", OptionError) if placement is None else placement[:, :3].T
    if rows.shape != (3, 3) or not np.isfinite(rows).all() or not rows.any(axis=1).all():
        raise OptionError(f"axes are {rows.tolist()}; need three directions, a row each")
    units = normalize(rows)
    if abs(np.linalg.det(units)) < 1e-6:
        raise OptionError(f"axes {rows.tolist()} lie in a plane; need three that span space")
    return units


def frame_along(axis: DirectionLike | None) -> Floats:
    """Return orthonormal rows (3, 3), the last along `axis`: all of a Plane, z by default.

    Raises
    ------
    OptionError
        If it is not a direction.
    """
    placement = placement_of(axis)
    if placement is not None:
        return placement[:, :3].T
    z = as_direction((0.0, 0.0, 1.0) if axis is None else axis, "axis")
    aside = np.array([1.0, 0.0, 0.0]) if abs(z[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    x = aside - z * (aside @ z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z])


def _as_turn(angle: float) -> float:
    """Return an angle in (0, 2 π].

    Raises
    ------
    OptionError
        If it is not such a number.
    """
    turn = as_number(angle, "angle", unit=" rad")
    if turn > 2 * np.pi + FULL_TURN:
        raise OptionError(f"angle is {turn:g} rad; need at most 2 pi, a full turn")
    return min(turn, 2 * np.pi)


def _as_latitudes(latitudes: ArrayLike) -> Floats:
    """Return the least and greatest latitude of a band (2,).

    Raises
    ------
    OptionError
        If they are not two, ascending, off the poles.
    """
    south_north = as_floats(latitudes, "latitudes", OptionError)
    if south_north.shape != (2,) or not (
        -NEAREST_POLE <= south_north[0] < south_north[1] <= NEAREST_POLE
    ):
        raise OptionError(
            f"latitudes are {south_north.tolist()} rad; need two, ascending, within "
            f"{NEAREST_POLE:g} (the whole sphere has none)"
        )
    return south_north


def _blown_up_cube(u: Floats, v: Floats, side: Ints) -> UnitVectors:
    """Return unit vectors (n, 3) at places of the sides of a cube, evenly spaced in angle."""
    a, b = np.tan((u - 0.5) * np.pi / 2), np.tan((v - 0.5) * np.pi / 2)
    axis, sign = np.divmod(side, 2)
    sign = 1.0 - 2.0 * sign
    rows = np.arange(len(u))
    cube = np.empty((len(u), 3))
    cube[rows, axis] = sign
    cube[rows, (axis + 1) % 3] = a * sign  # so that u, v and outwards are right-handed
    cube[rows, (axis + 2) % 3] = b
    return normalize(cube)
