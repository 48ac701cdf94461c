"""The members of a skeleton as files of beams have them."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.skeleton import Skeleton


def radii_of_ends(skeleton: Skeleton) -> Floats:
    """Return the radius of both ends of each edge, shape (m, 2), mm."""
    radii: Floats = skeleton.radii[skeleton.edges]
    return np.asarray(radii)
