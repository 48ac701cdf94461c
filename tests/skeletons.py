"""Named skeletons for tests: small, valid, each with one feature in its name. Lengths in mm."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from scaffold_cad.base.arrays import Edges
from scaffold_cad.skeleton import Skeleton


def polyline(count: int, *, closed: bool = False) -> Edges:
    """Return the edges of a path through nodes 0..count-1, shape (m, 2)."""
    nodes = np.arange(count)
    last = count if closed else count - 1
    return np.stack([nodes, np.roll(nodes, -1)], axis=1)[:last]


def star(tips: list[list[float]], radius: float = 1.0) -> Skeleton:
    """Return a branch point at the origin with an edge to each of `tips`."""
    spokes = [(0, k + 1) for k in range(len(tips))]
    return Skeleton(np.array([[0.0, 0.0, 0.0], *tips]), np.array(spokes), np.array(radius))


STRUT = Skeleton(np.array([[0, 0, 0], [10, 0, 0]]), np.array([[0, 1]]), np.array(1.0))
"""One edge."""

TAPER = Skeleton(np.array([[0, 0, 0], [0, 0, 10]]), np.array([[0, 1]]), np.array([1.0, 2.0]))
"""One edge, thicker at its second node."""

ELBOW = Skeleton(
    np.array([[0, 0, 0], [10, 0, 0], [10, 10, 0]]), np.array([[0, 1], [1, 2]]), np.array(1.0)
)
"""Two edges at a right angle: a joint."""

ZIGZAG = Skeleton(
    np.array([[0, 0, 0], [10, 0, 0], [10, 10, 0], [20, 10, 5], [20, 10, 15], [28, 10, 21]]),
    polyline(6),
    np.array([1.0, 1.2, 1.4, 1.2, 1.0, 0.8]),
)
"""A path through four joints that does not lie in a plane, with radii that change."""

TRIPOD = star([[10, 0, 0], [0, 10, 0], [0, 0, 10]])
"""A branch point with three edges at right angles."""

PLANAR_Y = star([[10, 0, 0], [-5, 8.660254037844386, 0], [-5, -8.660254037844386, 0]])
"""A branch point with three edges in a plane, 120° apart."""

STRAIGHT_THROUGH = star([[10, 0, 0], [-10, 0, 0], [0, 0, 10]])
"""A branch point where two of the three edges are opposite."""

CROSS = star([[10, 0, 0], [0, 10, 0], [-10, 0, 0], [0, -10, 0]])
"""A branch point with four edges in a plane, two opposite pairs."""

TETRAPOD = star([[6, 6, 6], [6, -6, -6], [-6, 6, -6], [-6, -6, 6]])
"""A branch point with four edges toward the corners of a regular tetrahedron."""

JACK = star([[10, 0, 0], [-10, 0, 0], [0, 10, 0], [0, -10, 0], [0, 0, 10], [0, 0, -10]])
"""A branch point with six edges along the axes, as in a simple cubic lattice."""

BCC_STAR = star([[x, y, z] for x in (-6.0, 6.0) for y in (-6.0, 6.0) for z in (-6.0, 6.0)])
"""A branch point with eight edges toward the corners of a cube."""

K4 = Skeleton(
    np.array([[6, 6, 6], [6, -6, -6], [-6, 6, -6], [-6, -6, 6]]),
    np.array(list(combinations(range(4), 2))),
    np.array(1.0),
)
"""The edges of a regular tetrahedron: four branch points, three loops."""

CUBE = Skeleton(
    np.array([[x, y, z] for x in (0, 10) for y in (0, 10) for z in (0, 10)]),
    np.array([(a, a | bit) for a in range(8) for bit in (1, 2, 4) if not a & bit]),
    np.array(1.0),
)
"""The edges of a cube: eight branch points, five loops."""

_TURN = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)

RING = Skeleton(
    np.stack([10 * np.cos(_TURN), 10 * np.sin(_TURN), 0 * _TURN], axis=1),
    polyline(12, closed=True),
    np.array(1.0),
)
"""A closed path in a plane: no branch point and no extremity."""

_FINE_TURN = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)

TREFOIL = Skeleton(
    5
    * np.stack(
        [
            np.sin(_FINE_TURN) + 2 * np.sin(2 * _FINE_TURN),
            np.cos(_FINE_TURN) - 2 * np.cos(2 * _FINE_TURN),
            -1.5 * np.sin(3 * _FINE_TURN),
        ],
        axis=1,
    ),
    polyline(40, closed=True),
    np.array(1.0),
)
"""A knotted ring, whose frame does not come back to where it began."""

LOLLIPOP = Skeleton(
    np.array([[0, 0, 0], [10, 5, 0], [15, 0, 3], [10, -5, 0], [-10, 0, 0]]),
    np.array([[0, 1], [1, 2], [2, 3], [3, 0], [0, 4]]),
    np.array(1.0),
)
"""A branch that leaves a branch point and comes back to it, and a handle."""

FIGURE_EIGHT = Skeleton(
    np.array(
        [[0, 0, 0], [10, 5, 0], [15, 0, 3], [10, -5, 0], [-10, 5, 0], [-15, 0, 3], [-9, -5, 0]]
    ),
    np.array([[0, 1], [1, 2], [2, 3], [3, 0], [0, 4], [4, 5], [5, 6], [6, 0]]),
    np.array(1.0),
)
"""Two branches that leave one branch point and come back to it."""

THETA = Skeleton(
    np.array([[-10, 0, 0], [10, 0, 0], [0, 8, 0], [0, -8, 1]]),
    np.array([[0, 1], [0, 2], [2, 1], [0, 3], [3, 1]]),
    np.array(1.0),
)
"""Two branch points joined by three branches, one of them a single edge."""

TWO_STRUTS = Skeleton(
    np.array([[0, 0, 0], [10, 0, 0], [0, 5, 5], [10, 5, 5]]),
    np.array([[0, 1], [2, 3]]),
    np.array(1.0),
)
"""Two components."""

STICK_FIGURE = Skeleton(
    np.array(
        [
            [0, 0, 20],  # hip
            [0, 0, 34],  # neck
            [0, 0, 42],  # head
            [0, 8, 32],  # left elbow
            [6, 12, 28],  # left hand
            [0, -8, 32],  # right elbow
            [6, -12, 28],  # right hand
            [1, 4, 10],  # left knee
            [0, 5, 0],  # left foot
            [1, -4, 10],  # right knee
            [0, -5, 0],  # right foot
        ]
    ),
    np.array([[0, 1], [1, 2], [1, 3], [3, 4], [1, 5], [5, 6], [0, 7], [7, 8], [0, 9], [9, 10]]),
    np.array([1.6, 1.4, 2.0, 1.0, 0.8, 1.0, 0.8, 1.2, 1.0, 1.2, 1.0]),
)
"""Two branch points, four joints, five extremities and eleven radii."""

NAMED: dict[str, Skeleton] = {
    "strut": STRUT,
    "taper": TAPER,
    "elbow": ELBOW,
    "zigzag": ZIGZAG,
    "tripod": TRIPOD,
    "planar_y": PLANAR_Y,
    "straight_through": STRAIGHT_THROUGH,
    "cross": CROSS,
    "tetrapod": TETRAPOD,
    "jack": JACK,
    "bcc_star": BCC_STAR,
    "k4": K4,
    "cube": CUBE,
    "ring": RING,
    "trefoil": TREFOIL,
    "lollipop": LOLLIPOP,
    "figure_eight": FIGURE_EIGHT,
    "theta": THETA,
    "two_struts": TWO_STRUTS,
    "stick_figure": STICK_FIGURE,
}
"""All of them by name, for `pytest.mark.parametrize(..., NAMED.values(), ids=NAMED)`."""
