"""`bench view` on a machine without a browser."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenewright.benchmarks import view
from scenewright.benchmarks._view import browser, faults, levels, words


@pytest.mark.slow
def test_without_a_browser_the_rest_is_measured_and_what_was_left_out_is_told(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(browser, "CHROMIUM", tmp_path / "no-browser")
    monkeypatch.setattr(words, "measure", lambda quick: [{"seconds": 0.2, "bytes_over_changed": 1.1}])
    monkeypatch.setattr(
        faults, "measure", lambda quick: [{"fault": "one", "same": True}, {"fault": "two", "same": False}]
    )
    monkeypatch.setattr(levels, "measure", lambda quick: ([], ["no room"]))
    made = view.run(quick=True)
    found = {metric.key: metric.value for metric in made.metrics}
    assert found["faults.wrong"] == 1 and found["words.seconds"] == 0.2 and found["words.bytes"] == 1.1
    assert not any(key.endswith((".opened", ".psnr", ".click")) for key in found)
    assert made.notes[0].startswith("the rows of drawing") and "no-browser" in made.notes[0]
    assert "no room" in made.notes


def test_levels_are_judged_against_leaving_out_the_least_visible() -> None:
    row = {"scene": "a", "level": 2, "gaussians": 5, "bytes": 7, "draw": 1.5, "psnr": 30.0, "dropped": 29.5}
    found = {metric.key: metric for metric in view._level(row)}
    assert found["a.level2.over_dropping"].value == 0.5 and found["a.level2.over_dropping"].met is False
    assert found["a.level2.psnr"].value == 30.0 and found["a.level2.bytes"].unit == "B"
    finest = view._level(row | {"level": 0, "dropped": 120.0})
    assert not any(metric.key.endswith("over_dropping") for metric in finest)


@pytest.mark.slow
def test_levels_of_a_small_room() -> None:
    rows, notes = levels.measure(quick=True)
    assert not notes and [row["level"] for row in rows if "level" in row] == [0, 1, 2, 3]
    for row in rows[1:4]:
        assert row["psnr"] > row["dropped"] + 1 and row["bytes"] < rows[0]["bytes"]
    assert [row["view"] for row in rows[4:]] == ["near", "far"]
    assert all(0 < row["share"] <= 1 and row["psnr_least"] <= row["psnr"] for row in rows[4:])
