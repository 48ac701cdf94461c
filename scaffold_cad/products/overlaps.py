"""The log message about struts that overlap, of the command line and of filled parts."""

from __future__ import annotations

import logging

from scaffold_cad.base.arrays import Ints
from scaffold_cad.scaffold import Scaffold

_log = logging.getLogger(__name__)


def log_overlaps(scaffold: Scaffold, edges: Ints, *, united: bool, smooth: bool = False) -> None:
    """Log that `edges` overlap others, if there are any: as a warning unless they are united.

    Parameters
    ----------
    edges : struts, see `Embedding.left_out`, `Solidified.united_edges` and `crossing_struts`
    united : whether they are united, so that the surface does not cross itself
    smooth : whether the surface is smooth elsewhere
    """
    if len(edges) == 0:
        return
    if united:
        outcome = "; they are united" + (", and not smooth there" if smooth else "")
    else:
        outcome = (
            ": the surface may cross itself there; smaller radii, a simplified skeleton or a mesh "
            "format help"
        )
    if not scaffold.options.collars:
        outcome += "; collars keep struts straight and thinner at their nodes"
    _log.log(
        logging.INFO if united else logging.WARNING,
        "%d of %d struts overlap others or their nodes, edge %d first%s",
        len(edges),
        len(scaffold.skeleton.edges),
        edges[0],
        outcome,
    )
