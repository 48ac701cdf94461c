"""Molecules as balls and sticks: atoms are nodes, bonds edges, Å are taken as mm."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import LARGEST_COORDINATE, Edges, Floats
from scaffold_cad.errors import FormatError
from scaffold_cad.io._raw import RawSkeleton

BALL = 0.25
"""Radius of an atom's ball, in van der Waals radii, as in most ball-and-stick pictures."""

STICK = 0.15
"""Radius of a bond's stick, Å."""

SYMBOLS = (
    "H", "He", "Li", "Be", "B", "C", "N", "O", "F", "Ne", "Na", "Mg", "Al", "Si", "P", "S", "Cl",
    "Ar", "K", "Ca", "Sc", "Ti", "V", "Cr", "Mn", "Fe", "Co", "Ni", "Cu", "Zn", "Ga", "Ge", "As",
    "Se", "Br", "Kr", "Rb", "Sr", "Y", "Zr", "Nb", "Mo", "Tc", "Ru", "Rh", "Pd", "Ag", "Cd", "In",
    "Sn", "Sb", "Te", "I", "Xe", "Cs", "Ba", "La", "Ce", "Pr", "Nd", "Pm", "Sm", "Eu", "Gd", "Tb",
    "Dy", "Ho", "Er", "Tm", "Yb", "Lu", "Hf", "Ta", "W", "Re", "Os", "Ir", "Pt", "Au", "Hg", "Tl",
    "Pb", "Bi", "Po", "At", "Rn", "Fr", "Ra", "Ac", "Th", "Pa", "U", "Np", "Pu", "Am", "Cm",
)  # fmt: skip
"""Symbols of the elements, the first of atomic number 1."""

# Å; A. Bondi, van der Waals volumes and radii, 1964, and for metals R. S. Rowland, S. Alvarez 2013.
VAN_DER_WAALS = {
    "H": 1.20, "HE": 1.40, "LI": 1.82, "B": 1.92, "C": 1.70, "N": 1.55, "O": 1.52, "F": 1.47,
    "NE": 1.54, "NA": 2.27, "MG": 1.73, "AL": 1.84, "SI": 2.10, "P": 1.80, "S": 1.80, "CL": 1.75,
    "AR": 1.88, "K": 2.75, "CA": 2.31, "FE": 2.04, "CO": 2.00, "NI": 1.63, "CU": 1.40, "ZN": 1.39,
    "SE": 1.90, "BR": 1.85, "AG": 1.72, "CD": 1.58, "I": 1.98, "PT": 1.75, "AU": 1.66, "HG": 1.55,
}  # fmt: skip
OTHER_VAN_DER_WAALS = 2.0

# Å; B. Cordero et al., Covalent radii revisited, 2008.
COVALENT = {
    "H": 0.31, "B": 0.84, "C": 0.76, "N": 0.71, "O": 0.66, "F": 0.57, "SI": 1.11, "P": 1.07,
    "S": 1.05, "CL": 1.02, "SE": 1.20, "BR": 1.20, "I": 1.39,
}  # fmt: skip
OTHER_COVALENT = 1.4

BOND_SLACK = 0.45
"""How much longer a bond may be than both covalent radii, Å."""


@dataclass
class Molecule:
    """Atoms and bonds as a file has them."""

    elements: list[str] = field(default_factory=list)
    """Symbols, in any case."""
    places: list[Sequence[float]] = field(default_factory=list)
    """x, y, z of each atom, Å."""
    bonds: list[tuple[int, int]] = field(default_factory=list)
    """Pairs of atoms, counted from 0."""

    def skeleton(self, path: Path) -> RawSkeleton:
        """Return balls and sticks; a bond that is there twice is one.

        Raises
        ------
        FormatError
            If there is no atom.
        """
        if not self.elements:
            raise FormatError(f"{path} holds no atoms; need atoms and bonds")
        pairs = np.reshape(np.asarray(self.bonds, dtype=np.intp), (-1, 2))
        edges = np.unique(np.sort(pairs, axis=1), axis=0)
        balls = BALL * _sizes(self.elements, VAN_DER_WAALS, OTHER_VAN_DER_WAALS)
        return RawSkeleton(self.places, edges, balls, np.full(len(edges), STICK))


def bonds_by_distance(elements: Sequence[str], places: Sequence[Sequence[float]]) -> Edges:
    """Return the pairs of atoms that are as close as bonds are, shape (m, 2)."""
    points = np.reshape(np.asarray(places, dtype=np.float64), (-1, 3))
    radii = _sizes(elements, COVALENT, OTHER_COVALENT)
    if not len(points) or not (np.abs(points) <= LARGEST_COORDINATE).all():  # refused later
        return np.zeros((0, 2), dtype=np.intp)
    reach = 2 * float(radii.max()) + BOND_SLACK
    pairs = cKDTree(points).query_pairs(reach, output_type="ndarray")
    distance = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    near = distance <= radii[pairs].sum(axis=1) + BOND_SLACK
    found = np.sort(pairs[near], axis=1)
    return found[np.lexsort(found.T[::-1])]


def _sizes(elements: Sequence[str], known: dict[str, float], other: float) -> Floats:
    return np.array([known.get(element.strip().upper(), other) for element in elements])
