"""Skeletons from build123d's edges, wires and sketches, and back.

Imports build123d and its OCP: `Skeleton.from_edges` and `Skeleton.to_wire_compound` do so when
they are called.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain
from typing import TypeAlias

import numpy as np
from build123d import Curve, Edge, Shape
from OCP.BOPAlgo import BOPAlgo_Builder
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.GCPnts import GCPnts_TangentialDeflection
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS_Compound, TopoDS_Edge

from scaffold_cad._occt_meshes import line_edges
from scaffold_cad.arrays import Edges, Points
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.lattice.struts import Radius, Struts
from scaffold_cad.skeleton import Skeleton

Curves: TypeAlias = Shape | Iterable[Shape]
"""A shape of build123d that has edges, or several of them."""

TURN = np.pi / 6
"""Largest turn from one joint to the next along a curve, rad: a circle gets 12 of them."""


def skeleton_from_edges(
    curves: Curves, radius: Radius, *, tolerance: float, contact: float
) -> Skeleton:
    """Do what `Skeleton.from_edges` says."""
    for name, value in (("tolerance", tolerance), ("contact", contact)):
        if not 0 < value < np.inf:
            raise OptionError(f"{name} is {value:g} mm; need > 0")
    edges = [edge.wrapped for edge in _edges_in(curves) if not _is_degenerate(edge)]
    if not edges:
        raise SkeletonError("the shapes have no edges; need at least one")
    polylines = [_sampled(edge, tolerance) for edge in _split_where_they_meet(edges, contact)]
    nodes, pairs = _chained(polylines)
    clean = Skeleton(nodes, pairs, np.asarray(1.0)).cleaned(weld_distance=contact).skeleton
    return Struts(clean.nodes, clean.edges).skeleton(radius)


def wire_compound(skeleton: Skeleton) -> Curve:
    """Return each edge of the skeleton, in order, as a straight build123d Edge of one Curve."""
    compound = TopoDS_Compound()
    builder = BRep_Builder()
    builder.MakeCompound(compound)
    for edge in line_edges(skeleton.nodes, skeleton.edges):
        builder.Add(compound, edge)
    return Curve(compound)


def _edges_in(curves: Curves) -> Iterator[Edge]:
    """Yield the edges of a shape or of several, one after the other."""
    shapes = [curves] if isinstance(curves, Shape) else list(curves)
    strange = next((shape for shape in shapes if not isinstance(shape, Shape)), None)
    if strange is not None:
        raise OptionError(
            f"a {type(strange).__name__} is no shape of build123d; need edges, wires or sketches"
        )
    return chain.from_iterable(shape.edges() for shape in shapes)


def _is_degenerate(edge: Edge) -> bool:
    """Return whether an edge is a single point, such as a pole of a sphere."""
    return bool(BRep_Tool.Degenerated_s(edge.wrapped))


def _split_where_they_meet(edges: list[TopoDS_Edge], distance: float) -> list[TopoDS_Edge]:
    """Return the edges cut where they touch, cross or cover each other, each piece once.

    Raises
    ------
    SkeletonError
        If OCCT finds no way to do so.
    """
    if len(edges) == 1:
        return edges
    fuse = BOPAlgo_Builder()
    for edge in edges:
        fuse.AddArgument(edge)
    fuse.SetFuzzyValue(distance)
    fuse.SetNonDestructive(True)
    fuse.Perform()
    if fuse.HasErrors():
        raise SkeletonError(f"OCCT cannot tell where the {len(edges)} edges meet; need fewer")
    return [edge.wrapped for edge in Shape.cast(fuse.Shape()).edges()]


def _sampled(edge: TopoDS_Edge, tolerance: float) -> Points:
    """Return points along an edge whose chords are within `tolerance` of it, (k, 3)."""
    sampler = GCPnts_TangentialDeflection(BRepAdaptor_Curve(edge), TURN, tolerance)
    inner = [sampler.Value(i) for i in range(2, sampler.NbPoints())]
    # Its ends where the edges that it meets have theirs.
    ends = [BRep_Tool.Pnt_s(end(edge)) for end in (TopExp.FirstVertex_s, TopExp.LastVertex_s)]
    points = [ends[0], *inner, ends[1]]
    return np.array([(point.X(), point.Y(), point.Z()) for point in points])


def _chained(polylines: list[Points]) -> tuple[Points, Edges]:
    """Return the points of polylines one after the other, and the pairs that they join."""
    counts = np.array([len(points) for points in polylines])
    last = np.cumsum(counts) - 1
    first = np.delete(np.arange(counts.sum()), last)
    return np.concatenate(polylines), np.stack([first, first + 1], axis=1)
