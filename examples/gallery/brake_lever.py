"""A brake lever of two chords and a web, on a boss that build123d drills for its pivot.

Each chord tapers as its load does, and the blade ends in a ball, as rules of racing ask for.
"""

import build123d as bd
import numpy as np

from scaffold_cad import Skeleton, round_struts, to_brep, write

LENGTH, DEPTH, SWEEP = 100.0, 26.0, 16.0
"""Length of the blade, distance of its chords at the boss, and how far its tip stands back, mm."""

BOSS, PIVOT, BALL = 8.0, 3.0, 7.5
"""Radii of the boss, of the hole for its pivot and of the ball, mm."""

FRONT, BACK = np.array([0.24, 0.5, 0.74]), np.array([0.36, 0.62])
"""Joints of the web along the chord in front and the one behind, in parts of the length."""


def axes() -> Skeleton:
    """Return the members: boss, chords and web."""
    along = np.concatenate([FRONT, BACK, [1.0]])
    behind = np.concatenate([0 * FRONT, DEPTH * (1 - BACK**2), [0.0]])
    blade = np.stack([LENGTH * along, SWEEP * along**2 - 8 * (1 - along) + behind], axis=1)
    nodes = np.vstack([[[0, 0, -13], [0, 0, 0], [0, 0, 13]], np.insert(blade, 2, 0.0, axis=1)])
    chords = [[1, 3], [3, 4], [4, 5], [5, 8], [1, 6], [6, 7], [7, 8]]
    web = [[3, 6], [6, 4], [4, 7], [7, 5]]
    thick = np.array([4.6, 4.2, 3.8, 3.4, 3.0, 4.6, 4.0, 3.5, 3.0])
    ends = [thick[[0, 1]], thick[[1, 2]], thick[[2, 3]], thick[[3, 4]]]
    ends += [thick[[5, 6]], thick[[6, 7]], thick[[7, 8]]]
    radii = np.vstack([np.full((2, 2), BOSS), ends, np.full((4, 2), 2.2)])
    own = np.where(np.arange(len(nodes)) == 8, BALL, 1.0)
    return Skeleton(nodes, [[0, 1], [1, 2], *chords, *web], own, edge_radii=radii)


def make() -> bd.Part:
    """Return the lever as a solid, its boss drilled."""
    lever = to_brep(round_struts(axes(), blend=2.5))
    return bd.Part() + bd.Solid(lever.wrapped) - bd.Cylinder(PIVOT, 40.0)


if __name__ == "__main__":
    write(make(), "brake_lever.step")
