"""AnalyticBrep: a B-rep in arrays, with planes, cylinders, cones, spheres, tori and spline patches.

It knows nothing of OCCT: `occtanalytic` makes shapes of it, and the writer of STEP files writes it
straight from its arrays. Edges are shared: a closed shell uses each of them twice, in opposite
directions, and the seam of a cylinder is used twice by the cylinder itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.errors import BrepError


class Curve(IntEnum):
    """Kinds of edges."""

    LINE = 0
    CIRCLE = 1
    SPLINE = 2


class Surface(IntEnum):
    """Kinds of faces."""

    PLANE = 0
    CYLINDER = 1
    CONE = 2
    SPHERE = 3
    TORUS = 4
    SPLINE = 5


@dataclass(frozen=True, eq=False)
class Axes(Frozen):
    """Right-handed placements: an origin, an axis z and a direction x across it."""

    origin: Points
    """Shape (a, 3), mm."""
    z: UnitVectors
    """Shape (a, 3)."""
    x: UnitVectors
    """Shape (a, 3)."""


@dataclass(frozen=True, eq=False)
class Knots(Frozen):
    """The knots of a clamped spline over [0, 1]."""

    values: Floats
    """Distinct knots, ascending, shape (k,)."""
    counts: Ints
    """How often each counts, shape (k,): the degree + 1 at both ends."""

    @property
    def degree(self) -> int:
        """Degree of the spline."""
        return int(self.counts[0]) - 1

    @property
    def count(self) -> int:
        """Number of control points."""
        return int(self.counts.sum()) - self.degree - 1

    @property
    def is_bezier(self) -> bool:
        """Whether there is one piece."""
        return len(self.values) == 2

    def matrix(self, at: Floats, order: int = 0) -> Floats:
        """Return the derivatives of the basis at parameters (n,) in [0, 1], shape (n, count)."""
        from scipy.interpolate import BSpline

        knots = np.repeat(self.values, self.counts)
        basis = BSpline(knots, np.eye(self.count), self.degree)
        return np.asarray(basis(np.clip(at, 0.0, 1.0), nu=order), dtype=np.float64)


@dataclass(frozen=True, eq=False)
class SplineCurves(Frozen):
    """Curves with the same knots."""

    control: Floats
    """Control points, shape (b, n, 3), mm."""
    knots: Knots
    """Their knots."""


@dataclass(frozen=True, eq=False)
class SplinePatches(Frozen):
    """Patches with the same knots."""

    control: Floats
    """Control points, shape (p, n_u, n_v, 3), mm."""
    u: Knots
    """Their knots in u."""
    v: Knots
    """Their knots in v."""


@dataclass(frozen=True, eq=False)
class BrepEdges(Frozen):
    """Edges, by kind: first the lines, then circles and ellipses, then the splines."""

    ends: Edges
    """First and last vertex, shape (e, 2); the same twice for a full circle."""
    circles: Axes
    """Of the circles; their parameter is the angle about z from x, rad."""
    radii: Floats
    """Of the circles, shape (c,), mm."""
    angles: Floats
    """First and last angle of the circles, the first in [0, 2π), ascending, shape (c, 2), rad."""
    curves: tuple[SplineCurves, ...]
    """The splines, table after table."""
    lesser: Floats | None = None
    """Lesser half-diameter of circles that are ellipses, along y; else their radius, shape (c,),
    mm. All are circles by default."""

    @property
    def lesser_radii(self) -> Floats:
        """The lesser half-diameter of each circle, shape (c,), mm."""
        return self.radii if self.lesser is None else self.lesser

    @property
    def counts(self) -> tuple[int, int, int]:
        """How many lines, circles and splines there are."""
        circles, curves = len(self.radii), sum(len(table.control) for table in self.curves)
        return len(self.ends) - circles - curves, circles, curves

    @property
    def kinds(self) -> Ints:
        """The `Curve` of each edge, shape (e,)."""
        return np.repeat(np.arange(3), self.counts)


@dataclass(frozen=True, eq=False)
class Traces(Frozen):
    """Edges in the parameters of faces, as splines over their own parameter."""

    use: Ints
    """The use that each is of, shape (q,)."""
    control: Floats
    """Control points, shape (q, n, 2)."""
    knots: Knots
    """Their knots, from the first parameter of the edge, 0, to its last, 1."""


@dataclass(frozen=True, eq=False)
class BrepFaces(Frozen):
    """Faces, in the order of their kinds in `Surface`."""

    kinds: Ints
    """The `Surface` of each face, ascending, shape (f,)."""
    axes: Axes
    """Of all faces but the splines, in their order."""
    sizes: Floats
    """Of these, shape (a, 2): the radius of a cylinder or a sphere and 0; the radius of a cone at
    its origin, mm, and its half angle, rad; both radii of a torus; 0 and 0 for a plane."""
    patches: tuple[SplinePatches, ...]
    """The splines, table after table."""
    outward: Bools
    """Whether the surface's own normal points out of the solid, shape (f,)."""
    loops: Ints
    """Face f has the loops loops[f] to loops[f + 1], its outer one first, shape (f + 1,)."""
    uses: Ints
    """Loop l has the edge uses uses[l] to uses[l + 1], shape (l + 1,)."""
    edge: Ints
    """Edge of each use, counter-clockwise seen from where the surface's own normal points to,
    shape (u,)."""
    forward: Bools
    """Whether each use runs along its edge, shape (u,)."""
    parameters: Floats
    """Parameters on the surface at the start and at the end of the edge of each use, shape
    (u, 2, 2); nan on planes. Between them they change evenly with the edge's own parameter, but
    for circles at the side of patches and uses with a trace."""
    shell: Ints
    """Shell of each face, shape (f,)."""
    name: Ints
    """Place of each face's name in `AnalyticBrep.names`, shape (f,)."""
    traces: tuple[Traces, ...] = ()
    """Of uses whose parameters do not change evenly, table after table."""

    @property
    def face_of_use(self) -> Ints:
        """The face of each use, shape (u,)."""
        face = np.repeat(np.arange(len(self.kinds)), np.diff(self.loops))
        return np.repeat(face, np.diff(self.uses))


@dataclass(frozen=True, eq=False)
class AnalyticBrep(Frozen):
    """Closed shells of analytic faces and Bézier patches."""

    vertices: Points
    """Shape (v, 3), mm."""
    edges: BrepEdges
    """Its edges."""
    faces: BrepFaces
    """Its faces."""
    solid: Ints
    """Solid that each shell bounds, the outer shell of a solid before its voids, shape (s,)."""
    names: tuple[str, ...]
    """Names of faces."""
    slack: Floats | None = None
    """How far from each vertex its edges end, or are off their faces, shape (v,), mm; by default
    they do not and are not."""

    @property
    def slacks(self) -> Floats:
        """How far from each vertex its edges end, shape (v,), mm."""
        return np.zeros(len(self.vertices)) if self.slack is None else self.slack

    @property
    def face_names(self) -> list[str]:
        """The name of each face."""
        return [self.names[name] for name in self.faces.name.tolist()]

    def check_closed(self) -> None:
        """Raise unless each edge is used twice, once in each direction, by faces of one shell.

        Raises
        ------
        BrepError
            If an edge is not; it is named, and where it begins.
        """
        faces = self.faces
        face = faces.face_of_use
        # A face that is seen from inside runs along its edges the other way round.
        along = faces.forward == faces.outward[face]
        count = len(self.edges.ends)
        ahead, back = (np.bincount(faces.edge[along == way], minlength=count) for way in (1, 0))
        bad = np.flatnonzero((ahead != 1) | (back != 1))
        if len(bad):
            place = self.vertices[self.edges.ends[bad[0], 0]].tolist()
            raise BrepError(
                f"edge {bad[0]} from {place} mm is used {ahead[bad[0]]} times forward and "
                f"{back[bad[0]]} backward; need once each in a closed shell"
            )
