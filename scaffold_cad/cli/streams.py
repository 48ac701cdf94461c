"""What a command reads and writes: one file, several into a folder, or `-`, a standard stream."""

from __future__ import annotations

import argparse
import os
import shutil
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from scaffold_cad.base.files import check_name, make_folder
from scaffold_cad.cli import sizes
from scaffold_cad.errors import OptionError

STREAM = "-"
"""What stands for standard input, or output."""


def open_closed() -> None:
    """Let standard streams that are closed be empty, and take what is written."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:  # in this order they get their numbers, which no file gets
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: PTH123, SIM115


def add_output(parser: argparse.ArgumentParser, about: str) -> None:
    """Add the arguments of what is written."""
    parser.add_argument(
        "-o",
        "--output",
        required=True,
        type=sizes.path,
        metavar="OUT",
        help=f"{about}; - for standard output, or a folder, with --format",
    )
    parser.add_argument(
        "--format",
        metavar="FMT",
        help="format of - or of the files in a folder: a suffix of OUT without its dot",
    )


@contextmanager
def streamed(options: argparse.Namespace) -> Iterator[str]:
    """Let files stand for `-` while the block runs; what was written goes to standard output.

    The folder of these files is yielded, to be left out of messages, or an empty text.
    """
    inputs = getattr(options, "input", [])
    reads = STREAM in inputs if isinstance(inputs, list) else inputs == STREAM
    writes = str(getattr(options, "output", "")) == STREAM
    if not reads and not writes:
        yield ""
        return
    with TemporaryDirectory(prefix="scaffold-cad-") as folder:
        if reads:
            read = Path(folder) / f"stdin{_suffix(options.from_format, '--from')}"
            read.write_bytes(sys.stdin.buffer.read())
            options.input = _with_stream(inputs, str(read))
        if writes:
            options.output = Path(folder) / f"stdout{_suffix(options.format, '--format')}"
        yield folder
        if writes and options.output.exists():
            with options.output.open("rb") as made:
                shutil.copyfileobj(made, sys.stdout.buffer)


def _with_stream(inputs: str | list[str], path: str) -> str | list[str]:
    """Return inputs with a path where `-` was."""
    if isinstance(inputs, str):
        return path
    if inputs.count(STREAM) > 1:
        raise OptionError("- is given twice as input; need standard input once")
    return [path if one == STREAM else one for one in inputs]


def each_file(options: argparse.Namespace) -> list[argparse.Namespace]:
    """Return the options for each of several inputs, with its output.

    Raises
    ------
    OptionError
        If several inputs have one file to go to, the format of a folder is missing, or an input is
        in it.
    """
    inputs = getattr(options, "input", None)
    if not isinstance(inputs, list):
        _refuse_format(options)
        return [options]
    if not hasattr(options, "output"):
        return [_changed(options, input=one) for one in inputs]
    output: Path = options.output
    check_name(output, f"cannot write {output}")
    if output.suffix and not output.is_dir():
        if len(inputs) > 1:
            raise OptionError(f"{output} is one file for {len(inputs)} inputs; need a folder")
        _refuse_format(options)
        return [_changed(options, input=inputs[0])]
    if getattr(options, "tiles", None) is not None:
        raise OptionError("--tiles is for one file; need -o with its name")
    folder = "is a folder" if output.is_dir() else "has no suffix, as folders have none"
    suffix = _suffix(options.format, f"{output} {folder}; --format")
    outputs = [output / f"{Path(one).stem}{suffix}" for one in inputs]
    for path, count in Counter(outputs).items():
        if count > 1:
            raise OptionError(f"{count} inputs would be written to {path}; need other names")
    for one, path in zip(inputs, outputs, strict=True):
        if path.exists() and Path(one).exists() and path.samefile(one):
            raise OptionError(f"{path} is an input; need another folder, or its name for -o")
    make_folder(output)
    many = len(inputs) > 1
    return [
        _changed(options, input=one, output=path, format=None, **({"jobs": None} if many else {}))
        for one, path in zip(inputs, outputs, strict=True)
    ]


def _refuse_format(options: argparse.Namespace) -> None:
    given = getattr(options, "format", None)
    if given is not None and options.output.name != f"stdout{_suffix(given, '--format')}":
        raise OptionError(f"--format is for - and for folders; {options.output} names its own")


def _suffix(given: str | None, flag: str) -> str:
    """Return a suffix with its dot."""
    if not given:
        raise OptionError(f"{flag} is missing; need a format, such as stl or json")
    return f".{given.lower().lstrip('.')}"


def _changed(options: argparse.Namespace, **values: object) -> argparse.Namespace:
    return argparse.Namespace(**{**vars(options), **values})
