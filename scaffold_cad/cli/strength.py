"""`scaffold-cad strength`: what struts carry, as beams; and radii sized by it."""

from __future__ import annotations

import argparse
import json
import logging
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from scaffold_cad.base.files import check_page, check_target
from scaffold_cad.cli import sizes, source, strengthtiles, tiled
from scaffold_cad.cli.flags import told_as
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.io import written_suffixes
from scaffold_cad.io.write import check_writable, write

if TYPE_CHECKING:
    from scaffold_cad.mechanics import BeamModel, BeamSolution, Loading, Material, Sized
    from scaffold_cad.skeleton import Skeleton

SHOWN = 10
"""Struts in the table."""

NEAR = 1e-6
"""Distance from the skeleton's box within which a node is at its side, in diagonals."""

BEAM_ENDINGS = (".inp", ".bdf", ".tcl", ".vtu")
"""Endings that hold beam models; others get the skeleton."""

_log = logging.getLogger(__name__)


def add_parser(
    commands: argparse._SubParsersAction[argparse.ArgumentParser], common: argparse.ArgumentParser
) -> None:
    """Add this command to the command line."""
    parser = commands.add_parser(
        "strength",
        parents=[common],
        help="solve the struts as beams: displacements, stresses, buckling; size their radii",
        description="WHERE is xmin, xmax, ymin, ymax, zmin or zmax (the nodes at that side), node "
        "numbers from 0 such as 4,7,9, or a bound such as z<5. Linear beams with rigid joints: "
        "up to 40 percent too soft where struts are thick.",
    )
    source.add_arguments(parser)
    parser.add_argument(
        "--material", default="steel", help="steel, stainless, aluminum, titanium, pa12, pla, ..."
    )
    parser.add_argument("--young", type=float, metavar="E", help="Young's modulus instead, MPa")
    parser.add_argument(
        "--strength", type=float, metavar="S", help="stress that no strut may exceed instead, MPa"
    )
    parser.add_argument(
        "--fix",
        action="append",
        metavar="WHERE[:FREEDOMS]",
        help="nodes that are held; all their freedoms, or pinned, or some of x y z rx ry rz with "
        "commas (default: those of the file, or zmin)",
    )
    parser.add_argument(
        "--load",
        action="append",
        default=[],
        metavar="WHERE:FX,FY,FZ",
        help="force that these nodes share, N (default: the loads of the file)",
    )
    parser.add_argument("--weight", action="store_true", help="add the struts' weight, along -z")
    parser.add_argument(
        "--hollow", type=float, default=0.0, metavar="K", help="inner over outer radius of tubes"
    )
    parser.add_argument(
        "--size",
        type=float,
        metavar="RMIN",
        help="size the radii, so that no strut is overloaded, none below RMIN mm",
    )
    parser.add_argument(
        "--html", type=Path, metavar="PAGE", help="write a page of the struts by utilization"
    )
    parser.add_argument("--json", action="store_true", help="print results as JSON")
    parser.add_argument(
        "-o",
        "--output",
        type=sizes.path,
        metavar="OUT",
        help="write the beam model, .inp .bdf .tcl .vtu, or the skeleton with its radii, .json ...",
    )
    tiled.add_arguments(parser, of="stiffness and stresses")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Solve, print and write."""
    from scaffold_cad.mechanics import sized, write_beams, write_strength_page

    if options.tiles is not None:
        _solve_tiles(options)
        return
    tiled.refuse(options)
    if options.html is not None:
        check_page(options.html)
    if options.output is not None:
        _check_output(options.output)
    skeleton = source.skeleton_from(options)
    model = _model(options, skeleton)
    result = None
    if options.size is not None:
        with told_as(least_radius="--size"):
            result = sized(model, least_radius=options.size)
    solution = model.solved() if result is None else result.solution
    rows = _summary(solution, result)
    if options.json:
        print(json.dumps(rows | {"struts": _struts(solution)}, indent=1))
    else:
        _print_table(rows, solution)
    if options.html is not None:
        write_strength_page(solution, options.html)
        _log.info("%s written", options.html)
    if options.output is None:
        return
    if options.output.suffix.lower() in BEAM_ENDINGS:
        write_beams(solution, options.output)
    else:
        write(skeleton if result is None else result.skeleton, options.output)
    _log.info("%s written", options.output)


def _check_output(path: Path) -> None:
    """Raise unless beams or a skeleton can be written to a file."""
    suffix, skeletons = path.suffix.lower(), written_suffixes(skeleton=True)
    if suffix in BEAM_ENDINGS:
        check_target(path)
    elif suffix in skeletons:
        check_writable(path, skeleton=True)
    else:
        known = ", ".join(sorted({*BEAM_ENDINGS, *skeletons}))
        raise FormatError(f"{path} can hold neither a skeleton nor loaded beams; need {known}")


def _solve_tiles(options: argparse.Namespace) -> None:
    """Solve, print and write tile by tile."""
    strengthtiles.check(options)
    skeleton = source.skeleton_from(options)
    loading = _asked(options, skeleton)
    report = strengthtiles.solve(
        options, skeleton, _material(options), loading, gravity=_gravity(options)
    )
    if options.json:
        print(json.dumps(report, indent=1))
    else:
        strengthtiles.print_table(report)


def _model(options: argparse.Namespace, skeleton: Skeleton) -> BeamModel:
    from scaffold_cad.mechanics import beam_model

    asked = _asked(options, skeleton)
    return beam_model(
        skeleton,
        _material(options),
        asked.supports,
        asked.loads,
        gravity=_gravity(options),
        hollow=options.hollow,
    )


def _gravity(options: argparse.Namespace) -> tuple[float, float, float]:
    """Return the acceleration, m/s²."""
    return (0.0, 0.0, -9.81) if options.weight else (0.0, 0.0, 0.0)


def _asked(options: argparse.Namespace, skeleton: Skeleton) -> Loading:
    """Return the supports and loads that are asked for, of the options or of the file."""
    from scaffold_cad.mechanics import Load, Loading, Support

    loading = _loading(options, skeleton)
    supports, loads = list(loading.supports), list(loading.loads)
    if options.fix or not supports:
        supports = []
        for text in options.fix or ["zmin"]:
            where, _, freedoms = text.partition(":")
            supports.append(
                Support(_where(skeleton, where, "--fix"), freedoms.replace(",", " ") or "all")
            )
    if options.load:
        loads = []
        for text in options.load:
            where, _, force = text.rpartition(":")
            newtons = _force(text, force)
            loads.append(Load(_where(skeleton, where, "--load"), newtons))
    if not loads and not options.weight:
        raise OptionError("nothing loads the struts; need --load WHERE:FX,FY,FZ or --weight")
    return Loading(tuple(supports), tuple(loads))


def _loading(options: argparse.Namespace, skeleton: Skeleton) -> Loading:
    """Return the supports and loads of the input, unless the options replace both."""
    from scaffold_cad.mechanics import Loading, read_loading

    if options.fix and (options.load or options.weight):
        return Loading((), ())
    loading = read_loading(options.input, skeleton, units=options.units, scale=options.scale)
    for items, name, flag in (
        (loading.supports, "supports", options.fix),
        (loading.loads, "loads", options.load),
    ):
        if items and not flag:
            _log.info("%s of %s are used", name, options.input)
    return loading


def _material(options: argparse.Namespace) -> Material:
    from dataclasses import replace

    from scaffold_cad.mechanics.materials import as_material

    material = as_material(options.material)
    changes = {"young": options.young, "strength": options.strength}
    return replace(material, **{k: v for k, v in changes.items() if v is not None})


def _where(skeleton: Skeleton, text: str, flag: str) -> Any:
    """Return the nodes that the text of a flag names, by mark or by number."""
    from scaffold_cad.mechanics import Between

    word = text.strip().lower()
    nodes = skeleton.nodes
    near = NEAR * float(np.linalg.norm(np.ptp(nodes, axis=0)))
    if word[:1] in tuple("xyz") and word[1:] in ("min", "max"):
        values = nodes[:, "xyz".index(word[0])]
        if word[1:] == "min":
            return Between(word[0], high=float(values.min()) + near)
        return Between(word[0], low=float(values.max()) - near)
    try:
        if word[:1] in tuple("xyz") and word[1:2] in ("<", ">"):
            bound = float(word[2:])
            if word[1] == "<":
                return Between(word[0], high=float(np.nextafter(bound, -np.inf)))
            return Between(word[0], low=float(np.nextafter(bound, np.inf)))
        numbers = [int(number) for number in word.split(",")]
    except ValueError:
        raise OptionError(
            f"{flag} has nodes {text!r}; need xmin .. zmax, numbers such as 4,7,9 or a bound such "
            "as z<5"
        ) from None
    for number in numbers:
        if not 0 <= number < len(nodes):
            raise OptionError(f"{flag} names node {number}; need 0 to {len(nodes) - 1}")
    return numbers


def _force(text: str, force: str) -> list[float]:
    try:
        parts = [float(part) for part in force.split(",")]
    except ValueError:
        parts = []
    if len(parts) != 3 or not np.isfinite(parts).all():
        raise OptionError(f"--load is {text!r}; need WHERE:FX,FY,FZ, N, as in zmax:0,0,-50")
    return parts


def _summary(solution: BeamSolution, result: Sized | None) -> dict[str, Any]:
    """Return what is reported of the whole, in order."""
    rows: dict[str, Any] = {
        "struts": len(solution.model.skeleton.edges),
        "mass_kg": solution.mass,
        "largest_displacement_mm": solution.largest_displacement,
        "largest_stress_MPa": float(solution.stresses.max()),
        "stress_utilization": float(solution.stress_utilization.max()),
        "buckling_utilization": float(solution.buckling_utilization.max()),
        "overloaded_struts": int((solution.utilization > 1.0).sum()),
        "compliance_Nmm": solution.compliance,
    }
    if result is not None:
        rows["mass_before_kg"] = float(result.masses[0])
        rows["least_radius_mm"] = float(result.radii.min())
        rows["largest_radius_mm"] = float(result.radii.max())
    return {"strut_count" if name == "struts" else name: value for name, value in rows.items()}


def _struts(solution: BeamSolution) -> list[dict[str, float | int]]:
    """Return each strut's results."""
    axial = solution.axial.mean(axis=1).tolist()
    columns = zip(
        solution.model.edge_radii.tolist(),
        axial,
        solution.stresses.tolist(),
        solution.buckling_utilization.tolist(),
        solution.utilization.tolist(),
        strict=True,
    )
    return [
        {
            "edge": edge,
            "radius_start_mm": radii[0],
            "radius_end_mm": radii[1],
            "axial_N": force,
            "stress_MPa": stress,
            "buckling_utilization": buckling,
            "utilization": used,
        }
        for edge, (radii, force, stress, buckling, used) in enumerate(columns)
    ]


def _print_table(rows: dict[str, Any], solution: BeamSolution) -> None:
    width = max(len(name) for name in rows)
    for name, value in rows.items():
        shown = str(value) if isinstance(value, int) else f"{value:.5g}"
        print(f"{name.replace('_', ' '):<{width}}  {shown}")
    worst = np.argsort(-solution.utilization, kind="stable")[:SHOWN].tolist()
    print(f"\n{'edge':>8} {'axial N':>12} {'stress MPa':>11} {'buckling':>9} {'utilization':>12}")
    axial = solution.axial.mean(axis=1)
    for edge in worst:
        print(
            f"{edge:>8} {axial[edge]:>12.4g} {solution.stresses[edge]:>11.4g} "
            f"{solution.buckling_utilization[edge]:>9.3f} {solution.utilization[edge]:>12.3f}"
        )
