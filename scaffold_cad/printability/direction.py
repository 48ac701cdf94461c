"""Findings on a direction of building: supports, what starts in mid-air, hold on the plate."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points, UnitVectors
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.topology import component_labels
from scaffold_cad.printability.processes import Process
from scaffold_cad.printability.report import MOST_PLACES, Finding, Verdict
from scaffold_cad.printability.standing import (
    Facets,
    Standing,
    best_direction,
    hanging_facets,
    least_angle,
    standing,
)
from scaffold_cad.printability.triangletopology import SINGLE_STEP, TriangleTopology
from scaffold_cad.skeleton import Skeleton

LEVEL = 1e-6
"""Difference of heights below which they count as equal, parts of the extent."""


def floating_groups(
    heights: Floats, edges: Edges, clear: Bools, tolerance: float
) -> tuple[Ints, Ints]:
    """Return the lowest sets of connected nodes that nothing holds from below.

    A set is what level edges connect; it floats if every other edge leaves it upwards and all of
    it is clear of the plate.

    Parameters
    ----------
    heights : (n,), mm
    edges : (m, 2)
    clear : whether each node is clear of the plate, shape (n,)
    tolerance : difference of heights below which they count as equal, mm

    Returns
    -------
    The set of each node (n,), and the sets that float (k,).
    """
    rise = heights[edges[:, 1]] - heights[edges[:, 0]]
    group = component_labels(edges[np.abs(rise) <= tolerance], len(heights))
    held = np.zeros(len(heights), dtype=np.bool_)
    # The upper end of an edge is held by the lower.
    held[edges[rise > tolerance, 1]] = True
    held[edges[rise < -tolerance, 0]] = True
    held |= ~clear
    holds = np.bincount(group, held)
    return group, np.flatnonzero(holds == 0)


def direction_findings(
    surface: TriangleTopology,
    facets: Facets,
    direction: UnitVectors,
    process: Process,
    skeleton: Skeleton | None,
    supports: bool,
) -> Iterator[Finding]:
    """Yield what there is to say of a part built in a direction.

    Parameters
    ----------
    surface, facets : of the part
    direction : of building
    process : whose faces need support below its overhang angle, if any
    skeleton : with the radii of the struts, where the part has one
    supports : whether supports may be used: without them what needs some cannot be printed
    """
    stand = standing(facets, direction, process)
    needy: Verdict = "warning" if supports else "failure"
    if skeleton is not None:
        yield _strut_overhang(skeleton, direction, process, needy)
        yield _floating_nodes(skeleton, direction, process, needy)
    yield _islands(surface, facets, stand.floor, direction, process, needy)
    yield _supports(facets, stand, direction, process, needy)
    yield _plate_contact(stand, process)
    yield _best(facets, stand, direction, process)


def _strut_overhang(
    skeleton: Skeleton, direction: UnitVectors, process: Process, needy: Verdict
) -> Finding:
    angles = np.arcsin(np.clip(np.abs(skeleton.directions[::2] @ direction), 0.0, 1.0))
    clear = _clear_of_lowest(skeleton, direction, process)
    flat = (angles < least_angle(process)) & clear[skeleton.edges].any(axis=1)
    flat &= ~_bridges(skeleton, direction, flat, clear, process.longest_bridge)
    first = int(np.argmin(angles))
    needs = math.degrees(process.overhang_angle)
    text = f"{math.degrees(angles[first]):.3g}° to the plate at least, strut {first}"
    count = int(flat.sum())
    return Finding(
        "strut_overhang",
        "build",
        needy if count else "ok",
        {"least_deg": math.degrees(angles[first]), "needed_deg": needs, "overhanging": count},
        text + ("" if process.overhang_angle else f"; {process.name.upper()} asks for no angle"),
        f"{counted(count, 'strut needs', 'struts need')} support, being below {needs:g}°: turn the "
        "part or the cell"
        if count
        else "",
        skeleton.nodes[skeleton.edges[np.flatnonzero(flat)[:MOST_PLACES]]].mean(axis=1),
    )


def _bridges(
    skeleton: Skeleton, direction: UnitVectors, flat: Bools, clear: Bools, longest: float
) -> Bools:
    """Return which of the `flat` struts (m,) are part of a bridge between held places, (m,).

    A place is held on the plate, by a steep strut from below, or by flat ones from below that meet
    there. From other places the gap goes on over the next flat strut.

    Parameters
    ----------
    clear : whether each node is clear of the plate, shape (n,)
    longest : length of a bridge, mm
    """
    heights, edges = skeleton.nodes @ direction, skeleton.edges
    rise = heights[edges[:, 1]] - heights[edges[:, 0]]
    step = _level_step(skeleton.nodes, heights)
    upper = np.stack([-rise, rise], axis=1) > step  # (m, 2), the end held from below
    count = len(heights)
    steep_below = np.bincount(edges[upper & ~flat[:, None]], minlength=count)
    flat_below = np.bincount(edges[upper & flat[:, None]], minlength=count)
    # One flat strut from below alone holds nothing that goes on from it: the two are one gap.
    held = ~clear[edges] | (steep_below[edges] > 0) | (flat_below[edges] > 1)
    spans = np.sqrt(np.maximum(skeleton.lengths**2 - rise**2, 0.0))
    reach = _to_held(edges[flat], spans[flat], held[flat], longest)
    bridges = np.zeros(len(edges), dtype=np.bool_)
    bridges[flat] = spans[flat] + reach.sum(axis=1) <= longest
    return bridges


def _to_held(edges: Edges, spans: Floats, held: Bools, longest: float) -> Floats:
    """Return how far it is from each end of each edge (k, 2) over others to a held end, (k, 2).

    Infinite where that is more than `longest`.

    Parameters
    ----------
    spans : lengths of the edges, shape (k,), all > 0
    held : shape (k, 2)
    """
    node = edges.reshape(-1)
    reach = np.where(held, 0.0, np.inf)
    while True:
        over = (spans[:, None] + reach[:, ::-1]).reshape(-1)  # from an end over its own edge
        order = np.lexsort((over, node))
        first = np.diff(node[order], prepend=-1) > 0
        nearest = np.empty(len(node))
        # Over the nearest of the other edges at the node: at the nearest itself, the second.
        nearest[order] = over[order][first][np.cumsum(first) - 1]
        second = np.where(np.roll(first, -1), np.inf, np.roll(over[order], -1))
        nearest[order[first]] = second[first]
        found = np.where(held, 0.0, nearest.reshape(-1, 2))
        found[found > longest] = np.inf
        if np.array_equal(found, reach):
            return found
        reach = found


def _level_step(places: Points, heights: Floats) -> float:
    """Return the difference below which heights of places count as equal, mm.

    Far from the origin, differences that 32-bit coordinates round away do not count.
    """
    hidden = SINGLE_STEP * float(np.abs(places).max())
    return LEVEL * float(np.ptp(heights)) + hidden + 1e-12


def _clear_of_lowest(skeleton: Skeleton, direction: UnitVectors, process: Process) -> Bools:
    """Return whether each node is more than a layer above the lowest, shape (n,).

    The plate itself may be lower: a node's blend reaches farther than its radius, and `islands`
    tells of the surface.
    """
    lows = skeleton.nodes @ direction - skeleton.radii
    clear: Bools = lows > lows.min() + process.layer
    return clear


def _floating_nodes(
    skeleton: Skeleton, direction: UnitVectors, process: Process, needy: Verdict
) -> Finding:
    heights = skeleton.nodes @ direction
    clear = _clear_of_lowest(skeleton, direction, process)
    tolerance = _level_step(skeleton.nodes, heights)
    group, floating = floating_groups(heights, skeleton.edges, clear, tolerance)
    nodes = np.flatnonzero(np.isin(group, floating))
    matters = process.overhang_angle > 0 and len(floating) > 0
    return Finding(
        "floating_nodes",
        "build",
        needy if matters else "note" if len(floating) else "ok",
        {"count": len(floating), "nodes": nodes[:MOST_PLACES].tolist()},
        f"{counted(len(floating), 'lowest place')} in mid-air, node {nodes[0]} first"
        if len(floating)
        else "every strut begins on the plate or on another",
        "support them from below, or turn the part" if matters else "",
        skeleton.nodes[nodes[:MOST_PLACES]],
    )


def _islands(
    surface: TriangleTopology,
    facets: Facets,
    floor: float,
    direction: UnitVectors,
    process: Process,
    needy: Verdict,
) -> Finding:
    heights = facets.vertices @ direction
    tolerance = _level_step(facets.vertices, heights)
    group, lowest = floating_groups(
        heights, surface.edges, heights > floor + process.layer, tolerance
    )
    # The floor of a hollow faces up: solid is below it.
    facing = np.bincount(
        group[facets.triangles.reshape(-1)],
        np.repeat(facets.area_vectors @ direction, 3),
        minlength=int(group.max()) + 1,
    )
    islands = lowest[facing[lowest] < 0]
    _, first = np.unique(group, return_index=True)
    matters = process.overhang_angle > 0 and len(islands) > 0
    return Finding(
        "islands",
        "build",
        needy if matters else "note" if len(islands) else "ok",
        {"count": len(islands)},
        f"{counted(len(islands), 'lowest place')} of the surface off the plate"
        if len(islands)
        else "the surface begins on the plate only",
        "support them from below, or turn the part" if matters else "",
        facets.vertices[first[islands[:MOST_PLACES]]],
    )


def _supports(
    facets: Facets, stand: Standing, direction: UnitVectors, process: Process, needy: Verdict
) -> Finding:
    if process.overhang_angle == 0:
        text = f"none: {process.name.upper()} needs no supports"
        return Finding("supports", "build", "ok", {"area_mm2": 0.0, "facets": 0}, text)
    rows = hanging_facets(facets, direction, process)
    angle = math.degrees(process.overhang_angle)
    return Finding(
        "supports",
        "build",
        needy if len(rows) else "ok",
        {"area_mm2": stand.support_area, "facets": len(rows)},
        f"{stand.support_area:.4g} mm² hang over at less than {angle:g}°, "
        f"{stand.support_area / facets.area:.0%} of the surface"
        if len(rows)
        else f"no face below {angle:g}°",
        "let the slicer add supports, or build in the best direction" if len(rows) else "",
        facets.vertices[facets.triangles[rows[:MOST_PLACES]]].mean(axis=1),
    )


def _plate_contact(stand: Standing, process: Process) -> Finding:
    bare = process.overhang_angle > 0 and stand.contact_area == 0
    return Finding(
        "plate_contact",
        "build",
        "warning" if bare else "ok" if process.overhang_angle else "note",
        {"area_mm2": stand.contact_area},
        f"{stand.contact_area:.4g} mm² on the plate",
        "only points or edges touch the plate: add a raft, or cut the bottom flat" if bare else "",
    )


def _best(facets: Facets, stand: Standing, direction: UnitVectors, process: Process) -> Finding:
    best = best_direction(facets, process, direction)
    other = standing(facets, best, process)
    text = f"({', '.join(f'{value:.3g}' for value in best + 0.0)}) up: height {other.height:.4g} mm"
    if other.support_area < stand.support_area:
        text += f", supports {other.support_area:.4g} mm² instead of {stand.support_area:.4g}"
    return Finding(
        "best_direction",
        "build",
        "note",
        {
            "direction": (best + 0.0).tolist(),
            "support_area_mm2": other.support_area,
            "height_mm": other.height,
            "checked": direction.tolist(),
        },
        text,
    )
