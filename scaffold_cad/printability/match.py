"""Whether a skeleton is that of a part: whether the middles of its struts are in it."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Bools
from scaffold_cad.base.summaries import counted
from scaffold_cad.lattice.meshregion import MeshRegion
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.printability.report import MOST_PLACES, Finding
from scaffold_cad.skeleton import Skeleton


def match_finding(skeleton: Skeleton, mesh: TriangleMesh, surrounded: Bools) -> Finding:
    """Return whether the struts are inside a closed mesh: otherwise findings on them are void.

    Parameters
    ----------
    surrounded : whether the mesh goes around the middle of each strut, (m,): the axis of a hollow
        one is in its bore
    """
    middles = skeleton.nodes[skeleton.edges].mean(axis=1)
    outside = np.flatnonzero(~surrounded & ~MeshRegion(mesh).contains(middles))
    count = len(skeleton.edges)
    text, advice = "the middle of every strut is in the part", ""
    if len(outside):
        text = (
            f"{len(outside)} of {counted(count, 'strut')} not in the part, strut {outside[0]} first"
        )
        advice = "the findings on struts are not about this part: need its own skeleton"
    return Finding(
        "struts_in_part",
        "lattice",
        "failure" if len(outside) else "ok",
        {"outside": len(outside), "struts": count},
        text,
        advice,
        middles[outside[:MOST_PLACES]],
    )
