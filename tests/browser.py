"""Pages in a headless Chromium: a script looks at them from inside and reports what it sees."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import tempfile
from html import unescape
from pathlib import Path
from typing import Any

import pytest

CHROMIUM = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), ""
)

needs_chromium = pytest.mark.skipif(not CHROMIUM, reason="no Chromium to show pages in")

OPTIONS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--window-size=640,480",
]

HELPERS = """
function pixels(inside = window) {
  inside.dispatchEvent(new Event("resize"));  // drawn now: what was drawn before may be gone
  const canvas = inside.document.getElementById("view"), copy = document.createElement("canvas");
  [copy.width, copy.height] = [canvas.width, canvas.height];
  const flat = copy.getContext("2d");
  flat.drawImage(canvas, 0, 0);
  return new Uint32Array(flat.getImageData(0, 0, copy.width, copy.height).data.buffer);
}
function unlike(one, other) { return one.filter((pixel, k) => pixel !== other[k]).length; }
function count(picture, hex) {
  const [r, g, b] = [1, 3, 5].map(k => parseInt(hex.slice(k, k + 2), 16));
  return picture.filter(p => (p & 255) === r && (p >> 8 & 255) === g && (p >> 16 & 255) === b)
    .length;
}
function box(name, inside = window) {
  return inside.document.querySelector(`input[value="${name}"]`);
}
"""


def seen_in(page: str, script: str, folder: Path, *, fragment: str = "", webgl: bool = True) -> Any:
    """Return what `script`, the body of a function, returns at the end of a page.

    It may use `pixels()`, `unlike(a, b)`, `count(picture, "#rrggbb")` and `box(layer)`. The test is
    skipped where the browser has no WebGL 2; without `webgl` the browser is started so.
    """
    end = f"""<script>{HELPERS}
    window.addEventListener("load", () => {{
      const told = document.createElement("pre"), look = () => {{ {script} }};
      told.id = "told";
      const gl = document.createElement("canvas").getContext("webgl2");
      if (!gl && {json.dumps(webgl)}) told.textContent = JSON.stringify({{ blind: true }});
      else try {{ told.textContent = JSON.stringify({{ seen: look() }}); }}
      catch (error) {{ told.textContent = JSON.stringify({{ error: String(error) }}); }}
      document.body.append(told);
    }});
    </script></body>"""
    path = folder / "page.html"
    path.write_text(page.replace("</body>", end), encoding="utf-8")
    # Its children may still write when it has ended.
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        shown = subprocess.run(
            [
                CHROMIUM,
                *OPTIONS,
                *([] if webgl else ["--disable-3d-apis"]),
                f"--user-data-dir={profile}",
                "--dump-dom",
                f"{path.as_uri()}{fragment}",
            ],
            capture_output=True,
            encoding="utf-8",
            timeout=120,
            check=True,
        )
    told = re.search(r'<pre id="told">(.*?)</pre>', shown.stdout, flags=re.DOTALL)
    assert told, shown.stderr
    answer = json.loads(unescape(told[1]))
    if "blind" in answer:
        pytest.skip("this Chromium has no WebGL 2")
    assert "error" not in answer, answer["error"]
    return answer["seen"]
