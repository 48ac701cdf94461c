"""Homogenized cells: how stiff an endless lattice is, from the beams of one cell."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_number, checks_keywords
from scaffold_cad.base.arrays import Edges, Floats, Frozen, as_floats
from scaffold_cad.base.placements import DirectionLike, direction_of
from scaffold_cad.base.summaries import range_text
from scaffold_cad.base.vectors import sums_by_row
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice import UnitCell, cells, unit_cell
from scaffold_cad.mechanics.elements import beam_blocks
from scaffold_cad.mechanics.materials import Material, as_material
from scaffold_cad.mechanics.sections import as_hollow, end_stiffnesses

VOIGT_PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
"""Axes of strains and stresses in Voigt's order; shear strains are angles, twice the tensor's."""

SOFT = 1e-12
"""Stiffness of a motion, in those of the stiffest one, below which the cell does not resist it."""


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Homogenized(Frozen):
    """The elastic law of an endless lattice: stress = stiffness · strain, in Voigt's order.

    Young's moduli, shear moduli and the like are those of the lattice as a block of material.
    """

    cell: UnitCell
    """What is repeated."""
    size: Floats
    """Size of one cell, shape (3,), mm."""
    radius: float
    """Radius of its struts, mm."""
    material: Material
    """What they are made of."""
    stiffness: Floats
    """Stiffness in the order xx, yy, zz, yz, xz, xy, shape (6, 6), MPa."""
    relative_density: float
    """Volume of the struts over that of the cell; beams are counted from node to node."""

    def __str__(self) -> str:
        young = range_text(self.young(np.eye(3)), "MPa")
        size = " x ".join(f"{side:.6g}" for side in self.size)
        return (
            f"Homogenized: {self.cell.name} of {self.material.name or 'material'}, {size} mm, "
            f"radius {self.radius:.6g} mm, density {self.relative_density:.4g}, E {young}"
        )

    @cached_property
    def compliance(self) -> Floats:
        """Inverse of the stiffness, shape (6, 6), 1/MPa."""
        return np.asarray(np.linalg.inv(self.stiffness), dtype=np.float64)

    def young(self, directions: DirectionLike) -> Floats:
        """Return Young's modulus along each of `directions` (..., 3), of any length, MPa.

        Examples
        --------
        >>> octet = homogenized("octet", 0.1, "steel", size=10.0)
        >>> softer, stiffer = octet.young([[1, 0, 0], [1, 1, 1]])
        >>> bool(stiffer > softer)
        True
        """
        vectors = as_floats(direction_of(directions), "directions", OptionError)
        sizes = np.linalg.norm(vectors, axis=-1, keepdims=True)
        if vectors.shape[-1:] != (3,) or not (sizes > 0).all():
            raise OptionError("directions must be vectors (..., 3), none of length 0")
        stress = _voigt(vectors / sizes)  # (..., 6) of a unit pull
        modulus: Floats = 1.0 / np.einsum("...i,ij,...j->...", stress, self.compliance, stress)
        return modulus

    @property
    def young_axes(self) -> Floats:
        """Young's moduli along x, y and z, shape (3,), MPa."""
        return 1.0 / np.diag(self.compliance)[:3]

    @property
    def shear_axes(self) -> Floats:
        """Shear moduli in the planes yz, xz and xy, shape (3,), MPa."""
        return 1.0 / np.diag(self.compliance)[3:]

    @property
    def poisson(self) -> Floats:
        """Row i, column j: how much side j narrows over how much side i stretches, (3, 3)."""
        inner = self.compliance[:3, :3]
        ratios: Floats = -inner / np.diag(inner)[:, None]
        np.fill_diagonal(ratios, np.nan)
        return ratios

    @property
    def bulk(self) -> float:
        """Bulk modulus: pressure over the loss of volume under even pressure, MPa."""
        return float(1.0 / self.compliance[:3, :3].sum())

    @property
    def zener(self) -> float:
        """Anisotropy 2 C44 / (C11 − C12) by the means over the axes: 1 for an isotropic cell."""
        c = self.stiffness
        direct = np.diag(c)[:3].mean()
        cross = (c[0, 1] + c[0, 2] + c[1, 2]) / 3.0
        return float(2.0 * np.diag(c)[3:].mean() / (direct - cross))

    @property
    def maxwell(self) -> int:
        """Maxwell's count of the cell, see `UnitCell.maxwell_number`."""
        return self.cell.maxwell_number


@checks_keywords()
def homogenized(
    cell: str | UnitCell,
    radius: float,
    material: Material | str,
    *,
    size: ArrayLike = 1.0,
    hollow: float = 0.0,
    rigid_ends: float = 0.0,
) -> Homogenized:
    """Return the elastic law of an endless lattice of `cell`.

    One cell's struts are Timoshenko beams; its sites move alike in all cells, apart from the
    strain. Right for slender struts: at relative densities above some 10 % real nodes are
    stiffer, see `beam_model`.

    Parameters
    ----------
    cell : a unit cell or its name
    radius : of the struts, mm
    material : a Material, or the name of one in MATERIALS
    size : of one cell, mm: three numbers, or one for a cell that is not distorted
    hollow : inner over outer radius of tubes
    rigid_ends : length at both ends of each strut that does not deform, mm

    Raises
    ------
    OptionError
        If the cell is not known or a number is out of its range, or struts are so thick that
        their volumes come to that of the cell.

    References
    ----------
    Hutchinson, Fleck, The structural performance of the periodic truss, JMPS 54, 2006.

    Examples
    --------
    A slender simple cubic lattice has a third of its struts along a pull:

    >>> cubic = homogenized("sc", 0.1, "steel", size=10.0)
    >>> print(f"{cubic.young_axes[0] / (cubic.relative_density * 210e3):.4f}")
    0.3333
    """
    law = beam_law(cell, radius, material, size, hollow=hollow, rigid_ends=rigid_ends)
    density = law.relative_density
    if not density < 1:
        raise OptionError(
            f"radius is {law.radius:g} mm, which gives relative density {density:.3g}; need less "
            f"than {law.radius / density**0.5:.3g} mm for beams in cells of this size"
        )
    return law


def beam_law(
    cell: str | UnitCell,
    radius: float,
    material: Material | str,
    size: ArrayLike,
    *,
    hollow: float = 0.0,
    rigid_ends: float = 0.0,
) -> Homogenized:
    """Return the law of beams of any thickness, see `homogenized`."""
    cell = unit_cell(cell) if isinstance(cell, str) else cell
    law = as_material(material)
    radius = as_number(radius, "radius")
    sizes = _sizes(cell, size)
    motif = cell.motif
    ends = (motif.sites[motif.struts] + motif.moves) * sizes @ cell.axes  # (s, 2, 3)
    spans = ends[:, 1] - ends[:, 0]
    lengths = np.linalg.norm(spans, axis=1)
    rigid = np.full((len(spans), 2), as_number(rigid_ends, "rigid_ends", or_zero=True))
    if (rigid.sum(axis=1) >= 0.9 * lengths).any():
        raise OptionError(
            f"rigid_ends is {rigid_ends:g} mm; need less than {0.45 * lengths.min():g} mm"
        )
    ratio = as_hollow(hollow)
    stiffnesses = end_stiffnesses(lengths, np.full((len(spans), 2), radius), law, ratio, rigid)
    blocks = beam_blocks(spans, spans / lengths[:, None], stiffnesses)
    volume = cell.volume(sizes)
    stiffness = _condensed(motif.struts, blocks, spans, cell.site_count) / volume
    density = np.pi * radius**2 * (1.0 - ratio**2) * lengths.sum() / volume
    return Homogenized(cell, sizes, radius, law, (stiffness + stiffness.T) / 2.0, float(density))


def _condensed(struts: Edges, blocks: Floats, spans: Floats, count: int) -> Floats:
    """Return the energy of a unit of each strain while the sites find their places, (6, 6)."""
    # Strain moves a strut's second end against its first one.
    gaps = np.zeros((len(spans), 6, 6))
    for k, (i, j) in enumerate(VOIGT_PAIRS):
        gaps[:, i, k] += spans[:, j] * (1.0 if i == j else 0.5)
        if i != j:
            gaps[:, j, k] += spans[:, i] * 0.5
    pulls = blocks[:, :, 1] @ gaps[:, None]  # (s, 2, 6, 6)
    direct = np.einsum("sik,sij->kj", gaps, pulls[:, 1])
    pairs = struts[:, :, None] * count + struts[:, None, :]  # (s, 2, 2)
    matrix = sums_by_row(blocks, pairs, count**2).reshape(count, count, 6, 6)
    coupling = sums_by_row(pulls, struts, count)
    # Rotations in units of displacement over a strut's length, so that all entries compare.
    scale = np.tile(np.repeat([1.0, 1.0 / np.linalg.norm(spans, axis=1).mean()], 3), count)
    square = matrix.transpose(0, 2, 1, 3).reshape(6 * count, 6 * count) * np.outer(scale, scale)
    right = coupling.reshape(6 * count, 6) * scale[:, None]
    values, vectors = np.linalg.eigh(square)
    kept = values > SOFT * values[-1]  # the others are motions of the whole lattice
    along = vectors[:, kept].T @ right
    condensed: Floats = direct - along.T @ (along / values[kept, None])
    return condensed


def _sizes(cell: UnitCell, size: ArrayLike) -> Floats:
    given = as_floats(size, "size", OptionError)
    if given.shape not in {(), (3,)} or not (np.isfinite(given) & (given > 0)).all():
        raise OptionError(f"size is {given.tolist()} mm; need a number > 0, or three")
    sizes: Floats = given * cell.proportions if given.ndim == 0 else given
    return np.array(sizes)


def _voigt(units: Floats) -> Floats:
    """Return the stress of a unit pull along each row, in Voigt's order, (..., 6)."""
    return np.stack([units[..., i] * units[..., j] for i, j in VOIGT_PAIRS], axis=-1)


@checks_keywords()
@dataclass(frozen=True)
class CellRow:
    """A line of the table of cells."""

    name: str
    """Of the cell."""
    relative_density: float
    """Volume of the struts over that of the cell."""
    young: tuple[float, float, float]
    """Young's moduli along x, y, z, over density times the material's; no unit."""
    shear: tuple[float, float, float]
    """Shear moduli yz, xz, xy, over density times the material's Young's modulus; no unit."""
    poisson: float
    """How much z narrows when x is pulled, over how much x stretches."""
    bulk: float
    """Bulk modulus over density times the material's Young's modulus; no unit."""
    zener: float
    """Anisotropy, 1 for isotropic cells."""
    maxwell: int
    """Struts − 3 nodes − 3; below 0 the cell bends in some direction."""


@checks_keywords()
def cell_table(
    relative_density: float = 0.05, *, poisson: float = 0.3, names: tuple[str, ...] = ()
) -> list[CellRow]:
    """Return how stiff all known cells, or those named, are at one relative density.

    Parameters
    ----------
    relative_density : of thin struts, in (0, 1)
    poisson : ratio of the material

    Raises
    ------
    OptionError
        If the density or the ratio is out of its range or a name is not known.

    Examples
    --------
    >>> for row in cell_table(0.01, names=("sc", "octet")):
    ...     print(f"{row.name}: {row.young[0]:.3f}")
    sc: 0.333
    octet: 0.111
    """
    density = as_number(relative_density, "relative density", unit="")
    if not density < 1:
        raise OptionError(f"relative density is {density:g}; need more than 0, less than 1")
    law = Material(1.0, poisson)
    rows = []
    for name in names or tuple(cells()):
        cell = unit_cell(name)
        radius = float(np.sqrt(density / cell.density_coefficient))
        found = homogenized(cell, radius, law)
        x, y, z = (found.young_axes / density).tolist()
        yz, xz, xy = (found.shear_axes / density).tolist()
        rows.append(
            CellRow(
                name=cell.name,
                relative_density=density,
                young=(x, y, z),
                shear=(yz, xz, xy),
                poisson=float(found.poisson[0, 2]),
                bulk=found.bulk / density,
                zener=found.zener,
                maxwell=found.maxwell,
            )
        )
    return rows
