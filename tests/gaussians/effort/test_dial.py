"""The dial: what it takes, what it chooses, and what it says."""

from __future__ import annotations

import math
import time

import pytest

from scenewright.gaussians import effort
from scenewright.gaussians.effort import Dial, Method, parse
from scenewright.gaussians.effort import dial as module
from scenewright.gaussians.effort.points import WORDS, methods
from scenewright.gaussians.errors import UserError


def _method(*points: dict[str, object]) -> Method:
    told = {"unit": "dB", "sized_by": "Gaussians", "size": 100, "scene": "a room", "revision": "abc"}
    return Method.of("test", {**told, "points": list(points)})


PLAIN = _method(
    {"setting": "a", "settings": {"n": 1}, "fixed": 1, "per": 0.01, "accuracy": 20, "names": ["fast"]},
    {"setting": "b", "settings": {"n": 2}, "fixed": 2, "per": 0.02, "accuracy": 25, "names": ["balanced"]},
    {"setting": "c", "settings": {"n": 3}, "fixed": 4, "per": 0.04, "accuracy": 26, "names": ["accurate"]},
    {"setting": "d", "settings": {"n": 4}, "fixed": 8, "per": 0.0, "accuracy": 25.5},
)
CLOCKED = _method(
    {"setting": "60 s", "settings": {}, "fixed": 2, "per": 0, "clock": 60, "accuracy": 25, "names": ["fast"]},
    {"setting": "300 s", "settings": {}, "fixed": 2, "per": 0, "clock": 300, "accuracy": 28, "names": ["balanced"]},
    {"setting": "600 s", "settings": {}, "fixed": 2, "per": 0, "clock": 600, "accuracy": 29, "names": ["accurate"]},
)


@pytest.fixture(autouse=True)
def _without_calibration(monkeypatch: pytest.MonkeyPatch, tmp_path: object) -> None:
    monkeypatch.setenv("SCENEWRIGHT_EFFORT", f"{tmp_path}/effort.json")


def _dial(given: effort.Effort, of: Method, monkeypatch: pytest.MonkeyPatch, spent: float = 0.0) -> Dial:
    monkeypatch.setattr(module, "method", lambda name: of)
    return Dial(given, time.perf_counter() - spent)


@pytest.mark.parametrize(
    ("given", "meant"), [("fast", "fast"), (" Accurate ", "accurate"), ("30", 30.0), ("2.5s", 2.5), (7, 7.0)]
)
def test_words_and_seconds(given: effort.Effort, meant: effort.Effort) -> None:
    assert parse(given) == meant


@pytest.mark.parametrize("given", ["quick", "", "-3", "0", 0, -1.0, math.nan, "nan", math.inf, "inf", True, "fast 3"])
def test_anything_else_is_refused_and_what_is_allowed_is_named(given: effort.Effort) -> None:
    with pytest.raises(UserError, match="fast, balanced, accurate or a number of seconds"):
        parse(given)


@pytest.mark.parametrize(("word", "n"), [("fast", 1), ("balanced", 2), ("accurate", 3)])
def test_a_word_means_its_point(word: str, n: int, monkeypatch: pytest.MonkeyPatch) -> None:
    chosen = _dial(word, PLAIN, monkeypatch).choose("test", 100)
    assert chosen.settings == {"n": n} and chosen.fits
    assert chosen.predicted == pytest.approx(2.0 * 2 ** (n - 1))


def test_seconds_mean_the_most_accurate_point_that_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    for seconds, n in ((2.5, 1), (5, 2), (7.9, 2), (8.5, 3), (100, 3)):
        chosen = _dial(seconds, PLAIN, monkeypatch).choose("test", 100)
        assert chosen.settings == {"n": n} and chosen.fits and chosen.predicted <= seconds


def test_what_was_spent_and_what_is_reserved_is_not_spent_again(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _dial(9, PLAIN, monkeypatch, spent=4.5).choose("test", 100).settings == {"n": 2}
    assert _dial(9, PLAIN, monkeypatch).choose("test", 100, reserve=6).settings == {"n": 1}


def test_a_larger_scene_gets_less(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _dial(10, PLAIN, monkeypatch).choose("test", 100).settings == {"n": 3}
    assert _dial(10, PLAIN, monkeypatch).choose("test", 350).settings == {"n": 4}


def test_the_fastest_is_taken_and_told_where_nothing_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    dial = _dial(0.5, PLAIN, monkeypatch)
    chosen = dial.choose("test", 100)
    assert chosen.settings == {"n": 1} and not chosen.fits
    assert any("nothing that was measured of test fits" in line for line in dial.lines(2.0))
    assert dial.data(2.0)["kept"] is False


def test_a_clock_gets_all_that_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    for seconds, measured in ((100, 25), (310, 28), (5000, 29)):
        chosen = _dial(seconds, CLOCKED, monkeypatch).choose("test", 1)
        assert chosen.clock == pytest.approx(seconds - 2, abs=0.1) and chosen.point.accuracy == measured
        assert "at least" in chosen.sentence()


def test_a_clock_for_which_nothing_is_left_is_as_short_as_it_gets(monkeypatch: pytest.MonkeyPatch) -> None:
    dial = _dial(1.5, CLOCKED, monkeypatch)
    chosen = dial.choose("test", 1)
    assert not chosen.fits and chosen.clock == module.LEAST_CLOCK and chosen.data()["accuracy"] is None
    assert any("as short as it gets" in line for line in dial.lines(3.0))


def test_a_clock_shorter_than_measured_claims_no_accuracy(monkeypatch: pytest.MonkeyPatch) -> None:
    chosen = _dial(20, CLOCKED, monkeypatch).choose("test", 1)
    assert chosen.below and chosen.clock == pytest.approx(18, abs=0.1) and chosen.data()["accuracy"] is None


def test_the_report_names_point_accuracy_and_promise(monkeypatch: pytest.MonkeyPatch) -> None:
    dial = _dial(5, PLAIN, monkeypatch)
    dial.choose("test", 100)
    dial.overrule("--masks", "--masks")
    data = dial.data(5.6)
    assert data["kept"] is True and data["promised_seconds"] == 5 and data["seconds"] == 5.6
    assert data["points"][0]["accuracy"] == 25 and data["points"][0]["revision"] == "abc"
    assert data["overruled"] == ["--masks"]
    text = "\n".join(dial.lines(5.8))
    assert "25 dB measured on a room" in text and "not kept" in text and "--masks as given" in text


def test_another_job_counts_its_own_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    dial = _dial(5, PLAIN, monkeypatch, spent=4)
    dial.begin()
    assert dial.choose("test", 100).fits is False  # nothing was chosen yet, so that the same seconds count
    dial.begin()
    assert dial.choose("test", 100).settings == {"n": 2} and len(dial.choices) == 1


def test_each_word_means_one_measured_point_and_the_points_are_a_front() -> None:
    for one in methods().values():
        assert one.by_name and set(one.by_name) <= set(WORDS)
        every = sorted(one.points, key=lambda p: p.seconds(one.size))
        assert [p.accuracy for p in every] == sorted({p.accuracy for p in every}), one.name
        assert all(p.seconds(one.size) > 0 and p.fixed >= 0 and p.per >= 0 for p in every), one.name
        order = [one.by_name[word].seconds(one.size) for word in WORDS if word in one.by_name]
        assert order == sorted(order), one.name
        assert one.scene and one.unit and one.revision, one.name


def test_a_word_means_one_point_and_one_that_was_not_measured_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    point = {"setting": "a", "settings": {}, "fixed": 1, "per": 0, "accuracy": 1, "names": ["fast"]}
    with pytest.raises(ValueError, match="may mean one point"):
        _method(point, point)
    with pytest.raises(UserError, match="nothing accurate was measured of test; say fast, or seconds"):
        _dial("accurate", _method(point), monkeypatch).choose("test", 1)
