"""Run scripts in the real CQ-editor, twice each, and say what it shows, as JSON on one line.

`xvfb-run python tests/viewers/cq_editor_driver.py FOLDER SCRIPT...` puts a picture of the window
into FOLDER for each script.
"""

from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path
from typing import Any


def main(folder: Path, scripts: list[Path]) -> None:
    sys.argv = ["cq-editor"]
    from cq_editor.__main__ import app
    from cq_editor.main_window import MainWindow

    window = MainWindow()
    window.resize(1400, 900)
    window.show()
    debugger = window.components["debugger"]
    # CQ-editor cannot import scipy, which build123d needs, a second time.
    debugger.preferences["Reload imported modules"] = False
    errors: list[str] = []
    debugger.sigTraceback.connect(
        lambda error, _: errors.append(repr(error[1])) if error is not None else None
    )

    def settle() -> None:
        for _ in range(30):
            app.processEvents()
            time.sleep(0.02)

    shown: dict[str, Any] = {}
    for script in scripts:
        window.components["editor"].load_from_file(str(script))
        errors.clear()
        for _ in range(2):
            debugger.render()
            settle()
        window.components["console"].execute_command('show(skeleton, name="from the console")')
        models = window.components["object_tree"].CQ
        window.components["viewer"].fit()
        settle()
        picture = app.primaryScreen().grabWindow(int(window.winId()))
        picture.save(str(folder / f"{script.stem}.png"))
        shown[script.stem] = {
            "names": [models.child(i).text(0) for i in range(models.childCount())],
            "types": [models.child(i).shape.ShapeType() for i in range(models.childCount())],
            "errors": list(errors),
            "log": window.components["log"].toPlainText(),
            "gold": _share_of_gold(picture.toImage()),
        }
    print("\n" + json.dumps(shown), flush=True)
    os._exit(0)  # Qt and OpenGL without a screen may crash as they end


def _share_of_gold(image: Any) -> float:
    """Return the share of pixels that are golden, as CQ-editor's shapes are, of every third."""
    colors = [
        image.pixelColor(x, y).getRgb()
        for x in range(0, image.width(), 3)
        for y in range(0, image.height(), 3)
    ]
    golden = [red > 150 and green > 130 and blue < 110 for red, green, blue, _ in colors]
    return sum(golden) / len(golden)


if __name__ == "__main__":
    main(Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]])
