"""Skeletons from build123d's edges, wires and sketches, and back.

Imports build123d and its OCP: `Skeleton.from_edges` and `Skeleton.to_wire_compound` do so when
they are called.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, pairwise
from typing import TypeAlias

import numpy as np
from build123d import Builder, Curve, Edge, Shape
from numpy.typing import ArrayLike
from OCP.BOPAlgo import BOPAlgo_Builder
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.GCPnts import GCPnts_TangentialDeflection
from OCP.GeomAbs import GeomAbs_CurveType
from OCP.TopoDS import TopoDS_Compound, TopoDS_Edge

from scaffold_cad.base.arguments import as_number, described
from scaffold_cad.base.arrays import Edges, Floats, Points, as_floats
from scaffold_cad.base.boxes import overlapping_boxes
from scaffold_cad.base.builders import built
from scaffold_cad.base.radii import Radius, radii_at
from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.base.vectors import angle_between, length, normalize
from scaffold_cad.brep.occt import TOLERANCE
from scaffold_cad.brep.occtcurves import TURN, as_edge, sampled
from scaffold_cad.brep.occtmeshes import line_edges
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.skeleton import Skeleton

Curves: TypeAlias = Shape | Builder | Iterable[Shape | Builder]
"""A shape of build123d that has edges, or a builder that holds one, or several of them."""

MemberRadius: TypeAlias = Radius | Sequence[float] | Floats
"""A radius for all, or one for each shape or each edge of them, mm."""

HALF_TURN = 5
"""Points, no more than `TURN` apart, after which a curve has turned by less than π."""

ANY_DISTANCE = 1e9
"""Distance of chords from a curve where nothing but its turn matters, mm."""

NEVER_CROSSING = (
    GeomAbs_CurveType.GeomAbs_Line,
    GeomAbs_CurveType.GeomAbs_Circle,
    GeomAbs_CurveType.GeomAbs_Ellipse,
    GeomAbs_CurveType.GeomAbs_Hyperbola,
    GeomAbs_CurveType.GeomAbs_Parabola,
)
"""Curves that do not cross themselves."""


def skeleton_from_edges(
    curves: Curves, radius: MemberRadius, *, tolerance: float, contact: float
) -> Skeleton:
    """Do what `Skeleton.from_edges` says."""
    tolerance, contact = as_number(tolerance, "tolerance"), as_number(contact, "contact")
    shapes = [list(edges) for edges in _edges_in(curves)]
    # Each once, with its largest radius: shapes may share edges, as a face and its wire do.
    distinct: dict[Edge, float] = {}
    sizes = _radii_of(shapes, radius) if isinstance(radius, Sequence | np.ndarray) else None
    for k, edge in enumerate(chain.from_iterable(shapes)):
        if not _is_degenerate(edge):
            own = 1.0 if sizes is None else float(sizes[k])
            distinct[edge] = max(own, distinct.get(edge, 0.0))
    apart = contact + 2 * tolerance  # of chords whose curves do not touch
    cut = [(_pieces(edge.wrapped, tolerance, apart), own) for edge, own in distinct.items()]
    edges = [(piece, own) for pieces, own in cut for piece in pieces]
    if not edges:
        raise SkeletonError("the shapes have no edges; need at least one")
    split = _split_where_they_meet(edges, contact)
    polylines = [sampled(edge.wrapped, tolerance) for edge in split]
    nodes, pairs = _chained(polylines)
    members = np.repeat(list(split.values()), [len(points) - 1 for points in polylines])
    clean = Skeleton(nodes, pairs, edge_radii=members).cleaned(weld_distance=contact).skeleton
    if isinstance(radius, Sequence | np.ndarray):
        return clean
    return clean.with_radii(radii_at(clean.nodes, radius))


def _radii_of(shapes: list[list[Edge]], radius: ArrayLike) -> Floats:
    """Return the radius of each edge of shapes, one shape after the other, mm.

    Raises
    ------
    OptionError
        If there is neither a number > 0 for each shape nor one for each edge.
    """
    sizes = as_floats(radius, "radius", OptionError)
    counts = [len(edges) for edges in shapes]
    if len(shapes) > 1 and sizes.shape == (len(shapes),):
        what, own = "shape", np.repeat(sizes, counts)
    elif sizes.shape == (sum(counts),):
        what, own = "edge", sizes
    else:
        per_shape = f"{len(shapes)}, one for each shape, or " if len(shapes) > 1 else ""
        raise OptionError(
            f"radius has shape {sizes.shape}; need {per_shape}{sum(counts)}, one for each edge"
        )
    bad = np.flatnonzero(~(np.isfinite(sizes) & (sizes > 0)))
    if len(bad):
        raise OptionError(f"radius of {what} {bad[0]} is {sizes[bad[0]]:g} mm; need > 0")
    return np.asarray(own)


def wire_compound(skeleton: Skeleton) -> Curve:
    """Return each edge of the skeleton, in order, as a straight build123d Edge of one Curve.

    Raises
    ------
    SkeletonError
        If an edge is no longer than OCCT's tolerance; it is named.
    """
    short = np.flatnonzero(skeleton.lengths <= TOLERANCE)
    if len(short):
        raise SkeletonError(
            f"edge {short[0]} is {skeleton.lengths[short[0]]:g} mm long; need more than "
            f"{TOLERANCE:g} (use Skeleton.cleaned() to repair it)"
        )
    compound = TopoDS_Compound()
    builder = BRep_Builder()
    builder.MakeCompound(compound)
    for edge in line_edges(skeleton.nodes, skeleton.edges):
        builder.Add(compound, edge)
    return Curve(compound)


def _edges_in(curves: Curves) -> Iterator[Iterable[Edge]]:
    """Return the edges of a shape, or of each of several."""
    several = isinstance(curves, Iterable) and not isinstance(curves, Shape | str)
    shapes = [built(shape) for shape in (curves if several else [curves])]
    strange = [shape for shape in shapes if not isinstance(shape, Shape)]
    if strange:
        raise OptionError(
            f"{described(strange[0])} is not a shape of build123d; need edges, wires or sketches"
        )
    return (shape.edges() for shape in shapes)


def _is_degenerate(edge: Edge) -> bool:
    """Return whether an edge is a single point, such as a pole of a sphere."""
    return bool(BRep_Tool.Degenerated_s(edge.wrapped))


def _pieces(edge: TopoDS_Edge, tolerance: float, apart: float) -> list[TopoDS_Edge]:
    """Return an edge in pieces that do not cross themselves.

    Only a curve that turns by more than π can come back to where it was: a loop with one corner
    turns by 2π, no more than π of it at the corner.

    Parameters
    ----------
    tolerance : largest distance of chords from their curve, mm
    apart : distance of chords, mm; a curve whose chords are farther from each other is one piece
    """
    curve = BRepAdaptor_Curve(edge)
    if curve.GetType() in NEVER_CROSSING or not curve.Is3DCurve():
        return [edge]
    if not _comes_back(sampled(edge, tolerance), apart):
        return [edge]
    sampler = GCPnts_TangentialDeflection(curve, TURN, ANY_DISTANCE)
    last = sampler.NbPoints()
    cuts = [sampler.Parameter(i) for i in (*range(1, last, HALF_TURN), last)]
    if len(cuts) == 2:
        return [edge]
    path = curve.Curve().Curve().Transformed(curve.Trsf())
    return [BRepBuilderAPI_MakeEdge(path, a, b).Edge() for a, b in pairwise(cuts)]


def _comes_back(points: Points, apart: float) -> bool:
    """Return whether some chords between `points` (k, 3) come near others, not next to them."""
    spans = np.diff(points, axis=0)
    count, reach = len(spans), np.full(3, apart / 2)
    closed = bool(length(points[-1] - points[0]) <= apart)
    if closed and angle_between(*normalize(spans[[0, -1]])) > TURN:
        return True  # around a corner a few chords may turn by more than π
    low, high = np.minimum(points[:-1], points[1:]), np.maximum(points[:-1], points[1:])
    for i, j in overlapping_boxes(low - reach, high + reach):
        between = np.abs(j - i)
        far = between >= HALF_TURN
        if closed:
            far &= count - between >= HALF_TURN
        i, j = i[far], j[far]
        near = nearest_on_segments(points[i], points[i + 1], points[j], points[j + 1])
        if (length(near[1] - near[0]) <= apart).any():
            return True
    return False


def _split_where_they_meet(
    edges: list[tuple[TopoDS_Edge, float]], distance: float
) -> dict[Edge, float]:
    """Return the edges cut where they touch, cross or cover each other, each piece once.

    With each edge goes its radius; a piece of several has their largest.

    Raises
    ------
    SkeletonError
        If OCCT finds no way to do so.
    """
    if len(edges) == 1:
        return {Edge(edge): radius for edge, radius in edges}
    fuse = BOPAlgo_Builder()
    for edge, _ in edges:
        fuse.AddArgument(edge)
    fuse.SetFuzzyValue(distance)
    fuse.SetNonDestructive(True)
    fuse.Perform()
    if fuse.HasErrors():
        raise SkeletonError(f"OCCT cannot tell where the {len(edges)} edges meet; need fewer")
    found = dict.fromkeys(Shape.cast(fuse.Shape()).edges(), 0.0)
    for edge, radius in edges:
        images = [Edge(as_edge(image)) for image in fuse.Modified(edge)] or [Edge(edge)]
        for image in images:
            if image in found:  # too short ones are gone
                found[image] = max(found[image], radius)
    return found


def _chained(polylines: list[Points]) -> tuple[Points, Edges]:
    """Return the points of polylines one after the other, and the pairs that they join."""
    counts = np.array([len(points) for points in polylines])
    last = np.cumsum(counts) - 1
    first = np.delete(np.arange(counts.sum()), last)
    return np.concatenate(polylines), np.stack([first, first + 1], axis=1)
