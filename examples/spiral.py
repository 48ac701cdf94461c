"""A spiral that leaves a node of valency 3 (figure 6 of the paper).

The section is carried over 35 joints by rotation-minimizing frames: it does not turn around the
spiral's axis, and its radius shrinks with the spiral.
"""

from pathlib import Path

from _common import out_folder, save, skeleton

from scaffold_cad import build_scaffold


def main(folder: Path) -> None:
    """Write the scaffold of the spiral."""
    scaffold = build_scaffold(skeleton("spiral"))
    save(scaffold, folder / "spiral.step")
    save(scaffold, folder / "spiral.stl")


if __name__ == "__main__":
    main(out_folder(__doc__))
