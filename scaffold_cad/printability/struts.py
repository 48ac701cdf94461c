"""Findings on struts: thin ones, slender ones, and those that nearly touch."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points, place_text
from scaffold_cad.base.summaries import counted
from scaffold_cad.printability.gaps import narrow_gaps
from scaffold_cad.printability.processes import Process
from scaffold_cad.printability.report import MOST_PLACES, Finding
from scaffold_cad.printability.thickness import Thickness
from scaffold_cad.skeleton import Skeleton

RADIUS_STEP = 1e-3
"""What radii that are advised are multiples of, mm."""


def strut_findings(
    skeleton: Skeleton,
    thickness: Thickness,
    process: Process,
    flat: Bools,
    apothem: float = 1.0,
) -> Iterator[Finding]:
    """Yield what there is to say of struts with the radii of `skeleton`, at least one.

    Parameters
    ----------
    thickness : of the struts, as measured in a mesh or as asked for
    flat : (m, 2) which ends of struts are flat, see `narrow_gaps`
    apothem : what the radii asked for were multiplied by
    """
    yield _diameter(skeleton, thickness, process, apothem)
    yield _slenderness(skeleton, thickness.diameters, process)
    yield _gap(skeleton, process, flat)


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


def _gap(skeleton: Skeleton, process: Process, flat: Bools) -> Finding:
    needed = process.least_gap
    gaps = narrow_gaps(skeleton, needed, flat)
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
        text += f"; {counted(overlapping, 'pair overlaps and is', 'pairs overlap and are')} one"
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
