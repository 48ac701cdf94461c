"""Findings on a surface: whether it bounds one solid, and where it does not."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scaffold_cad.base.summaries import counted
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.printability.crossings import meeting_places
from scaffold_cad.printability.nesting import nesting
from scaffold_cad.printability.processes import Process
from scaffold_cad.printability.report import MOST_PLACES, Finding, Verdict
from scaffold_cad.printability.triangletopology import TriangleTopology

MOST_CROSSINGS = 100_000
"""How many pairs of triangles that meet are counted before a surface is given up."""
ROUNDING = 1e-6
"""How deep triangles may cross by the rounding of 32-bit coordinates, parts of the extent."""


def surface_findings(
    surface: TriangleTopology, process: Process, loops: int | None = None
) -> Iterator[Finding]:
    """Yield what there is to say of a surface, whatever it is to print.

    Parameters
    ----------
    surface : of at least one triangle
    process : whether voids keep powder or resin
    loops : of the skeleton that the surface is around, where there is one
    """
    yield from _edges(surface)
    yield _vertices(surface)
    yield _flat_triangles(surface)
    yield from _shells(surface, process)
    yield _crossings(surface)
    yield _genus(surface, loops)


def _edges(surface: TriangleTopology) -> Iterator[Finding]:
    count = len(surface.open_edges)
    yield Finding(
        "watertight",
        "mesh",
        "failure" if count else "ok",
        {"open_edges": count, "holes": surface.hole_count},
        f"{counted(surface.hole_count, 'hole')} of {counted(count, 'open edge')}"
        if count
        else "no open edge",
        "close the holes; a scaffold or a union of this package has none" if count else "",
        surface.middles(surface.open_edges[:MOST_PLACES]),
    )
    count = len(surface.crowded_edges)
    most = int(surface.share_count.max(initial=0))
    yield Finding(
        "manifold_edges",
        "mesh",
        "failure" if count else "ok",
        {"crowded_edges": count, "most_triangles": most},
        f"{counted(count, 'edge')} of three triangles or more, up to {most}"
        if count
        else "no edge of more than two triangles",
        "move the parts that touch along an edge apart, or into each other and unite them"
        if count
        else "",
        surface.middles(surface.crowded_edges[:MOST_PLACES]),
    )
    count = len(surface.clashing_edges)
    yield Finding(
        "winding",
        "mesh",
        "failure" if count else "ok",
        {"clashing_edges": count},
        f"{counted(count, 'edge')} between triangles that face opposite sides"
        if count
        else "all triangles agree on what is outside",
        "turn the triangles over that are clockwise seen from outside" if count else "",
        surface.middles(surface.clashing_edges[:MOST_PLACES]),
    )


def _vertices(surface: TriangleTopology) -> Finding:
    count = len(surface.pinched_vertices)
    return Finding(
        "manifold_vertices",
        "mesh",
        "warning" if count else "ok",
        {"pinched_vertices": count},
        f"{counted(count, 'vertex', 'vertices')} where parts of the surface meet in a point"
        if count
        else "the triangles at each vertex make one fan",
        "parts that meet in a point only break apart there: unite them deeper" if count else "",
        surface.mesh.vertices[surface.pinched_vertices[:MOST_PLACES]],
    )


def _flat_triangles(surface: TriangleTopology) -> Finding:
    count = len(surface.flat)
    return Finding(
        "degenerate_triangles",
        "mesh",
        "warning" if count else "ok",
        {"count": count},
        f"{counted(count, 'triangle')} without area, number {surface.flat[0]} first"
        if count
        else "no triangle without area",
        "most slicers drop them; merge their vertices" if count else "",
        surface.corners[surface.flat[:MOST_PLACES]].mean(axis=1),
    )


def _shells(surface: TriangleTopology, process: Process) -> Iterator[Finding]:
    nested = nesting(surface)
    volumes = surface.shell_volumes
    inverted, buried, voids = nested.inverted, nested.buried, nested.voids
    yield Finding(
        "orientation",
        "mesh",
        "failure" if len(inverted) else "ok",
        {"inverted_shells": len(inverted)},
        f"{counted(len(inverted), 'shell')} inside out, with a volume of "
        f"{volumes[inverted].sum():.4g} mm³"
        if len(inverted)
        else "every closed shell faces outwards",
        "reverse the triangles of these shells" if len(inverted) else "",
        nested.places[inverted[:MOST_PLACES]],
    )
    yield Finding(
        "overlapping_shells",
        "mesh",
        "failure" if len(buried) else "ok",
        {"buried_shells": len(buried)},
        f"{counted(len(buried), 'shell')} of solid within solid"
        if len(buried)
        else "no shell within the solid of another",
        "unite the shells (`to_solid` does for a scaffold)" if len(buried) else "",
        nested.places[buried[:MOST_PLACES]],
    )
    verdict: Verdict = "ok"
    if len(voids):
        verdict = "failure" if process.encloses else "warning"
    trapped = nested.void_volumes
    yield Finding(
        "voids",
        "mesh",
        verdict,
        {"count": len(voids), "volumes_mm3": trapped.tolist()},
        f"{counted(len(voids), 'void')} enclosed, {trapped.sum():.4g} mm³ in all"
        if len(voids)
        else "no enclosed void",
        f"fill them, or open each by a hole of {max(process.least_opening, 1.0):g} mm or more"
        if len(voids)
        else "",
        nested.places[voids[:MOST_PLACES]],
    )
    outer = surface.shell_count - len(voids)
    yield Finding(
        "components",
        "mesh",
        "ok" if outer == 1 else "warning",
        {"count": outer, "shells": surface.shell_count},
        f"{counted(outer, 'part')} in {counted(surface.shell_count, 'shell')}",
        "parts that hang together by nothing come out apart" if outer > 1 else "",
    )


def _crossings(surface: TriangleTopology) -> Finding:
    pairs = self_intersections(surface.mesh, limit=MOST_CROSSINGS)
    extent = float(np.ptp(surface.mesh.vertices, axis=0).max())
    deep = pairs
    if len(pairs):
        tolerance = ROUNDING * extent
        deep = self_intersections(surface.mesh, tolerance=tolerance, limit=MOST_CROSSINGS)
    verdict: Verdict = "ok"
    text, advice = "the surface meets itself nowhere", ""
    if len(deep):
        verdict = "failure"
        a, b = deep[0].tolist()
        at_least = "at least " if len(deep) == MOST_CROSSINGS else ""
        crossing = counted(len(deep), "pair of triangles crosses", "pairs of triangles cross")
        text = f"{at_least}{crossing}, {a} and {b} first"
        advice = "unite the overlapping parts (`to_solid`), or give them smaller radii"
    elif len(pairs):
        verdict = "warning"
        touching = "pair of triangles touches or crosses", "pairs of triangles touch or cross"
        text = f"{counted(len(pairs), *touching)} by rounding"
        advice = "slicers take it either way; move the parts apart or into each other"
    shown = (deep if len(deep) else pairs)[:MOST_PLACES]
    return Finding(
        "self_intersections",
        "mesh",
        verdict,
        {"crossing_pairs": len(deep), "touching_pairs": len(pairs) - len(deep)},
        text,
        advice,
        meeting_places(surface.corners[shown[:, 0]], surface.corners[shown[:, 1]]),
    )


def _genus(surface: TriangleTopology, loops: int | None) -> Finding:
    if not surface.closed:
        return Finding("genus", "mesh", "note", None, "none: the surface is not closed")
    text = counted(surface.genus, "handle")
    if loops is not None:
        text += f"; the skeleton has {counted(loops, 'loop')}"
        if surface.genus < loops:
            text += ", struts that overlap close or merge some"
        elif surface.genus > loops:
            text += ", struts that meet between nodes, or are hollow and open, add some"
    return Finding("genus", "mesh", "note", {"genus": surface.genus, "loops": loops}, text)
