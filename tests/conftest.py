"""Shared fixtures: where the real data lies, seeds, and packages that are not there."""

from __future__ import annotations

import builtins
import gc
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from amounts import ALL, SHARE
from hypothesis import settings

# Machines differ in speed, so no deadline; a failing example is the same for everyone.
settings.register_profile("all", deadline=None, derandomize=True, max_examples=ALL)
settings.register_profile("share", settings.get_profile("all"), max_examples=round(SHARE * ALL))
settings.load_profile("share")

for _name in ("SCENEWRIGHT_MODEL", "SCENEWRIGHT_VLM"):
    os.environ.pop(_name, None)  # no test asks the model of whoever runs it
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")  # as the package does, for tests that import torch before it

# Modules are compiled once, not in each process of each run, whatever the surroundings say about `__pycache__` folders:
# numba keeps machine code in them anyway, and compiling took a fifth of the time of a run.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

gc.set_threshold(20_000, 20, 20)  # tests make many objects and few cycles of them

_DATA = Path(os.environ.get("SCENEWRIGHT_DATA", Path(__file__).resolve().parents[1] / "../shared/data")).resolve()


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """Two processes for the whole suite. None beside the first where tests are named: starting them costs seconds."""
    return 2 if config.args_source is pytest.Config.ArgsSource.TESTPATHS else 0


def pytest_configure(config: pytest.Config) -> None:
    if _slow(config):
        settings.load_profile("all")


def _slow(config: pytest.Config) -> bool:
    return "not slow" not in config.option.markexpr


def pytest_itemcollected(item: pytest.Item) -> None:
    """Properties, which the default run tries with a share of their examples, are slow tests too: there with all."""
    if _slow(item.config) and getattr(getattr(item, "obj", None), "is_hypothesis_test", False):
        item.add_marker("slow")


def pytest_collection_finish() -> None:
    """Libraries and collected tests live to the end: no collection of garbage looks through them again."""
    gc.freeze()


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """The folder of real scenes; tests that need it are skipped where it is absent."""
    if not _DATA.is_dir():
        pytest.skip(f"real data not found at {_DATA}; set SCENEWRIGHT_DATA to run this test")
    return _DATA


@pytest.fixture
def uninstalled(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Called with a package's name, lets it look as if it were not installed."""
    real = builtins.__import__

    def remove(package: str) -> None:
        def refuse(name: str, *args: Any, **kwargs: Any) -> Any:
            if name == package:
                raise ModuleNotFoundError(f"No module named {package!r}", name=package)
            return real(name, *args, **kwargs)

        monkeypatch.setattr(builtins, "__import__", refuse)

    return remove
