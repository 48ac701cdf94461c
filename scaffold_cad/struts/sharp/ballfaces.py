"""The faces of a star's ball: its parts between cuts, piece by piece, each with a frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.vectors import normalize
from scaffold_cad.struts.sharp.curves import StarCurves
from scaffold_cad.struts.sharp.loops import Loop, Steps, area, is_inside

WIDEST = np.radians(87.0)
"""Largest latitude and part of a half turn in longitude of a face of the ball."""


@dataclass(frozen=True, eq=False)
class BallFace(Frozen):
    """A frame in which a part of the ball is away from the poles and from the seam."""

    z: UnitVectors
    x: UnitVectors


def ball_frames(
    curves: StarCurves, sides: Ints, points: Points, valency: int
) -> dict[int, BallFace] | None:
    """Return the frames of the faces of the ball, or None where one has none."""
    found = {}
    for face in np.unique(sides[sides >= valency]).tolist():
        around = points[(sides == face).any(axis=1)].reshape(-1, 3)
        planes = curves.planes[0][(curves.planes[0] != 0).any(axis=1)]
        signs = np.where((face - valency) & np.array([1, 2])[: len(planes)], 1.0, -1.0)
        if len(planes) == 2:
            middle = normalize((signs[:, None] * planes).sum(axis=0)[None])[0]
        else:
            middle = normalize(around.mean(axis=0)[None])[0]
        if len(planes) == 1:
            strut = int(np.argmax(curves.stars.tangent[0]))
            behind = -curves.stars.directions[0, strut]
            middle = normalize((signs[0] * planes[0] + behind)[None])[0]
        frame = _frame(middle, around)
        if frame is None:
            return None
        found[face] = frame
    return found


def apart(
    loops: tuple[Loop, ...],
    sides: Ints,
    frames: dict[int, BallFace],
    points: Points,
    valency: int,
) -> tuple[tuple[Loop, ...], Ints, dict[int, BallFace]]:
    """Return loops, sides and frames with a face for each piece of each part of the ball.

    The loop around a piece comes before those of its holes.
    """
    made: list[Loop] = [loop for loop in loops if loop[0] < valency]
    sides, balls = sides.copy(), {}
    face = valency
    for part, frame in frames.items():
        steps = [steps for number, steps in loops if number == part]
        flat = [_on_map(frame, points, each) for each in steps]
        areas = np.array([area(each) for each in flat])
        outer = np.flatnonzero(areas > 0).tolist()
        holes = np.flatnonzero(areas <= 0).tolist()
        owner = {
            hole: next((k for k in outer if is_inside(flat[k], flat[hole][0])), outer[0])
            for hole in holes
        }
        for first in outer:
            for loop in [first, *(hole for hole in holes if owner[hole] == first)]:
                made.append((face, steps[loop]))
                for edge, way in steps[loop]:
                    sides[edge, 0 if way else 1] = face
            balls[face] = frame
            face += 1
    return tuple(made), sides, balls


def _on_map(frame: BallFace, points: Points, steps: Steps) -> Floats:
    """Return longitudes and latitudes along a loop, (q, 2)."""
    path = np.concatenate([points[edge][:: 1 if way else -1][:-1] for edge, way in steps])
    longitude = np.arctan2(path @ np.cross(frame.z, frame.x), path @ frame.x)
    return np.stack([longitude, np.arcsin(np.clip(path @ frame.z, -1.0, 1.0))], axis=1)


def _frame(middle: UnitVectors, around: Points) -> BallFace | None:
    """Return the frame with `middle` at longitude and latitude 0 that is best, if one will do."""
    start = np.cross(middle, np.eye(3)[np.argmin(np.abs(middle))])
    start = start / np.linalg.norm(start)
    angle = np.pi / 36 * np.arange(36)[:, None]
    choices = np.cos(angle) * start + np.sin(angle) * np.cross(middle, start)  # (36, 3)
    height = np.abs(around @ choices.T).max(axis=0)
    best = choices[int(np.argmin(height))]
    east = np.cross(best, middle)
    longitude = np.abs(np.arctan2(around @ east, around @ middle)).max()
    if height.min() > np.sin(WIDEST) or longitude > 2 * WIDEST:
        return None
    return BallFace(best, middle)
