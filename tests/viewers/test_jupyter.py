"""A real kernel of Jupyter displays what show() is given; it needs ipykernel and jupyter_client."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.util import find_spec
from typing import Any

import pytest

PROGRAM = """
import build123d
from scaffold_cad import Skeleton, build_scaffold, to_solid
from scaffold_cad.viewers import show

bar = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
show(bar)
show(build_scaffold(bar))
show(to_solid(build_scaffold(bar)))
show(build123d.Box(1, 2, 3))
"""


@pytest.fixture
def kernel() -> Iterator[Any]:
    """A client of a kernel of this environment."""
    if not all(map(find_spec, ("ipykernel", "jupyter_client"))):
        pytest.skip("ipykernel and jupyter_client are not installed")
    from jupyter_client.manager import start_new_kernel

    manager, client = start_new_kernel()
    try:
        yield client
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)


def test_notebook_draws_skeletons_scaffolds_solids_and_shapes(kernel: Any) -> None:
    messages: list[dict[str, Any]] = []
    reply = kernel.execute_interactive(PROGRAM, output_hook=messages.append, timeout=200)
    assert reply["content"]["status"] == "ok", reply["content"]
    drawn = [m["content"]["data"] for m in messages if m["msg_type"] == "display_data"]
    assert len(drawn) == 4
    assert all("<iframe" in data["text/html"] for data in drawn)
