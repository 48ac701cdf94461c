"""The macro for FreeCAD, run by FreeCAD where it is installed."""

from __future__ import annotations

import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

MACRO = Path(__file__).parents[1] / "examples" / "freecad" / "round_struts.FCMacro"
FREECAD = shutil.which("freecadcmd") or shutil.which("FreeCADCmd")

PROGRAM = """
import FreeCAD, Part
lines = [((0, 0, 0), (40, 0, 0)), ((20, 0, 0), (20, 0, 30))]
drawn = FreeCAD.newDocument("tee").addObject("Part::Feature", "Lines")
drawn.Shape = Part.makeCompound(
    [Part.makeLine(FreeCAD.Vector(*a), FreeCAD.Vector(*b)) for a, b in lines]
)
exec(compile(open({macro!r}).read(), "macro", "exec"))
made = FreeCAD.ActiveDocument.Struts.Shape
print("made:", made.isValid(), len(made.Solids), made.Volume)
"""


@pytest.mark.skipif(FREECAD is None, reason="needs FreeCAD")
def test_edges_in_freecad_become_a_solid(tmp_path: Path) -> None:
    command = tmp_path / "scaffold-cad"
    root = Path(__file__).parents[1]
    command.write_text(
        f'#!/bin/sh\nPYTHONPATH={root} exec {sys.executable} -m scaffold_cad "$@"\n', "utf-8"
    )
    command.chmod(0o755)
    program = tmp_path / "program.py"
    program.write_text(PROGRAM.format(macro=str(MACRO)), encoding="utf-8")
    known = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(
        [str(FREECAD), str(program)],
        env={**known, "SCAFFOLD_CAD": str(command)},
        input="",
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    told = [line.split() for line in done.stdout.splitlines() if line.startswith("made:")]
    assert told, done.stdout + done.stderr
    assert told[0][1:3] == ["True", "1"]
    # Two struts, one ending inside the other: their cylinders, and the fillet of the node.
    assert float(told[0][3]) == pytest.approx(math.pi * 1.5**2 * 69, rel=0.02)
