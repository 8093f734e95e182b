"""bench structure: imports are read as Python reads them, circles are found, and a walk records what it enters."""

from __future__ import annotations

from pathlib import Path

from scenewright.benchmarks import structure
from scenewright.gaussians import color


def test_imports_are_resolved_relative_to_their_package(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text("from ..tools import measure\nfrom . import c\n\ndef f():\n    from .c import d\n")
    modules = {name: tmp_path / "x.py" for name in ("a.b", "a.c", "tools.measure", "tools")}
    assert list(structure.imported("a.b", tmp_path / "b.py", modules)) == ["a.c", "tools.measure"]


def test_circles_of_imports_are_found() -> None:
    modules = {name: Path() for name in "abcd"}
    assert structure.cycles(modules, [("a", "b"), ("b", "c"), ("c", "a"), ("c", "d")]) == [["a", "b", "c"]]
    assert structure.cycles(modules, [("a", "b"), ("a", "c"), ("b", "d"), ("c", "d")]) == []


def test_a_walk_records_files_functions_and_changes_of_package() -> None:
    walk = structure.Walk()
    walk.take(lambda: color.parse("teal"))
    assert walk.files == {"gaussians/color.py"} and ("gaussians/color.py", "parse") in walk.functions
    assert walk.changes == 0
