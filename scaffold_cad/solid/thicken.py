"""Frames: the edges of a mesh or a skeleton as struts.

The edges of a quad mesh are a skeleton of their own; its scaffold, with collars, is the frame.

References
----------
Srinivasan, Mandal, Akleman, Solidifying frames, Bridges 2004.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from scaffold_cad.base.arguments import check_kind, checks_keywords
from scaffold_cad.base.radii import Radius, radii_at
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.rounds import check_sides
from scaffold_cad.solid.solid import to_solid
from scaffold_cad.struts import round_struts

if TYPE_CHECKING:
    from manifold3d import Manifold


@checks_keywords()
def thicken(what: Scaffold | QuadMesh | Skeleton, radius: Radius, *, sides: int = 4) -> Manifold:
    """Return the edges of a scaffold, quad mesh or skeleton as struts: one watertight solid.

    Parameters
    ----------
    what : whose edges
    radius : mm; one number, or a function of positions (n, 3) that returns radii (n,): of the
        circle that a strut's section stands for. A square is around it, a section with more sides
        has its area
    sides : of a strut: 4 for square ones, 8 or another multiple of 4 for round ones

    Raises
    ------
    OptionError
        If `what` is of another kind, `radius` is not a finite number > 0, or `sides` is not a
        multiple of 4.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold, thicken
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> thicken(build_scaffold(strut), 0.1).genus()
    5
    """
    check_sides(sides)
    if sides == 4:
        return to_solid(frame_scaffold(what, radius))
    return to_solid(round_struts(frame_skeleton(what, radius)), sides=sides)


@checks_keywords()
def frame_scaffold(what: Scaffold | QuadMesh | Skeleton, radius: Radius) -> Scaffold:
    """Return the scaffold of the edges of a scaffold, quad mesh or skeleton, with collars.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> len(frame_scaffold(build_scaffold(strut), 0.1).skeleton.edges)
    12
    """
    return build_scaffold(frame_skeleton(what, radius), collars=True)


def frame_skeleton(what: Scaffold | QuadMesh | Skeleton, radius: Radius) -> Skeleton:
    """Return the edges of a scaffold, quad mesh or skeleton as a skeleton."""
    check_kind(what, Scaffold, QuadMesh, Skeleton)
    if isinstance(what, Scaffold):
        what = what.mesh
    if isinstance(what, QuadMesh):
        radii = radii_at(what.vertices, radius)
        what = Skeleton(what.vertices, what.edges, radii).cleaned().skeleton
    return what.with_radii(radii_at(what.nodes, radius))
