"""One thread in all tests of tiles: last bits of matrices depend on how many make them."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from threadpoolctl import threadpool_limits

from scaffold_cad.struts.fits import forget_systems


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    with threadpool_limits(1):
        forget_systems()
        yield
