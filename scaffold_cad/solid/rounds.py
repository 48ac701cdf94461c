"""Round struts as a watertight mesh: rings and bands, and fields where they are crowded.

What is written is what is proved. Beyond the proof of the smooth surface, the triangles of each
node are seen from the node from outside in the 32-bit coordinates of files, and polygons, which
reach beyond their circles, keep apart. Where one of these does not hold, the nodes and struts there
become part of a cluster, whose surface is that of a field solid, cut off across each strut that
leaves it.
"""

from __future__ import annotations

from scaffold_cad.base.arguments import as_count, check_kind
from scaffold_cad.base.arrays import Bools
from scaffold_cad.base.memory import MOST_MEMORY, machine_memory
from scaffold_cad.errors import OptionError
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.skeleton.checking import check_single_precision
from scaffold_cad.solid.clusters import surface_of, unseen
from scaffold_cad.solid.field.lattice import LEAST_STEPS
from scaffold_cad.struts.apart import Slack, crossings
from scaffold_cad.struts.meshes.bands import polygon_slack
from scaffold_cad.struts.meshes.fineness import Fineness
from scaffold_cad.struts.meshes.surface import Triangulated
from scaffold_cad.struts.model import RoundStruts
from scaffold_cad.struts.sharp.surface import without_triangles

SIDES = 16
"""Sides of round struts in meshes where none are given."""

MOST_SIDES = 8192
"""Most sides of the polygons that stand for circles: these are 7e-8 of their radius from the
circle, less than a step of 32-bit coordinates as large as the radius."""

FIELD_STEPS = 2.0 * LEAST_STEPS
"""Least radius in steps of 32-bit coordinates: fields make thinner struts as thick as that."""


TRIANGLE_BYTES = 250
"""What a triangle takes at least while a surface is made, measured."""


def round_mesh(struts: RoundStruts, sides: int = SIDES, factor: float = 1.0) -> TriangleMesh:
    """Return the surface of round struts, closed and without crossings in 32-bit coordinates.

    Parameters
    ----------
    sides : of the polygon that stands for a circle, a multiple of 4; it has the circle's area
    factor : what lengths are multiplied with in a file, in whose 32-bit numbers nothing crosses

    Raises
    ------
    OptionError
        If `struts` is not a RoundStruts, `sides` is not a multiple of 4, or the triangles do not
        fit into the memory of the machine.
    MeshError
        If struts are too thin for 32-bit coordinates so far from the origin.
    """
    check_kind(struts, RoundStruts)
    check_sides(sides)
    check_single_precision(struts.skeleton, FIELD_STEPS)
    _check_size(struts, sides)
    return surface_of(struts, sides, factor)


def faulty_runs(struts: RoundStruts, made: Triangulated, sides: int) -> Bools:
    """Return which runs have no sound triangles of their own, or end at a node that has none, (k,).

    Parameters
    ----------
    made : the triangles with this number of `sides`
    """
    faulty = struts.crowded | unseen(struts, made)
    faulty |= without_triangles(struts, sides)
    found = crossings(
        struts.runs,
        struts.blended,
        struts.curves,
        struts.collar,
        struts.options.ends,
        faulty,
        Slack(polygon_slack(sides), made.swell),
        sharp=struts.sharp,
    )
    runs = struts.crowded_runs | faulty[struts.runs.edges].any(axis=1)
    runs[found.runs] = True
    return runs


def check_sides(sides: int) -> None:
    """Check that `sides` is a number of sides that round struts can have."""
    if as_count(sides, "sides", 4) % 4:
        raise OptionError(f"sides is {sides}; need a multiple of 4")
    if sides > MOST_SIDES:
        raise OptionError(
            f"sides is {sides}; need at most {MOST_SIDES}, which files cannot tell from a circle"
        )


def _check_size(struts: RoundStruts, sides: int) -> None:
    """Raise if there is too little memory for the triangles of the nodes.

    Around each strut that leaves a node they are four grids of squares, see `Fineness`.
    """
    shells = [struts] if struts.inner is None else [struts, struts.inner]
    squares = 0
    for shell in shells:
        for group, grid in Fineness.of(shell, sides).parts(shell.blended):
            squares += 4 * group.half_runs.size * grid.steps * grid.levels
    triangles = 2 * squares
    most = MOST_MEMORY * machine_memory() / TRIANGLE_BYTES
    if triangles > most:
        fitting = int(sides * (most / triangles) ** 0.5) // 4 * 4
        raise OptionError(
            f"sides is {sides}; the nodes have some {triangles:.2g} triangles then, which need "
            f"{triangles * TRIANGLE_BYTES / 1e9:.2g} GB of memory or more; need "
            + (f"sides of at most {fitting} here" if fitting >= 4 else "fewer struts, or tiles")
        )
