"""Mutations of files: what storms, editors and attackers do to them."""

from __future__ import annotations

import re

from hypothesis import strategies as st

NUMBERS = (
    b"0",
    b"-1",
    b"nan",
    b"inf",
    b"-inf",
    b"1e308",
    b"1e-320",
    b"1e999",
    b"-0.0",
    b"2147483648",
    b"4294967295",
    b"9223372036854775807",
    b"18446744073709551616",
    b"-9223372036854775809",
    b"9" * 400,
    b"1_000",
    b"0x10",
    "٣".encode(),
    b"",
)
"""What is written in place of a number."""

TOKENS = (
    b"[" * 3000,
    b'{"a":' * 3000,
    b"<a>" * 3000,
    b"<!DOCTYPE a [<!ENTITY b 'bbbb'>]>",
    b"&lt;&#0;&b;",
    b"\0",
    b"\xff\xfe",
    b"\xf0\x9f\x92\xa5",
    b"\\\n",
    b"#",
    b'"',
    b"null",
    b"true",
    b"{}",
    b"[]",
    b"\n\n",
    b" " * 5000,
    b"../../../../etc/passwd",
    b"\xff\xff\xff\xff",
    b"\xff\xff\xff\x7f",
    b"\0\0\0\0\0\0\0\0",
)
"""What is put in, or in place of a piece."""

_NUMBER = re.compile(rb"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")


@st.composite
def mutated(draw: st.DrawFn, content: bytes) -> bytes:
    """Draw `content` with 1 to 4 mutations."""
    for _ in range(draw(st.integers(1, 4))):
        content = draw(st.sampled_from(_MUTATIONS))(draw, content)
    return content


def _place(draw: st.DrawFn, content: bytes) -> int:
    return draw(st.integers(0, len(content)))


def _piece(draw: st.DrawFn, content: bytes) -> tuple[int, int]:
    start = _place(draw, content)
    return start, min(len(content), start + draw(st.integers(1, 60)))


def _cut(draw: st.DrawFn, content: bytes) -> bytes:
    return content[: _place(draw, content)]


def _flip(draw: st.DrawFn, content: bytes) -> bytes:
    at = _place(draw, content)
    changed = bytearray(content)
    for value in changed[at : at + 1]:
        changed[at] = value ^ (1 << draw(st.integers(0, 7)))
    return bytes(changed)


def _drop(draw: st.DrawFn, content: bytes) -> bytes:
    start, stop = _piece(draw, content)
    return content[:start] + content[stop:]


def _repeat(draw: st.DrawFn, content: bytes) -> bytes:
    start, stop = _piece(draw, content)
    return content[:stop] + content[start:stop] * draw(st.integers(1, 300)) + content[stop:]


def _insert(draw: st.DrawFn, content: bytes) -> bytes:
    at = _place(draw, content)
    return content[:at] + draw(st.sampled_from(TOKENS)) + content[at:]


def _swap_number(draw: st.DrawFn, content: bytes) -> bytes:
    found = list(_NUMBER.finditer(content))
    if not found:
        return content
    number = draw(st.sampled_from(found))
    return content[: number.start()] + draw(st.sampled_from(NUMBERS)) + content[number.end() :]


def _swap_lines(draw: st.DrawFn, content: bytes) -> bytes:
    lines = content.split(b"\n")
    lines.insert(draw(st.integers(0, len(lines))), lines.pop(draw(st.integers(0, len(lines) - 1))))
    return b"\n".join(lines)


_MUTATIONS = (_cut, _flip, _drop, _repeat, _insert, _swap_number, _swap_number, _swap_lines)
