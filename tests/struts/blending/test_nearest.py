"""Points put back on blends: those moved along the normal return to where they were."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import Skeleton, round_struts
from scaffold_cad.struts.blending.nearest import nearest_on_blends
from tests.skeletons import BCC_STAR, ELBOW, TRIPOD


@pytest.mark.parametrize("skeleton", [TRIPOD, ELBOW, BCC_STAR], ids=["tripod", "elbow", "bcc"])
def test_points_moved_along_the_normal_return(skeleton: Skeleton) -> None:
    (group,) = round_struts(skeleton).blended
    shapes = group.shapes
    at = np.random.default_rng(1).uniform(0.05, 0.95, size=(40, 2))
    patch = np.arange(40) % shapes.control.shape[1]
    rows = np.einsum("qj,qijx->qix", shapes.layout.v.values_at(at[:, 1]), shapes.control[0, patch])
    points = np.einsum("qi,qix->qx", shapes.layout.u.values_at(at[:, 0]), rows)
    which = np.zeros(40, dtype=np.intp)
    same, normals = nearest_on_blends(shapes, which, points)
    np.testing.assert_allclose(same, points, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)
    moved, _ = nearest_on_blends(shapes, which, points + 0.02 * normals)
    np.testing.assert_allclose(moved, points, atol=1e-6)
