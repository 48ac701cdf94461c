"""What a skeleton's struts are made of: square scaffolds, or round struts."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from scaffold_cad.base.arrays import Ints
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts import RoundStruts

Model: TypeAlias = "Scaffold | RoundStruts"
"""What has a B-rep of a skeleton's struts."""

Make: TypeAlias = Callable[[Skeleton], Model]
"""What makes the struts of a skeleton."""


def overlapping(model: Model) -> Ints:
    """Return the struts that are not known to keep apart from the others, ascending."""
    return model.overlapping if isinstance(model, RoundStruts) else model.embedding().left_out
