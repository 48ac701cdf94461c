"""A simple tree with unit radii (figure 7 of the paper).

Three branch points of valency 4 and one of valency 3: four quads per edge and one per extremity.
"""

from pathlib import Path

from _common import out_folder, save, skeleton

from scaffold_cad import build_scaffold


def main(folder: Path) -> None:
    """Write the scaffold of the tree."""
    tree = skeleton("tree")
    scaffold = build_scaffold(tree)
    quads, edges, ends = len(scaffold.mesh.quads), len(tree.edges), len(tree.extremities)
    print(f"{quads} quads = 4 x {edges} edges + {ends} extremities")
    save(scaffold, folder / "tree.step")
    save(scaffold, folder / "tree.stl")


if __name__ == "__main__":
    main(out_folder(__doc__))
