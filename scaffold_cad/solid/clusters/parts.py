"""What of round struts is a field and what is exact, without their triangles: for layers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints
from scaffold_cad.solid.clusters.core import Core, unmade
from scaffold_cad.solid.clusters.fields import cluster_struts, whole_struts
from scaffold_cad.solid.clusters.fineness import Fineness
from scaffold_cad.solid.clusters.growth import Clusters, bodies_of, clusters_of, most_field
from scaffold_cad.solid.clusters.hollow import both_of
from scaffold_cad.solid.clusters.spans import Spans, whole_runs
from scaffold_cad.solid.clusters.stumps import wanted_fillets
from scaffold_cad.solid.field import FieldStruts
from scaffold_cad.struts.apart import Slack
from scaffold_cad.struts.meshes.bands import polygon_slack
from scaffold_cad.struts.meshes.surface import inside_of
from scaffold_cad.struts.model import RoundStruts


@dataclass(frozen=True, eq=False)
class Parts(Frozen):
    """Solid struts, some of which are fields."""

    struts: RoundStruts
    """All of them."""
    nodes: Bools
    """Nodes that are in fields, shape (n,)."""
    pieces: Bools
    """Pieces of curves that are in fields, shape (p,)."""
    spans: Spans
    """Stretches of runs that are in fields."""
    fillets: Floats
    """Fillet radius of each node, mm, shape (n,)."""
    fields: FieldStruts | None
    """What fields are made of, if there are any."""
    run: Ints
    """The run of each of these, -1 for balls, shape (q,)."""


def parts_of(struts: RoundStruts, sides: int) -> tuple[Parts, Parts | None]:
    """Return the parts of the outside of struts, and of the inside of hollow ones.

    Parameters
    ----------
    sides : of the polygons of struts that are exact, which must not cross
    """
    if struts.inner is None:
        return _parts(struts, sides, wanted_fillets(struts), unmade(struts, sides)), None
    inner = inside_of(struts)

    def make(own: RoundStruts, fillets: Floats, core: Core, *_: object) -> Parts:
        return _parts(own, sides, fillets, core)

    core = unmade(struts, sides).joined(unmade(inner, sides))
    return both_of(struts, inner, make, core, Fineness())


def _parts(struts: RoundStruts, sides: int, fillets: Floats, core: Core) -> Parts:
    """Return the parts of solid struts with what is in `core` in fields."""
    slack = Slack(polygon_slack(sides), np.zeros(len(core.nodes)))
    bodies = cache(partial(bodies_of, struts))
    found = clusters_of(struts, bodies, fillets, slack, core, core.spans, most_field(struts))
    if found is None:
        every = np.ones_like(core.nodes), np.ones_like(core.pieces)
        spans, whole = whole_runs(struts.runs), whole_struts(struts)
        return Parts(struts, *every, spans, fillets, whole, _with_balls(spans.run, whole))
    own = found.nodes, found.pieces, found.spans, found.reached
    if len(found.spans) == 0:
        return Parts(struts, *own, None, found.spans.run)
    fields = cluster_struts(struts, found)
    return Parts(struts, *own, fields, _with_balls(_runs_of(found), fields))


def _runs_of(clusters: Clusters) -> Ints:
    """Return the run of each strut of the field of clusters, see `cluster_struts`."""
    run, lines, of_cuts = clusters.spans.run, clusters.lines, clusters.rest.cuts.span
    leads = run[of_cuts[len(of_cuts) - len(lines.joints) :]]
    return np.concatenate([run[~lines.passed[run]], leads, leads])


def _with_balls(run: Ints, fields: FieldStruts) -> Ints:
    """Return the run (q,) of the first struts of fields, and -1 for the balls after them."""
    return np.append(run, np.full(len(fields.ends) - len(run), -1))
