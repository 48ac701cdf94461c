"""Curves: exact circles at joints, one tangent plane across them, tori and helices."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts import round_struts
from scaffold_cad.struts.curves.curve import ALONG, Curves
from tests.skeletons import NAMED, TREFOIL
from tests.struts.chains import HOOK, TAPERED, circle, helix

ANGLES = np.linspace(0, 2 * np.pi, 33)
CHAINS = {"trefoil": TREFOIL, "tapered": TAPERED, "hook": HOOK, "helix": helix(60)}


def sampled(curves: Curves, at: float, order: int = 0) -> np.ndarray:
    """Return points of pieces at a parameter, or their derivatives along, (p, 33, 3)."""
    rows = np.einsum("j,pjkx->pkx", bernstein(ALONG, np.array([at]), order)[0], curves.frames)
    around = np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=1)
    return rows[:, :1] + np.einsum("ak,pkx->pax", around, rows[:, 1:])


def normals(curves: Curves, at: float) -> np.ndarray:
    """Return unit normals of pieces at a parameter, (p, 33, 3)."""
    rows = np.einsum("j,pjkx->pkx", bernstein(ALONG, np.array([at]))[0], curves.frames)
    turned = np.stack([-np.sin(ANGLES), np.cos(ANGLES)], axis=1)
    by_angle = np.einsum("ak,pkx->pax", turned, rows[:, 1:])
    found = np.cross(by_angle, sampled(curves, at, 1))
    return found / np.linalg.norm(found, axis=2, keepdims=True)


@pytest.mark.parametrize("name", CHAINS)
def test_joints_have_exact_circles_in_the_planes_that_halve_their_angles(name: str) -> None:
    skeleton = CHAINS[name]
    struts = round_struts(skeleton)
    curves = struts.curves
    for piece, at in enumerate(curves.pieces.tolist()):
        node = int(curves.nodes[at])
        if node < 0:
            continue
        ring = sampled(curves, 0.0)[piece]
        away = np.linalg.norm(ring - skeleton.nodes[node], axis=1)
        np.testing.assert_allclose(away, skeleton.radii[node], rtol=1e-12)
        sides = skeleton.directions[skeleton.incidence.at_nodes(np.array([node]), 2)[0]]
        np.testing.assert_allclose(
            (ring - skeleton.nodes[node]) @ (sides[0] - sides[1]), 0, atol=1e-9
        )


@pytest.mark.parametrize("name", CHAINS)
def test_normals_agree_across_joints(name: str) -> None:
    curves = round_struts(CHAINS[name]).curves
    first = curves.pieces
    follows = np.flatnonzero(np.diff(first) == 1)
    end, start = normals(curves, 1.0)[follows], normals(curves, 0.0)[follows + 1]
    np.testing.assert_allclose(end, start, atol=1e-9)
    if curves.closed[0]:
        np.testing.assert_allclose(normals(curves, 1.0)[-1], normals(curves, 0.0)[0], atol=1e-9)


def test_straight_struts_join_with_their_generators() -> None:
    for skeleton in (HOOK, TAPERED):
        struts = round_struts(skeleton)
        curves = struts.curves
        axis = curves.tangents[0]
        slope = struts.runs.slopes[curves.half_runs[0, 0] ^ 1]
        wanted = 1 / np.hypot(1, slope), -slope / np.hypot(1, slope)
        ring, found = sampled(curves, 0.0)[0], normals(curves, 0.0)[0]
        spokes = (ring - curves.centers[0]) / curves.radii[0]
        expected = wanted[0] * spokes + wanted[1] * axis
        np.testing.assert_allclose(found, expected, atol=1e-9)


@pytest.mark.parametrize(("count", "error"), [(24, 1e-6), (96, 1e-9)])
def test_a_circle_is_a_torus(count: int, error: float) -> None:
    curves = round_struts(circle(count)).curves
    for at in (0.2, 0.5, 0.9):
        points = sampled(curves, at).reshape(-1, 3)
        from_circle = np.hypot(np.hypot(points[:, 0], points[:, 1]) - 10, points[:, 2])
        np.testing.assert_allclose(from_circle, 1.0, atol=error)


def test_sections_keep_near_their_circle_between_joints() -> None:
    # The centers of a helix are off it by less than its samples are from their chords.
    skeleton = helix(80)
    curves = round_struts(skeleton).curves
    whole = curves.curved[curves.run[curves.pieces]]
    whole[[1, -2]] = False  # beside the straight ends
    middle = sampled(curves, 0.5)[whole]
    centers = middle[:, :-1].mean(axis=1)
    wide = np.linalg.norm(middle - centers[:, None], axis=2)
    np.testing.assert_allclose(wide, 1.0, atol=2e-5)
    angle = np.arctan2(centers[:, 1], centers[:, 0])
    np.testing.assert_allclose(np.hypot(centers[:, 0], centers[:, 1]), 10.0, atol=2e-3)
    off = np.mod(centers[:, 2] - 6 * angle / (2 * np.pi) + 3, 6) - 3
    np.testing.assert_allclose(off, 0, atol=2e-3)


def test_radii_stay_between_those_of_two_joints() -> None:
    radii = np.array([1.0, 1.0, 1.3, 1.3, 0.8, 0.8, 1.0, 1.2, 1.2, 1.2])
    nodes = [[2.0 * k, 0.02 * k * k, 0] for k in range(10)]
    chain = Skeleton(nodes, [[k, k + 1] for k in range(9)], radii)
    curves = round_struts(chain, joints="curve").curves
    first = curves.pieces
    for at in np.linspace(0, 1, 9).tolist():
        rows = np.einsum("j,pjkx->pkx", bernstein(ALONG, np.array([at]))[0], curves.frames)
        wide = np.linalg.norm(rows[:, 1:], axis=2)
        low = np.minimum(curves.radii[first], curves.radii[first + 1])[:, None]
        high = np.maximum(curves.radii[first], curves.radii[first + 1])[:, None]
        assert (wide > low * (1 - 2e-4)).all()
        assert (wide < high * (1 + 2e-4)).all()


def test_closed_curves_meet_themselves() -> None:
    curves = round_struts(TREFOIL).curves
    assert curves.closed.tolist() == [True]
    np.testing.assert_allclose(sampled(curves, 1.0)[-1], sampled(curves, 0.0)[0], atol=1e-12)


def test_no_joints_make_no_curves() -> None:
    curves = round_struts(NAMED["tripod"]).curves
    assert len(curves.half_runs) == len(curves.pieces) == 0
