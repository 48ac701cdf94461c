"""The halo of a tile: the struts around its own ones that decide what these become.

A strut's surface depends on its branch, which carries its section from end to end; on the stars at
both ends of the branch; on how much room the struts of these stars leave, which depends on the
stars at their far ends; and the rings of a mesh at a node on all of that for each of its struts.
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Ints
from scaffold_cad.base.topology import Chains

RINGS = 3
"""Stars beyond a tile's own branches: of their ends, of those that share room with them, and of
those whose fillets the collars of these depend on."""


def chain_of_edges(chains: Chains, count: int) -> Ints:
    """Return the chain of each of `count` edges, shape (m,)."""
    chain = np.empty(count, dtype=np.intp)
    sizes = np.diff(chains.offsets)
    chain[chains.half_edges >> 1] = np.repeat(np.arange(len(sizes)), sizes)
    return chain


def with_halo(edges: Edges, count: int, chain: Ints, own: Bools) -> tuple[Bools, Bools]:
    """Return the edges of a tile, and the nodes whose stars it must have, (m,) and (n,).

    Parameters
    ----------
    edges : (m, 2) of a graph of `count` nodes
    chain : (m,) chain of each edge
    own : (m,) the edges whose surface is wanted
    """
    marks = _whole_chains(chain, own)
    inner = np.zeros(count, dtype=np.bool_)
    for _ in range(RINGS):
        inner[edges[marks]] = True
        at_inner: Bools = np.asarray(inner[edges].any(axis=1))
        marks = _whole_chains(chain, at_inner)
    return marks, inner


def _whole_chains(chain: Ints, marks: Bools) -> Bools:
    """Return the edges of all chains of which an edge is marked, (m,)."""
    chosen = np.zeros(len(chain), dtype=np.bool_)
    chosen[chain[marks]] = True
    return chosen[chain]
