"""The page of the dial says what the points say, and charts name its settings."""

from __future__ import annotations

from scenewright.benchmarks._effort import named, page
from scenewright.gaussians.effort.points import methods


def test_the_page_holds_the_present_points() -> None:
    text = page.PAGE.read_text(encoding="utf-8")
    assert page.written(text) == text, "run python -m scenewright.benchmarks._effort.page"
    assert all(f"**{name}**" in text for name in methods())


def test_settings_are_named_by_the_words_that_mean_them() -> None:
    assert named.words("compose", effort=1.0) == " (balanced)"
    assert named.words("compose", effort=4.0) == ""
