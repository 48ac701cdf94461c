"""What a check found: findings one by one, and the report of them all."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.arrays import Frozen, Points, UnitVectors
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.printability.processes import Process

Verdict: TypeAlias = Literal["ok", "note", "warning", "failure"]
"""As it must be; a plain figure; to be looked at; not printable."""
Topic: TypeAlias = Literal["mesh", "lattice", "build", "part"]
"""What a finding is about."""

SCHEMA = 1
"""Version of the JSON form; it grows when a key changes its meaning or goes."""

MOST_PLACES = 1000
"""How many places a finding points at; it counts them all."""

MARKS = {"ok": "ok", "note": "", "warning": "warning", "failure": "FAILURE"}


def no_places() -> Points:
    """Return no position at all, shape (0, 3)."""
    return np.zeros((0, 3))


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Finding(Frozen):
    """One thing that was looked at."""

    name: str
    """Stable and unique in a report, such as "self_intersections"."""
    topic: Topic
    verdict: Verdict
    value: Any
    """What was found, in numbers, strings, lists and dictionaries: a JSON value."""
    text: str
    """The same in words."""
    advice: str = ""
    """What to do about it; empty where nothing must be done."""
    places: Points = field(default_factory=no_places)
    """Where it is, shape (k, 3), mm; not all places of a kind need be there."""

    def __str__(self) -> str:
        return f"Finding: {self.name}, {self.verdict}: {self.text}"


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Report(Frozen):
    """Everything that a check found, in order.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, check_printability
    >>> strut = Skeleton([[0, 0, 0], [0, 0, 9]], [[0, 1]], 0.2)
    >>> report = check_printability(strut, "sls", name="pin")
    >>> report.name, report.printable, report["strut_diameter"].verdict
    ('pin', False, 'failure')
    """

    name: str
    """What was checked, such as the name of a file."""
    process: Process
    findings: tuple[Finding, ...]
    mesh: TriangleMesh
    """The surface that was checked."""
    direction: UnitVectors
    """In which it is built upwards, shape (3,)."""

    @property
    def printable(self) -> bool:
        """Whether nothing failed; there may be warnings."""
        return not self.failures

    @property
    def failures(self) -> tuple[Finding, ...]:
        """The findings that keep it from being printed."""
        return tuple(finding for finding in self if finding.verdict == "failure")

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """The findings to be looked at."""
        return tuple(finding for finding in self if finding.verdict == "warning")

    def __iter__(self) -> Iterator[Finding]:
        return iter(self.findings)

    def __getitem__(self, name: str) -> Finding:
        for finding in self.findings:
            if finding.name == name:
                return finding
        known = ", ".join(finding.name for finding in self.findings)
        raise KeyError(f"{name!r} was not checked; the findings are {known}")

    def __contains__(self, name: str) -> bool:
        return any(finding.name == name for finding in self.findings)

    def __str__(self) -> str:
        """Return a table for the terminal."""
        width = max(len(finding.name) for finding in self.findings)
        lines = [self.summary]
        topic = ""
        for finding in self.findings:
            if finding.topic != topic:
                topic = finding.topic
                lines.append(f"-- {topic} " + "-" * (width + 18 - len(topic)))
            label = finding.name.replace("_", " ")
            lines.append(f"{label:<{width}}  {MARKS[finding.verdict]:<8} {finding.text}".rstrip())
            if finding.advice:
                lines.append(f"{'':<{width}}  {'':<8} -> {finding.advice}")
        return "\n".join(lines)

    @property
    def summary(self) -> str:
        """The verdict in one line."""
        if not self.printable:
            why = ", ".join(finding.name.replace("_", " ") for finding in self.failures)
            return f"{self.name}: not printable by {self.process.name}: {why}"
        line = f"{self.name}: printable by {self.process.name}"
        if self.warnings:
            why = ", ".join(finding.name.replace("_", " ") for finding in self.warnings)
            line += f"; look at {why}"
        return line

    def as_dict(self) -> dict[str, Any]:
        """Return the report as JSON values; its keys are stable within a `SCHEMA`."""
        return {
            "schema": SCHEMA,
            "name": self.name,
            "process": self.process.name,
            "printable": self.printable,
            "findings": {
                finding.name: {
                    "topic": finding.topic,
                    "verdict": finding.verdict,
                    "value": finding.value,
                    "text": finding.text,
                    "advice": finding.advice,
                    "places": finding.places.tolist(),
                }
                for finding in self.findings
            },
        }

    def to_json(self) -> str:
        """Return the report as JSON text."""
        return json.dumps(self.as_dict(), indent=2, allow_nan=False)
