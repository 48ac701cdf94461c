"""Imports point down the list of wings, and the map in CONTRIBUTING names them."""

from __future__ import annotations

import re

from tests import wings


def test_every_folder_of_the_package_is_a_wing_on_a_floor() -> None:
    folders = {
        path.name
        for path in (wings.ROOT / "scaffold_cad").iterdir()
        if (path / "__init__.py").exists()
    }
    assert folders | {"errors"} == set(wings.FLOOR_OF)


def test_only_the_entrance_and_the_errors_stand_in_no_wing() -> None:
    assert set(wings.loose_modules()) <= {"__init__", "__main__", "errors"}


def test_imports_point_down_but_for_the_named_exceptions() -> None:
    upward = {(one.who, one.what) for one in wings.imports() if not one.points_down}
    assert upward == wings.EXCEPTIONS


def test_there_are_as_many_floors_as_the_longest_chain_of_imports() -> None:
    assert len(wings.floors()) == len(wings.FLOORS)


def test_no_wings_import_one_another_in_a_circle() -> None:
    assert wings.circles(wings.between_wings()) == []


def test_no_modules_import_one_another_in_a_circle() -> None:
    assert wings.circles(wings.between_modules()) == []


def test_the_map_has_a_line_for_each_wing_from_the_top_floor_down() -> None:
    page = (wings.ROOT / ".github" / "CONTRIBUTING.md").read_text("utf-8")
    there = page.split("## Where things are")[1].split("Where is")[0]
    listed = re.findall(r"^\| `(\w+)/?` \|", there, flags=re.MULTILINE)
    assert sorted(listed) == sorted(wings.FLOOR_OF)
    floors = [wings.FLOOR_OF[wing] for wing in listed]
    assert floors == sorted(floors, reverse=True)
