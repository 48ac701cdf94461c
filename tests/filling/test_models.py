"""What makes the struts of parts: square or round ones, with all options of these."""

from __future__ import annotations

from functools import partial
from inspect import Parameter, signature
from typing import Any

import pytest
from build123d import Box

from scaffold_cad.errors import OptionError
from scaffold_cad.filling import lattice_part
from scaffold_cad.filling.models import RoundOptions, maker
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.struts import RoundStruts, round_struts
from tests.skeletons import TRIPOD


def test_every_option_of_round_struts_is_one_of_parts() -> None:
    parameters = signature(round_struts).parameters.values()
    names = {each.name for each in parameters if each.kind is Parameter.KEYWORD_ONLY}
    assert names == set(RoundOptions.__annotations__)


def test_struts_are_square_or_round() -> None:
    assert isinstance(maker()(TRIPOD), Scaffold)
    struts = maker(section="round", nodes="sharp")(TRIPOD)
    assert isinstance(struts, RoundStruts)
    assert struts.options.nodes == "sharp"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"section": "oval"}, "section is 'oval'; need one of square, round"),
        ({"nodes": "sharp"}, "nodes given with section='square'; need section='round'"),
        ({"section": "square", "wall": 1.0, "ends": "open"}, "wall, ends given with section='squ"),
    ],
)
def test_options_that_no_section_has_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        maker(**options)


def test_lattice_part_takes_a_section_as_lattice_solid_does() -> None:
    fill = partial(lattice_part, Box(8, 8, 8), "bcc", 8.0, 0.5, skin=1.0)
    assert fill(section="round").volume() == fill(sides=16).volume()
    assert fill(section="square").volume() == fill().volume()
    with pytest.raises(OptionError, match="sides is 8 for section='square'; need 4 for square"):
        fill(section="square", sides=8)
    with pytest.raises(OptionError, match="section is 'oval'"):
        fill(section="oval")
