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
    ("scaffold", "struts"),
    ("solid",),
    ("products",),
    ("layers", "webpage", "viewers", "filling"),
    ("io", "parts"),
    ("printability", "mechanics"),
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


def between_wings() -> set[tuple[str, str]]:
    """Return the wings that import others, (who, what), the named exceptions apart."""
    allowed = [one for one in imports() if (one.who, one.what) not in EXCEPTIONS]
    pairs = {(wing_of(one.who), wing_of(one.what)) for one in allowed}
    return {(who, what) for who, what in pairs if who != what}


def between_modules() -> set[tuple[str, str]]:
    """Return the modules that import others, (who, what), the named exceptions apart."""
    return {(one.who, one.what) for one in imports()} - EXCEPTIONS


def floors() -> list[list[str]]:
    """Return the wings by the longest chain of imports below each, as the imports show it."""
    left, pairs, found = set(FLOOR_OF), between_wings(), []
    while left:
        lowest = {wing for wing in left if not any((wing, other) in pairs for other in left)}
        if not lowest:  # the rest import one another in circles
            return [*found, sorted(left)]
        found.append(sorted(lowest))
        left -= lowest
    return found


def circles(pairs: set[tuple[str, str]]) -> list[list[str]]:
    """Return the sets of names that import one another in a circle."""
    names = sorted({name for pair in pairs for name in pair})
    place = {name: k for k, name in enumerate(names)}
    rows, columns = np.array([(place[who], place[what]) for who, what in sorted(pairs)]).T
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(len(names), len(names)))
    count, label = connected_components(graph, directed=True, connection="strong")
    members = [[names[k] for k in np.flatnonzero(label == one)] for one in range(count)]
    return [names for names in members if len(names) > 1]


def loose_modules() -> list[str]:
    """Return the modules that stand in no wing."""
    return [path.stem for path in sorted((ROOT / "scaffold_cad").glob("*.py"))]


def main() -> None:
    """Print what the imports show."""
    rooms = {(one.name, one.is_dir()) for one in (ROOT / "scaffold_cad").iterdir()}
    rooms = {name for name, folder in rooms if (folder or name.endswith(".py")) and name[0] != "_"}
    files = {(one.who, one.what) for one in imports()}
    upward = [one for one in imports() if not one.points_down]
    print(f"rooms {len(rooms)}, modules {len(modules())}, imports {len(files)}")
    print(f"loose modules: {', '.join(loose_modules())}")
    print(f"floors {len(floors())}, from the lowest: {' / '.join(map(' '.join, floors()))}")
    print(f"upward imports {len(upward)}: {', '.join(f'{i.who} -> {i.what}' for i in upward)}")
    print(f"circles across wings: {circles(between_wings()) or 'none'}")
    print(f"circles of modules: {circles(between_modules()) or 'none'}")


if __name__ == "__main__":
    main()
