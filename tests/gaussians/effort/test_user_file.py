"""The calibration of a machine: written, read, and broken files."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from scenewright.gaussians.effort import Dial, user_file
from scenewright.gaussians.effort.points import method
from scenewright.gaussians.effort.user_file import Calibration


@pytest.fixture
def place(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    path = tmp_path / "settings" / "effort.json"
    monkeypatch.setenv("SCENEWRIGHT_EFFORT", str(path))
    return path


def test_a_calibration_is_read_as_it_was_written(place: Path) -> None:
    assert user_file.read() == (None, "")
    told = Calibration({"embed": 2.0, "compose": 0.5}, "a machine", "2026-01-02", "abc")
    assert user_file.write(told) == place
    assert user_file.read() == (told, "")


def test_predictions_are_scaled_and_the_report_says_whose_times_they_are(place: Path) -> None:
    plain = Dial("fast").choose("embed", 1e5).predicted
    user_file.write(Calibration({"embed": 3.0}, "a machine", "2026-01-02", "abc"))
    dial = Dial("fast")
    assert dial.choose("embed", 1e5).predicted == pytest.approx(3 * plain)
    assert "this machine, measured on 2026-01-02" in dial.lines()[0]
    assert dial.fastest("embed", 1e5) == pytest.approx(3 * method("embed").points[0].seconds(1e5))


FACTORS = [json.dumps({"version": 1, "factors": {"embed": f}}) for f in (0, -1, "x", None, 1e9)]


@pytest.mark.parametrize("content", ["{", "[]", "{}", json.dumps({"version": 9, "factors": {}}), *FACTORS])
def test_a_broken_file_is_told_and_not_used(place: Path, content: str) -> None:
    place.parent.mkdir()
    place.write_text(content)
    found, trouble = user_file.read()
    assert found is None and "bench calibrate" in trouble
    assert any("bench calibrate" in line for line in Dial("fast").lines())


def test_the_folder_for_settings_is_used_without_a_name(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("SCENEWRIGHT_EFFORT", raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    assert user_file.path() == tmp_path / "scenewright" / "effort.json"
