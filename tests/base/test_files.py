"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from scaffold_cad.base.files import check_target, check_there, remove_unfinished, replacing
from scaffold_cad.errors import FormatError


def names_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def write_half(path: Path, error: type[BaseException] | BaseException) -> None:
    with replacing(path) as fresh:
        fresh.write_text("half")
        raise error


def test_a_new_file_appears_once_it_is_done(tmp_path: Path) -> None:
    path = tmp_path / "cube.stl"
    with replacing(path) as fresh:
        assert fresh.parent == tmp_path
        assert fresh.suffix == ".stl"
        fresh.write_text("new")
        assert not path.exists()
    assert path.read_text() == "new"
    assert names_in(tmp_path) == ["cube.stl"]


def test_a_file_is_replaced_and_keeps_its_permissions(tmp_path: Path) -> None:
    path = tmp_path / "cube.stl"
    path.write_text("old")
    path.chmod(0o640)
    with replacing(path) as fresh:
        fresh.write_text("new")
        assert path.read_text() == "old"
    assert path.read_text() == "new"
    if os.name == "posix":
        assert path.stat().st_mode & 0o777 == 0o640


@pytest.mark.skipif(os.name != "posix", reason="permissions are those of POSIX")
def test_a_new_file_has_the_permissions_of_any_new_file(tmp_path: Path) -> None:
    (tmp_path / "plain").touch()
    with replacing(tmp_path / "cube.stl") as fresh:
        fresh.write_text("new")
    assert (tmp_path / "cube.stl").stat().st_mode == (tmp_path / "plain").stat().st_mode


@pytest.mark.parametrize("error", [KeyboardInterrupt, MemoryError, FormatError])
def test_after_an_error_all_is_as_it_was(tmp_path: Path, error) -> None:
    path = tmp_path / "cube.stl"
    path.write_text("old")
    with pytest.raises(error):
        write_half(path, error)
    assert path.read_text() == "old"
    assert names_in(tmp_path) == ["cube.stl"]


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (OSError(28, "No space left on device"), "No space left on device"),
        (OSError("90 requested and 8 written"), "90 requested and 8 written; is the disk full?"),
    ],
)
def test_an_error_of_the_system_is_one_line_about_the_file(tmp_path: Path, error, reason) -> None:
    path = tmp_path / "cube.stl"
    with pytest.raises(FormatError) as caught:
        write_half(path, error)
    assert str(caught.value) == f"cannot write {path}: {reason}"
    assert names_in(tmp_path) == []


@pytest.mark.skipif(os.name != "posix", reason="links need no privilege on POSIX")
def test_a_link_keeps_pointing_to_the_file(tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    target = tmp_path / "elsewhere" / "cube.stl"
    target.write_text("old")
    link = tmp_path / "link.stl"
    link.symlink_to(target)
    with replacing(link) as fresh:
        fresh.write_text("new")
    assert link.is_symlink()
    assert target.read_text() == "new"


def test_bad_targets_are_refused(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "folder.stl").mkdir()
    for name, reason in (
        ("nowhere/cube.stl", f"there is no folder {tmp_path / 'nowhere'}"),
        ("file/cube.stl", f"{tmp_path / 'file'} is not a folder"),
        ("folder.stl", "it is a folder; need the name of a file"),
        (f"{300 * 'a'}.stl", "its name is too long for a file"),
    ):
        path = tmp_path / name
        with pytest.raises(FormatError, match=re.escape(f"cannot write {path}: {reason}")):
            check_target(path)


@pytest.mark.skipif(not Path("/dev/null").exists(), reason="needs a device")
def test_a_device_is_not_replaced() -> None:
    with pytest.raises(FormatError, match="cannot write /dev/null: it is a device"):
        check_target(Path("/dev/null"))


def test_a_read_only_folder_is_refused(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr("os.access", lambda path, mode: False)
    message = re.escape(f"the folder {tmp_path} is read-only")
    with pytest.raises(FormatError, match=message):
        check_target(tmp_path / "cube.stl")


@pytest.mark.skipif(os.name != "posix", reason="links ask for rights elsewhere")
def test_a_link_into_a_missing_folder_is_told(tmp_path: Path) -> None:
    link = tmp_path / "cube.stl"
    link.symlink_to(tmp_path / "gone" / "cube.stl")
    need = re.escape(f"cannot write {link}: there is no folder {tmp_path / 'gone'}")
    with pytest.raises(FormatError, match=need):
        check_target(link)


def test_a_name_with_a_null_is_refused() -> None:
    with pytest.raises(FormatError, match="its name has a null character"):
        check_target(Path("a\0.stl"))


def test_what_killed_processes_left_is_removed(tmp_path: Path) -> None:
    for name in (".scaffold-cad-12-ab.stl", ".scaffold-cad-123-ab.stl", "12-ab.stl"):
        (tmp_path / name).touch()
    remove_unfinished(tmp_path, [12, 7, None])
    assert names_in(tmp_path) == [".scaffold-cad-123-ab.stl", "12-ab.stl"]
    with replacing(tmp_path / "cube.stl") as fresh:
        remove_unfinished(tmp_path, [os.getpid()])
        assert not fresh.exists()
        fresh.touch()


@pytest.mark.skipif(os.name != "posix", reason="pipes are those of POSIX")
def test_a_pipe_is_refused_before_it_is_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.json")
    with pytest.raises(FormatError, match="is a pipe or a device; need a file"):
        check_there(tmp_path / "pipe.json")
