"""The radius that gives the struts of `scaffold-cad lattice` their relative density."""

from __future__ import annotations

import argparse
import logging

from scaffold_cad.cli import shapes
from scaffold_cad.cli.maps import map_of
from scaffold_cad.errors import OptionError
from scaffold_cad.filling import solve_radius
from scaffold_cad.lattice.registry import as_cell
from scaffold_cad.lattice.tiling import cell_size
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import solidified
from scaffold_cad.struts import round_struts

_log = logging.getLogger(__name__)


def check(options: argparse.Namespace) -> None:
    """Raise if the density is out of its range, or cells have no one size.

    Cells of foams, on maps and of sizes that vary have none.
    """
    if options.foam is not None or callable(options.size) or map_of(options) is not None:
        raise OptionError("--density is of equal cells in a box or a part; need --radius here")
    if not 0 < options.density < 1:
        raise OptionError(f"--density is {options.density:g}; need > 0 and < 1")


def radius(options: argparse.Namespace) -> float:
    """Return the radius for the density that is asked for, of the struts that are made, mm."""
    given = shapes.round_options(options)
    square = not options.round and options.layer is None

    def volume(skeleton: Skeleton) -> float:
        made = build_scaffold(skeleton, collars=True) if square else round_struts(skeleton, **given)
        return float(solidified(made).manifold.volume())

    size = cell_size(as_cell(options.cell), options.size)
    if not square and not given:
        found = solve_radius(options.cell, size, options.density, measured=True)
    else:
        found = solve_radius(options.cell, size, options.density, volume=volume)
    _log.info("a radius of %.6g mm has a relative density of %g", found, options.density)
    return found
