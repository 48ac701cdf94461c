"""The order of the package's wings, and a count of what its own imports show.

`python -m tests.wings` prints the counts.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

ROOT = Path(__file__).parents[1]

FLOORS = (
    ("errors",),
    ("base",),
    ("mesh", "skeleton"),
    ("lattice", "partition", "convolution", "brep"),
    ("scaffold",),
    ("struts",),
    ("solid",),
    ("products",),
    ("layers",),
    ("io",),
    ("webpage", "viewers", "filling"),
    ("parts", "printability", "mechanics"),
    ("tiles",),
    ("cli",),
)
"""Wings from the bottom up. A wing imports those below it, and none beside it."""

EXCEPTIONS = {
    # Skeletons of build123d's edges and back: an optional back end, imported when it is asked for.
    ("scaffold_cad.skeleton.skeleton", "scaffold_cad.brep.wires"),
}
"""Imports that point up, (who, what)."""

FLOOR_OF = {wing: floor for floor, wings in enumerate(FLOORS) for wing in wings}


@dataclass(frozen=True)
class Import:
    """A module of the package and another that it imports, anywhere in its text."""

    who: str
    what: str

    @property
    def points_down(self) -> bool:
        """Whether it stays in its wing or goes to one below it."""
        who, what = wing_of(self.who), wing_of(self.what)
        return who == what or FLOOR_OF[what] < FLOOR_OF[who]


def modules() -> dict[str, Path]:
    """Return the path of each module of the package by its dotted name."""
    found = {}
    for path in sorted((ROOT / "scaffold_cad").rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def wing_of(module: str) -> str:
    """Return the wing of a module: the first name below the package's."""
    return module.split(".")[1]


def imports() -> list[Import]:
    """Return all imports between modules below the package's own, those in functions included."""
    known = modules()
    found = set()
    for who, path in known.items():
        if who.count(".") < 1 or who == "scaffold_cad.__main__":
            continue
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            found |= {Import(who, what) for what in _imported(node, known) if what != who}
    return sorted(found, key=lambda one: (one.who, one.what))


def _imported(node: ast.AST, known: dict[str, Path]) -> list[str]:
    names: list[str] = []
    if isinstance(node, ast.Import):
        names = [alias.name for alias in node.names]
    elif isinstance(node, ast.ImportFrom) and node.module:
        inner = [f"{node.module}.{alias.name}" for alias in node.names]
        names = [name if name in known else node.module for name in inner]
    elif isinstance(node, ast.Call) and "import_module" in ast.unparse(node.func):
        names = [arg.value for arg in node.args if isinstance(arg, ast.Constant)]
    return [name for name in names if name in known and name.count(".") >= 1]


def circles() -> list[list[str]]:
    """Return the sets of wings that import one another in a circle."""
    wings = sorted(FLOOR_OF)
    pairs = {
        (wings.index(wing_of(one.who)), wings.index(wing_of(one.what)))
        for one in imports()
        if (one.who, one.what) not in EXCEPTIONS and wing_of(one.who) != wing_of(one.what)
    }
    rows, columns = np.array(sorted(pairs)).T
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(len(wings), len(wings)))
    count, label = connected_components(graph, directed=True, connection="strong")
    members = [[wings[k] for k in np.flatnonzero(label == one)] for one in range(count)]
    return [wings for wings in members if len(wings) > 1]


def loose_modules() -> list[str]:
    """Return the modules that stand in no wing."""
    return [path.stem for path in sorted((ROOT / "scaffold_cad").glob("*.py"))]


def main() -> None:
    """Print what the imports show."""
    upward = [one for one in imports() if not one.points_down]
    print(f"wings {len(FLOOR_OF)}, floors {len(FLOORS)}, imports {len(imports())}")
    print(f"loose modules: {', '.join(loose_modules())}")
    print(f"upward imports {len(upward)}: {', '.join(f'{i.who} -> {i.what}' for i in upward)}")
    print(f"circles across wings: {circles() or 'none'}")


if __name__ == "__main__":
    main()
