"""A column of BCC cells with 128 million struts, cut into layers without a mesh.

Of its 250 000 layers five in the middle are written, as a Common Layer Interface file and as a
drawing.
"""

from pathlib import Path

from _common import out_folder

from scaffold_cad import PeriodicLattice, slices, write_layers

CELLS = (40, 40, 10_000)
"""Cells of 1 mm."""

HEIGHTS = [5000.02, 5000.06, 5000.1, 5000.14, 5000.18]
"""Of the layers, mm."""


def main(folder: Path) -> None:
    """Write some layers."""
    column = PeriodicLattice("bcc", 1.0, CELLS, radius=0.1)
    print(f"{column.strut_count} struts")
    for suffix in (".cli", ".svg"):
        path = folder / f"column{suffix}"
        write_layers(slices(column, HEIGHTS), path)
        print(f"{path}: {path.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main(out_folder(__doc__))
