"""A report as one HTML page that needs nothing else: the table, and the part with its marks."""

from __future__ import annotations

import json
from base64 import b64encode
from html import escape
from importlib.resources import files
from itertools import groupby
from os import PathLike
from pathlib import Path
from string import Template

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.files import replacing
from scaffold_cad.printability.report import MARKS, Finding, Report


def write_page(report: Report, path: str | PathLike[str]) -> None:
    """Write a report as an HTML page, whole or not at all.

    Raises
    ------
    FormatError
        If the file cannot be written.
    """
    with replacing(Path(path)) as fresh:
        fresh.write_text(page(report), encoding="utf-8")


def page(report: Report) -> str:
    """Return a report as the text of an HTML page that refers to nothing outside itself."""
    template = files("scaffold_cad.printability").joinpath("page.html").read_text("utf-8")
    return Template(template).substitute(
        title=escape(f"{report.name}: printability"),
        answer="yes" if report.printable else "no",
        summary=escape(report.summary),
        tables="\n".join(
            f"<h2>{topic}</h2><table>{''.join(_row(finding) for finding in findings)}</table>"
            for topic, findings in groupby(report, key=lambda finding: finding.topic)
        ),
        # "</script>" must not occur in it.
        model=_model(report).replace("<", "\\u003c"),
    )


def _row(finding: Finding) -> str:
    advice = f'<div class="advice">{escape(finding.advice)}</div>' if finding.advice else ""
    placed = " placed" if len(finding.places) else ""
    return (
        f'<tr class="{finding.verdict}{placed}" data-name="{finding.name}">'
        f"<td>{finding.name.replace('_', ' ')}</td>"
        f'<td><span class="badge">{MARKS[finding.verdict].lower()}</span></td>'
        f"<td>{escape(finding.text)}{advice}</td></tr>"
    )


def _model(report: Report) -> str:
    """Return what the page draws, as JSON."""
    vertices = report.mesh.vertices
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    return json.dumps(
        {
            "vertices": _base64(vertices.astype("<f4")),
            "triangles": _base64(report.mesh.triangles.astype("<u4")),
            "center": ((low + high) / 2).tolist(),
            # The diagonal: the part stays in view however it is turned.
            "size": max(float(np.linalg.norm(high - low)), 1e-9),
            "up": report.direction.tolist(),
            "floor": float((vertices @ report.direction).min()),
            "placed": [
                {
                    "name": finding.name,
                    "verdict": finding.verdict,
                    "places": np.round(finding.places, 6).reshape(-1).tolist(),
                }
                for finding in report
                if len(finding.places)
            ],
        },
        allow_nan=False,
    )


def _base64(array: NDArray[np.generic]) -> str:
    return b64encode(array.tobytes()).decode("ascii")
