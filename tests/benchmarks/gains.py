"""The weights ONCE and AGAIN of `scaffold_cad.partition.dual`: `python -m tests.benchmarks.gains`.

For random stars, choices of edges are drawn at random (found by the search for random gains),
relaxed, and their lowest ratios compared within each star. The ratio that a choice reaches beyond
the mean of its star is fitted by least squares to sums over its edges: of arcs, gaps and merging
ends of the edges taken, and of arcs and gaps of those taken twice, beside their number. Only the
proportions matter for the search, so that weights are printed in what an edge more that is taken
once counts.
"""

from __future__ import annotations

import argparse

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.partition import dual
from scaffold_cad.partition.delaunay import triangulations
from scaffold_cad.partition.matching import good_matchings
from scaffold_cad.partition.multigraph import quadrangulations
from scaffold_cad.partition.relax import relaxed
from scaffold_cad.partition.star import nearest_angles
from tests.validation.star_families import drawn

VALENCIES = (6, 8, 10, 12, 16)
CHOICES = 24
STEPS = 120
FLOW, NEWTON = 30, 10
DRAWS = 12
"""Random gains for which choices are searched."""


def terms(directions: Floats, random: np.random.Generator) -> tuple[Floats, Floats]:
    """Return sums over the edges of random choices, (k, 6), and the ratios they reach, (k,).

    Both less their mean over each star.
    """
    meshes, meshed = triangulations(directions)
    stars = directions[meshed]
    reach = nearest_angles(stars) / 2
    half_edges = dual.edges_of(meshes)
    ends = np.stack(
        [np.take_along_axis(of, half_edges, 1) for of in (meshes.tails, meshes.heads)], axis=2
    )
    rows = []
    for _ in range(DRAWS):
        gains = random.normal(size=(2, *half_edges.shape))
        choices, found = good_matchings(ends, *gains, stars.shape[1], CHOICES, STEPS)
        star, choice = np.nonzero(found > -np.inf)
        rows.append(np.column_stack([star, choices[star, choice]]))
    unlike = np.unique(np.concatenate(rows), axis=0)
    star, taken = unlike[:, 0], unlike[:, 1:]  # (k,), (k, E)
    multiplicity = np.zeros((len(star), meshes.tails.shape[1]), dtype=np.intp)
    for side in (half_edges, np.take_along_axis(meshes.twins, half_edges, 1)):
        np.put_along_axis(multiplicity, side[star], taken, axis=1)
    made, kept = quadrangulations(meshes[star], stars[star], multiplicity)
    star, taken = star[kept], taken[kept]
    _, ratio = relaxed(
        stars[star], reach[star], made.quads, made.vertices, flow=FLOW, newton=NEWTON
    )
    arc, gap, merging = (each[star] for each in dual.measures(meshes, half_edges, stars, reach))
    once, twice = taken > 0, taken > 1
    sums = [((taken == 1), 1.0), (once, arc), (once, -gap), (once, -merging)]
    sums += [(twice, arc), (twice, -gap)]
    table = np.stack([(marks * values).sum(axis=1) for marks, values in sums], axis=1)
    ratio = np.maximum(ratio, 0.0)  # how far a folded one is from any does not matter
    count = np.maximum(np.bincount(star, minlength=len(stars)), 1)
    for column in (*table.T, ratio):
        column -= (np.bincount(star, column, len(stars)) / count)[star]
    return table, ratio


def main() -> None:
    """Print the weights that fit best."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stars", type=int, default=300, help="of each valency, default: 300")
    count, random = parser.parse_args().stars, np.random.default_rng(1)
    parts = []
    for valency in VALENCIES:
        parts.append(terms(drawn("uniform", random, count, valency), random))
        print(f"valency {valency}: {len(parts[-1][1])} choices", flush=True)
    table = np.concatenate([rows for rows, _ in parts])
    ratios = np.concatenate([values for _, values in parts])
    weights, *_ = np.linalg.lstsq(table, ratios, rcond=None)
    left = 1 - np.var(ratios - table @ weights) / np.var(ratios)
    weights /= weights[0]
    print(f"ONCE {np.round(weights[1:4], 2).tolist()}, AGAIN {np.round(weights[4:], 2).tolist()}")
    print(f"they explain {left:.0%} of the variance within stars; in use {dual.ONCE}, {dual.AGAIN}")


if __name__ == "__main__":
    main()
