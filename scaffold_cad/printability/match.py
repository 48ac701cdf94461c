"""Whether a skeleton is that of a part: whether its struts are in it, and none is cut through."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Ints, Points, place_text
from scaffold_cad.base.summaries import counted
from scaffold_cad.lattice.meshregion import MeshRegion
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.printability.report import MOST_PLACES, Finding
from scaffold_cad.printability.thickness import Thickness
from scaffold_cad.skeleton import Skeleton


def match_finding(skeleton: Skeleton, mesh: TriangleMesh, thickness: Thickness) -> Finding:
    """Return whether the struts are inside a closed mesh: otherwise findings on them are void.

    The axis of a hollow strut is in its bore: it is in the mesh where this goes around its middle.
    """
    middles = skeleton.nodes[skeleton.edges].mean(axis=1)
    outside, cut, places = _missing(mesh, middles, thickness)
    count = counted(len(middles), "strut")
    text, advice = "every strut is in the part", ""
    if len(cut):
        text = f"{len(cut)} of {count} cut through, strut {cut[0]} near {place_text(places[0])}"
        advice = "need struts that are whole, or a skeleton without these"
    if len(outside):
        text = f"{len(outside)} of {count} not in the part, strut {outside[0]} first"
        advice = "the findings on struts are not about this part: need its own skeleton"
    return Finding(
        "struts_in_part",
        "lattice",
        "failure" if len(outside) or len(cut) else "ok",
        {"outside": len(outside), "cut": len(cut), "struts": len(middles)},
        text,
        advice,
        (middles[outside] if len(outside) else places)[:MOST_PLACES],
    )


def _missing(
    mesh: TriangleMesh, middles: Points, thickness: Thickness
) -> tuple[Ints, Ints, Points]:
    """Return the struts whose middles are not in the part, and those cut beside, and where."""
    doubtful = np.flatnonzero(~thickness.surrounded)
    bare, of_bare = thickness.bare, thickness.of_bare
    if len(doubtful) + len(bare) == 0:
        return doubtful, doubtful, np.zeros((0, 3))
    region = MeshRegion(mesh)
    outside = doubtful[~region.contains(middles[doubtful])]
    # Where bores meet, a hollow strut may have no wall: its middle is not in the mesh.
    solid = np.flatnonzero(~region.contains(bare))
    solid = solid[region.contains(middles[of_bare[solid]])]
    cut, first = np.unique(of_bare[solid], return_index=True)
    return outside, cut, bare[solid[first]]
