"""Frames beside other engines: which ratio is told, and what is said where the others cannot be had."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenewright.benchmarks._view import engines
from scenewright.benchmarks.view import beside
from scenewright.gaussians.errors import BackendError


def row(engine: str, frame: float, cpu: float) -> engines.Row:
    return engines.Row("swiftshader", "room", "512x512", engine, frame, cpu, 40.0)


def test_ours_is_held_against_the_better_of_the_others() -> None:
    found = {m.key: m for m in beside([row("ours", 80, 90), row("playcanvas", 100, 120), row("spark", 400, 90)])}
    ratio, cpu = (found[f"beside.swiftshader.room.512x512.{name}"] for name in ("ratio", "cpu_ratio"))
    assert (ratio.value, cpu.value) == (0.8, 1.0)
    assert (ratio.met, cpu.met) == (True, False)


def test_without_the_others_there_is_no_ratio() -> None:
    found = [m.key for m in beside([row("ours", 80, 90)])]
    assert found and not [key for key in found if "ratio" in key]


def test_without_npm_it_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(BackendError, match="there is no npm"):
        engines.fetched()


def test_packages_of_another_version_are_not_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("PATH", str(tmp_path))
    modules = tmp_path / "scenewright" / "engines" / "node_modules"
    for name, _, version in (package.rpartition("@") for package in engines.PACKAGES):
        (modules / name).mkdir(parents=True)
        (modules / name / "package.json").write_text(f'{{"version": "{version}"}}')
    assert engines.fetched() == modules
    (modules / "three" / "package.json").write_text('{"version": "0.1.0"}')
    with pytest.raises(BackendError, match="npm"):
        engines.fetched()
