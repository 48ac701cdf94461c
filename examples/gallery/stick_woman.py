"""The stick woman (figures 1 and 9 of the paper), dancing, and her scaffold as a frame.

The hem of her skirt is a loop; her nodes have valencies 1 to 4 and radii from 0.9 to 6 mm.
"""

from pathlib import Path

from scaffold_cad import Scaffold, build_scaffold, read_skeleton, thicken, write

SKELETON = Path(__file__).parents[1] / "skeletons" / "stick_woman.json"

WIRE = 0.55
"""Radius of the frame's struts, mm."""


def make() -> Scaffold:
    """Return her scaffold."""
    return build_scaffold(read_skeleton(SKELETON, strict=True))


if __name__ == "__main__":
    scaffold = make()
    write(scaffold, "stick_woman.step")
    write(scaffold, "stick_woman.stl")
    write(thicken(scaffold, WIRE), "stick_woman_frame.stl")
