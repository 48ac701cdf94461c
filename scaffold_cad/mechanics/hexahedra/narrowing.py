"""Nodes made narrower until no hexahedron is inverted.

Where branch points are closer than their struts are thick, descent may find no places for their
outer points. But near their hubs there are some. Let the outer points of a node stand at one
distance from its hub, those in the middle of sides (v, w) at m = MIDDLE (v + w). Then the quads
(hub, v, m, w) are convex, and as that is affine, they are so seen along each strut whose partition
is star-shaped around it. As the distance shrinks, the sides between two sections turn parallel to
the strut, and all corners of its hexahedra become positive. Beside a section that stays wide, such
as a collar, that needs its points to be in the strut's cone, as the certificate of scaffolds says.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scaffold_cad.base.arrays import Points
from scaffold_cad.base.vectors import length
from scaffold_cad.mechanics.hexahedra.control import Control
from scaffold_cad.mechanics.hexahedra.quality import scaled_jacobians
from scaffold_cad.mechanics.hexahedra.sections import Frame

MIDDLE = 0.7
"""Of v + w; the quad is convex between 1/2 and 1. At sides that turn by 90° all points are at one
distance."""

NARROWER = 0.7
"""How wide a node is after a round, in what it was."""

ROUNDS = 30
"""Most times that nodes are made narrower: to some 1/50 000."""

LEAST = 0.1
"""Scaled Jacobian at which nodes are narrow enough, in what is asked for."""


def narrow_controls(frame: Frame, layers: int) -> Points:
    """Return the control points, (c, 3), mm, where all of a node are at the least of its distances.

    Sections have eight points.
    """
    offsets = frame.rim - frame.hubs[frame.owner]
    distance = length(offsets)
    units = offsets / distance[:, None]
    least = np.full(len(frame.hubs), np.inf)
    np.minimum.at(least, frame.owner, distance)
    corners, middles = frame.around[:, ::2], frame.around[:, 1::2]  # (c, 4) each
    apart = length(units[corners] + units[np.roll(corners, -1, axis=1)])  # of v + w
    part = np.ones(len(frame.rim))
    part[middles] = np.minimum(1.0, MIDDLE * apart)
    reach = least[frame.owner] * part
    rim = frame.hubs[frame.owner] + reach[:, None] * units
    return replace(frame, rim=rim).controls(layers)


def narrowed(control: Control, places: Points, goal: float) -> Points:
    """Return the control points, those of nodes with inverted hexahedra drawn toward their hubs.

    A node is drawn in round by round, and with it those at the other ends of its struts where
    their hexahedra need that.

    Parameters
    ----------
    control : the mesh
    places : (c, 3) float64, mm, control points
    goal : least scaled Jacobian that was asked for
    """
    if control.narrow is None:
        return places
    places, points, narrow = places.copy(), control.weights @ places, control.narrow()
    quality = scaled_jacobians(points, control.hexahedra)
    width = np.ones(len(places))  # of each hub's node, in that of its narrow place
    for _ in range(ROUNDS):
        bad = quality <= LEAST * goal
        if not bad.any():
            break
        hubs = np.zeros(len(places), dtype=np.bool_)
        hubs[control.hub[control.touched(control.hexahedra[bad])]] = True
        width[hubs] *= NARROWER
        moving = np.flatnonzero(hubs[control.hub])
        hub = control.hub[moving]
        offsets = narrow[moving] - narrow[hub]
        places[moving] = narrow[hub] + width[hub, None] * offsets
        moved = np.diff(control.weights[:, moving].indptr) > 0
        points[moved] = control.weights[np.flatnonzero(moved)] @ places
        rows = np.flatnonzero(moved[control.hexahedra].any(axis=1))
        quality[rows] = scaled_jacobians(points, control.hexahedra[rows])
    return places
