"""Equal nodes cut once have the sections of each by itself."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import Layer, round_struts, slices, tile
from scaffold_cad.struts import bodies


def test_equal_nodes_are_cut_as_each_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    struts = round_struts(tile("bcc", 4.0, 3, radius=0.4))
    heights = np.linspace(-0.3, 12.3, 43)
    once = list(slices(struts, heights))
    monkeypatch.setattr(bodies, "OFTEN", 10**6)
    each: list[Layer] = list(slices(struts, heights))
    assert [len(layer.loops) for layer in once] == [len(layer.loops) for layer in each]
    assert [layer.area for layer in once] == pytest.approx([layer.area for layer in each])
