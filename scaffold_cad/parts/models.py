"""What part objects are made of: square scaffolds with collars, or round struts."""

from __future__ import annotations

from typing import TypeAlias, get_args

from scaffold_cad.base.arguments import check_choice
from scaffold_cad.base.arrays import Ints
from scaffold_cad.filling.solids import Section
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts import RoundStruts, round_struts

Model: TypeAlias = "Scaffold | RoundStruts"
"""What has a B-rep of a skeleton's struts."""


def model_of(skeleton: Skeleton, section: Section) -> Model:
    """Return the struts of a skeleton with the section asked for.

    Raises
    ------
    OptionError
        If there is no such section.
    """
    check_choice(section, "section", get_args(Section))
    if section == "round":
        return round_struts(skeleton)
    return build_scaffold(skeleton, collars=True)


def overlapping(model: Model) -> Ints:
    """Return the struts that are not known to keep apart from the others, ascending."""
    return model.overlapping if isinstance(model, RoundStruts) else model.embedding().left_out
