"""Beam models written for other programs: CalculiX, Nastran, OpenSees, ParaView."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from scaffold_cad.base.arguments import as_path, check_kind, checks_keywords
from scaffold_cad.base.arrays import Ints, Points
from scaffold_cad.base.files import replacing, unknown_suffix
from scaffold_cad.base.summaries import counted
from scaffold_cad.io.radii import MEANS
from scaffold_cad.mechanics.beams import BeamModel, BeamSolution
from scaffold_cad.mechanics.meshfiles import write_meshio
from scaffold_cad.mechanics.nastran import card, short
from scaffold_cad.mechanics.sections import sections_at

TONNES = 1e-12
"""Density in t/mm³ of one in kg/m³: with N, mm and MPa forces are consistent in tonnes."""

MEANS_ONLY = (".tcl",)
"""Endings of formats whose beams do not taper."""

PIECES = 4
"""Elements of CalculiX a strut. Lattices sag 26, 7, 3, 2 % too little with 1, 2, 4, 8."""

STEEP = 0.9
"""Part of a strut's direction along z above which its section is oriented by x."""

_log = logging.getLogger(__name__)


@checks_keywords()
def write_beams(model: BeamModel | BeamSolution, path: str | Path) -> None:
    """Write a beam model, with what holds and loads it, for another program.

    ========  ==========================================================================
    .inp      CalculiX: four B32R elements per strut, as one bends too little; cones in 4 steps,
              which CalculiX joins by stiff knots: 6 to 21 % too little
    .bdf      Nastran: CBEAM, tapered PBEAML sections
    .tcl      OpenSees: ElasticTimoshenkoBeam; cones by their mean section
    .vtu      ParaView: lines with radii and, of a solution, all its results (needs meshio)
    ========  ==========================================================================

    Raises
    ------
    OptionError
        If it is not a beam model.
    FormatError
        If the ending is not one of these, or the file cannot be written.
    MissingBackendError
        If meshio is needed and not installed.

    Examples
    --------
    >>> from scaffold_cad import Skeleton
    >>> from scaffold_cad.mechanics import Load, Support, beam_model
    >>> arm = Skeleton([[0, 0, 0], [100, 0, 0]], [[0, 1]], 5.0)
    >>> model = beam_model(arm, "steel", Support([0]), Load([1], (0, 0, -100)))
    >>> write_beams(model, "arm.inp")  # doctest: +SKIP
    """
    check_kind(model, BeamModel, BeamSolution)
    place = as_path(path)
    beams = model.model if isinstance(model, BeamSolution) else model
    writers = {".inp": _calculix, ".bdf": _nastran, ".tcl": _opensees}
    tapers = int((beams.edge_radii[:, 0] != beams.edge_radii[:, 1]).sum())
    ending = place.suffix.lower()
    if ending == ".vtu":
        _vtu(model, place)
        return
    if ending not in writers:
        raise unknown_suffix(place, [*writers, ".vtu"], "beams")
    with replacing(place) as fresh:
        fresh.write_text("\n".join([*writers[ending](beams), ""]), encoding="utf-8")
    if tapers and ending in MEANS_ONLY:
        _log.warning("%s holds %s: %s lost", place.name, MEANS, counted(tapers, "taper"))


def _steep(model: BeamModel) -> Ints:
    return (np.abs(model.skeleton.directions[::2, 2]) > STEEP).astype(np.intp)


def _calculix(model: BeamModel) -> Iterator[str]:
    skeleton, (inner, chain) = model.skeleton, _pieces(model)
    yield "*NODE, NSET=NALL"
    for k, place in enumerate(np.concatenate([skeleton.nodes, inner]).tolist(), 1):
        yield f"{k}, " + ", ".join(f"{x:.12g}" for x in place)
    middle = (np.arange(PIECES) + 0.5) / PIECES
    ends = model.edge_radii[..., None]
    mean = ends[:, 0] * (1 - middle) + ends[:, 1] * middle  # (m, PIECES)
    radii, number = np.unique(np.round(mean, 9), return_inverse=True)
    kind = 2 * number.reshape(mean.shape) + _steep(model)[:, None]
    for one in np.unique(kind).tolist():
        yield f"*ELEMENT, TYPE=B32R, ELSET=S{one}"
        for e, piece in np.argwhere(kind == one).tolist():
            nodes = chain[e, 2 * piece : 2 * piece + 3].tolist()
            yield f"{PIECES * e + piece + 1}, " + ", ".join(str(k + 1) for k in nodes)
    material = model.material
    yield "*MATERIAL, NAME=M1"
    yield f"*ELASTIC\n{material.young:.12g}, {material.poisson:.12g}"
    yield f"*DENSITY\n{max(material.density * TONNES, 1e-30):.12g}"
    for one in np.unique(kind).tolist():
        radius = float(radii[one // 2])
        if model.hollow:
            yield f"*BEAM SECTION, SECTION=PIPE, ELSET=S{one}, MATERIAL=M1"
            yield f"{radius:.12g}, {radius * (1 - model.hollow):.12g}"
        else:
            yield f"*BEAM SECTION, SECTION=CIRC, ELSET=S{one}, MATERIAL=M1"
            yield f"{2 * radius:.12g}, {2 * radius:.12g}"
        yield "1., 0., 0." if one % 2 else "0., 0., -1."
    yield "*BOUNDARY"
    for node, freedom in np.argwhere(model.fixed).tolist():
        if model.displacement[node, freedom] == 0:
            yield f"{node + 1}, {freedom + 1}, {freedom + 1}"
    yield "*STEP\n*STATIC"
    moved = np.argwhere(model.fixed & (model.displacement != 0)).tolist()
    if moved:
        yield "*BOUNDARY"
    for node, freedom in moved:
        value = model.displacement[node, freedom]
        yield f"{node + 1}, {freedom + 1}, {freedom + 1}, {value:.12g}"
    yield "*CLOAD"
    for node, freedom in np.argwhere(model.forces).tolist():
        yield f"{node + 1}, {freedom + 1}, {model.forces[node, freedom]:.12g}"
    if model.gravity.any() and material.density:
        size = float(np.linalg.norm(model.gravity))
        way = ", ".join(f"{x:.12g}" for x in (model.gravity / size).tolist())
        yield "*DLOAD"
        for one in np.unique(kind).tolist():
            yield f"S{one}, GRAV, {1e3 * size:.12g}, {way}"
    yield "*NODE PRINT, NSET=NALL\nU, RF\n*NODE FILE, OUTPUT=2D\nU\n*EL FILE\nS\n*END STEP"


def _pieces(model: BeamModel) -> tuple[Points, Ints]:
    """Return points inside struts, and all those along each, from node to node.

    Returns
    -------
    inner : (m (2 PIECES - 1), 3) float64, mm
    chain : (m, 2 PIECES + 1) intp, nodes, and behind them inner points
    """
    skeleton, count = model.skeleton, 2 * PIECES - 1
    share = np.arange(1, count + 1) / (count + 1)
    start, end = np.moveaxis(skeleton.nodes[skeleton.edges][:, :, None], 1, 0)  # (m, 1, 3)
    inner = (start + share[:, None] * (end - start)).reshape(-1, 3)
    numbers = len(skeleton.nodes) + np.arange(len(inner)).reshape(-1, count)
    first, last = skeleton.edges[:, :1], skeleton.edges[:, 1:]
    return inner, np.concatenate([first, numbers, last], axis=1)


def _nastran(model: BeamModel) -> Iterator[str]:
    skeleton, material = model.skeleton, model.material
    yield "SOL 101\nCEND\nSPC = 1\nLOAD = 1\nDISPLACEMENT = ALL\nFORCE = ALL\nBEGIN BULK"
    for k, place in enumerate(skeleton.nodes.tolist(), 1):
        yield card("GRID", k, None, *place)
    yield card("MAT1", 1, material.young, None, material.poisson, material.density * TONNES)
    sections, number = np.unique(np.round(model.edge_radii, 9), axis=0, return_inverse=True)
    for k, ends in enumerate(sections.tolist(), 1):
        (a, b), hollow = ends, model.hollow
        yield f"PBEAML,{k},1,,{'TUBE' if hollow else 'ROD'}"
        first = f"{short(a)},{short(a * hollow)}" if hollow else short(a)
        last = f"{short(b)},{short(b * hollow)}" if hollow else short(b)
        yield f",{first},0.0,YES,1.0,{last},0.0"
    axes = np.where(_steep(model)[:, None], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0])
    rows = zip(number.reshape(-1).tolist(), skeleton.edges.tolist(), axes.tolist(), strict=True)
    for e, (section, (i, j), axis) in enumerate(rows, 1):
        yield f"CBEAM,{e},{section + 1},{i + 1},{j + 1}," + ",".join(f"{x:.1f}" for x in axis)
    for node in np.flatnonzero(model.fixed.any(axis=1)).tolist():
        for freedom in np.flatnonzero(model.fixed[node]).tolist():
            value = float(model.displacement[node, freedom])
            yield f"SPC,1,{node + 1},{freedom + 1},{short(value)}"
    for name, part in (("FORCE", slice(0, 3)), ("MOMENT", slice(3, 6))):
        for node in np.flatnonzero(model.forces[:, part].any(axis=1)).tolist():
            yield card(name, 1, node + 1, 0, 1.0, *model.forces[node, part].tolist())
    if model.gravity.any() and material.density:
        yield card("GRAV", 1, 0, 1e3, *model.gravity.tolist())
    yield "ENDDATA"


def _opensees(model: BeamModel) -> Iterator[str]:
    skeleton, material = model.skeleton, model.material
    yield "wipe\nmodel BasicBuilder -ndm 3 -ndf 6"
    for k, place in enumerate(skeleton.nodes.tolist(), 1):
        yield f"node {k} " + " ".join(f"{x:.15g}" for x in place)
    for node in np.flatnonzero(model.fixed.any(axis=1)).tolist():
        still = model.fixed[node] & (model.displacement[node] == 0)
        yield f"fix {node + 1} " + " ".join(str(int(x)) for x in still.tolist())
    yield "geomTransf Linear 1 0 0 1\ngeomTransf Linear 2 1 0 0"
    mean = sections_at(model.edge_radii, np.array([0.5]), model.hollow)
    area, inertia = mean.area[:, 0].tolist(), mean.inertia[:, 0].tolist()
    factor, shear = material.shear_factor(model.hollow), material.shear_modulus
    steep = _steep(model).tolist()
    for e, (i, j) in enumerate(skeleton.edges.tolist()):
        a, s = area[e], inertia[e]
        yield (
            f"element ElasticTimoshenkoBeam {e + 1} {i + 1} {j + 1} {material.young:.15g} "
            f"{shear:.15g} {a:.15g} {2 * s:.15g} {s:.15g} {s:.15g} "
            f"{factor * a:.15g} {factor * a:.15g} {steep[e] + 1}"
        )
    yield "timeSeries Linear 1\npattern Plain 1 1 {"
    total = model.forces - model.weight_at_nodes()
    for node in np.flatnonzero(total.any(axis=1)).tolist():
        yield f"  load {node + 1} " + " ".join(f"{x:.15g}" for x in total[node].tolist())
    for node, freedom in np.argwhere(model.fixed & (model.displacement != 0)).tolist():
        yield f"  sp {node + 1} {freedom + 1} {model.displacement[node, freedom]:.15g}"
    yield "}"
    yield "constraints Transformation\nnumberer RCM\nsystem UmfPack\nalgorithm Linear"
    yield "integrator LoadControl 1.0\nanalysis Static\nanalyze 1"


def _vtu(model: BeamModel | BeamSolution, path: Path) -> None:
    beams = model.model if isinstance(model, BeamSolution) else model
    at_nodes: dict[str, Any] = {"force": beams.forces[:, :3], "fixed": beams.fixed.astype(float)}
    at_struts: dict[str, Any] = {"radius": beams.edge_radii.mean(axis=1)}
    if isinstance(model, BeamSolution):
        at_nodes |= {
            "displacement": model.displacements,
            "rotation": model.rotations,
            "reaction": model.reactions[:, :3],
        }
        at_struts |= {
            "axial": model.axial.mean(axis=1),
            "stress": model.stresses,
            "utilization": model.utilization,
            "buckling": model.buckling_utilization,
        }
    write_meshio(
        path,
        beams.skeleton.nodes,
        [("line", beams.skeleton.edges)],
        at_points=at_nodes,
        at_cells={name: [values] for name, values in at_struts.items()},
    )
