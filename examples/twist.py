"""Twist spread over a branch, or left in its last row of quads (figure 5 of the paper).

Rotation-minimizing frames carry the section of one fork along a branch that bends in space; at the
other fork it meets a quad that it fits only when turned. The paper leaves that turn, the twist, in
the last row of quads; `build_scaffold` spreads it evenly. Both are written, to be compared.
"""

from pathlib import Path

import numpy as np
from _common import out_folder, save, skeleton

from scaffold_cad import QuadMesh, Scaffold, build_scaffold, rotation_minimizing_frames


def main(folder: Path) -> None:
    """Write the branch both ways."""
    scaffold = build_scaffold(skeleton("bend"))
    twist = np.degrees(np.abs(scaffold.twist).max())
    rows = len(scaffold.skeleton.joints) + 1
    print(f"{twist:.1f}° of twist over {rows} rows: {twist / rows:.1f}° a row, or all in the last")
    save(scaffold, folder / "twist_spread.step")
    save(with_twist_in_last_row(scaffold), folder / "twist_in_last_row.step")


def with_twist_in_last_row(scaffold: Scaffold) -> QuadMesh:
    """Return the mesh with the section of the first joint carried to the last one untwisted."""
    joints = scaffold.skeleton.joints
    nodes = scaffold.skeleton.nodes[joints]
    frames = rotation_minimizing_frames(nodes)
    corners = np.stack([np.flatnonzero(scaffold.node_of_vertex == joint) for joint in joints])
    vertices = scaffold.mesh.vertices.copy()
    section = (vertices[corners[0]] - nodes[0]) @ frames[0].T
    vertices[corners] = nodes[:, None, :] + section @ frames
    return scaffold.mesh.moved(vertices)


if __name__ == "__main__":
    main(out_folder(__doc__))
