"""How much room each node gets on the struts that it shares with others."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats

SPARE = 1e-3
"""Part of a strut's length that is left between its collars at least."""


def allotted(wanted: Floats, least: Floats, lengths: Floats) -> tuple[Floats, Bools]:
    """Return how far from its node each half-run's collar may be, and which runs have no room.

    Where the collars wanted do not fit on a run, both nodes get what they need at least, and what
    is left in proportion to what more they want.

    Parameters
    ----------
    wanted : (2 k,) distances of the collars with the fillets asked for, mm
    least : (2 k,) with the smallest fillets, mm, at most those wanted
    lengths : (k,) of the runs, mm

    Returns
    -------
    (2 k,) float64, mm, and (k,) bool
    """
    wanted, least = wanted.reshape(-1, 2), least.reshape(-1, 2)
    usable = lengths * (1 - SPARE)
    needed = least.sum(axis=1)
    more = wanted - least
    share = np.divide(
        usable - needed, more.sum(axis=1), out=np.ones(len(lengths)), where=more.sum(axis=1) > 0
    )
    allowed = least + np.clip(share, 0.0, 1.0)[:, None] * more
    return allowed.reshape(-1), needed > usable
