"""A node as its STEP file holds it, judged by OCCT and Monte Carlo alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from build123d import import_step

from scaffold_cad import Skeleton, round_struts, write
from tests.validation.fillets import fillet_volume
from tests.validation.reread import SAG, axes_outside, least_wall, worst_join
from tests.validation.struts import union_volume

TIPS = [[60, 0, 0], [0, 70, 0], [-45, -40, 20], [0, 0, 55], [35, -45, -40]]
NODE = Skeleton([[0, 0, 0], *TIPS], [[0, tip] for tip in range(1, 6)], edge_radii=[8, 7, 6, 5, 5])


def test_a_node_is_smooth_around_its_axes_and_has_the_volume_of_its_fillets(tmp_path: Path) -> None:
    struts = round_struts(NODE, blend=3.0)
    write(struts, tmp_path / "node.step")
    shape = import_step(tmp_path / "node.step")
    assert worst_join(shape) < 1e-3
    assert axes_outside(shape, NODE) == 0
    generator = np.random.default_rng(1)
    bare, _ = union_volume(NODE, generator)
    fillets = fillet_volume(NODE, np.nan_to_num(struts.fillet), generator)
    assert fillets > 0
    assert shape.volume == pytest.approx(bare + fillets, rel=3e-3)


def test_walls_of_a_hollow_node_are_as_thick_as_asked(tmp_path: Path) -> None:
    write(round_struts(NODE, blend=3.0, wall=1.5, ends="open"), tmp_path / "node.step")
    assert least_wall(import_step(tmp_path / "node.step"), 1.5) > 0.95 - SAG
