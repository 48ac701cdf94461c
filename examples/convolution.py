"""A dog whose limbs blend into its body: a convolution surface on the quads of its scaffold.

The scaffold is subdivided, and its vertices are moved to where the skeleton's convolution field is
1. Written are the coarse scaffold and the surface as STL files.
"""

from pathlib import Path

import numpy as np
from _common import out_folder, save, skeleton

from scaffold_cad import QuadMesh, Scaffold, build_scaffold, catmull_clark
from scaffold_cad.convolution import ConvolutionField, project

WIDTH = 2.0
"""Width of the kernel, in radii: the wider, the softer the blends."""


def main(folder: Path) -> None:
    """Write the scaffold and the surface."""
    scaffold = build_scaffold(skeleton("dog"), collars=True)
    field = ConvolutionField(scaffold.skeleton, width=WIDTH)
    mesh = surface(scaffold, field)
    off = np.abs(field.value(mesh.vertices) - 1).max()
    print(f"{len(scaffold.mesh.quads)} quads became {len(mesh.quads)}; field within {off:.0e} of 1")
    save(scaffold, folder / "dog_scaffold.stl")
    save(mesh, folder / "dog.stl")


def surface(scaffold: Scaffold, field: ConvolutionField, levels: int = 2) -> QuadMesh:
    """Return the scaffold, its quads cut in four `levels` times, on the convolution surface."""
    coarse = scaffold.mesh
    fine = catmull_clark(coarse, levels, creases=coarse.edges).mesh
    return project(fine, field)


if __name__ == "__main__":
    main(out_folder(__doc__))
