"""Beams, cells and hexahedra beside other programs and published values, in one run.

Run as ``python -m tests.validation.strength [--large]``; `--large` adds 10⁵ struts.
OpenSees, PyNite and CalculiX are asked where they are installed.
"""

from __future__ import annotations

import argparse
import shutil
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from scaffold_cad import Skeleton, build_scaffold
from scaffold_cad.filling import voronoi_foam
from scaffold_cad.lattice import cells, tile
from scaffold_cad.mechanics import (
    BeamModel,
    Hexahedra,
    Load,
    Material,
    Support,
    beam_model,
    hexahedra,
    homogenized,
    homogenized_solid,
    write_beams,
)
from scaffold_cad.scaffold import Scaffold
from tests.mechanics.peers import (
    calculix_displacements,
    opensees_displacements,
    pynite_displacements,
)
from tests.struts.stars import random_stars

STEEL = Material(210e3, 0.3)
SLENDER = 0.002
"""Radius of struts over the side of the cell, where bending no longer counts."""


def block(cell: str, count: int) -> BeamModel:
    """Return a block of cells that is held below and pushed down from above."""
    top = 10.0 * count
    return beam_model(
        tile(cell, 10.0, count, radius=0.2),
        STEEL,
        Support(lambda nodes: nodes[:, 2] < 0.1),
        Load(lambda nodes: nodes[:, 2] > top - 0.1, (1, 0, -4), each=True),
    )


def beams() -> None:
    """Print what other programs find of 1000 and 8000 struts, and how long they take."""
    for count in (5, 10):
        model = block("bcc", count)
        start = time.process_time()
        ours = model.solved()
        print(f"{len(model.skeleton.edges)} struts: {time.process_time() - start:.2f} s")
        for name, solve in (("OpenSees", opensees), ("PyNite", pynite_displacements)):
            start = time.process_time()
            theirs = solve(model)
            off = np.abs(theirs - ours.displacements).max() / ours.largest_displacement
            print(f"  {name:10} {time.process_time() - start:7.2f} s, {off:.1e} apart")


def opensees(model: BeamModel) -> np.ndarray:
    """Return the displacements that OpenSees finds."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "block.tcl"
        write_beams(model, file)
        return opensees_displacements(file, len(model.skeleton.nodes))[:, :3]


def calculix() -> None:
    """Print what CalculiX finds of a cell."""
    if shutil.which("ccx") is None:
        print("CalculiX is not installed")
        return
    model = block("bcc", 1)
    with TemporaryDirectory() as folder:
        file = Path(folder) / "block.inp"
        write_beams(model, file)
        found = calculix_displacements(file)
    ours = model.solved()
    theirs = np.array([found.get(k + 1, [0.0] * 3) for k in range(len(model.skeleton.nodes))])
    off = np.abs(theirs - ours.displacements).max() / ours.largest_displacement
    print(f"CalculiX, {len(model.skeleton.edges)} struts: {off:.1e} apart")


def large() -> None:
    """Print the time of some 10⁵ struts."""
    model = block("octet", 16)
    start = time.process_time()
    model.solved()
    print(f"{len(model.skeleton.edges)} struts of octet: {time.process_time() - start:.1f} s")


def slender_cells() -> None:
    """Print moduli in the slender limit beside published ones."""
    octet, cubic, kelvin = (
        homogenized(name, SLENDER, STEEL, size=1.0) for name in ("octet", "sc", "kelvin")
    )
    length, area, inertia = np.sqrt(2) / 4, np.pi * SLENDER**2, np.pi / 4 * SLENDER**4
    zhu = 6 * np.sqrt(2) * inertia / length**4 / (1 + 12 * inertia / (area * length**2))
    for name, cell, published in (
        ("octet: Deshpande, Fleck, Ashby 2001", octet, octet.relative_density / 9),
        ("simple cubic: Gibson, Ashby 1997", cubic, cubic.relative_density / 3),
        ("kelvin: Zhu, Knott, Mills 1997", kelvin, zhu),
    ):
        found = cell.young([1, 0, 0]) / STEEL.young
        print(f"{name}: E/Es {found:.5g}, published {published:.5g}, {found / published - 1:+.2%}")


def fat_cells() -> None:
    """Print moduli of octets of beams over those of hexahedra."""
    for radius in (0.0245, 0.0474, 0.0887):
        solid = homogenized_solid("octet", radius, STEEL, size=1.0, layers=2, along=6)
        found = homogenized("octet", radius, STEEL, size=1.0)
        print(
            f"octet at {solid.relative_density:.1%}: beams over hexahedra E "
            f"{found.young([1, 0, 0]) / solid.young([1, 0, 0]):.2f}, G "
            f"{found.shear_axes.mean() / solid.shear_axes.mean():.2f}"
        )


def named_cells() -> None:
    """Print the least scaled Jacobian of all named cells."""
    for collars in (False, True):
        for layers in (0, 1):
            worst = {}
            for name in cells():
                thin = tile(name, 10.0, 2, radius=0.1)
                skeleton = thin.with_radii(float(0.08 * np.median(thin.lengths)))
                mesh = hexahedra(build_scaffold(skeleton, collars=collars), layers=layers)
                worst[name] = float(mesh.quality.min())
            name = min(worst, key=worst.__getitem__)
            print(
                f"{len(worst)} cells, collars={collars}, layers={layers}: least {worst[name]:.4f} "
                f"({name})"
            )


def stars() -> None:
    """Print the least scaled Jacobians of random stars."""
    random, least = np.random.default_rng(3), []
    for valency in (4, 6, 8, 12):
        for directions in random_stars(10, valency, 25, random):
            tips = np.concatenate([np.zeros((1, 3)), 10 * directions])
            star = Skeleton(tips, [[0, k + 1] for k in range(valency)], 0.8)
            for collars in (False, True):
                mesh = hexahedra(build_scaffold(star, collars=collars), layers=1)
                least.append(float(mesh.quality.min()))
    found = np.array(least)
    print(
        f"{len(found)} random stars: least {found.min():.3f}, {(found >= 0.2).mean():.0%} at 0.2 "
        f"and more, {(found <= 0).sum()} with inverted ones"
    )


def foams() -> None:
    """Print what of a foam's hexahedra is inverted, and where its scaffold is certified."""
    foam = voronoi_foam(120, np.array([[0.0] * 3, [100.0] * 3]), 0.5)
    for collars in (False, True):
        scaffold = build_scaffold(foam, collars=collars)
        mesh = hexahedra(scaffold, layers=1)
        whole = at_certified(scaffold, mesh)
        print(
            f"foam of {len(foam.edges)} struts, {(~scaffold.embedding().kept).mean():.0%} left "
            f"out, collars={collars}: {(mesh.quality <= 0).mean():.2%} inverted, "
            f"{(mesh.quality < 0.2).mean():.1%} below 0.2; least where certified "
            f"{mesh.quality[whole].min():.3f}"
        )


def at_certified(scaffold: Scaffold, mesh: Hexahedra) -> np.ndarray:
    """Return which hexahedra touch no branch point with a strut that the certificate leaves out."""
    kept, edges = scaffold.embedding().kept, scaffold.skeleton.edges
    broken = np.zeros(len(scaffold.skeleton.nodes), dtype=np.bool_)
    broken[edges[~kept]] = True
    edge, node = mesh.edge_of_hexahedron, mesh.node_of_hexahedron
    reached = broken[node] & (node >= 0)
    if not scaffold.options.collars:  # each reaches from node to node
        reached = broken[edges[edge]].any(axis=1)
    return np.asarray(kept[edge] & ~reached)


def main() -> None:
    """Print all of it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--large", action="store_true", help="10⁵ struts too")
    options = parser.parse_args()
    for part in (slender_cells, beams, calculix, fat_cells, named_cells, stars, foams):
        part()
    if options.large:
        large()


if __name__ == "__main__":
    main()
