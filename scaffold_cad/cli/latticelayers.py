"""`scaffold-cad lattice --layer`: a lattice of any size, cut into layers without a mesh."""

from __future__ import annotations

import argparse
import logging
from typing import Any

import numpy as np

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.base.summaries import counted
from scaffold_cad.cli import borders, processes, shapes, slicing, source
from scaffold_cad.cli.flags import told_as
from scaffold_cad.cli.progress import Progress
from scaffold_cad.filling.fill import lattice_around, whole_cells_around
from scaffold_cad.io.stacks import write_layers
from scaffold_cad.lattice.registry import as_cell
from scaffold_cad.lattice.tiling import cell_size
from scaffold_cad.layers import slices
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts import round_struts

NOT_PERIODIC = ("joints", "bend", "nodes")
"""Options of round struts that are not for those that are made as they are cut."""

WHOLE = 1e-9
"""Part of a cell by which a box may be off a whole number of cells."""

_log = logging.getLogger(__name__)


def check(options: argparse.Namespace) -> None:
    """Raise where an option is out of its range, or would do nothing."""
    slicing.check_layers(options)
    source.refuse(options, ["beams", "overlaps", "max_nodes"], "is not for --layer")
    if made_whole(options):
        return
    named = (*NOT_PERIODIC, *borders.OF_BORDERS)
    source.refuse(options, named, "is not for layers of a box or a part")


def made_whole(options: argparse.Namespace) -> bool:
    """Return whether all struts are made before they are cut: those of endless cells are not."""
    bodied = options.box is not None or options.inside is not None
    return not bodied or options.foam is not None or callable(options.size)


def write(
    options: argparse.Namespace,
    where: Skeleton | TriangleMesh | Floats,
    region: TriangleMesh | None = None,
) -> None:
    """Cut and write.

    Parameters
    ----------
    where : a foam or a lattice on a map; a part to fill; or the box around a box
    region : what a foam is cut to
    """
    given: dict[str, Any] = {"skin": options.skin, "sides": options.sides}
    if region is not None:
        given["region"] = region
    if isinstance(where, Skeleton):
        what: Any = round_struts(where, **shapes.round_options(options))
        struts = len(where.edges)
    else:
        cell = as_cell(options.cell)
        corners = where.vertices if isinstance(where, TriangleMesh) else where
        bounds = np.stack([corners.min(axis=0), corners.max(axis=0)])
        given_struts = shapes.round_options(options)
        size = cell_size(cell, options.size)
        what = lattice_around(bounds, cell, size, options.radius, **given_struts)
        processes.check_lattice(options, what)
        struts = what.strut_count
        if isinstance(where, TriangleMesh):
            given["region"] = where
    with told_as(thickness="--layer"):
        layers = slices(what, thickness=options.layer, **given)
    _log.info(
        "%s, %s of %g mm", counted(struts, "strut"), counted(len(layers), "layer"), options.layer
    )
    with Progress().stage("layers", struts * len(layers), "sections"), told_as(pixel="--pixel"):
        write_layers(layers, options.output, text=options.text, pixel=options.pixel)
    _log.info("%s written", options.output)


def fills(box: Points, options: argparse.Namespace) -> bool:
    """Return whether whole cells fill a box (2, 3), so that nothing is to be cut off."""
    cell = as_cell(options.cell)
    if cell.is_net or not np.array_equal(cell.axes, np.eye(3)):
        return False
    size = cell_size(cell, options.size)
    counts, _ = whole_cells_around(box, cell, size)
    off = size * counts - (box[1] - box[0])
    return bool((np.abs(off) < WHOLE * size).all())
