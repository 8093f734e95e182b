"""What a command tells of its start, and that garbage is collected again after it."""

from __future__ import annotations

import gc
import importlib
import sys
from pathlib import Path

import pytest

from scenewright.agent import startup


def test_debug_tells_the_package_that_took_the_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    busy = "import time, quick_to_load\nend = time.process_time() + 0.06\nwhile time.process_time() < end: pass\n"
    (tmp_path / "slow_to_load.py").write_text(busy)
    (tmp_path / "quick_to_load.py").write_text("value = 1\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(startup, "_watch", None)
    monkeypatch.setattr(sys, "meta_path", list(sys.meta_path))
    monkeypatch.setattr(sys, "modules", dict(sys.modules))
    assert startup.told() == []
    startup.watch_imports()
    monkeypatch.setattr(startup, "_watch", None)
    startup.watch_imports()  # two of them, as of two commands in one process
    importlib.import_module("slow_to_load")
    imports, kernels = startup.told()[:2]
    assert ": slow_to_load 0." in imports and "quick_to_load" not in imports
    assert "kernel" in kernels


def test_garbage_is_collected_again_after_the_start() -> None:
    assert gc.isenabled()
    startup.begin()
    assert not gc.isenabled()
    startup.end()
    assert gc.isenabled()
