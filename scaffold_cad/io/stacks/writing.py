"""write_layers(): layers as a file whose suffix names the format.

======  ===========================================================================================
.cli    Common Layer Interface 2.0, binary or as text, mm
.3mf    a slice stack (3MF Slice Extension 1.0), mm
.svg    one drawing, a group per layer, mm
.zip    black-and-white PNG images, one per layer, and `layers.json`, which says how large they are
======  ===========================================================================================
"""

from __future__ import annotations

from os import PathLike

from scaffold_cad.base.arguments import as_flag, as_number, as_path, check_kind, checks_keywords
from scaffold_cad.base.files import replacing, unknown_suffix
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.io.stacks.cli import write_cli
from scaffold_cad.io.stacks.images import write_images
from scaffold_cad.io.stacks.precision import check_precision
from scaffold_cad.io.stacks.slicestack import write_slice_stack
from scaffold_cad.io.stacks.svg import write_svg
from scaffold_cad.layers import Layers

STACK_SUFFIXES = (".3mf", ".cli", ".svg", ".zip")
"""Suffixes of the formats that hold layers."""


@checks_keywords()
def write_layers(
    layers: Layers,
    path: str | PathLike[str],
    *,
    text: bool = False,
    pixel: float | None = None,
    label: str | None = None,
) -> None:
    """Write layers to the file at `path`, one after another, whole or not at all.

    No more than a layer is in memory at a time.

    Parameters
    ----------
    layers : from `slices`
    path : of the file; its suffix names the format
    text : whether a .cli file is one of text, not a binary one
    pixel : side of a pixel of the images in a .zip file, mm. A pixel is white where its center is
        in what is solid
    label : name of the part in a .cli file; by default that of the file

    Raises
    ------
    FormatError
        If the suffix is unknown, there is no layer, a format cannot hold the layers, its numbers
        are too coarse for them, or the file cannot be written.
    OptionError
        If `layers` are not Layers, or some of them were taken already, or an option does not fit
        the format.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from scaffold_cad import Skeleton, slices, write_layers
    >>> strut = Skeleton([[0, 0, 0], [0, 0, 9]], [[0, 1]], 1.0)
    >>> with TemporaryDirectory() as folder:
    ...     write_layers(slices(strut, thickness=0.1), Path(folder, "strut.cli"))
    ...     Path(folder, "strut.cli").stat().st_size  # 90 layers of 17 corners
    14196
    """
    check_kind(layers, Layers)
    path = as_path(path)
    suffix = check_stack(path)
    if as_flag(text, "text") and suffix != ".cli":
        raise OptionError(f"text is for .cli files; {path.name} is not one")
    if label is not None and suffix != ".cli":
        raise OptionError(f"label is for .cli files; {path.name} is not one")
    if (pixel is not None) != (suffix == ".zip"):
        need = "is for .zip files" if suffix != ".zip" else "is not given; need it, mm"
        raise OptionError(f"pixel {need}: {path.name}")
    if layers.taken:
        raise OptionError(
            f"{layers.taken} of {len(layers)} layers are taken already, as each is made only once; "
            "need those of a new call of slices"
        )
    if len(layers) == 0:
        raise FormatError(f"cannot write {path}: there are no layers; need at least one")
    check_precision(layers, path, binary=suffix == ".cli" and not text)
    with replacing(path) as fresh:
        if suffix == ".cli":
            write_cli(layers, fresh, path.stem if label is None else label, text)
        elif suffix == ".3mf":
            write_slice_stack(layers, fresh)
        elif suffix == ".svg":
            write_svg(layers, fresh)
        else:
            write_images(layers, fresh, as_number(pixel, "pixel"))


def check_stack(path: PathLike[str]) -> str:
    """Return the suffix of a file of layers.

    Raises
    ------
    FormatError
        If no format of layers has it.
    """
    suffix = as_path(path).suffix.lower()
    if suffix not in STACK_SUFFIXES:
        raise unknown_suffix(as_path(path), STACK_SUFFIXES, "layers")
    return suffix
