import numpy as np

from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.struts.blending.quarter import ARC, ARC_ERROR, DEGREE, OUTWARD, OUTWARD_SLOPE
from tests.benchmarks.quarter import best

AT = np.linspace(0, 1, 1001)
BASIS = bernstein(DEGREE, AT)


def test_arc_is_a_quarter_circle_to_1e_9() -> None:
    assert np.abs(np.linalg.norm(BASIS @ ARC, axis=1) - 1).max() < ARC_ERROR < 2e-9


def test_arc_is_the_one_of_least_greatest_distance_from_the_circle() -> None:
    numbers, distance = best()
    np.testing.assert_allclose([ARC[1, 1], *ARC[2]], numbers, rtol=0, atol=1e-9)
    assert distance < ARC_ERROR


def test_arc_leaves_its_ends_across_the_radius_with_equal_speed() -> None:
    first, last = ARC[1] - ARC[0], ARC[-1] - ARC[-2]
    assert first[0] == 0
    assert last[1] == 0
    assert first[1] == -last[0]


def test_companions_keep_to_the_arc_as_their_fade_says() -> None:
    for companion in (OUTWARD, OUTWARD_SLOPE):
        along = ((BASIS @ companion.curve) * (BASIS @ ARC)).sum(axis=1)
        assert np.abs(along - BASIS @ companion.fade).max() < 2e-8


def test_outward_companion_falls_from_one_to_zero() -> None:
    fade = BASIS @ OUTWARD.fade
    assert fade[0] == 1
    assert fade[-1] == 0
    assert (np.diff(fade) <= 0).all()
