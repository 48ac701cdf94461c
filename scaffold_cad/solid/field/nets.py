"""The struts of a skeleton as the struts of a field solid."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.arrays import Floats, as_floats
from scaffold_cad.errors import OptionError
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.field.struts import FieldStruts, field_struts


@checks_keywords()
def skeleton_struts(
    skeleton: Skeleton,
    *,
    edge_radii: ArrayLike | None = None,
    blend: ArrayLike | None = None,
    flat_ends: bool = False,
) -> FieldStruts:
    """Return the struts of a skeleton, and a ball at each node that is thicker than its struts.

    Parameters
    ----------
    skeleton : Skeleton
    edge_radii : (m, 2), (m,) or a number, mm
        Radius of each edge at both ends; by default those of its nodes.
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
    edges, nodes = skeleton.edges, skeleton.nodes
    radii = _edge_radii(skeleton, edge_radii)
    flat = skeleton.valency[edges] == 1 if flat_ends else np.zeros(edges.shape, dtype=np.bool_)
    largest = np.zeros(len(nodes))
    np.maximum.at(largest, edges, radii)
    thicker = np.flatnonzero((skeleton.radii > largest) & (skeleton.valency > 0))
    return field_struts(
        nodes[edges],
        radii,
        flat=flat,
        balls=nodes[thicker],
        ball_radii=skeleton.radii[thicker],
        blend=blend,
    )


def _edge_radii(skeleton: Skeleton, given: ArrayLike | None) -> Floats:
    if given is None:
        return skeleton.radii[skeleton.edges]
    radii = as_floats(given, "edge_radii", OptionError)
    try:
        return np.array(
            np.broadcast_to(radii[:, None] if radii.ndim == 1 else radii, skeleton.edges.shape)
        )
    except ValueError:
        raise OptionError(
            f"edge_radii has shape {radii.shape}; need {skeleton.edges.shape}"
        ) from None
