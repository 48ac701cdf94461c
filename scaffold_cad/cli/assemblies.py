"""What is beside the beams of a 3MF file, and the beams, as a file of one part."""

from __future__ import annotations

import argparse
import logging
from typing import Any

from scaffold_cad.base.summaries import counted
from scaffold_cad.brep import BREP_SUFFIXES
from scaffold_cad.cli.progress import Progress
from scaffold_cad.io.write import write
from scaffold_cad.products.assembly import Assembly, assembly_solid, log_united
from scaffold_cad.products.assemblybreps import assembly_brep
from scaffold_cad.products.models import Make
from scaffold_cad.products.overlaps import Overlaps
from scaffold_cad.solid.rounds import SIDES
from scaffold_cad.struts import round_struts

_log = logging.getLogger(__name__)


def build(
    assembly: Assembly, options: argparse.Namespace, make: Make | None, progress: Progress
) -> None:
    """Write beams and what is beside them: one solid in meshes, bodies in STEP and BREP files.

    Parameters
    ----------
    make : what makes the struts that stand for beams; None for the beams as they are, in meshes
    """
    beams = assembly.beam_count
    cad = options.output.suffix.lower() in BREP_SUFFIXES
    if cad and options.overlaps != "unite":
        struts, others = counted(beams, "beam is", "beams are"), ", ".join(assembly.beside_beams())
        _log.info("%s a body beside %s; --overlaps unite makes one of triangles", struts, others)
    else:
        log_united(assembly, options.input)
    with progress.stage("solid", beams, "struts"):
        product: Any
        if cad:
            overlaps: Overlaps = options.overlaps or "refuse"
            product = assembly_brep(assembly, make or round_struts, overlaps=overlaps)
        else:
            product = assembly_solid(
                assembly,
                SIDES if options.sides is None else options.sides,
                make=make,
                overlaps=options.overlaps or "unite",
            )
    with progress.stage("file", beams, "struts"):
        write(product, options.output)
    _log.info("%s written", options.output)
