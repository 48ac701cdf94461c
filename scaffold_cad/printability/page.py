"""A report as one HTML page that needs nothing else: the table, and the part with its marks."""

from __future__ import annotations

from html import escape
from importlib.resources import files
from itertools import groupby
from os import PathLike

from scaffold_cad.base.arguments import as_path
from scaffold_cad.base.files import replacing
from scaffold_cad.printability.report import MARKS, Finding, Report
from scaffold_cad.webpage.scene import Dots, Layer, Scene, Surface, filled

PART = "#8ca8cc"
TINTS = {"failure": "#c71a24", "warning": "#e68c00", "note": "#3366cc"}
"""Color of the marks by verdict, most pressing first; what is ok has no places to mark."""

MANY = 60
"""Marks of a finding from which on they are drawn small."""


def write_page(report: Report, path: str | PathLike[str]) -> None:
    """Write a report as an HTML page, whole or not at all.

    Raises
    ------
    FormatError
        If the file cannot be written.
    """
    with replacing(as_path(path)) as fresh:
        fresh.write_text(page(report), encoding="utf-8")


def page(report: Report) -> str:
    """Return a report as the text of an HTML page that refers to nothing outside itself."""
    return filled(
        files("scaffold_cad.printability").joinpath("page.html").read_text("utf-8"),
        _scene(report),
        title=escape(f"{report.name}: printability"),
        answer="yes" if report.printable else "no",
        summary=escape(report.summary),
        tables="\n".join(
            f"<h2>{topic}</h2><table>{''.join(_row(finding) for finding in findings)}</table>"
            for topic, findings in groupby(report, key=lambda finding: finding.topic)
        ),
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


def _scene(report: Report) -> Scene:
    """Return the part and a layer of marks for each finding that has places."""
    placed = [finding for finding in report if len(finding.places)]
    verdicts = {finding.verdict for finding in placed}
    # Failures first: a part that hangs over is full of marks.
    worst = next((verdict for verdict in TINTS if verdict in verdicts), None)
    marks = [
        Layer(
            finding.name,
            (
                Dots(
                    finding.places,
                    TINTS[finding.verdict],
                    size=7.0 if len(finding.places) > MANY else 14.0,
                ),
            ),
            shown=finding.verdict == worst,
        )
        for finding in placed
    ]
    return Scene((Layer("part", (Surface(report.mesh, PART),)), *marks), report.direction)
