"""What all formats share: options, repairs and their log, errors of files, the register."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scaffold_cad.errors import FormatError, OptionError, SkeletonError
from scaffold_cad.io import (
    RawSkeleton,
    _text,
    known_suffixes,
    read_raw,
    read_skeleton,
    read_with_repairs,
    register,
    register_reader,
    skeleton_to_json,
)
from scaffold_cad.skeleton import check_skeleton
from scaffold_cad.skeleton.repair import Repairs
from tests.skeletons import STICK_FIGURE, STRUT

ELBOW_OBJ = "v 0 0 0\nv 10 0 0\nv 10 10 0\nl 1 2 3\n"
"""Two edges, no radii, no faults."""

UNSHARED_OBJ = "v 0 0 0\nv 10 0 0\nv 10 0 0\nv 10 10 0\nl 1 2\nl 3 4\n"
"""The same, with a vertex of its own for each end."""

THIN_TIP_SWC = "1 1 0 0 0 2.5 -1\n2 3 10 0 0 0 1\n"
"""One edge, whose second radius is 0."""


def written(folder: Path, name: str, content: str | bytes) -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def test_radius_is_given_to_every_node_of_a_file_without_radii(tmp_path: Path) -> None:
    skeleton = read_skeleton(written(tmp_path, "elbow.obj", ELBOW_OBJ), 1.5)
    assert skeleton.radii.tolist() == [1.5, 1.5, 1.5]
    assert skeleton.edges.tolist() == [[0, 1], [1, 2]]


def test_radius_overrides_the_radii_of_the_file(tmp_path: Path) -> None:
    path = written(tmp_path, "figure.json", skeleton_to_json(STICK_FIGURE))
    assert set(read_skeleton(path, radius=0.5).radii.tolist()) == {0.5}


def test_a_path_may_be_a_string(tmp_path: Path) -> None:
    path = str(written(tmp_path, "elbow.obj", ELBOW_OBJ))
    assert len(read_skeleton(path, 1.0).edges) == 2


def test_a_file_without_radii_needs_a_radius(tmp_path: Path) -> None:
    path = written(tmp_path, "elbow.obj", ELBOW_OBJ)
    for strict in (False, True):
        with pytest.raises(FormatError, match=r"elbow\.obj has no radii; need radius="):
            read_skeleton(path, strict=strict)


def test_a_function_that_gives_no_radius_at_a_node_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, "elbow.obj", ELBOW_OBJ)
    with pytest.raises(OptionError, match=r"radius is 0 mm for node 0 at \[0, 0, 0\] mm"):
        read_skeleton(path, lambda places: places[:, 0])


@pytest.mark.parametrize("radius", [0.0, -1.0, np.nan, np.inf])
def test_a_radius_that_is_not_positive_and_finite_is_refused(tmp_path: Path, radius: float) -> None:
    path = written(tmp_path, "elbow.obj", ELBOW_OBJ)
    with pytest.raises(OptionError, match=r"radius is \S+ mm; need > 0"):
        read_skeleton(path, radius)


def test_faults_are_repaired_and_the_repairs_logged(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = written(tmp_path, "unshared.obj", UNSHARED_OBJ)
    with caplog.at_level(logging.INFO, "scaffold_cad.io"):
        skeleton = read_skeleton(path, 1.0)
    check_skeleton(skeleton)
    assert len(skeleton.nodes) == 3
    assert [(r.levelname, r.getMessage()) for r in caplog.records] == [
        ("INFO", f"{path}: 4 nodes and 2 edges read"),
        ("WARNING", f"{path} was repaired: 1 node welded"),
    ]


def test_a_sound_file_is_read_without_a_warning(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    read_skeleton(written(tmp_path, "elbow.obj", ELBOW_OBJ), 1.0)
    assert not [r for r in caplog.records if r.levelno >= logging.WARNING]


def test_repairs_are_returned_on_request(tmp_path: Path) -> None:
    cleaning = read_with_repairs(written(tmp_path, "unshared.obj", UNSHARED_OBJ), 1.0)
    assert cleaning.repairs == Repairs(nodes_welded=1)
    assert len(cleaning.skeleton.nodes) == 3


def test_options_of_repair_are_passed_on(tmp_path: Path) -> None:
    gap = written(tmp_path, "gap.obj", "v 0 0 0\nv 10 0 0\nv 10.1 0 0\nv 20 5 0\nl 1 2\nl 3 4\n")
    assert len(read_skeleton(gap, 1.0).nodes) == 4
    assert len(read_skeleton(gap, 1.0, weld_distance=0.2).nodes) == 3
    touch = written(tmp_path, "t.obj", "v 0 0 0\nv 10 0 0\nv 5 0 0\nv 5 5 0\nl 1 2\nl 3 4\n")
    assert len(read_skeleton(touch, 1.0).edges) == 2
    assert len(read_skeleton(touch, 1.0, split_contacts=True).edges) == 3


def test_strict_reading_takes_a_sound_file(tmp_path: Path) -> None:
    skeleton = read_skeleton(written(tmp_path, "elbow.obj", ELBOW_OBJ), 1.0, strict=True)
    assert len(skeleton.nodes) == 3


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("u.obj", UNSHARED_OBJ, r"u\.obj: nodes 1 and 2 are both at \[10, 0, 0\] mm"),
        ("g.graph", "n 0 0 0\nn 1 0 0\nn nan nan nan\nc 0 1\n", r"nodes\[2\] is \[nan, nan, nan\]"),
        ("l.obj", "v 0 0 0\nv 9 0 0\nl 1 2\nl 1 1\n", r"edge 1 joins node 0 at \[0, 0, 0\] mm to"),
        ("d.obj", "v 0 0 0\nv 9 0 0\nl 1 2\nl 2 1\n", r"edges 0 and 1 near \[4.5, 0, 0\] mm both"),
        ("i.graph", "n 0 0 0\nn 9 0 0\nn 1 1 1\nc 0 1\n", r"node 2 at \[1, 1, 1\] mm has no edge"),
        (
            "o.obj",
            "v 0 0 0\nv 9 0 0\nv 5 0 0\nl 1 2\nl 1 3\n",
            r"edges 0 and 1 leave node 0 at \[.*\] mm in the same direction",
        ),
    ],
)
def test_strict_reading_refuses_what_needs_repair(
    tmp_path: Path, name: str, content: str, message: str
) -> None:
    path = written(tmp_path, name, content)
    with pytest.raises(SkeletonError, match=message):
        read_skeleton(path, 1.0, strict=True)
    check_skeleton(read_skeleton(path, 1.0))


def test_strict_reading_refuses_a_radius_of_zero(tmp_path: Path) -> None:
    path = written(tmp_path, "tip.swc", THIN_TIP_SWC)
    with pytest.raises(
        SkeletonError, match=r"tip\.swc: node 1 at \[10.* mm has radius 0 mm; need > 0"
    ):
        read_skeleton(path, strict=True)
    assert read_skeleton(path).radii.tolist() == [2.5, 2.5]


@pytest.mark.parametrize("option", [{"weld_distance": 0.1}, {"split_contacts": True}])
def test_strict_reading_takes_no_option_of_repair(tmp_path: Path, option: dict[str, bool]) -> None:
    path = written(tmp_path, "elbow.obj", ELBOW_OBJ)
    with pytest.raises(OptionError, match="strict reading repairs nothing"):
        read_skeleton(path, 1.0, strict=True, **option)


def test_what_no_repair_can_mend_is_refused_with_the_name_of_the_file(tmp_path: Path) -> None:
    path = written(tmp_path, "dots.obj", "v 1 1 1\nv 1 1 1\nl 1 2\n")
    with pytest.raises(SkeletonError, match=r"dots\.obj: the skeleton has no edge longer than"):
        read_skeleton(path, 1.0)
    path = written(tmp_path, "thin.swc", "1 1 0 0 0 0 -1\n2 3 10 0 0 0 1\n")
    with pytest.raises(SkeletonError, match=r"thin\.swc: node 0 at \[0, 0, 0\] mm and all that"):
        read_skeleton(path)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"none\.swc cannot be read: there is no such file"):
        read_skeleton(tmp_path / "none.swc")


def test_a_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="is a folder; need a file"):
        read_skeleton(tmp_path)


@pytest.mark.parametrize("suffix", known_suffixes())
def test_an_empty_file_is_refused(tmp_path: Path, suffix: str) -> None:
    with pytest.raises(FormatError, match="is empty; need"):
        read_skeleton(written(tmp_path, f"empty{suffix}", ""), 1.0)


@pytest.mark.parametrize("suffix", known_suffixes())
@pytest.mark.parametrize("seed", range(3))
def test_binary_garbage_is_refused(tmp_path: Path, suffix: str, seed: int) -> None:
    noise = np.random.default_rng(seed).bytes(2000)
    with pytest.raises(FormatError, match="noise"):
        read_skeleton(written(tmp_path, f"noise{suffix}", noise), 1.0)


@pytest.mark.parametrize("suffix", known_suffixes())
def test_a_file_of_comments_or_blanks_is_refused(tmp_path: Path, suffix: str) -> None:
    for content in ("\n\n", "# nothing\n"):
        with pytest.raises(FormatError, match="blank"):
            read_skeleton(written(tmp_path, f"blank{suffix}", content), 1.0)


def test_text_with_a_zero_byte_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, "zero.obj", b"v 0 0 0\n\0")
    with pytest.raises(FormatError, match=r"zero\.obj is not text: byte 8 is zero"):
        read_skeleton(path, 1.0)


def test_a_file_that_is_too_large_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(_text, "LARGEST_FILE", 10)
    path = written(tmp_path, "large.obj", ELBOW_OBJ)
    with pytest.raises(FormatError, match=rf"has {len(ELBOW_OBJ)} bytes; need at most 10"):
        read_skeleton(path, 1.0)


def test_nodes_without_edges_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path, "loose.graph", "n 0 0 0\nn 1 1 1\n")
    with pytest.raises(FormatError, match=r"loose\.graph has 2 nodes but no edges"):
        read_skeleton(path, 1.0)


def test_an_absurd_coordinate_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, "far.obj", "v 0 0 0\nv 1e300 0 0\nl 1 2\n")
    with pytest.raises(FormatError, match=r"far\.obj: node 1 is at \[1e\+300, 0.0, 0.0\] mm; need"):
        read_skeleton(path, 1.0)
    path = written(tmp_path, "fat.swc", "1 1 0 0 0 1 -1\n2 3 10 0 0 1e99 1\n")
    with pytest.raises(FormatError, match=r"node 1 has radius 1e\+99 mm; need at most 1e\+12"):
        read_skeleton(path)


def test_an_unknown_format_is_refused_with_the_known_ones(tmp_path: Path) -> None:
    path = written(tmp_path, "notes.md", "nothing of the kind\n")
    with pytest.raises(
        FormatError, match=r"is of no known format; need one of \.3dm, \.3mf, .*\.wire"
    ):
        read_skeleton(path, 1.0)


def test_case_of_the_suffix_does_not_matter(tmp_path: Path) -> None:
    assert len(read_skeleton(written(tmp_path, "ELBOW.OBJ", ELBOW_OBJ), 1.0).edges) == 2


def test_content_decides_where_the_suffix_is_wrong_or_unknown(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    contents = {
        "OBJ": ELBOW_OBJ,
        "SWC": "# a comment\n1 1 0 0 0 1 -1\n2 3 10 0 0 1 1\n3 3 10 10 0 1 2\n",
        "GEL graph": "n 0 0 0\nn 10 0 0\nn 10 10 0\nc 0 1\nc 1 2\n",
        "CGAL polylines": "3 0.5 0 0 10.5 0 0 10 10 0\n",
        "scaffold-cad JSON": skeleton_to_json(STICK_FIGURE),
    }
    for name, content in contents.items():
        for suffix in (".txt", ".3mf", ".swc" if name == "OBJ" else ".obj"):
            caplog.clear()
            assert (
                len(read_skeleton(written(tmp_path, "skeleton" + suffix, content), 1.0).edges) > 1
            )
            assert f"is read as {name}, by its content" in caplog.text


def test_other_line_ends_a_byte_order_mark_and_foreign_letters_do_no_harm(tmp_path: Path) -> None:
    expected = read_skeleton(written(tmp_path, "plain.obj", ELBOW_OBJ), 1.0)
    for content in (
        ELBOW_OBJ.replace("\n", "\r\n").encode(),
        ELBOW_OBJ.replace("\n", "\r").encode(),
        b"\xef\xbb\xbf" + ELBOW_OBJ.encode(),
        "# gerüst\n".encode("latin-1") + ELBOW_OBJ.encode(),
    ):
        read = read_skeleton(written(tmp_path, "other.obj", content), 1.0)
        np.testing.assert_array_equal(read.nodes, expected.nodes)
        np.testing.assert_array_equal(read.edges, expected.edges)


def test_a_registered_reader_is_used_and_named_among_the_known(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(register, "_formats", list(register._formats))

    @register_reader("pairs", ".Pairs", recognizes=lambda head: head.startswith(b"pairs"))
    def read_pairs(path: Path) -> RawSkeleton:
        numbers = [float(word) for word in path.read_text().split()[1:]]
        return RawSkeleton(np.reshape(numbers, (2, 3)), np.array([[0, 1]]))

    path = written(tmp_path, "strut.pairs", "pairs 0 0 0 10 0 0")
    assert ".pairs" in known_suffixes()
    np.testing.assert_array_equal(read_skeleton(path, 1.0).nodes, STRUT.nodes)


@pytest.mark.parametrize(
    ("message", "nodes", "edges", "radii"),
    [
        (r"edges\[0\] joins nodes \[0, 2\]; need 0 to 1", np.zeros((2, 3)), [[0, 2]], None),
        (r"nodes have shape \(2, 2\); need \(n, 3\)", np.zeros((2, 2)), [[0, 1]], None),
        (r"radii have shape \(3,\); need \(2,\)", np.zeros((2, 3)), [[0, 1]], [1, 1, 1]),
        ("radii is not an array of numbers", np.zeros((2, 3)), [[0, 1]], ["a", "b"]),
    ],
)
def test_what_a_foreign_reader_gets_wrong_is_refused_with_the_name_of_the_file(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    message: str,
    nodes: np.ndarray,
    edges: Any,
    radii: Any,
) -> None:
    monkeypatch.setattr(register, "_formats", list(register._formats))
    register_reader("wrong", ".wrong", recognizes=lambda head: True)(
        lambda path: RawSkeleton(nodes, edges, radii)
    )
    with pytest.raises(FormatError, match=rf"x\.wrong: {message}"):
        read_raw(written(tmp_path, "x.wrong", "x"))


def test_raw_arrays_are_read_only_copies() -> None:
    nodes, radii = np.array([[0.0, 0, 0], [np.nan, 0, 0]]), np.array([0.0, np.nan])
    raw = RawSkeleton(nodes, np.array([[0, 1]]), radii)
    nodes[0] = 7.0
    assert raw.nodes[0].tolist() == [0, 0, 0]
    assert raw.radii is not None
    for array in (raw.nodes, raw.edges, raw.radii):
        assert not array.flags.writeable


def test_what_is_no_path_is_refused() -> None:
    with pytest.raises(OptionError, match=r"path is 5; need a str or a Path"):
        read_skeleton(5)  # type: ignore[arg-type]
