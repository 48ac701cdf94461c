"""SWC files: skeletons without loops, one sample a node."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order

from scaffold_cad.base.arrays import Ints
from scaffold_cad.errors import FormatError
from scaffold_cad.skeleton import Skeleton

DENDRITE = 3
"""Type of every sample: a skeleton knows no soma and no axon."""


def write_swc(skeleton: Skeleton, path: Path) -> None:
    """Write the nodes, exact to the last bit, in mm; edges turn so that parents come first.

    Each component begins with its first node, and samples follow in order of their distance
    from it, which many readers of SWC ask for.

    Raises
    ------
    FormatError
        If the skeleton has a loop.
    """
    if skeleton.loop_count:
        raise FormatError(f"SWC holds trees only; the skeleton has {skeleton.loop_count} loops")
    order, parent = _walk(skeleton)
    number = np.empty(len(order), dtype=np.intp)
    number[order] = np.arange(1, len(order) + 1)
    parents = np.where(parent < 0, -1, number[parent])[order]
    rows = zip(
        skeleton.nodes[order].tolist(),
        skeleton.radii[order].tolist(),
        parents.tolist(),
        strict=True,
    )
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write("# scaffold_cad\n# unit: mm\n# number type x y z radius parent\n")
        file.writelines(
            f"{k} {DENDRITE} {x!r} {y!r} {z!r} {radius!r} {up}\n"
            for k, ((x, y, z), radius, up) in enumerate(rows, start=1)
        )


def _walk(skeleton: Skeleton) -> tuple[Ints, Ints]:
    """Return the nodes, parents before children, and the parent of each, -1 without one."""
    count = len(skeleton.nodes)
    ends = (skeleton.edges[:, 0], skeleton.edges[:, 1])
    roads = coo_array((np.ones(len(skeleton.edges)), ends), shape=(count, count)).tocsr()
    _, roots = np.unique(skeleton.component_of_node, return_index=True)
    orders, parent = [], np.full(count, -1, dtype=np.intp)
    for root in roots.tolist():
        order, before = breadth_first_order(roads, root, directed=False)
        orders.append(order)
        parent[order[1:]] = before[order[1:]]
    return np.concatenate([np.zeros(0, dtype=np.intp), *orders]), parent
