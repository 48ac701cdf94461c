"""The faces of a star's ball: one for each piece that is seen, most often one, closed by a seam."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points
from scaffold_cad.struts.sharp.loops import Loop, Steps, area, is_inside


def apart(
    loops: tuple[Loop, ...], sides: Ints, frame: Floats, points: Points, seam: Bools, valency: int
) -> tuple[tuple[Loop, ...], Ints]:
    """Return loops and sides with a face for each piece of the ball.

    The loop around a piece comes before those of its holes.

    Parameters
    ----------
    frame, seam : (3, 3) of the ball; (e,) which edges are on its seam
    """
    made: list[Loop] = [loop for loop in loops if loop[0] < valency]
    rest = [steps for face, steps in loops if face >= valency]
    flat = [_on_map(frame, points, seam, steps) for steps in rest]
    sides = sides.copy()
    areas = np.array([area(each) for each in flat])
    outer = np.flatnonzero(areas > 0).tolist()
    owner = {
        hole: next((k for k in outer if is_inside(flat[k], flat[hole][0])), outer[0])
        for hole in np.flatnonzero(areas <= 0).tolist()
    }
    for face, first in enumerate(outer, start=valency):
        for loop in [first, *(hole for hole in owner if owner[hole] == first)]:
            made.append((face, rest[loop]))
            for edge, way in rest[loop]:
                sides[edge, 0 if way else 1] = face
    return tuple(made), sides


def _on_map(frame: Floats, points: Points, seam: Bools, steps: Steps) -> Floats:
    """Return longitudes and latitudes along a loop, (q, 2)."""
    paths = []
    for edge, way in steps:
        x, y, z = (points[edge] @ frame.T).T
        longitude = in_turn(np.unwrap(np.arctan2(y, x)))
        if seam[edge]:
            longitude[:] = np.pi if way else -np.pi
        path = np.stack([longitude, np.arcsin(np.clip(z, -1.0, 1.0))], axis=1)
        paths.append(path[:: 1 if way else -1][:-1])
    return np.concatenate(paths)


def in_turn(longitude: Floats) -> Floats:
    """Return longitudes along an edge, without jumps, (q,), as those from −π to π.

    Edges do not cross the seam, at ±π, but may end there.
    """
    return np.asarray(longitude - 2 * np.pi * np.round(np.median(longitude) / (2 * np.pi)))
