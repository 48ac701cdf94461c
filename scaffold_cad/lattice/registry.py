"""The unit cells known by name, and how more of them are made known.

`namedcells` and `morecells` have those that are known from the start.
"""

from __future__ import annotations

from scaffold_cad.base.arguments import check_choice, check_kind, checks_keywords
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice.morecells import more_cells
from scaffold_cad.lattice.namedcells import named_cells
from scaffold_cad.lattice.repetition import repeated
from scaffold_cad.lattice.unitcell import UnitCell, check_periodic
from scaffold_cad.skeleton import check_skeleton

ALSO_CALLED = {
    "a15_foam": "weaire_phelan",
    "kagome_3d": "pyrochlore",
    "laves": "gyroid",
    "re_entrant": "auxetic",
    "sodalite": "kelvin",
    "srs": "gyroid",
    "truncated_octahedron": "kelvin",
}
"""Other names of cells."""


@checks_keywords()
def cells() -> dict[str, UnitCell]:
    """Return all known unit cells by name; `print` one to see what it is.

    Examples
    --------
    >>> from scaffold_cad import cells
    >>> cells()["bcc"].edges.shape
    (8, 2)
    """
    return dict(_CELLS)


def unit_cell(name: str) -> UnitCell:
    """Return the known unit cell called `name`; case does not matter, nor which of " -+_" it has.

    Raises
    ------
    OptionError
        If no cell has that name, or it is not text.
    """
    check_kind(name, str)
    key = ALSO_CALLED.get(_key(name), _key(name))
    if key not in _CELLS:
        check_choice(name, "unit cell", _CELLS)
    return _CELLS[key]


@checks_keywords()
def register_cell(cell: UnitCell, *, periodic: bool = True) -> None:
    """Make `cell` known by its name.

    Parameters
    ----------
    cell : unit cell
    periodic : whether neighboring cells must meet on all faces; without it, only that a
        lattice of it is a valid skeleton

    Raises
    ------
    OptionError
        If it is not a unit cell, or another one has that name.
    SkeletonError
        If the cell is not periodic, or a lattice of it is not a valid skeleton.

    Examples
    --------
    >>> from scaffold_cad import UnitCell, cells, register_cell
    >>> register_cell(UnitCell("pillar", [[0, 0, 0], [0, 0, 1]], [[0, 1]]), periodic=False)
    >>> "pillar" in cells()
    True
    """
    check_kind(cell, UnitCell)
    key = _key(cell.name)
    if key in _CELLS or key in ALSO_CALLED:
        raise OptionError(f"a unit cell called {key!r} exists already; need another name")
    if periodic:
        check_periodic(cell)
    check_skeleton(repeated(cell, cell.proportions, (2, 2, 2)).skeleton(1.0))
    _CELLS[key] = cell


def as_cell(cell: str | UnitCell) -> UnitCell:
    """Return `cell`, looked up if it is a name; refuse anything else."""
    if isinstance(cell, str):
        return unit_cell(cell)
    check_kind(cell, UnitCell, "name of one", name="cell")
    return cell


def _key(name: str) -> str:
    return name.strip().lower().translate(str.maketrans(" -+", "___"))


_CELLS = {cell.name: cell for cell in (*named_cells(), *more_cells())}
