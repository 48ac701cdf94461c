"""Parts of a quad mesh that are alike: the same up to a renumbering of their quads and vertices.

A part is turned into colors of its sides: a side's color is mixed from its own mark and the
colors of the side after it and of the side that runs back along it, until no more sides
differ. One side of the least color in each part is then marked and the colors are mixed again.
Now all sides of a part differ, for walks from the marked side lead to each of them; sorted by
color they are in an order that does not depend on their numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.base.arrays import Ints
from scaffold_cad.base.topology import component_labels

Colors = NDArray[np.uint64]
"""Hashes of sides, shape (s,)."""

ROOT = np.uint64(0x9E3779B97F4A7C15)
"""Mark of the side from which the others are found."""


@dataclass(frozen=True, eq=False)
class AlikeParts:
    """Parts that are alike, quad by quad and side by side."""

    sides: Ints
    """First side of each quad in each part, shape (parts, quads): those of a column correspond.
    Side `4 i + k` is side k of quad i, and a quad's other sides follow in their order."""


def alike_parts(quads: Ints, twin: Ints, marks: Ints) -> list[AlikeParts]:
    """Return the parts of a mesh, those that are alike together.

    Parameters
    ----------
    quads : (q,) intp, the quads that take part
    twin : (4 f,) intp, the side that runs back along each side; -1 where a part ends
    marks : (4 f,) intp, what parts must have in common to be alike; with the valences of the
        sides' vertices among it, few parts that are alike are missed
    """
    if len(quads) == 0:
        return []
    sides = (4 * quads[:, None] + np.arange(4)).reshape(-1)
    rank = np.full(len(twin), -1, dtype=np.intp)
    rank[sides] = np.arange(len(sides))
    back = np.where(twin[sides] >= 0, rank[twin[sides]], -1)
    after = np.roll(np.arange(len(sides)).reshape(-1, 4), -1, axis=1).reshape(-1)

    joined = np.flatnonzero(back >= 0)
    links = np.stack([joined >> 2, back[joined] >> 2], axis=1)
    part = np.repeat(component_labels(links, len(quads)), 4)  # (s,)
    colors = _stable(_mixed(marks[sides].astype(np.uint64)), after, back)
    root = np.lexsort((colors, part))[np.searchsorted(np.sort(part), np.arange(part.max() + 1))]
    colors[root] ^= ROOT
    colors = _stable(_mixed(colors), after, back)

    order = np.lexsort((colors, part))
    sizes = np.bincount(part)
    starts = np.cumsum(sizes) - sizes
    # The first side of each quad in this order stands for the quad.
    place = np.empty(len(sides), dtype=np.intp)
    place[order] = np.arange(len(sides))
    first = np.sort(place.reshape(-1, 4).min(axis=1))
    chosen = sides[order[first]]
    fingerprint = np.add.reduceat(_mixed(colors[order]), starts)
    _, kind = np.unique(
        np.stack([fingerprint, sizes.astype(np.uint64)]), axis=1, return_inverse=True
    )
    kind = kind.reshape(-1)
    return [
        AlikeParts(chosen[starts[members][:, None] // 4 + np.arange(sizes[members[0]] // 4)])
        for members in np.split(np.argsort(kind, kind="stable"), np.cumsum(np.bincount(kind))[:-1])
    ]


def _stable(colors: Colors, after: Ints, back: Ints) -> Colors:
    """Return the colors mixed with those of their neighbors until as many differ as ever will."""
    count = 0
    while True:
        differing = len(np.unique(colors))
        if differing == count:
            return colors
        count = differing
        across = np.where(back >= 0, colors[back], np.uint64(0))
        colors = _mixed(_mixed(_mixed(colors) + colors[after]) + across)


def _mixed(values: Colors) -> Colors:
    """Return well-spread hashes of 64-bit numbers: the finalizer of MurmurHash3."""
    values = values ^ (values >> np.uint64(33))
    values = values * np.uint64(0xFF51AFD7ED558CCD)
    values = values ^ (values >> np.uint64(33))
    values = values * np.uint64(0xC4CEB9FE1A85EC53)
    return values ^ (values >> np.uint64(33))
