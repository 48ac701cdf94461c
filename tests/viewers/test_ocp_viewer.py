"""The real OCP CAD Viewer, in a browser without a screen, shows what the package makes.

It needs ocp_viewer in the environment that runs the tests, and Chromium; docs/viewers.md has
versions that go together. `--basetemp=DIR` keeps the picture.
"""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DRIVER = Path(__file__).with_name("ocp_viewer_driver.py")
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--enable-unsafe-swiftshader",
    "--use-angle=swiftshader",
    "--window-size=1200,800",
    "--remote-debugging-port=0",  # keeps it open
]


@contextmanager
def running(command: list[str], log: Path, env: dict[str, str]) -> Iterator[None]:
    """Run a program, what it says into a file, and end it afterwards."""
    with log.open("w", encoding="utf-8") as said:
        process = subprocess.Popen(command, stdout=said, stderr=said, env=env)
        try:
            yield
        finally:
            process.terminate()
            process.wait(timeout=20)


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


def wait_for(text: str, log: Path) -> None:
    until = time.monotonic() + 60
    while text not in log.read_text(encoding="utf-8"):
        assert time.monotonic() < until, log.read_text(encoding="utf-8")
        time.sleep(0.2)


def test_ocp_viewer_shows_all_kinds_of_objects(tmp_path: Path) -> None:
    if find_spec("ocp_viewer") is None:
        pytest.skip("ocp_viewer is not installed")
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        pytest.skip("Chromium is not installed")
    from PIL import Image

    port = free_port()
    # The viewer notes its port in the home folder.
    env = {**os.environ, "HOME": str(tmp_path), "PYTHONUNBUFFERED": "1"}
    server, page, picture = (tmp_path / name for name in ("server", "page", "picture.png"))
    with ExitStack() as stack:
        viewer = [sys.executable, "-m", "ocp_viewer", "--port", str(port)]
        stack.enter_context(running(viewer, server, env))
        wait_for("OCP Viewer runs at", server)
        address = f"http://127.0.0.1:{port}/viewer"
        profile = f"--user-data-dir={tmp_path / 'profile'}"
        stack.enter_context(running([browser, *FLAGS, profile, address], page, env))
        wait_for("Browser as viewer client registered", server)
        done = subprocess.run(
            [sys.executable, str(DRIVER), str(port), str(picture)],
            capture_output=True,
            text=True,
            timeout=300,
            cwd=ROOT,
            env=env,
            check=False,
        )
    assert done.returncode == 0, done.stderr
    names = json.loads(done.stdout.splitlines()[-1])
    assert names == ["skeleton", "scaffold", "frame", "rods", "plate"]
    with Image.open(picture) as image:
        colors = image.convert("RGB").getcolors(maxcolors=1 << 24)
    background = max(count for count, _ in colors)
    assert 0.5 < background / sum(count for count, _ in colors) < 0.97
