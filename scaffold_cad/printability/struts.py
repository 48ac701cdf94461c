"""Findings on struts: thin ones, slender ones, and those that nearly touch."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points, UnitVectors, place_text
from scaffold_cad.base.boxes import overlapping_boxes
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.printability.processes import Process
from scaffold_cad.printability.report import MOST_PLACES, Finding
from scaffold_cad.printability.thickness import Thickness
from scaffold_cad.skeleton import Skeleton

RADIUS_STEP = 1e-3
"""What radii that are advised are multiples of, mm."""


def strut_findings(
    skeleton: Skeleton, thickness: Thickness, process: Process, apothem: float = 1.0
) -> Iterator[Finding]:
    """Yield what there is to say of struts with the radii of `skeleton`, at least one.

    Parameters
    ----------
    thickness : of the struts, as measured in a mesh or as asked for
    apothem : what the radii asked for were multiplied by
    """
    yield _diameter(skeleton, thickness, process, apothem)
    yield _slenderness(skeleton, thickness.diameters, process)
    yield _gap(skeleton, process)


def as_wide(skeleton: Skeleton, apothem: float) -> Skeleton:
    """Return a skeleton whose radii are half the width of the sections that struts get."""
    return skeleton.with_edge_radii(skeleton.edge_radii * apothem, skeleton.radii * apothem)


def radius_for(process: Process, apothem: float = 1.0) -> float:
    """Return the least radius that a process prints, rounded up, mm."""
    needed = process.least_diameter / 2 / apothem
    return math.ceil(needed / RADIUS_STEP * (1 - 1e-9)) * RADIUS_STEP


def _diameter(
    skeleton: Skeleton, thickness: Thickness, process: Process, apothem: float
) -> Finding:
    needed, thinnest = process.least_diameter, thickness.diameters
    # A strut of the very limit, its radius halved and doubled in decimals, is thick enough.
    thin = np.flatnonzero(thinnest < needed * (1 - 1e-9))
    first = int(np.argmin(thinnest))
    text = f"{thinnest[first]:.4g} mm at least, strut {first}"
    advice = []
    if len(thin):
        advice.append(
            f"{counted(len(thin), 'strut')} too thin: strut {first} is {thinnest[first]:.4g} mm, "
            f"{process.name.upper()} needs {needed:g}: raise the radius to "
            f"{radius_for(process, apothem):g} or more"
        )
    asked = 2 * skeleton.edge_radii.min(axis=1)
    thinned = thickness.thinned
    if len(thinned):
        worst = int(thinned[np.argmin((thinnest / asked)[thinned])])
        place = place_text(thickness.places[worst])
        advice.append(
            f"{counted(len(thinned), 'strut')} thinner than asked for: strut {worst} measures "
            f"{thinnest[worst]:.4g} mm near {place}, not {asked[worst]:.4g}"
        )
    return Finding(
        "strut_diameter",
        "lattice",
        "failure" if len(thin) else "warning" if len(thinned) else "ok",
        {
            "least_mm": float(thinnest[first]),
            "needed_mm": needed,
            "strut": first,
            "thin": len(thin),
            "thinned": len(thinned),
        },
        text,
        "; ".join(advice),
        thickness.places[np.union1d(thin, thinned)[:MOST_PLACES]],
    )


def _slenderness(skeleton: Skeleton, thinnest: Floats, process: Process) -> Finding:
    ratios = skeleton.lengths / thinnest
    allowed = process.greatest_slenderness
    slender = np.flatnonzero(ratios > allowed)
    first = int(np.argmax(ratios))
    advice = ""
    if len(slender):
        advice = (
            f"{counted(len(slender), 'strut')} may bend or break: strut {first} is "
            f"{skeleton.lengths[first]:.4g} mm long and {thinnest[first]:.4g} mm thick; "
            f"keep it within {allowed:g} diameters"
        )
    return Finding(
        "slenderness",
        "lattice",
        "warning" if len(slender) else "ok",
        {"greatest": float(ratios[first]), "allowed": allowed, "strut": first},
        f"{ratios[first]:.3g} diameters long at most, strut {first}",
        advice,
        _middles(skeleton, slender),
    )


@dataclass(frozen=True, eq=False)
class Gaps:
    """Pairs of struts without a common node that come closer than a limit."""

    first: Ints
    second: Ints
    """The struts of each pair, shapes (p,)."""
    widths: Floats
    """Room between their surfaces, < 0 where they overlap, shape (p,), mm."""
    places: Points
    """The middle of the gap, shape (p, 3), mm."""


def narrow_gaps(skeleton: Skeleton, limit: float) -> Gaps:
    """Return the pairs of struts whose round surfaces come closer than `limit`, mm.

    A strut's radius goes evenly from that of its one node to that of its other.
    """
    start, end = np.moveaxis(skeleton.nodes[skeleton.edges], 1, 0)
    reach = skeleton.edge_radii.max(axis=1)[:, None] + limit / 2
    blocks = [
        _gaps_of(skeleton, i, j, limit)
        for i, j in overlapping_boxes(
            np.minimum(start, end) - reach, np.maximum(start, end) + reach
        )
    ]
    if not blocks:
        none = np.zeros(0, dtype=np.intp)
        return Gaps(none, none, np.zeros(0), np.zeros((0, 3)))
    return Gaps(
        np.concatenate([block.first for block in blocks]),
        np.concatenate([block.second for block in blocks]),
        np.concatenate([block.widths for block in blocks]),
        np.concatenate([block.places for block in blocks]),
    )


def _gaps_of(skeleton: Skeleton, i: Ints, j: Ints, limit: float) -> Gaps:
    """Return those of the pairs i, j that are gaps narrower than `limit`."""
    ends = skeleton.edges
    apart = (ends[i][:, :, None] != ends[j][:, None, :]).all(axis=(1, 2))
    i, j = i[apart], j[apart]
    widths, places = _nearest_surfaces(_Cones.of(skeleton, i), _Cones.of(skeleton, j))
    near = widths < limit
    return Gaps(i[near], j[near], widths[near], places[near])


@dataclass(frozen=True, eq=False)
class _Cones:
    """Struts whose radius goes evenly from one end to the other."""

    start: Points
    """First end of the axis, shape (k, 3), mm."""
    axis: UnitVectors
    """From there to the other, shape (k, 3)."""
    lengths: Floats
    """Shape (k,), mm."""
    radii: Floats
    """At the first end, shape (k,), mm."""
    slope: Floats
    """What the radius grows by along the axis, shape (k,)."""

    @classmethod
    def of(cls, skeleton: Skeleton, edges: Ints) -> _Cones:
        start, end = np.moveaxis(skeleton.nodes[skeleton.edges[edges]], 1, 0)
        lengths = length(end - start)
        near, far = skeleton.edge_radii[edges].T
        slope = np.divide(far - near, lengths, out=np.zeros_like(near), where=lengths > 0)
        return cls(start, normalize(end - start), lengths, near, slope)

    def at(self, along: Floats) -> tuple[Points, Floats]:
        """Return places on the axes and the radii there, of distances from the start (k,)."""
        return self.start + along[:, None] * self.axis, self.radii + along * self.slope

    def nearest(self, points: Points) -> Floats:
        """Return where on the axis the surface is nearest to points (k, 3), (k,)."""
        foot = dot(points - self.start, self.axis)
        beside = length(points - self.start - foot[:, None] * self.axis)
        steep = np.abs(self.slope) >= 1.0
        tilt = self.slope / np.sqrt(np.where(steep, 1.0, 1.0 - self.slope**2))
        along = np.where(steep, np.copysign(np.inf, self.slope), foot + beside * tilt)
        return np.clip(along, 0.0, self.lengths)


def _nearest_surfaces(a: _Cones, b: _Cones) -> tuple[Floats, Points]:
    """Return the room between the surfaces of pairs, (k,), and where it is, (k, 3).

    The distance of two places on the axes less the radii there is a convex function: it is least
    where both its slopes are 0, or else at an end of one of the two.
    """
    zero = np.zeros(len(a.lengths))
    tried = [
        _level(a, b),
        *((end, b.nearest(a.at(end)[0])) for end in (zero, a.lengths)),
        *((a.nearest(b.at(end)[0]), end) for end in (zero, b.lengths)),
    ]
    widths, places = np.full(len(zero), np.inf), np.zeros((len(zero), 3))
    for along_a, along_b in tried:
        (on_a, radii_a), (on_b, radii_b) = a.at(along_a), b.at(along_b)
        room = length(on_a - on_b) - radii_a - radii_b
        nearer = room < widths
        widths[nearer], places[nearer] = room[nearer], ((on_a + on_b) / 2)[nearer]
    return widths, places


def _level(a: _Cones, b: _Cones) -> tuple[Floats, Floats]:
    """Return where on the axes of pairs the distance of surfaces has no slope, (k,) each.

    There the line from one place to the other is at the angles to the axes that the surfaces ask
    for. Ends are returned where the axes are parallel, or no line is at these angles.
    """
    cosine = dot(a.axis, b.axis)
    normal = np.cross(a.axis, b.axis)
    squared = dot(normal, normal)  # of the sine
    between = a.start - b.start
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        # The line is x a + y b + z normal, 1 long.
        x = (a.slope + cosine * b.slope) / squared
        y = -(b.slope + cosine * a.slope) / squared
        z = np.sqrt((1.0 - x * a.slope + y * b.slope) / squared)
        apart = np.abs(dot(between, normal)) / (z * squared)
        z = np.copysign(z, dot(between, normal))
        line = x[:, None] * a.axis + y[:, None] * b.axis + z[:, None] * normal
        rest = apart[:, None] * line - between
        along, across = dot(rest, a.axis), dot(rest, b.axis)
        on_a, on_b = (along - cosine * across) / squared, (cosine * along - across) / squared
    found = np.isfinite(on_a) & np.isfinite(on_b)
    return (
        np.clip(np.where(found, on_a, 0.0), 0.0, a.lengths),
        np.clip(np.where(found, on_b, 0.0), 0.0, b.lengths),
    )


def _gap(skeleton: Skeleton, process: Process) -> Finding:
    needed = process.least_gap
    gaps = narrow_gaps(skeleton, needed)
    overlapping = int((gaps.widths <= 0).sum())
    open_rows = np.flatnonzero(gaps.widths > 0)
    value = {"needed_mm": needed, "least_mm": None, "narrow": len(open_rows)}
    value["overlapping"] = overlapping
    text = f"{needed:g} mm or more between struts"
    advice = ""
    if len(open_rows):
        row = open_rows[np.argmin(gaps.widths[open_rows])]
        value["least_mm"] = float(gaps.widths[row])
        text = f"{gaps.widths[row]:.3g} mm, struts {gaps.first[row]} and {gaps.second[row]}"
        advice = (
            f"{counted(len(open_rows), 'pair')} of struts may fuse, {process.name.upper()} needs "
            f"{needed:g} mm: move them apart, or lower the radius"
        )
    if overlapping:
        text += f"; {counted(overlapping, 'pair')} overlap and are one"
    return Finding(
        "strut_gap",
        "lattice",
        "warning" if len(open_rows) else "ok",
        value,
        text,
        advice,
        gaps.places[open_rows[:MOST_PLACES]],
    )


def _middles(skeleton: Skeleton, edges: Ints) -> Points:
    """Return the middle of the first of `edges`, shape (k, 3), mm."""
    middles: Points = skeleton.nodes[skeleton.edges[edges[:MOST_PLACES]]].mean(axis=1)
    return middles
