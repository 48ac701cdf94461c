"""Beam models solved by other programs, where they are installed."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

from scaffold_cad.mechanics import BeamModel


def opensees_displacements(path: Path, count: int) -> np.ndarray:
    """Return the displacements that OpenSees finds of a file's own commands."""
    ops = pytest.importorskip("openseespy.opensees", exc_type=(ImportError, RuntimeError))
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    for line in path.read_text().splitlines():
        name, *words = line.split()
        numbers = [w for w in words if re.fullmatch(r"-?[\d.]+(e[-+]?\d+)?", w)]
        values = [float(w) if re.search(r"[.e]", w) else int(w) for w in numbers]
        if name == "node":
            ops.node(values[0], *map(float, values[1:]))
        elif name == "fix":
            ops.fix(*values)
        elif name == "geomTransf":
            ops.geomTransf("Linear", values[0], *map(float, values[1:]))
        elif name == "element":
            tag, i, j, *sizes, turn = values
            ops.element(words[0], tag, i, j, *map(float, sizes), turn)
        elif name == "timeSeries":
            ops.timeSeries("Linear", 1)
        elif name == "pattern":
            ops.pattern("Plain", 1, 1)
        elif name == "load":
            ops.load(values[0], *map(float, values[1:]))
        elif name == "system":
            ops.system(*words)
    ops.constraints("Transformation")
    ops.numberer("RCM")
    ops.algorithm("Linear")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static")
    assert ops.analyze(1) == 0
    return np.array([ops.nodeDisp(k + 1) for k in range(count)])


def pynite_displacements(model: BeamModel) -> np.ndarray:
    """Return the displacements that PyNite finds of solid even struts."""
    pynite = pytest.importorskip("Pynite")
    material, skeleton = model.material, model.skeleton
    theirs = pynite.FEModel3D()
    theirs.add_material("m", material.young, material.shear_modulus, material.poisson, 0)
    for k, (place, fixed, forces) in enumerate(
        zip(skeleton.nodes.tolist(), model.fixed.tolist(), model.forces.tolist(), strict=True)
    ):
        theirs.add_node(f"n{k}", *place)
        theirs.def_support(f"n{k}", *fixed)
        for axis, force in zip("XYZ", forces[:3], strict=True):
            if force:
                theirs.add_node_load(f"n{k}", f"F{axis}", force)
    for k, (ends, radius) in enumerate(
        zip(skeleton.edges.tolist(), model.edge_radii[:, 0].tolist(), strict=True)
    ):
        if f"r{radius}" not in theirs.sections:
            area, inertia = np.pi * radius**2, np.pi / 4 * radius**4
            theirs.add_section(f"r{radius}", area, inertia, inertia, 2 * inertia)
        theirs.add_member(f"m{k}", f"n{ends[0]}", f"n{ends[1]}", "m", f"r{radius}")
    theirs.analyze_linear(sparse=True)
    return np.array(
        [
            [getattr(theirs.nodes[f"n{k}"], f"D{axis}")["Combo 1"] for axis in "XYZ"]
            for k in range(len(skeleton.nodes))
        ]
    )


def calculix_displacements(path: Path) -> dict[int, list[float]]:
    """Return the displacements that CalculiX finds of an input file, by number of node."""
    done = subprocess.run(
        ["ccx", path.stem],
        cwd=path.parent,
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    result = path.with_suffix(".dat")
    assert result.exists(), done.stdout[-2000:]
    table = result.read_text().split(" forces")[0]
    rows = [line.split() for line in table.splitlines() if re.match(r"\s+\d+\s", line)]
    return {int(row[0]): [float(x) for x in row[1:4]] for row in rows}
