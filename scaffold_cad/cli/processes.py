"""The option `--process`: struts that a printer cannot make are refused before they are built."""

from __future__ import annotations

import argparse
import logging

import numpy as np

from scaffold_cad.errors import OptionError
from scaffold_cad.lattice import PeriodicLattice
from scaffold_cad.printability import PROCESSES
from scaffold_cad.printability.gaps import free_ends
from scaffold_cad.printability.struts import as_wide, radius_for, strut_findings
from scaffold_cad.printability.thickness import thickness_asked
from scaffold_cad.skeleton import Skeleton

_log = logging.getLogger(__name__)


def add_process(parser: argparse.ArgumentParser) -> None:
    """Add the argument that names a process."""
    parser.add_argument(
        "--process",
        choices=PROCESSES,
        help="refuse struts thinner than this process prints, and warn of slender ones and of "
        "narrow gaps, before they are made",
    )


def check_struts(options: argparse.Namespace, skeleton: Skeleton, apothem: float = 1.0) -> None:
    """Raise if a process cannot print the struts that are to be made; log what it may not.

    Parameters
    ----------
    apothem : half the width of the struts' section over the radius

    Raises
    ------
    OptionError
        If struts are too thin.
    """
    if options.process is None:
        return
    process = PROCESSES[options.process]
    wide = as_wide(skeleton, apothem)
    flat = free_ends(wide)
    if getattr(options, "ends", None) == "round" or getattr(options, "product", None) == "frame":
        flat[:] = False
    for finding in strut_findings(wide, thickness_asked(wide), process, flat, apothem):
        if finding.verdict == "failure":
            raise OptionError(f"not printable by {process.name}: {finding.advice}")
        if finding.verdict == "warning":
            _log.warning("%s: %s", process.name, finding.advice)


def check_lattice(options: argparse.Namespace, lattice: PeriodicLattice) -> None:
    """Raise if a process cannot print the struts of a lattice, before any is made."""
    if options.process is None:
        return
    process = PROCESSES[options.process]
    thickness = 2.0 * _least_radius(lattice)
    if thickness < process.least_diameter * (1 - 1e-9):
        raise OptionError(
            f"not printable by {process.name}: struts of {thickness:.4g} mm, "
            f"{process.name.upper()} needs {process.least_diameter:g}: raise --radius to "
            f"{radius_for(process):g} or more"
        )


def _least_radius(lattice: PeriodicLattice) -> float:
    """Return the least radius of a lattice, whose nodes are made layer by layer, mm."""
    if not callable(lattice.radius):
        return lattice.radius
    x, y, z = lattice.layers
    windows = [lattice.window((0, 0, k), (x, y, k + 1)) for k in range(z)]
    return min(float(lattice.part(window).radii.min(initial=np.inf)) for window in windows)
