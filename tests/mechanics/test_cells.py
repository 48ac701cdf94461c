"""Homogenized cells against published values in the slender limit."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.errors import OptionError
from scaffold_cad.lattice import UnitCell, cells, tile
from scaffold_cad.mechanics import (
    Load,
    Material,
    Support,
    beam_model,
    cell_table,
    homogenized,
    polar_picture,
    young_polar,
)

STEEL = Material(210e3, 0.3)


def triangular_cells() -> tuple[UnitCell, UnitCell]:
    """Return layers of triangles joined by columns, as one cell of 60° and as a box of two."""
    skewed = UnitCell.of_net(
        "triangles",
        [[0, 0, 0]],
        [[0, 0]] * 4,
        [[1, 0, 0], [0, 1, 0], [1, -1, 0], [0, 0, 1]],
        angles=np.radians([90, 90, 60]),
    )
    straight = UnitCell.of_net(
        "triangles in a box",
        [[0, 0, 0], [0.5, 0.5, 0]],
        [[0, 0], [1, 1], [0, 1], [0, 1], [0, 1], [0, 1], [0, 0], [1, 1]],
        [
            [1, 0, 0],
            [1, 0, 0],
            [0, 0, 0],
            [-1, 0, 0],
            [0, -1, 0],
            [-1, -1, 0],
            [0, 0, 1],
            [0, 0, 1],
        ],
        proportions=[1.0, np.sqrt(3), 1.0],
    )
    return skewed, straight


def test_octet_has_the_stiffness_of_deshpande_fleck_and_ashby() -> None:
    # Effective properties of the octet-truss lattice material, JMPS 49, 2001: equation 8.
    octet = homogenized("octet", 0.01, STEEL)
    scaled = octet.stiffness / (octet.relative_density * STEEL.young)
    expected = np.zeros((6, 6))
    expected[:3, :3] = 1 / 12
    np.fill_diagonal(expected, [1 / 6] * 3 + [1 / 12] * 3)
    np.testing.assert_allclose(scaled, expected, atol=0.01 / 12)
    assert octet.young([1, 0, 0]) / octet.relative_density / STEEL.young == pytest.approx(
        1 / 9, rel=0.01
    )
    assert octet.poisson[0, 1] == pytest.approx(1 / 3, rel=0.01)
    assert octet.young([1, 1, 1]) / octet.relative_density / STEEL.young == pytest.approx(
        1 / 5, rel=0.01
    )


def test_simple_cubic_carries_a_third_along_its_struts() -> None:
    # Gibson, Ashby, Cellular Solids, 1997, section 5.3: struts along the pull, and no others.
    cubic = homogenized("sc", 0.01, STEEL)
    assert cubic.young_axes / cubic.relative_density / STEEL.young == pytest.approx([1 / 3] * 3)
    # Struts bend in shear as clamped ones of half their length: G = 6 E I / a⁴.
    inertia = np.pi / 4 * 0.01**4
    assert cubic.shear_axes == pytest.approx([6 * STEEL.young * inertia] * 3, rel=0.01)


@pytest.mark.parametrize("slenderness", [0.01, 0.02])
def test_kelvin_cell_has_the_stiffness_of_zhu_knott_and_mills(slenderness: float) -> None:
    # Analysis of the elastic properties of open-cell foams with tetrakaidecahedral cells,
    # JMPS 45, 1997: equation 12 (E100) and 16 (Poisson's ratio near 1/2).
    length = np.sqrt(2) / 4
    radius = slenderness * length
    area, inertia = np.pi * radius**2, np.pi / 4 * radius**4
    kelvin = homogenized("kelvin", radius, STEEL)
    expected = 6 * np.sqrt(2) * inertia / length**4 / (1 + 12 * inertia / (area * length**2))
    assert kelvin.young_axes / STEEL.young == pytest.approx([expected] * 3, rel=0.01)
    assert kelvin.zener == pytest.approx(1, abs=0.02)
    assert kelvin.poisson[0, 1] == pytest.approx(0.5, rel=0.01)


@pytest.mark.parametrize("name", ["bcc", "fcc", "octet", "kelvin", "diamond", "gyroid", "sc"])
def test_bulk_modulus_of_struts_in_line_is_a_ninth(name: str) -> None:
    # Under even strain all struts of these cells only stretch: the Voigt bound of a truss is met
    # (Christensen, Mechanics of low density materials, JMPS 34, 1986).
    cell = homogenized(name, 0.003, STEEL)
    assert cell.bulk / cell.relative_density / STEEL.young == pytest.approx(1 / 9, rel=0.01)


@pytest.mark.parametrize("name", list(cells()))
def test_stiffness_is_symmetric_positive_and_below_the_voigt_bound(name: str) -> None:
    cell = homogenized(name, 0.02, STEEL)
    np.testing.assert_array_equal(cell.stiffness, cell.stiffness.T)
    values = np.linalg.eigvalsh(cell.stiffness)
    assert values[0] > 0
    assert cell.stiffness[0, 0] < cell.relative_density * STEEL.young


def test_a_block_of_cells_between_plates_tends_to_the_homogenized_modulus() -> None:
    # Of many cells, whose free sides matter less and less; octet struts lie in the plates.
    modulus = []
    for count in (2, 4):
        block = tile("sc", 10.0, (count, count, count), radius=0.5)
        side = 10.0 * count
        press = beam_model(
            block,
            STEEL,
            [
                Support(lambda nodes: nodes[:, 2] < 0.1),
                Support(lambda nodes, top=side: nodes[:, 2] > top - 0.1, "z", -0.01 * side),
            ],
            Load([0]),
        ).solved()
        top = block.nodes[:, 2] > side - 0.1
        # Outer struts are shared with neighbors that a finite block lacks.
        modulus.append(-press.reactions[top, 2].sum() / 0.01 / (10.0 * (count + 1)) ** 2)
    exact = homogenized("sc", 0.5, STEEL, size=10.0).young_axes[2]
    assert modulus == pytest.approx([exact, exact], rel=1e-6)


def test_stiffer_nodes_make_a_stiffer_cell() -> None:
    soft = homogenized("bcc", 0.1, STEEL)
    stiff = homogenized("bcc", 0.1, STEEL, rigid_ends=0.1)
    assert (stiff.young_axes > soft.young_axes * 1.2).all()


def test_cells_of_any_angles_are_as_stiff_as_boxes_of_the_same_struts() -> None:
    skewed, straight = triangular_cells()
    law = homogenized(skewed, 0.3, STEEL, size=10.0)
    same = homogenized(straight, 0.3, STEEL, size=10.0 * straight.proportions)
    np.testing.assert_allclose(law.stiffness, same.stiffness, rtol=1e-9, atol=1e-9)
    assert law.relative_density == pytest.approx(same.relative_density)
    # Struts in three directions of a plane, at 60° to each other: isotropic there.
    assert law.young([1, 0, 0]) == pytest.approx(float(law.young([0.3, 0.8, 0])), rel=1e-6)


def test_maxwell_count_of_trusses_that_bend_and_that_do_not() -> None:
    assert homogenized("octet", 0.01, STEEL).maxwell == 24 - 12 - 3
    assert homogenized("kelvin", 0.01, STEEL).maxwell == 24 - 36 - 3


def test_table_has_a_row_a_cell_and_the_values_of_the_cell() -> None:
    rows = cell_table(0.02)
    assert [row.name for row in rows] == list(cells())
    (octet,) = cell_table(0.02, names=("octet",))
    radius = np.sqrt(0.02 / cells()["octet"].density_coefficient)
    cell = homogenized("octet", float(radius), Material(1.0, 0.3))
    assert octet.young == pytest.approx(cell.young_axes / 0.02)
    assert octet.zener == pytest.approx(cell.zener)


def test_polar_plot_of_an_isotropic_law_is_a_circle() -> None:
    kelvin = homogenized("kelvin", 0.01, STEEL)
    points = young_polar(kelvin, "xy", 72)
    assert points.shape == (72, 2)
    sizes = np.hypot(*points.T)
    assert sizes.min() / sizes.max() > 0.95
    assert sizes[0] == pytest.approx(float(kelvin.young([1, 0, 0])))
    assert polar_picture(kelvin).startswith("<svg")


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: homogenized("cheese", 1, STEEL), "unit cell is 'cheese'"),
        (lambda: homogenized("sc", 0, STEEL), "radius is 0 mm"),
        (lambda: homogenized("sc", 1, STEEL, size=[1, 2]), "size is"),
        (lambda: homogenized("sc", 0.1, STEEL, rigid_ends=0.5), "rigid_ends is 0.5 mm; need less"),
        (lambda: homogenized("sc", 0.1, STEEL, hollow=1.0), "hollow is 1"),
        (lambda: homogenized("sc", 0.1, STEEL).young([0, 0, 0]), "none of length 0"),
        (
            lambda: homogenized("octet", 9, STEEL, size=10),
            r"need less than 1\.37 mm",
        ),
        (lambda: cell_table(1.5), "relative density is 1.5"),
        (lambda: young_polar(homogenized("sc", 0.1, STEEL), "xx"), "plane is 'xx'"),
    ],
)
def test_bad_arguments_are_named(call: object, message: str) -> None:
    with pytest.raises(OptionError, match=message):
        call()  # type: ignore[operator]
