"""A spiral that leaves a node of valency 3 (figure 6 of the paper).

The section is carried over 35 joints by rotation-minimizing frames: it does not turn around the
spiral's axis, and its radius shrinks with the spiral.
"""

from pathlib import Path

from scaffold_cad import Scaffold, build_scaffold, read_skeleton, write

SKELETON = Path(__file__).parents[1] / "skeletons" / "spiral.json"


def make() -> Scaffold:
    """Return the scaffold of the spiral."""
    return build_scaffold(read_skeleton(SKELETON, strict=True))


if __name__ == "__main__":
    write(make(), "spiral.step")
    write(make(), "spiral.stl")
