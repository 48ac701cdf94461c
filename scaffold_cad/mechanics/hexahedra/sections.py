"""Cross-sections as quads: a core of four squares around a center, and layers around the core.

A section has a hub and a rim of 8, 16, 24 ... points. Its core has a corner at every second eighth
of the rim: the four squares (hub, v, m, w) are cut into k × k, for 8 k points. Where sections share
points of their rims, as at nodes, they share all points between these and the hub.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points

CORE = 0.55
"""How far out the core of a section with layers reaches at its corners, in radii."""

SQUARENESS = 0.5
"""From a circle, 0, to a square, 1: what a core looks like. Three hexahedra meet around the points
half way between its corners, which are best at 120°."""


@dataclass(frozen=True, eq=False)
class Frame(Frozen):
    """The hubs and rims of cross-sections, each point once."""

    hubs: Points
    """Centers of sections, shape (h, 3), mm."""
    rim: Points
    """Outer points, shape (r, 3), mm."""
    owner: Ints
    """Hub that each point of the rim is around, shape (r,)."""
    hub: Ints
    """Hub of each section, shape (c,)."""
    around: Ints
    """Points of the rim around each section, counter-clockwise, shape (c, sides): every quarter of
    them begins at a corner of the section."""
    loose: Bools
    """Hubs that may move, with the cores around them, shape (h,)."""
    loose_rim: Bools
    """Points of the rim that may move, shape (r,)."""
    scale: Floats
    """What counts as a large move at each hub, shape (h,), mm."""

    @property
    def sides(self) -> int:
        """Points around a section."""
        return int(self.around.shape[1])

    def controls(self, layers: int) -> Points:
        """Return the hubs, the rim, and with layers the cores' outer points, (c, 3), mm."""
        places = [self.hubs, self.rim]
        if layers:
            middle = self.hubs[self.owner]
            places.append(middle + self._reach[:, None] * (self.rim - middle))
        return np.concatenate(places)

    @property
    def _reach(self) -> Floats:
        """How far out the core reaches below each point of the rim, in parts, (r,)."""
        place = np.arange(self.sides) / self.sides * 8.0 % 2.0  # in eighths from a corner
        angle = np.pi / 4 * np.minimum(place, 2.0 - place)
        found = np.empty(len(self.rim))
        found[self.around] = CORE * (1.0 + SQUARENESS * (1.0 / np.cos(angle) - 1.0))
        return found

    def movable(self, layers: int) -> tuple[Bools, Floats]:
        """Return which controls may move, and what counts as a large move of each, mm."""
        cores = [self.loose[self.owner]] if layers else []
        scale = self.scale[self.hub_of_control(layers)]
        return np.concatenate([self.loose, self.loose_rim, *cores]), scale

    def hub_of_control(self, layers: int) -> Ints:
        """Return the hub that each control is, or is around, (c,)."""
        return np.concatenate([np.arange(len(self.hubs)), *[self.owner] * (2 if layers else 1)])


class FrameParts:
    """The parts of a frame, while they are put together."""

    def __init__(self, sides: int) -> None:
        self.sides = sides
        self._hubs: list[Points] = [np.empty((0, 3))]
        self._scale: list[Floats] = [np.empty(0)]
        self._loose: list[Bools] = [np.empty(0, dtype=np.bool_)]
        self._rim: list[Points] = [np.empty((0, 3))]
        self._loose_rim: list[Bools] = [np.empty(0, dtype=np.bool_)]
        self._owner: list[Ints] = [np.empty(0, dtype=np.intp)]
        self._hub: list[Ints] = [np.empty(0, dtype=np.intp)]
        self._around: list[Ints] = [np.empty((0, sides), dtype=np.intp)]

    def add_hubs(self, places: Points, scale: Floats, loose: bool = False) -> Ints:
        """Add hubs (..., 3), with what counts as a large move (...); return their numbers (...)."""
        numbers = _numbers(self._hubs, places)
        self._scale.append(np.broadcast_to(scale, numbers.shape).reshape(-1))
        self._loose.append(np.full(numbers.size, loose))
        return numbers

    def add_rim(self, places: Points, owner: Ints, loose: bool = False) -> Ints:
        """Add points (..., s, 3) around hubs (...); return their numbers (..., s)."""
        numbers = _numbers(self._rim, places)
        self._owner.append(np.broadcast_to(owner[..., None], numbers.shape).reshape(-1))
        self._loose_rim.append(np.full(numbers.size, loose))
        return numbers

    def add_sections(self, hub: Ints, around: Ints) -> Ints:
        """Add sections with hubs (...) and rims (..., sides); return their numbers (...)."""
        first = sum(len(each) for each in self._hub)
        self._hub.append(hub.reshape(-1))
        self._around.append(around.reshape(-1, self.sides))
        return first + np.arange(hub.size).reshape(hub.shape)

    def middles(self, pairs: Ints) -> Points:
        """Return the places half way between the hubs of pairs of sections (e, 2), (e, 3), mm."""
        ends = np.concatenate(self._hubs)[np.concatenate(self._hub)[pairs]]
        middles: Points = ends.mean(axis=1)
        return middles

    def frame(self) -> Frame:
        """Return the frame."""
        rim = np.concatenate(self._rim)
        return Frame(
            np.concatenate(self._hubs),
            rim,
            np.concatenate(self._owner),
            np.concatenate(self._hub),
            np.concatenate(self._around),
            np.concatenate(self._loose),
            np.concatenate(self._loose_rim),
            np.concatenate(self._scale),
        )


def _numbers(parts: list[Points], places: Points) -> Ints:
    """Add places (..., 3) to parts, and return their numbers, (...)."""
    first = sum(len(each) for each in parts)
    parts.append(places.reshape(-1, 3))
    return first + np.arange(places.size // 3).reshape(places.shape[:-1])


@dataclass(frozen=True, eq=False)
class Sections(Frozen):
    """All points of the sections of a frame."""

    frame: Frame
    """Hubs and rims."""
    layers: int
    """Of quads around the cores."""

    @property
    def count(self) -> int:
        """Points in all."""
        return int(self._first_of_squares + len(self._squares[0]) * (self.steps - 1) ** 2)

    @property
    def steps(self) -> int:
        """Quads along a side of the four squares of a core."""
        return self.frame.sides // 8

    @cached_property
    def numbers(self) -> Ints:
        """Points of each section, shape (c, s).

        The hub, from the inside out the rings around the core, the spokes from the hub to its four
        corners, and what is inside its squares.
        """
        frame, steps = self.frame, self.steps
        ring = len(frame.hubs) + len(frame.rim) * np.arange(self.layers + 1)
        rings = ring[:, None] + frame.around[:, None]  # (c, layers + 1, sides)
        inner = np.arange(steps - 1)
        spoke = self._spokes[1].reshape(-1, 4, 1) * (steps - 1) + inner
        a, b = inner[:, None], inner[None]
        straight, turned = a * (steps - 1) + b, b * (steps - 1) + a
        way = np.where(self._turned[..., None, None], turned, straight)
        square = self._squares[1].reshape(-1, 4, 1, 1) * (steps - 1) ** 2 + way
        count = len(frame.hub)
        return np.concatenate(
            [
                frame.hub[:, None],
                rings.reshape(count, -1),
                self._first_of_spokes + spoke.reshape(count, -1),
                self._first_of_squares + square.reshape(count, -1),
            ],
            axis=1,
        )

    @cached_property
    def weights(self) -> sparse.csr_array:
        """What takes the controls of the frame to all points, (points, controls)."""
        frame, layers, steps = self.frame, self.layers, self.steps
        hubs, rim = len(frame.hubs), len(frame.rim)
        core = hubs + (rim if layers else 0)
        every = np.arange(rim)
        parts = [(np.arange(hubs), np.arange(hubs), np.ones(hubs))]
        for layer in range(layers + 1):
            far = layer / layers if layers else 1.0
            row = hubs + layer * rim + every
            parts.append((row, core + every, np.full(rim, 1.0 - far if layers else 1.0)))
            parts.append((row, hubs + every, np.full(rim, far if layers else 0.0)))
        along = np.arange(1, steps) / steps
        corner = self._spokes[0]
        row = self._first_of_spokes + np.arange(corner.size * (steps - 1))
        for column, share in ((frame.owner[corner], 1.0 - along), (core + corner, along)):
            parts.append((row, np.repeat(column, steps - 1), np.tile(share, len(corner))))
        square = self._squares[0]
        first = self._first_of_squares + np.arange(len(square)) * (steps - 1) ** 2
        out = self._outlines[square]  # (q, 2 steps + 1), from the lower corner
        for a in range(1, steps):
            for b in range(1, steps):
                s, t = a / steps, b / steps
                row = first + (a - 1) * (steps - 1) + b - 1
                # Between the two outer sides, and two straight spokes.
                for column, part in (
                    (frame.owner[out[:, steps]], (1.0 - s) * (1.0 - t)),
                    (core + out[:, b], s),
                    (core + out[:, 2 * steps - a], t),
                    (core + out[:, steps], -s * t),
                ):
                    parts.append((row, column, np.full(len(square), part)))
        rows, columns, values = (np.concatenate(each) for each in zip(*parts, strict=True))
        shape = (self.count, core + rim)
        found = sparse.csr_array((values, (rows, columns)), shape=shape)
        found.eliminate_zeros()
        return found

    @cached_property
    def quads(self) -> Ints:
        """Quads of a section by its points, counter-clockwise, (4 steps² + sides layers, 4)."""
        steps, sides = self.steps, self.frame.sides
        spokes = 1 + sides * (self.layers + 1)
        squares = spokes + 4 * (steps - 1)
        found = []
        for quarter in range(4):
            following = (quarter + 1) % 4
            grid = np.empty((steps + 1, steps + 1), dtype=np.intp)
            inner = np.arange(steps - 1)
            grid[0, 0] = 0
            grid[1:-1, 0] = spokes + quarter * (steps - 1) + inner
            grid[0, 1:-1] = spokes + following * (steps - 1) + inner
            corner = squares + quarter * (steps - 1) ** 2
            grid[1:-1, 1:-1] = corner + inner[:, None] * (steps - 1) + inner
            edge = 1 + (2 * steps * quarter + np.arange(2 * steps + 1)) % sides
            grid[-1], grid[:, -1] = edge[: steps + 1], edge[steps:][::-1]
            turn = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
            found.append(np.stack(turn, axis=-1).reshape(-1, 4))
        place = np.arange(sides)
        for layer in range(self.layers):
            inside, outside = 1 + sides * layer, 1 + sides * (layer + 1)
            a, b = place, (place + 1) % sides
            found.append(np.stack([inside + a, outside + a, outside + b, inside + b], axis=1))
        return np.concatenate(found)

    @property
    def _first_of_spokes(self) -> int:
        return len(self.frame.hubs) + len(self.frame.rim) * (self.layers + 1)

    @property
    def _first_of_squares(self) -> int:
        return self._first_of_spokes + len(self._spokes[0]) * (self.steps - 1)

    @cached_property
    def _corners(self) -> Ints:
        """Points of the rim at the corners of each section, (c, 4)."""
        return self.frame.around[:, :: 2 * self.steps]

    @cached_property
    def _spokes(self) -> tuple[Ints, Ints]:
        """Corners, each once, and the number of those of sections, (4 c,)."""
        found, number = np.unique(self._corners, return_inverse=True)
        return found, number.reshape(-1)

    @cached_property
    def _squares(self) -> tuple[Ints, Ints]:
        """Outer corners of the squares of cores, each once, and the number of each, (4 c,)."""
        middles = self.frame.around[:, self.steps :: 2 * self.steps]
        found, number = np.unique(middles, return_inverse=True)
        return found, number.reshape(-1)

    @cached_property
    def _turned(self) -> Bools:
        """Whether squares are numbered from the end of their quarter, (c, 4).

        Two sections that share a square see it from either side.
        """
        return self._corners > np.roll(self._corners, -1, axis=1)

    @cached_property
    def _outlines(self) -> Ints:
        """Rim from the lower to the higher corner by the point between, (r, 2 steps + 1)."""
        around = self.frame.around
        wide = np.concatenate([around, around[:, :1]], axis=1)
        place = 2 * self.steps * np.arange(4)[:, None] + np.arange(2 * self.steps + 1)
        outline = wide[:, place]  # (c, 4, 2 steps + 1)
        outline = np.where(self._turned[..., None], outline[..., ::-1], outline)
        found = np.zeros((len(self.frame.rim), 2 * self.steps + 1), dtype=np.intp)
        found[outline[..., self.steps].reshape(-1)] = outline.reshape(-1, 2 * self.steps + 1)
        return found
