"""Positions, directions and places as build123d has them, in numbers; all else is left as it is.

build123d is not imported: whoever has such an object has it loaded.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scaffold_cad.base.backends import is_instance

if TYPE_CHECKING:
    from build123d import Axis, BoundBox, Location, Plane, Vector, Vertex

PositionLike: TypeAlias = "ArrayLike | Vector | Vertex | Location"
"""Three numbers, or a Vector, Vertex or Location of build123d."""
BoxLike: TypeAlias = "ArrayLike | BoundBox"
"""The lowest and the highest corner of a box, or a BoundBox of build123d."""
OriginLike: TypeAlias = "PositionLike | Plane"
"""A position, or a Plane or Location, which has axes too."""
DirectionLike: TypeAlias = "PositionLike | Axis | Plane"
"""A vector of any length > 0, an Axis, or a Plane or Location for its z axis."""
AxesLike: TypeAlias = "ArrayLike | Plane | Location"
"""Three directions, rows, or a Plane or Location that has them."""


def numbers_of(position: Any) -> Any:
    """Return where a Vector, Vertex or Location is, (3,).

    GridLocations and the like are (n, 3), and both corners of a BoundBox (2, 3).
    """
    if _is(position, "BoundBox"):
        return tuple(position.min), tuple(position.max)
    if _is(position, "LocationList"):
        return [tuple(location.position) for location in position]
    if _is(position, "Location"):
        return tuple(position.position)
    return tuple(position) if _is(position, "Vector", "Vertex") else position


def direction_of(direction: Any) -> Any:
    """Return that of an Axis, the z axis of a Plane or Location, or the numbers of a Vector."""
    placement = placement_of(direction)
    if placement is not None:
        return placement[:, 2]
    return numbers_of(direction.direction if _is(direction, "Axis") else direction)


def placement_of(place: Any) -> NDArray[np.float64] | None:
    """Return the rotation and the position of a Plane or Location, (3, 4), or None.

    The first three columns are its x, y and z axis.
    """
    if not _is(place, "Plane", "Location"):
        return None
    location = place.location if _is(place, "Plane") else place
    move = location.wrapped.Transformation()
    return np.array([[move.Value(row, column) for column in (1, 2, 3, 4)] for row in (1, 2, 3)])


def placed_by(origin: Any, axes: Any) -> tuple[Any, Any]:
    """Return a position and axes, or a direction, where each may come from the other.

    Parameters
    ----------
    origin : a position; a Plane or Location gives the axes too, where there are none
    axes : an Axis, Plane or Location gives the position too, where there is none
    """
    if origin is None:
        return origin_of(axes), axes
    if axes is None and placement_of(origin) is not None:
        axes = origin
    return origin_of(origin, origin), axes


def origin_of(place: Any, default: Any = (0.0, 0.0, 0.0)) -> Any:
    """Return the position of an Axis, a Plane or a Location, or a default of all else."""
    if _is(place, "Axis"):
        return numbers_of(place.position)
    placement = placement_of(place)
    return default if placement is None else placement[:, 3]


def side_of(plane: Any) -> Any:
    """Return the distance behind a Plane as a function of positions (n, 3); all else as it is.

    It is negative where the z axis points to: on the side that `split` of build123d keeps.
    """
    if not _is(plane, "Plane"):
        return plane
    placement = placement_of(plane)
    assert placement is not None
    return lambda points: (placement[:, 3] - points) @ placement[:, 2]


def _is(what: Any, *names: str) -> bool:
    return any(is_instance(what, "build123d", name) for name in names)
