"""How much memory the machine has."""

from __future__ import annotations

import os

UNKNOWN = 16e9
"""Memory of a machine that does not tell, bytes."""

MOST_MEMORY = 0.8
"""Most of the machine's memory that one work may need."""


def machine_memory() -> float:
    """Return the memory of the machine, bytes.

    Examples
    --------
    >>> machine_memory() > 1e8
    True
    """
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):  # Windows has no sysconf
        return UNKNOWN
