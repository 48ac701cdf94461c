"""Whether powder or resin leaves a part: pockets that a ball cannot leave, found on a grid."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.vectors import length
from scaffold_cad.printability.nesting import winding_numbers
from scaffold_cad.printability.processes import Process
from scaffold_cad.printability.report import Finding
from scaffold_cad.printability.triangletopology import TriangleTopology

GRID_STEPS = 6
"""Steps of the grid across the narrowest opening."""
MOST_CELLS = 10_000_000
"""Cells of a grid: some 100 MB."""
MOST_POCKETS = 100
"""Number of pockets that are listed, the largest first."""


def drainage_finding(surface: TriangleTopology, process: Process) -> Finding:
    """Return the finding on pockets that a ball of the least opening fits in but cannot leave.

    The grid is no finer than that a ball a third larger must fit in, and one a third smaller must
    be unable to leave. A wide pocket with many narrow windows counts too: powder comes out of it,
    but slowly.
    """
    if not process.encloses:
        text = f"{process.name.upper()} leaves nothing behind that must come out"
        return Finding("drainage", "build", "ok", {"pockets": 0, "volume_mm3": 0.0}, text)
    step = process.least_opening / GRID_STEPS
    low = surface.mesh.vertices.min(axis=0) - process.least_opening
    high = surface.mesh.vertices.max(axis=0) + process.least_opening
    shape = np.ceil((high - low) / step).astype(np.intp) + 1
    if np.prod(shape, dtype=np.float64) > MOST_CELLS:
        text = f"not checked: the part is too large for steps of {step:.2g} mm"
        return Finding("drainage", "build", "note", None, text)
    centers, volumes = _pockets(surface, low, shape, step)
    count = len(volumes)
    total = float(volumes.sum())
    return Finding(
        "drainage",
        "build",
        "warning" if count else "ok",
        {"pockets": count, "volume_mm3": total, "opening_mm": process.least_opening},
        f"{counted(count, 'pocket')} of {total:.4g} mm³ or more with openings narrower than "
        f"about {process.least_opening:g} mm"
        if count
        else f"every pocket opens to about {process.least_opening:g} mm or more",
        f"widen an opening of each to {process.least_opening:g} mm, or give it several"
        if count
        else "",
        centers,
    )


def _pockets(
    surface: TriangleTopology, low: Points, shape: Ints, step: float
) -> tuple[Points, Floats]:
    """Return a point in each pocket (k, 3), and the volume open to a ball's center there (k,)."""
    touched = _touched(surface, low, shape, step)
    # The surface is up to half a step out of the cells that it touches.
    reach = (GRID_STEPS - 1) / 2
    labels, count = ndimage.label(~_near(touched, reach - 1))
    sizes = np.bincount(labels.reshape(-1), minlength=count + 1)
    wide = np.zeros(count + 1, dtype=np.bool_)
    wide[labels[~_near(touched, reach + 1)]] = True
    sizes[~wide] = 0
    sizes[0] = sizes[labels[0, 0, 0]] = 0  # near the surface; outside
    largest = np.argsort(-sizes, kind="stable")[:MOST_POCKETS]
    largest = largest[sizes[largest] > 0]
    boxes = ndimage.find_objects(labels)
    cells = [_middle_cell(labels, int(label), boxes[label - 1]) for label in largest]
    places = low + step * np.asarray(cells, dtype=np.float64).reshape(-1, 3)
    open_air = np.abs(winding_numbers(places, surface.corners)) < 0.5
    volumes: Floats = sizes[largest[open_air]] * np.float64(step**3)
    return places[open_air], volumes


def _middle_cell(labels: NDArray[Any], label: int, box: tuple[slice, slice, slice]) -> Ints:
    """Return one of the cells in a box that have a label, halfway through them."""
    cells = np.argwhere(labels[box] == label)
    middle: Ints = cells[len(cells) // 2] + np.array([side.start for side in box])
    return middle


def _near(touched: Bools, reach: float) -> Bools:
    """Return the cells less than `reach` steps from a touched one.

    The outermost cells must be farther than that from any touched one.
    """
    steps = np.arange(-int(reach), int(reach) + 1)
    offsets = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=3).reshape(-1, 3)
    offsets = offsets[length(offsets.astype(np.float64)) < reach]
    near = np.zeros(touched.size, dtype=np.bool_)
    # Moving a flat array moves the grid: what wraps around is empty.
    strides = np.array([touched.shape[1] * touched.shape[2], touched.shape[2], 1])
    flat = touched.reshape(-1)
    for shift in (offsets @ strides).tolist():
        near[max(shift, 0) : len(flat) + min(shift, 0)] |= flat[
            max(-shift, 0) : len(flat) - max(shift, 0)
        ]
    return near.reshape(touched.shape)


def _touched(surface: TriangleTopology, low: Points, shape: Ints, step: float) -> Bools:
    """Return the cells of the grid that the surface goes through, of `shape`."""
    corners = surface.corners
    sides = length(np.roll(corners, -1, axis=1) - corners).max(axis=1)
    parts = np.maximum(np.ceil(sides / step), 1).astype(np.intp)
    touched = np.zeros(shape, dtype=np.bool_)
    for count in np.unique(parts):
        # Barycentric grid of `count` steps per side: points a cell apart, of which the ball spans
        # several, so that it finds no way between them.
        i, j = np.divmod(np.arange((count + 1) ** 2), count + 1)
        weights = np.stack([i, j, count - i - j], axis=1)[i + j <= count] / count
        rows = np.flatnonzero(parts == count)
        for some in np.array_split(rows, 1 + len(rows) * len(weights) // 1_000_000):
            points = (weights @ corners[some]).reshape(-1, 3)
            cells = np.round((points - low) / step).astype(np.intp)
            touched[tuple(cells.T)] = True
    return touched
