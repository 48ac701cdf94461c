"""Struts made like others whose triangles or faces could not be kept: they are named."""

from __future__ import annotations

import logging

import numpy as np

from scaffold_cad.base.arrays import place_text
from scaffold_cad.base.summaries import counted
from scaffold_cad.solid.clusters.spans import Spans
from scaffold_cad.struts.model import RoundStruts

_log = logging.getLogger(__name__)


def tell_changed(struts: RoundStruts, *spans: Spans) -> None:
    """Warn of struts made like others that are in fields, whose triangles are made anew.

    Parameters
    ----------
    spans : stretches of runs that are in fields, of each surface
    """
    runs = np.concatenate([some.run for some in spans])
    if struts.like is None or len(runs) == 0:
        return
    skeleton = struts.skeleton
    edges = np.flatnonzero(np.isin(struts.runs.run_of_edge, runs))
    middle = skeleton.nodes[skeleton.edges[edges[0]]].mean(axis=0)
    _log.warning(
        "%s crowded or overlap, whose triangles are not those of `like`: edge %d, near %s%s; "
        "need wider angles or thinner struts",
        counted(len(edges), "strut is", "struts are"),
        edges[0],
        place_text(middle),
        ", first" if len(edges) > 1 else "",
    )
