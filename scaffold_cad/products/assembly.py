"""Assembly: beam lattices and meshes that stand together, as a 3MF file builds them, and its solid.

This is the one place where the solid of a 3MF file is made.
"""

from __future__ import annotations

import logging
import operator
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import reduce
from typing import TYPE_CHECKING, overload

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_count, check_kind, checks_keywords
from scaffold_cad.base.arrays import Floats, Frozen
from scaffold_cad.base.summaries import counted
from scaffold_cad.errors import MeshError, OptionError
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.models import Make, Model, overlapping
from scaffold_cad.products.overlaps import Overlaps, to_unite
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.beams import BUTT, BeamLattice
from scaffold_cad.solid.beamsolids import beam_solid, solid_of_mesh, strut_solid, united
from scaffold_cad.solid.rounds import SIDES
from scaffold_cad.solid.solid import solidified
from scaffold_cad.struts import RoundStruts

if TYPE_CHECKING:
    from manifold3d import Manifold

_log = logging.getLogger(__name__)


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Assembly(Frozen):
    """Beam lattices and meshes in one space."""

    lattices: tuple[BeamLattice, ...]
    """Each with the mesh of its object, and what it is clipped to: a TriangleMesh or None."""
    meshes: tuple[TriangleMesh, ...]
    """Objects without beams."""
    beams_left_out: int
    """Beams of the file it was read from that have no length, or no radius > 0."""

    def __init__(
        self,
        lattices: Iterable[BeamLattice] = (),
        meshes: Iterable[TriangleMesh] = (),
        beams_left_out: int = 0,
    ) -> None:
        self._keep(lattices=tuple(lattices), meshes=tuple(meshes), beams_left_out=beams_left_out)
        for lattice in self.lattices:
            check_kind(lattice, BeamLattice)
        for mesh in self.meshes:
            check_kind(mesh, TriangleMesh)

    def __str__(self) -> str:
        beams = counted(self.beam_count, "beam")
        lattices = counted(len(self.lattices), "lattice")
        meshes = counted(len(self.meshes), "mesh", "meshes")
        return f"Assembly: {beams} in {lattices}, {meshes}"

    @property
    def beam_count(self) -> int:
        """Number of beams of all lattices."""
        return sum(len(lattice.skeleton.edges) for lattice in self.lattices)

    @property
    def is_skeleton(self) -> bool:
        """Whether a skeleton holds all of it: beams with spheres at their ends, nothing else."""
        return not self.beyond_skeleton() and bool(self.lattices)

    def whole_beams(self) -> Skeleton | None:
        """Return the beams of all lattices as one skeleton; None if some are clipped."""
        if not self.lattices or any(one.clip is not None for one in self.lattices):
            return None
        return reduce(operator.add, (one.skeleton for one in self.lattices))

    def transformed(self, rows: ArrayLike) -> Assembly:
        """Return all of it turned, mirrored and scaled alike in all directions.

        Parameters
        ----------
        rows : (3, 3), where the unit vectors along x, y and z come to lie

        Raises
        ------
        OptionError
            If the rows are not at right angles, or not of one length.

        Examples
        --------
        >>> from scaffold_cad import BeamLattice, Skeleton
        >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
        >>> twice = Assembly([BeamLattice(strut)]).transformed([[0, 2, 0], [-2, 0, 0], [0, 0, 2]])
        >>> twice.lattices[0].skeleton.nodes.tolist(), twice.lattices[0].skeleton.radii.tolist()
        ([[0.0, 0.0, 0.0], [0.0, 18.0, 0.0]], [2.0, 2.0])
        """
        turn = np.asarray(rows, dtype=np.float64)
        factor = float(np.linalg.norm(turn[0]))
        if turn.shape != (3, 3) or not np.allclose(turn @ turn.T, np.eye(3) * factor**2):
            raise OptionError(
                f"rows are {turn.tolist()}; need three of one length, at right angles"
            )
        return Assembly(
            [_transformed(lattice, turn, factor) for lattice in self.lattices],
            [_turned_mesh(mesh, turn) for mesh in self.meshes],
            self.beams_left_out,
        )

    def with_skeletons(self, change: Callable[[Skeleton], Skeleton]) -> Assembly:
        """Return it with the beams of each lattice changed; what is beside them stays.

        Balls and flat ends stay where the edges do; where `change` makes others they go, and the
        log says so.
        """
        lattices = [_with_skeleton(lattice, change(lattice.skeleton)) for lattice in self.lattices]
        return Assembly(lattices, self.meshes, self.beams_left_out)

    def beyond_skeleton(self) -> list[str]:
        """Return in words what a skeleton of the beams does not keep; nothing if it keeps all."""
        flat = self.flat_ends
        return [*self.beside_beams(), *([f"{counted(flat, 'flat end')} of beams"] if flat else [])]

    @property
    def flat_ends(self) -> int:
        """Number of ends of beams that are flat, where others are balls."""
        return sum(int((one.caps == BUTT).sum()) for one in self.lattices)

    def beside_beams(self) -> list[str]:
        """Return in words what there is beside the beams: meshes, clipping and balls."""
        meshes = [*self.meshes, *(one.mesh for one in self.lattices if one.mesh is not None)]
        found = []
        if meshes:
            triangles = sum(len(mesh.triangles) for mesh in meshes)
            found.append(
                f"{counted(len(meshes), 'mesh', 'meshes')} of {counted(triangles, 'triangle')}"
            )
        for clipping in ("inside", "outside"):
            clipped = [o for o in self.lattices if o.clip is not None and o.clipping == clipping]
            if clipped:
                lattices = counted(len(clipped), "lattice")
                found.append(f"the clipping of {lattices} (what is {clipping} stays)")
        balls = sum(int((one.balls > 0).sum()) for one in self.lattices)
        if balls:
            found.append(counted(balls, "ball"))
        return found


def _transformed(lattice: BeamLattice, turn: Floats, factor: float) -> BeamLattice:
    """Return a lattice and its meshes turned by rows of the length `factor`."""
    nodes = lattice.skeleton.nodes @ turn
    return replace(
        lattice,
        skeleton=lattice.skeleton.scaled(factor).moved(nodes),
        balls=lattice.balls * factor,
        clip=_turned_mesh(lattice.clip, turn),
        mesh=_turned_mesh(lattice.mesh, turn),
        representation=_turned_mesh(lattice.representation, turn),
    )


@overload
def _turned_mesh(mesh: TriangleMesh, turn: Floats) -> TriangleMesh: ...


@overload
def _turned_mesh(mesh: None, turn: Floats) -> None: ...


def _turned_mesh(mesh: TriangleMesh | None, turn: Floats) -> TriangleMesh | None:
    """Return a mesh turned, its outside outside also where it is mirrored."""
    if mesh is None:
        return None
    triangles = mesh.triangles if np.linalg.det(turn) > 0 else mesh.triangles[:, ::-1]
    return TriangleMesh(mesh.vertices @ turn, triangles)


def _with_skeleton(lattice: BeamLattice, skeleton: Skeleton) -> BeamLattice:
    """Return a lattice of other beams, with what is beside them."""
    if np.array_equal(skeleton.edges, lattice.skeleton.edges):
        return replace(lattice, skeleton=skeleton)
    lost = [
        counted(number, name)
        for name, number in (
            ("ball", int((lattice.balls > 0).sum())),
            ("flat end", int((lattice.caps == BUTT).sum())),
        )
        if number
    ]
    if lost:
        _log.warning("left out %s, as beams are changed", " and ".join(lost))
    return BeamLattice(skeleton, 0.0, lattice.clip, lattice.mesh, clipping=lattice.clipping)


@checks_keywords()
def assembly_solid(
    assembly: Assembly,
    sides: int = SIDES,
    *,
    flat_joints: bool = False,
    make: Make | None = None,
    overlaps: Overlaps = "unite",
) -> Manifold:
    """Return the solid of an assembly: all beams, clipped, and all meshes, united.

    Parameters
    ----------
    sides : ≥ 4, of the beams, whose sections have the area of their circles; a multiple of 4 for
        round struts
    flat_joints : whether beams with flat ends (cap "butt") have them where they meet other beams
        too, as the standard has it literally: that leaves notches between them. By default
        only free ends are flat, and beams meet in spheres
    make : what makes a RoundStruts or a Scaffold of a skeleton, such as `round_struts`, to stand
        for the beams, with blends and ends as it gives them; by default beams are cones between
        spheres, as the standard has them
    overlaps : of what `make` makes, see `write`: "unite" or "refuse"

    Raises
    ------
    MeshError
        If a mesh is not closed, every union tried crosses itself, or nothing is left of it.
    BrepError
        If struts overlap and are refused.
    OptionError
        If `sides` is less than 4, or `overlaps` is "allow".
    MissingBackendError
        If manifold3d is not installed.

    Examples
    --------
    >>> from scaffold_cad import BeamLattice, Skeleton
    >>> from scaffold_cad.products.assembly import Assembly, assembly_solid
    >>> strut = Skeleton([[0, 0, 0], [0, 0, 10]], [[0, 1]], 1.0)
    >>> solid = assembly_solid(Assembly([BeamLattice(strut, caps="butt")]))
    >>> round(solid.volume(), 3)
    31.416

    >>> from scaffold_cad import TriangleMesh, round_struts
    >>> corners = [[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]]
    >>> clip = TriangleMesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> clipped = Assembly([BeamLattice(strut, clip=clip)])
    >>> assembly_solid(clipped, make=round_struts).volume() < 31.416 / 4  # a quarter is inside
    True
    """
    check_kind(assembly, Assembly)
    as_count(sides, "sides", least=4)
    if make is None:
        parts = [beam_solid(lattice, sides, flat_joints) for lattice in assembly.lattices]
    else:
        parts = [_strut_solid(lattice, sides, make, overlaps) for lattice in assembly.lattices]
    parts += [solid_of_mesh(mesh) for mesh in assembly.meshes]
    solid = united([part for part in parts if not part.is_empty()]) if parts else None
    if solid is None or solid.is_empty():
        raise MeshError("nothing is left of the beams and meshes; need a solid")
    return solid


def log_united(assembly: Assembly, path: str) -> None:
    """Log what of a file is one solid with the beams, if there is anything, and what is not."""
    if assembly.beams_left_out:
        what = counted(assembly.beams_left_out, "beam")
        _log.warning("%s: left out %s without a length or a radius > 0", path, what)
    beside = ", ".join(assembly.beside_beams())
    if beside:
        _log.info("%s: %s united with %s", path, counted(assembly.beam_count, "beam"), beside)


def models_of(assembly: Assembly, make: Make) -> list[Model]:
    """Return the struts that stand for each lattice's beams, whose skeleton is repaired before."""
    found = []
    for lattice in assembly.lattices:
        cleaning = lattice.skeleton.cleaned()
        if cleaning.repairs.total:
            _log.warning("beams were repaired: %s", cleaning.repairs)
        found.append(make(cleaning.skeleton))
    return found


def _strut_solid(lattice: BeamLattice, sides: int, make: Make, overlaps: Overlaps) -> Manifold:
    """Return the solid of struts that stand for beams, clipped, and of what is beside them."""
    if overlaps == "allow":
        raise OptionError(
            "overlaps is 'allow' for struts that are united with others; need 'unite' or 'refuse'"
        )
    (model,) = models_of(Assembly([lattice]), make)
    if overlaps == "refuse":
        to_unite(overlaps, overlapping(model), model.skeleton)
    made = solidified(model, sides=sides if isinstance(model, RoundStruts) else None)
    to_unite(overlaps, made.united_edges, model.skeleton)
    return strut_solid(lattice, made.manifold, sides)
