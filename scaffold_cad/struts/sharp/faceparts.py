"""The vertices, edges and faces of a B-rep of sharp nodes while it grows."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.brep.analytic import Surface
from scaffold_cad.struts.sharp.seamed import Trace


@dataclass
class Use:
    """An edge of a loop."""

    edge: int
    along: bool
    trace: Trace
    """In the parameters of the face."""


@dataclass
class Face:
    """A face, its outer loop first."""

    kind: Surface
    axes: tuple[Floats, Floats, Floats]
    sizes: tuple[float, float]
    loops: list[list[Use]]
    node: int
    name: int
    part: int = -1
    """Of a ball, the number in its shape."""


@dataclass
class Parts:
    """A B-rep that grows; edges are ordered by kind when it is done."""

    vertices: list[Points] = field(default_factory=list)
    slack: list[Floats] = field(default_factory=list)
    count: int = 0
    ends: list[tuple[int, int]] = field(default_factory=list)
    kind: list[int] = field(default_factory=list)
    """0 for lines, 1 for circles and ellipses, 1 + the pieces of splines."""
    curve: list[tuple[Floats, Floats, Floats]] = field(default_factory=list)
    """Axes, half-diameters and angles, or control points."""
    faces: list[Face] = field(default_factory=list)

    def add_points(self, points: Points, slack: Floats | None = None) -> int:
        """Add vertices (v, 3) with how far from them edges end; return the number of the first."""
        self.vertices.append(points)
        self.slack.append(np.zeros(len(points)) if slack is None else slack)
        self.count += len(points)
        return self.count - len(points)

    def add_edge(self, ends: tuple[int, int], kind: int, *curve: Floats) -> int:
        """Add an edge; return its number."""
        self.ends.append(ends)
        self.kind.append(kind)
        nothing = np.zeros((0, 3))
        self.curve.append((*curve, nothing, nothing, nothing)[:3])  # type: ignore[arg-type]
        return len(self.ends) - 1


@dataclass
class Around:
    """What goes around a strut at one of its nodes, in the strut's own parameters there."""

    uses: list[Use]
    vertex: int
    height: float
    """Of the vertex, mm."""
