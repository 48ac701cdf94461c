"""The struts of a skeleton as the struts of a field solid."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.repair import largest_at_nodes
from scaffold_cad.solid.field.struts import FieldStruts, field_struts


@checks_keywords()
def skeleton_struts(
    skeleton: Skeleton, *, blend: ArrayLike | None = None, flat_ends: bool = False
) -> FieldStruts:
    """Return the struts of a skeleton, and a ball at each node that is thicker than its struts.

    Parameters
    ----------
    skeleton : Skeleton
    blend : (m,) or a number, mm
        Fillet radius; by default a part of the strut's radius.
    flat_ends : bool
        Whether struts end flat at extremities, or else in balls.

    Raises
    ------
    OptionError
        If a shape is wrong or a value out of range.

    Examples
    --------
    >>> tripod = Skeleton([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]],
    ...                   [[0, 1], [0, 2], [0, 3]], 1.0)
    >>> len(skeleton_struts(tripod).ends)
    3
    """
    edges, radii = skeleton.edges, skeleton.edge_radii
    flat = skeleton.valency[edges] == 1 if flat_ends else np.zeros(edges.shape, dtype=np.bool_)
    largest = largest_at_nodes(edges, radii, len(skeleton.nodes))
    thicker = np.flatnonzero((skeleton.radii > largest) & (skeleton.valency > 0))
    return field_struts(
        skeleton.nodes[edges],
        radii,
        flat=flat,
        balls=skeleton.nodes[thicker],
        ball_radii=skeleton.radii[thicker],
        blend=blend,
    )
