"""Bodies of one compound, and facets joined where they are in one plane.

build123d is imported when the functions are called.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from scaffold_cad.base.backends import need

if TYPE_CHECKING:
    from build123d import Compound, Shape


def bodies(shapes: Mapping[str, Shape]) -> Compound:
    """Return shapes as bodies of one compound, labeled by their names."""
    need("build123d", "a B-rep")
    from scaffold_cad.brep import occtbodies

    return occtbodies.bodies(shapes)


def with_plane_faces(shape: Shape) -> Shape:
    """Return a shape whose neighboring faces in one plane are one; as it is where OCCT fails."""
    need("build123d", "a B-rep")
    from scaffold_cad.brep import occtbodies

    return occtbodies.with_plane_faces(shape)
