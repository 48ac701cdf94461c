"""What a direction of building asks for: supports, what starts in mid-air, hold on the plate."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.arrays import Bools, Edges, Floats, Ints, Points, UnitVectors, as_floats
from scaffold_cad.errors import OptionError
from scaffold_cad.printability.processes import Process
from scaffold_cad.printability.report import MOST_PLACES, Finding, Verdict, counted
from scaffold_cad.printability.topology import Connectivity
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.topology import component_labels
from scaffold_cad.vectors import any_perpendicular, length, normalize

CANDIDATES = 150
"""Directions spread over the sphere that are tried, beside the axes and the largest faces."""
LARGEST_FACES = 20
"""Directions that put one of the largest flat parts on the plate are tried too."""
SAME_AREA = 0.01
"""Support areas that differ by less than this part of the surface are taken as equal."""
SAME_NORMAL = 1e-4
"""Step to which normals are rounded to tell which faces face the same way."""
ROUNDING = 1e-6
"""Room left for rounding at the limit of what hangs over, in the cosine."""
LEVEL = 1e-6
"""Difference of heights taken as none, parts of the extent."""


def as_direction(values: ArrayLike) -> UnitVectors:
    """Return a direction as a unit vector (3,).

    Raises
    ------
    OptionError
        If it is not three finite numbers, or all are zero.
    """
    needed = '3 numbers, not all 0, or "best"'
    if isinstance(values, str):
        raise OptionError(f"build direction is {values!r}; need {needed}")
    vector = as_floats(values, "build direction", OptionError)
    if vector.shape != (3,) or not np.isfinite(vector).all() or not vector.any():
        raise OptionError(f"build direction is {vector.tolist()}; need {needed}")
    return normalize(vector / np.abs(vector).max())  # squares of large ones would overflow


@dataclass(frozen=True, eq=False)
class Facets:
    """The triangles of a surface, as the plate sees them."""

    vertices: Points
    """Positions, shape (v, 3), mm."""
    triangles: Ints
    """Vertex indices, shape (t, 3)."""
    area_vectors: Floats
    """Outward normals as long as the areas, shape (t, 3), mm²."""

    @classmethod
    def of(cls, surface: Connectivity) -> Facets:
        """Return the facets of a surface."""
        corners = surface.corners
        vectors = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
        return cls(surface.mesh.vertices, surface.mesh.triangles, vectors)

    @cached_property
    def kinds(self) -> Floats:
        """Sums of the area vectors that face the same way, shape (k, 3), mm²: few in a lattice."""
        areas = length(self.area_vectors)
        proper = areas > 0
        normals = self.area_vectors[proper] / areas[proper, None]
        steps = np.round(normals / SAME_NORMAL).astype(np.int64)
        keys = (steps[:, 0] << 42) + (steps[:, 1] << 21) + steps[:, 2]
        found, kind = np.unique(keys, return_inverse=True)
        sums = np.zeros((len(found), 3))
        np.add.at(sums, kind, self.area_vectors[proper])
        return sums

    @cached_property
    def _first_corners(self) -> Ints:
        return np.ascontiguousarray(self.triangles[:, 0])

    @property
    def area(self) -> float:
        """Area of the surface, mm²."""
        return float(length(self.area_vectors).sum())

    def within(self, low: Bools) -> Ints:
        """Return the triangles all of whose vertices are `low`, shape (v,)."""
        rows = np.flatnonzero(low[self._first_corners])
        return rows[low[self.triangles[rows]].all(axis=1)]


@dataclass(frozen=True)
class Standing:
    """Facets built in one direction."""

    floor: float
    """Height of the plate along the direction, mm."""
    height: float
    """Of the part, mm."""
    support_area: float
    """Area of the triangles that need support, seen from below, mm²."""
    contact_area: float
    """Area of the triangles on the plate, mm²."""


def standing(facets: Facets, direction: UnitVectors, process: Process) -> Standing:
    """Return what facets ask for when they are built in a direction."""
    heights = facets.vertices @ direction
    floor = float(heights.min())
    on_plate = facets.area_vectors[facets.within(heights <= floor + process.layer)]
    shown = on_plate @ direction
    hanging = _hanging(facets.kinds, direction, process)
    hanging_on_plate = _hanging(on_plate, direction, process)
    support = facets.kinds[hanging].sum(axis=0) - on_plate[hanging_on_plate].sum(axis=0)
    return Standing(
        floor,
        float(heights.max()) - floor,
        max(-float(support @ direction), 0.0),
        abs(float(shown[shown < 0].sum())),
    )


def hanging_facets(facets: Facets, direction: UnitVectors, process: Process) -> Ints:
    """Return the triangles that need support when they are built in a direction."""
    heights = facets.vertices @ direction
    hanging = _hanging(facets.area_vectors, direction, process)
    hanging[facets.within(heights <= heights.min() + process.layer)] = False
    return np.flatnonzero(hanging)


def _hanging(area_vectors: Floats, direction: UnitVectors, process: Process) -> Bools:
    """Return whether faces are too flat to need no support, wherever they are, shape (t,)."""
    if process.overhang_angle == 0:
        return np.zeros(len(area_vectors), dtype=np.bool_)
    # A face at an angle a to the plate shows it the share cos a of its area; those at the very
    # limit are steep enough, whatever rounding says.
    limit = (math.cos(process.overhang_angle) + ROUNDING) * length(area_vectors)
    hanging: Bools = -(area_vectors @ direction) > limit
    return hanging


def best_direction(facets: Facets, process: Process) -> UnitVectors:
    """Return the direction that needs least support, of many that are tried.

    Among directions of nearly the same support, the one of the lowest part, and among those the
    one with the largest hold on the plate. +z wins over its equals.
    """
    tried = np.concatenate([[[0, 0, 1]], _axes(), _onto_faces(facets), _spiral(CANDIDATES)])
    stands = [standing(facets, direction, process) for direction in tried]
    step = max(SAME_AREA * facets.area, 1e-300)
    keys = [
        (round(stand.support_area / step), round(stand.height, 3), -round(stand.contact_area, 3))
        for stand in stands
    ]
    best: UnitVectors = tried[min(range(len(keys)), key=keys.__getitem__)]
    return best


def _axes() -> UnitVectors:
    return np.concatenate([np.eye(3), -np.eye(3)])


def _onto_faces(facets: Facets) -> UnitVectors:
    """Return the directions that put the largest flat parts on the plate, shape (k, 3)."""
    areas = length(facets.kinds)
    largest = np.argsort(-areas, kind="stable")[:LARGEST_FACES]
    return -facets.kinds[largest] / areas[largest, None]


def _spiral(count: int) -> UnitVectors:
    """Return directions spread evenly over the sphere along a golden spiral, shape (count, 3)."""
    number = np.arange(count) + 0.5
    z = 1.0 - 2.0 * number / count
    turn = np.pi * (1.0 + math.sqrt(5.0)) * number
    flat = np.sqrt(1.0 - z * z)
    return np.stack([flat * np.cos(turn), flat * np.sin(turn), z], axis=1)


def standing_size(
    vertices: Points, direction: UnitVectors, room: tuple[float, float, float]
) -> tuple[float, float, float]:
    """Return width, depth and height of a part as it stands on the plate.

    It is turned about `direction`, in steps of 5°, no farther than it must be to fit into the
    width and depth of `room`; if it never fits, as it comes nearest to that.
    """
    side = any_perpendicular(direction)
    flat = np.stack([vertices @ side, vertices @ np.cross(direction, side)])  # (2, v)
    least, most = sorted(room[:2])
    sizes = []
    for turn in np.radians(np.arange(0, 180, 5)):
        axes = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
        width, depth = np.ptp(axes @ flat, axis=1).tolist()
        short, long = sorted((width, depth))
        sizes.append((max(short / least, long / most, 1.0), width, depth))
    # The first of equals is turned least.
    _, width, depth = min(sizes, key=lambda size: size[0])
    return width, depth, float(np.ptp(vertices @ direction))


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
    tolerance : difference of heights taken as none, mm

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
    surface: Connectivity,
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
    lying = ~_clear_of_lowest(skeleton, direction, process)[skeleton.edges].any(axis=1)
    level = skeleton.lengths * np.cos(angles)
    both_held = (skeleton.valency[skeleton.edges] > 1).all(axis=1)
    bridges = both_held & (level <= process.longest_bridge)
    flat = (angles < process.overhang_angle - 1e-9) & ~bridges & ~lying
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
        f"{counted(count, 'strut')} below {needs:g}° need support: turn the part or the cell"
        if count
        else "",
        skeleton.nodes[skeleton.edges[np.flatnonzero(flat)[:MOST_PLACES]]].mean(axis=1),
    )


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
    tolerance = LEVEL * float(np.ptp(heights)) + 1e-12
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
    surface: Connectivity,
    facets: Facets,
    floor: float,
    direction: UnitVectors,
    process: Process,
    needy: Verdict,
) -> Finding:
    heights = facets.vertices @ direction
    tolerance = LEVEL * float(np.ptp(heights)) + 1e-12
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
    best = best_direction(facets, process)
    other = standing(facets, best, process)
    text = f"({', '.join(f'{value:.3g}' for value in best + 0.0)}) up: height {other.height:.4g} mm"
    if process.overhang_angle > 0:
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
