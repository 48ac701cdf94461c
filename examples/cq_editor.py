"""A lamp: a plate, three struts on it that meet, and a shade of lattice where they end.

`cq-editor examples/cq_editor.py` shows it, with its scaffold and the frame of that beside it, and
so does any other viewer that `show` finds. `python examples/cq_editor.py --out DIR` writes its
foot to a STEP file.
"""

import numpy as np
from build123d import Axis, BuildPart, Cylinder, Edge, Location, Locations, RigidJoint

from scaffold_cad import Skeleton, build_scaffold, thicken
from scaffold_cad.parts import LatticeBox, RoundStrutsSolid
from scaffold_cad.viewers import show

leg = Edge.make_three_point_arc((30, 0, 0), (22, 0, 40), (0, 0, 60))
legs = [leg.rotate(Axis.Z, turn) for turn in (0, 120, 240)]
neck = Edge.make_line((0, 0, 60), (0, 0, 85))
skeleton = Skeleton.from_edges([*legs, neck], radius=3.0, tolerance=1.0)

with BuildPart() as foot:
    with Locations((0, 0, -2)):
        Cylinder(radius=45, height=6)
    struts = RoundStrutsSolid(skeleton)

shade = LatticeBox("kelvin", 30, 30, 30, 30, radius=1.5, label="shade", color="orangered")
(top,) = [joint for joint in struts.joints.values() if joint.location.position.Z > 80]
top.connect_to(RigidJoint("below", shade, Location((0, 0, -15))))

if __name__ == "__main__":  # not in CQ-editor
    from _common import out_folder, save

    save(foot.part, out_folder(__doc__) / "lamp_foot.step")
else:
    aside = np.array([0, 90, 0])
    scaffold = build_scaffold(skeleton.moved(skeleton.nodes + aside))
    frame = thicken(build_scaffold(skeleton.moved(skeleton.nodes - aside)), 1.0)
    show(foot)
    show(shade)
    show(skeleton)
    show(scaffold)
    show(frame)
