"""The page's files: small, whole, without text put in as HTML, every shortcut once."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

PAGE = Path(__file__).parents[3] / "agent" / "view" / "page"
MODULES = sorted(PAGE.rglob("*.js"))
MOST_BYTES = 300_000


def test_the_page_has_at_most_300_kb() -> None:
    assert sum(path.stat().st_size for path in PAGE.rglob("*") if path.is_file()) <= MOST_BYTES


def test_no_text_is_put_in_as_html() -> None:
    for path in MODULES:
        assert not re.search(r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\(", path.read_text()), path


def test_nothing_comes_from_elsewhere() -> None:
    for path in (*MODULES, PAGE / "index.html", PAGE / "style.css"):
        addresses = re.findall(r"https?://[^\s\"'`]+", path.read_text())
        assert set(addresses) <= {"http://www.w3.org/2000/svg"}, path


def test_every_module_that_is_imported_is_there() -> None:
    for path in MODULES:
        for name in re.findall(r"^import .*? from [\"'](.+?)[\"'];", path.read_text(), re.MULTILINE):
            assert (path.parent / name).is_file(), f"{path.name} imports {name}"


def test_every_element_that_is_sought_is_in_the_page() -> None:
    there = set(re.findall(r'\bid="([\w-]+)"', (PAGE / "index.html").read_text()))
    for path in PAGE.glob("*.js"):
        assert set(re.findall(r'byId\("([\w-]+)"\)', path.read_text())) <= there, path


def test_every_shortcut_has_one_meaning() -> None:
    keys = Counter(
        re.findall(r'"([^"]+)"', ", ".join(re.findall(r"keys: \[(.+?)\]", (PAGE / "toolbar.js").read_text())))
    )
    drawn = Counter(re.findall(r'(?:tool|gizmo|way)\("\w+", "\w+", "(\w)"\)', (PAGE / "toolbar.js").read_text()))
    assert len(drawn) == 9
    assert max((keys + drawn).values()) == 1
    assert not set("wasdqe") & set(keys + drawn)  # these move the camera
