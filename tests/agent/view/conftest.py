"""A browser, and a room that is served to it: for tests that are marked `browser`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from real_browser import browser_or_skip
from served_page import Server, save_room


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with browser_or_skip() as opened:
        yield opened


@pytest.fixture(scope="session")
def room_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return save_room(tmp_path_factory.mktemp("room"))


@pytest.fixture
def server(room_file: Path, tmp_path: Path, browser: Any) -> Iterator[Server]:
    running = Server(room_file, tmp_path)
    yield running
    running.close()
