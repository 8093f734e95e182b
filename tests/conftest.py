"""Shared fixtures: where the real data lies, seeds, and packages that are not there."""

from __future__ import annotations

import builtins
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

# Machines differ in speed, so no deadline; a failing example is the same for everyone.
settings.register_profile("scenewright", deadline=None, derandomize=True)
settings.load_profile("scenewright")

for _name in ("SCENEWRIGHT_MODEL", "SCENEWRIGHT_VLM"):
    os.environ.pop(_name, None)  # no test asks the model of whoever runs it
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")  # as the package does, for tests that import torch before it

_DATA = Path(os.environ.get("SCENEWRIGHT_DATA", Path(__file__).resolve().parents[1] / "../shared/data")).resolve()


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """Two processes for the whole suite. None beside the first where tests are named: starting them costs seconds."""
    return 2 if config.args_source is pytest.Config.ArgsSource.TESTPATHS else 0


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
