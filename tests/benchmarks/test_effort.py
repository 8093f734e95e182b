"""The page of the dial says what the points say, and charts name its settings."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenewright.benchmarks._effort import named, page
from scenewright.benchmarks._effort.promises import read
from scenewright.gaussians.effort import Dial
from scenewright.gaussians.effort.points import methods


def test_the_page_holds_the_present_points() -> None:
    text = page.PAGE.read_text(encoding="utf-8")
    assert page.written(text) == text, "run python -m scenewright.benchmarks._effort.page"
    assert all(f"**{name}**" in text for name in methods())


def test_settings_are_named_by_the_words_that_mean_them() -> None:
    assert named.words("compose", effort=1.0) == " (balanced)"
    assert named.words("compose", effort=4.0) == ""


def test_receipts_are_read_as_the_dial_writes_them(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SCENEWRIGHT_EFFORT", f"{tmp_path}/effort.json")
    for asked, word, fits in ((100.0, "kept", True), (0.1, "told as not fitting", False)):
        dial = Dial(asked)
        chosen = dial.choose("compose", 20)
        promise = read("compose", asked, "\n".join(["seconds: total 3", *dial.lines(3.0)]), 3.0, 2.0)
        assert promise.chosen == (f"compose: {chosen.point.setting}",) and promise.fits == fits
        assert promise.predicted == pytest.approx(chosen.predicted, rel=0.01) and promise.verdict == word
    assert read("fit", 10, "\n".join(Dial(10).lines(11.0)), 11.0, 11.0).verdict == "kept"
    assert read("fit", 10, "", 12.0, 11.0).verdict == "kept in processor time alone"
    assert read("fit", 10, "", 12.0, 12.0).verdict == "missed"


def test_a_training_without_seconds_left_is_read(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SCENEWRIGHT_EFFORT", f"{tmp_path}/effort.json")
    dial = Dial(20.0)
    dial.choose("fit", 0.5)
    assert read("fit", 20.0, "\n".join(dial.lines(20.0)), 20.0, 20.0).chosen == ("fit: 60 s of training",)
