"""What a command tells of its start, that garbage is collected again after it, and how the process ends."""

from __future__ import annotations

import gc
import importlib
import inspect
import subprocess
import sys
import time
from pathlib import Path

import pytest

from scenewright.agent import cli, startup


def test_seconds_count_from_the_start_of_a_process_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(startup, "_began", None)
    now = time.perf_counter()
    assert startup.began(now) == now
    startup.own_process()
    assert startup.began(now) <= now - 0.05  # reading pytest alone takes longer
    assert startup.began(0.0) == 0.0


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
    kept = gc.get_freeze_count()
    assert kept
    startup.begin()
    startup.end()
    assert gc.get_freeze_count() <= kept  # a second command in this process leaves its garbage to be collected


@pytest.mark.parametrize("verb", cli.LOADING_FIRST)
def test_verbs_that_load_first_collect_garbage_while_they_work(verb: str) -> None:
    module = importlib.import_module(f"scenewright.agent.commands.{verb.replace('-', '_')}")
    source = inspect.getsource(module)
    assert "startup.end()" in source or "open_session(" in source  # which calls it


ENDING = """
import atexit, sys, threading
from scenewright.agent import cli

class Kept:
    def __del__(self):
        print("taken apart")

kept = Kept()
atexit.register(print, "functions have run")
threading.Thread(target=lambda: (threading.main_thread().join(), print("threads have ended"))).start()
sys.argv = ["scenewright", *{arguments}]
cli.main()
"""


@pytest.mark.parametrize(("arguments", "code"), [(["--version"], 0), (["nonsense"], 2), (["info", "absent.ply"], 4)])
def test_the_process_ends_whole_but_is_not_taken_apart(arguments: list[str], code: int) -> None:
    done = subprocess.run(
        [sys.executable, "-c", ENDING.format(arguments=arguments)], capture_output=True, text=True, check=False
    )
    assert done.returncode == code
    assert done.stdout.splitlines()[-2:] == ["threads have ended", "functions have run"]
    assert code == 0 or "scenewright: " in done.stderr
