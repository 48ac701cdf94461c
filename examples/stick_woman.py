"""The stick woman (figures 1 and 9 of the paper), dancing.

The hem of her skirt is a loop; her nodes have valencies 1 to 4 and radii from 0.9 to 6 mm. Written
are her scaffold as a STEP solid and as an STL file, and the scaffold's edges as a frame of struts.
"""

from pathlib import Path

from _common import out_folder, save, skeleton

from scaffold_cad import build_scaffold, thicken

WIRE = 0.55
"""Radius of the frame's struts, mm."""


def main(folder: Path) -> None:
    """Write the scaffold and the frame."""
    scaffold = build_scaffold(skeleton("stick_woman"))
    save(scaffold, folder / "stick_woman.step")
    save(scaffold, folder / "stick_woman.stl")
    save(thicken(scaffold, WIRE), folder / "stick_woman_frame.stl")


if __name__ == "__main__":
    main(out_folder(__doc__))
