"""Bodies of one compound by OCCT. Imports build123d, as `occt` does."""

from __future__ import annotations

from collections.abc import Mapping

from build123d import Compound, Shape
from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain


def bodies(shapes: Mapping[str, Shape]) -> Compound:
    """Return shapes as bodies of one compound, labeled by their names."""
    for name, shape in shapes.items():
        shape.label = name
    return Compound(children=list(shapes.values()))


def with_plane_faces(shape: Shape) -> Shape:
    """Return a shape whose neighboring faces in one plane are one; as it is where OCCT fails."""
    merged = ShapeUpgrade_UnifySameDomain(shape.wrapped, True, True, False)
    merged.Build()
    found = Shape.cast(merged.Shape())
    return found if found.is_valid else shape
