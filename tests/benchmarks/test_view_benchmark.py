"""`bench view` on a machine without a browser."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenewright.benchmarks import view
from scenewright.benchmarks._view import browser, faults, words


def test_without_a_browser_the_rest_is_measured_and_what_was_left_out_is_told(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(browser, "CHROMIUM", tmp_path / "no-browser")
    monkeypatch.setattr(words, "measure", lambda quick: [{"seconds": 0.2, "bytes_over_changed": 1.1}])
    monkeypatch.setattr(
        faults, "measure", lambda quick: [{"fault": "one", "same": True}, {"fault": "two", "same": False}]
    )
    made = view.run(quick=True)
    found = {metric.key: metric.value for metric in made.metrics}
    assert found["faults.wrong"] == 1 and found["words.seconds"] == 0.2 and found["words.bytes"] == 1.1
    assert not any(key.endswith((".opened", ".psnr", ".click")) for key in found)
    assert made.notes[0].startswith("the rows of drawing") and "no-browser" in made.notes[0]
