"""Show what the package makes in an open OCP CAD Viewer, and say what that shows, as JSON.

`python tests/viewers/ocp_viewer_driver.py PORT PICTURE` expects a viewer with a browser at PORT.
"""

from __future__ import annotations

import json
import sys
import time

import build123d as bd
import numpy as np
import ocp_viewer

from scaffold_cad import build_scaffold, read_skeleton, round_struts, thicken
from scaffold_cad.viewers import show

PATIENCE = 60.0
"""How long a browser without a graphics card may take to show all, s."""

EXPECTED = ["skeleton", "scaffold", "frame", "rods", "plate"]


def main(port: int, picture: str) -> None:
    ocp_viewer.set_port(port)
    aside = np.array([40, 0, 0])
    skeleton = read_skeleton("examples/skeletons/stick_woman.json")
    scaffold = build_scaffold(skeleton)
    frame = thicken(build_scaffold(skeleton.moved(skeleton.nodes + aside)), 0.55)
    rods = round_struts(skeleton.moved(skeleton.nodes - aside))
    plate = bd.Pos(0, 0, -10) * bd.Box(140, 40, 3)
    plate.color = bd.Color("orange")
    for name in EXPECTED:
        show(locals()[name], name=name)
    until = time.monotonic() + PATIENCE
    names: list[str] = []
    while names != EXPECTED and time.monotonic() < until:
        time.sleep(0.5)
        names = [path.rsplit("/", 1)[-1] for path in ocp_viewer.status().get("states", {})]
    ocp_viewer.save_screenshot(picture, timeout_s=PATIENCE)
    print("\n" + json.dumps(names))


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2])
