"""What objects print as: one short line with counts and sizes."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np
import pytest

from scaffold_cad import (
    BeamLattice,
    Field,
    PeriodicLattice,
    PointField,
    build_scaffold,
    catmull_clark,
    round_struts,
    slices,
    smooth_patches,
)
from scaffold_cad.base.arrays import Frozen
from scaffold_cad.convolution import ConvolutionField
from scaffold_cad.io import RawSkeleton
from scaffold_cad.lattice import BoxMap, lattice_on
from scaffold_cad.mechanics import Load, Loading, Support, beam_model, hexahedra, homogenized, sized
from scaffold_cad.partition import certify, partition_spheres
from scaffold_cad.products.assembly import Assembly
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.field import field_solid, skeleton_struts
from scaffold_cad.tiles import tiles
from tests.meshes import CUBE
from tests.skeletons import TRIPOD
from tests.test_public import CALLABLES

UPRIGHT = round_struts(Skeleton([[0, 0, 0], [0, 0, 9]], [[0, 1]], 1.0))
MAPPED = lattice_on(BoxMap([8, 8, 4]), "bcc", radius=0.3, counts=(2, 2, 1))
MODEL = beam_model(TRIPOD, "steel", Support([1, 2]), Load([3], (1.0, 0, 0)))
SPHERES = partition_spheres(np.eye(4, 3)[None] - np.array([0.3, 0.2, 0.25]))
SPHERE = SPHERES[0]
FIELD = skeleton_struts(TRIPOD)
NARROW = Skeleton([[0, 0, 0], [9, 0, 0], [9, 0.1, 0.2]], [[0, 1], [0, 2]], 1.0)


@pytest.mark.parametrize(
    ("thing", "begin"),
    [
        (slices(UPRIGHT, thickness=0.5), "Layers: 18, 0.5 mm thick, "),
        (slices(UPRIGHT, [3.0]), "Layers: 1, sections, "),
        (PointField([[0, 0, 0], [9, 0, 0]], [1.0, 3.0]), "PointField: 2 points, 9 x 0 x 0 mm, "),
        (
            PeriodicLattice("bcc", 8.0, 2, radius=0.5),
            "PeriodicLattice: 2 x 2 x 2 cells of bcc, each 8 x 8 x 8 mm, 64 struts",
        ),
        (BeamLattice(TRIPOD, balls=2.0), "BeamLattice: 3 beams, 4 balls, "),
        (Assembly([BeamLattice(TRIPOD)], []), "Assembly: 3 beams in 1 lattice, 0 meshes"),
        (Field(np.ones((2, 2, 1)), [[0, 0, 0], [9, 4, 0]]), "Field: 2 x 2 x 1 values, 9 x 4 x 0"),
        (RawSkeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]]), "RawSkeleton: 2 nodes, 1 edge, 9 x 0 x 0"),
        (Loading((Support([0]),), ()), "Loading: 1 support, 0 loads"),
        (catmull_clark(CUBE, 1), "Subdivision: QuadMesh: 26 vertices, 24 quads, "),
        (smooth_patches(CUBE), "Patches: 6 patches, 0 flat, "),
        (FIELD, "FieldStruts: 3 struts, "),
        (field_solid(FIELD), "FieldSolid: "),
        (build_scaffold(TRIPOD).embedding(), "Embedding: certified"),
        (build_scaffold(NARROW).embedding(), "Embedding: 2 of 2 struts and 0 nodes left out"),
        (hexahedra(build_scaffold(TRIPOD)), "Hexahedra: 12 with 39 points, "),
        (TRIPOD.cleaned(), f"{TRIPOD}; repaired: nothing"),
        (next(slices(UPRIGHT, [3.0])), "Layer: at 3 mm, 0 mm thick, 1 polygons, "),
        (BoxMap([8, 8, 4]), "BoxMap: about 8 x 8 x 4 mm along u, v and w"),
        (MAPPED, "MappedLattice: 2 x 2 x 1 cells, "),
        (MODEL, "BeamModel: 3 struts of steel, "),
        (MODEL.solved(), "BeamSolution: 3 struts, moved by up to "),
        (
            sized(MODEL, least_radius=0.5, steps=2, least_mass=False),
            "Sized: 3 struts, radius ",
        ),
        (
            homogenized("bcc", 0.5, "steel", size=10.0),
            "Homogenized: bcc of steel, 10 x ",
        ),
        (SPHERE, "Partition: 4 quads by dual, relative clearance "),
        (SPHERES, "Partitions: 1 of 4 quads, relative clearance "),
        (
            certify(SPHERES.directions, SPHERES.vertices, SPHERES.quads),
            "Certificate: 1 of 1 partitions are valid",
        ),
        (ConvolutionField(TRIPOD), f"ConvolutionField: compact-cubic, of {TRIPOD}"),
        (ConvolutionField(TRIPOD).samples(TRIPOD.nodes), "FieldSamples: at 4 points, values "),
        (tiles(TRIPOD, block=20.0), "SkeletonTiles: "),
        (tiles(TRIPOD, block=20.0)[0], "Tile: 0, "),
        (
            tiles(PeriodicLattice("bcc", 8.0, 2, radius=0.5), block=2),
            "LatticeTiles: 1, of Periodic",
        ),
    ],
    ids=lambda value: type(value).__name__,
)
def test_things_print_as_one_short_line(thing: Any, begin: str) -> None:
    assert str(thing).startswith(begin)
    assert len(str(thing)) < 120
    assert "\n" not in str(thing)


def test_every_class_of_results_has_a_line_of_its_own() -> None:
    """Options and single loads are printed by their fields; all that holds arrays is summed up."""
    homes = [import_module(f"scaffold_cad.{wing}") for wing in ("mesh", "partition", "tiles")]
    named = [getattr(home, name) for home in homes for name in home.__all__]
    known = [one for one in [*CALLABLES.values(), *named] if isinstance(one, type)]
    kinds = {kind for kind in known if issubclass(kind, Frozen)}
    assert {kind.__name__ for kind in kinds if kind.__str__ is object.__str__} == set()
