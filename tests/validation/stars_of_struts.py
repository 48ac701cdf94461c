"""How many blends of random stars of struts are proved, and how well they fit: a table.

`python -m tests.validation.stars_of_struts [STARS]` prints a line for each family of stars: the
share proved with one polynomial patch a quad, the share proved in all, the share whose ρ grew for
that, the greatest misfit and depth inside a strut, the greatest angle between normals across
joins, and the milliseconds of processor time a node.

Families: N struts with a least angle between them, of equal radii or of radii from 0.5 to 2, with
wide fillets or the usual ones of half the thinnest strut (ρ r/2); all struts within 60° of an axis;
all in a plane; a straight pair with one more; a big ball on thin necks; five tubes; bends.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.base.vectors import normalize
from scaffold_cad.struts import Blends, Stars, blends
from scaffold_cad.struts.options import BLEND
from tests.struts.stars import FIVE_TUBES, random_stars, stars_of

STARS = 100
SEED = 1
GRID = np.linspace(0, 1, 17)


@dataclass(frozen=True)
class Result:
    """What was found for a family of stars."""

    whole: float
    proved: float
    swollen: float
    misfit: float
    depth: float
    shallow: float
    angle: float
    milliseconds: float


def families(count: int, rng: np.random.Generator) -> dict[str, Stars]:
    """Return stars by the name of their family."""
    found = {}
    for least in (60, 45, 30, 20):
        for valency in (2, 3, 4, 6, 8, 12):
            if (valency >= 8 and least == 60) or (valency == 12 and least > 30):
                continue  # such stars are rare or not there at all
            number = count if valency < 8 else max(4, count // 10)  # each is of its own type
            star = random_stars(number, valency, least, rng)
            found[f"N = {valency:2d}, {least}°"] = stars_of(star)
            if valency in (3, 4, 6):
                radii = np.exp(rng.uniform(np.log(0.5), np.log(2), star.shape[:2]))
                for name, blend in (
                    ("", 0.6 * radii.mean(axis=1)),
                    (", ρ r/2", BLEND * radii.min(axis=1)),
                ):
                    found[f"N = {valency:2d}, {least}°, radii 0.5..2{name}"] = stars_of(
                        star, radii, blends=blend
                    )
    found["N =  4 within 60° of an axis, 30°"] = stars_of(_fans(count, rng))
    found["N =  4 in a plane, 30°"] = stars_of(_planar(count, 4, rng))
    found["N =  3, a straight pair, 30°"] = stars_of(_tees(count, rng))
    found["N =  3, 45°, ball 6 on necks 1"] = stars_of(random_stars(count, 3, 45, rng), balls=6.0)
    found["N =  4, 45°, cones ±0.1"] = stars_of(
        random_stars(count, 4, 45, rng), slopes=rng.uniform(-0.1, 0.1, (count, 4))
    )
    found["five tubes 17.5, 16, 14, 9, 9"] = stars_of(
        FIVE_TUBES, np.array([17.5, 16, 14, 9, 9]), blends=8.0
    )
    return found


def _fans(count: int, rng: np.random.Generator) -> Floats:
    star = random_stars(40 * count, 4, 30, rng)
    axis = normalize(star.sum(axis=1))
    near = np.einsum("mix,mx->mi", star, axis).min(axis=1) > np.cos(np.radians(60))
    return star[near][:count]


def _planar(count: int, valency: int, rng: np.random.Generator) -> Floats:
    gaps = rng.dirichlet(np.ones(valency), count) * (360 - 30 * valency) + 30
    angle = np.radians(np.cumsum(gaps, axis=1))
    return np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=2)


def _tees(count: int, rng: np.random.Generator) -> Floats:
    side = np.radians(rng.uniform(30, 150, count))
    one = np.tile([1.0, 0, 0], (count, 1))
    other = np.stack([np.cos(side), np.sin(side), np.zeros(count)], axis=1)
    return np.stack([one, -one, other], axis=1)


def measured(stars: Stars) -> Result:
    """Return what is found for `stars`."""
    start = time.process_time()
    groups = blends(stars)
    spent = time.process_time() - start
    total = len(stars)
    whole = sum(group.proved.sum() for group in groups if group.layout.along_arc == 1)
    proved = sum(group.proved.sum() for group in groups)
    rho = np.concatenate([group.shapes.rho[group.shape_of] for group in groups])
    asked = np.concatenate([group.stars.blends for group in groups])
    good = [group.shapes.proved for group in groups]
    misfit = np.concatenate([g.shapes.misfit[ok] for g, ok in zip(groups, good, strict=True)])
    depth = np.concatenate([g.shapes.depth[ok] for g, ok in zip(groups, good, strict=True)])
    return Result(
        whole / total,
        proved / total,
        float((rho > 1.01 * asked).mean()),
        float(misfit.max(initial=0)),
        float(depth.max(initial=0)),
        float((depth <= 0.02).mean()) if len(depth) else 1.0,
        max(joint_angle(group) for group in groups),
        1e3 * spent / total,
    )


def joint_angle(group: Blends) -> float:
    """Return the greatest angle between normals across spokes and arcs of proved blends, deg."""
    control = group.control[group.shapes.proved]
    twins = group.twins[group.shapes.proved]
    if len(control) == 0:
        return 0.0
    u, v = group.layout.u, group.layout.v
    slope_u = np.einsum("ai,upijx,bj->upabx", u.values_at(GRID, 1), control, v.values_at(GRID))
    slope_v = np.einsum("ai,upijx,bj->upabx", u.values_at(GRID), control, v.values_at(GRID, 1))
    normals = normalize(np.cross(slope_u, slope_v))
    sides = np.arange(control.shape[1])
    following = (sides & ~3) | ((sides + 1) & 3)
    spokes = normals[:, :, -1] - normals[:, following, 0]
    across = np.take_along_axis(normals[:, :, :, 0], twins[:, :, None, None], axis=1)
    arcs = normals[:, :, :, 0] - across[:, :, ::-1]
    chord = max(np.linalg.norm(each, axis=-1).max() for each in (spokes, arcs))
    return float(np.degrees(2 * np.arcsin(min(1.0, chord / 2))))


def main(count: int) -> None:
    """Print the table."""
    print("family                            one patch  proved  ρ grew  misfit  depth ≤.02r  most")
    for name, stars in families(count, np.random.default_rng(SEED)).items():
        one = measured(stars)
        print(
            f"{name:34s} {one.whole:8.1%} {one.proved:8.1%} {one.swollen:7.1%} "
            f"{one.misfit:7.3f} {one.shallow:7.1%} {one.depth:7.3f} "
            f"{one.angle:8.1e}° {one.milliseconds:6.1f} ms",
            flush=True,
        )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else STARS)
