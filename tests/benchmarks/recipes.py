"""What each of the ways to fit a blend is for: `python -m tests.benchmarks.recipes [--stars 30]`.

Random stars of struts are solved with all of `scaffold_cad.struts.blending.recipes.RECIPES`,
without each of them, and with other numbers of the first one, which solves most nodes. For each a
line has the share that is proved, the share whose depth inside a strut is at most 0.02 of its
radius, the median and the greatest misfit (distance from the filleted union, in radii), and the
time per star. A recipe is worth its place where the line without it has less proved, worse fits
or more time."""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from scaffold_cad.struts import Stars, blends
from scaffold_cad.struts.blending.recipes import RECIPES, Recipe
from scaffold_cad.struts.options import BLEND
from tests.struts.stars import random_stars, stars_of

FAMILIES = ((2, 20), (3, 30), (4, 30), (6, 30), (6, 20), (8, 30))
"""Valency and least angle, in degrees."""


def families(count: int, blend: float = BLEND) -> list[Stars]:
    """Return stars of each family, of even radii and of radii from 0.5 to 2.

    Parameters
    ----------
    blend : fillet radius, in radii of the thinnest strut
    """
    random = np.random.default_rng(1)
    found = []
    for valency, least in FAMILIES:
        star = random_stars(count, valency, least, random)
        found.append(stars_of(star, blends=blend))
        radii = np.exp(random.uniform(np.log(0.5), np.log(2), star.shape[:2]))
        found.append(stars_of(star, radii, blends=blend * radii.min(axis=1)))
    return found


def variants() -> Iterator[tuple[str, tuple[Recipe, ...]]]:
    """Yield recipes by what is changed."""
    first, *others = RECIPES
    yield "all", RECIPES
    yield "all for any fillet", tuple(replace(each, least=0.0, most=np.inf) for each in RECIPES)
    for number in range(len(RECIPES)):
        yield f"without {number}", (*RECIPES[:number], *RECIPES[number + 1 :])
    for name in ("openness", "momentum", "urge"):
        value = getattr(first, name)
        for factor in (0.8, 1.25):
            changed = replace(first, **{name: factor * value})
            yield f"{name} of 0 x {factor:g}", (changed, *others)


def measured(recipes: tuple[Recipe, ...], stars: list[Stars]) -> str:
    """Return the line of some recipes."""
    start, total = time.process_time(), sum(map(len, stars))
    groups = [group for each in stars for group in blends(each, recipes)]
    spent = time.process_time() - start
    proved = np.concatenate([group.proved for group in groups])
    depth, misfit = (
        np.concatenate([getattr(group.shapes, name)[group.shape_of] for group in groups])[proved]
        for name in ("depth", "misfit")
    )
    return (
        f"{proved.mean():8.2%}{(depth <= 0.02).mean():9.2%}{np.median(misfit):9.4f}"
        f"{misfit.max():8.3f}{1e3 * spent / total:9.1f} ms"
    )


def main() -> None:
    """Print a line per variant."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stars", type=int, default=30, help="of each family, default: 30")
    parser.add_argument(
        "--blend", type=float, default=BLEND, help="fillet radius in radii of the thinnest strut"
    )
    options = parser.parse_args()
    stars = families(options.stars, options.blend)
    print(f"{'recipes':<24}  proved  shallow   misfit    most     time")
    for name, recipes in variants():
        print(f"{name:<24}{measured(recipes, stars)}", flush=True)


if __name__ == "__main__":
    main()
