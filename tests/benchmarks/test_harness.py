"""The measuring harness: results survive JSON, the front is the front, and every benchmark in the folder plugs in."""

from __future__ import annotations

import importlib
import inspect
import json
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright.benchmarks import _chart, harness, render
from scenewright.benchmarks.harness import Metric, Point, Result
from scenewright.gaussians.errors import BackendError, FileError, UserError

RESULT = Result(
    title="a picture",
    accuracy="PSNR, dB",
    metrics=(Metric("room.cpu", 12.5, "ms", "lower", 0.1), Metric("room.psnr", 98.0, "dB", "higher", 0.05)),
    points=(
        Point("cpu", "full", 0.0125, 98.0, 6_000_000, default=True),
        Point("cpu", "half", 0.005, 30.0, 6_000_000),
        Point("reference", "full", 2.0, 97.0, 6_000_000),
    ),
    notes=("made up",),
    seeds=(1, 2),
)
seconds = st.sampled_from([0.1, 0.2, 0.5, 1.0, 2.0])
accuracies = st.sampled_from([1.0, 2.0, 3.0, 4.0])
points = st.lists(st.builds(Point, st.just("m"), st.just("s"), seconds, accuracies, st.just(1)), max_size=8)


@given(points)
def test_no_point_beats_the_front_and_the_front_beats_all_others(some: list[Point]) -> None:
    front = Result("", "", (), tuple(some)).front()
    for point in some:
        beaten = [p for p in some if (p.seconds, -p.accuracy) != (point.seconds, -point.accuracy)
                  and p.seconds <= point.seconds and p.accuracy >= point.accuracy]  # fmt: skip
        assert bool(beaten) == ((point.seconds, point.accuracy) not in [(p.seconds, p.accuracy) for p in front])
    assert [p.seconds for p in front] == sorted({p.seconds for p in front})


def test_json_round_trip() -> None:
    assert Result.from_json(RESULT.to_json()) == RESULT
    assert json.loads(RESULT.to_json())["metrics"][0]["unit"] == "ms"
    for broken in ("", "[]", "{}", '{"metrics": 3, "points": []}'):
        with pytest.raises(FileError, match="--json"):
            Result.from_json(broken)


@pytest.mark.parametrize(
    "direction, change, worse",
    [("lower", 1.2, True), ("lower", 1.05, False), ("lower", 0.5, False), ("higher", 0.8, True),
     ("higher", 0.95, False), ("higher", 2.0, False), ("neither", 5.0, False)],
)  # fmt: skip
def test_a_metric_is_worse_beyond_its_tolerance(direction: harness.Direction, change: float, worse: bool) -> None:
    before, after = (Metric("k", value, "ms", direction, 0.1) for value in (10.0, 10.0 * change))
    assert after.worse_than(before) is worse
    results = [Result("", "", (metric,), ()) for metric in (before, after)]
    assert len(results[1].regressions(results[0])) == int(worse)


def test_figures_that_cannot_be_told_are_refused_where_they_are_made() -> None:
    with pytest.raises(ValueError, match="cap it"):
        Metric("k", float("inf"), "dB")
    with pytest.raises(ValueError, match="point cpu"):
        Point("cpu", "full", 0.0, 1.0, 1)
    with pytest.raises(ValueError, match="differ"):
        Result("", "", (Metric("k", 1, ""), Metric("k", 2, "")), ())


def test_a_goal_is_met_in_its_direction_and_told_first() -> None:
    fast, slow = (Metric(f"{value} s", value, "s", "lower", goal=2.0) for value in (2.0, 2.1))
    right = Metric("right", 0.96, "share", "higher", goal=0.95)
    assert (fast.met, slow.met, right.met, Metric("k", 1, "").met) == (True, False, True, None)
    text = Result("", "", (Metric("k", 1, ""), fast, slow, right), ()).to_markdown()
    assert (
        "| 2.1 s | at most 2 s | 2.1 s | missed |" in text
        and "| right | at least 0.95 share | 0.96 share | met |" in text
    )
    with pytest.raises(ValueError, match="no direction"):
        Metric("k", 1, "", goal=1.0)


def test_markdown_names_default_front_and_notes() -> None:
    text = RESULT.to_markdown()
    assert "| cpu | full | 12.5 ms | 98 | 6 MB | default, on the front |" in text
    assert "| reference | full | 2 s | 97 | 6 MB |  |" in text
    assert "| room.cpu | 12.5 ms | lower | 10% |" in text
    assert "- made up" in text and "seeds 1, 2" in text


@pytest.mark.parametrize("kind", ["png", "svg"])
def test_chart_is_written(tmp_path: Path, kind: str) -> None:
    pytest.importorskip("matplotlib")
    path = _chart.draw(RESULT, tmp_path / f"chart.{kind}")
    assert path.stat().st_size > 5000


def test_a_chart_shows_eight_settings_with_the_default_and_the_front(tmp_path: Path) -> None:
    many = tuple(Point("dial", f"{i}", 1.0 + i, 10.0 - abs(i - 5), 1, default=i == 12) for i in range(20))
    result = Result("many", "dB", (), many)
    shown = {p.setting for p in _chart.shown(result)}
    assert len(shown) == _chart.MAX_SETTINGS
    assert shown >= {"12", *(p.setting for p in result.front())}
    assert _chart.shown(RESULT) == RESULT.points
    pytest.importorskip("matplotlib")
    assert _chart.draw(result, tmp_path / "many.svg").stat().st_size > 5000


@given(points, st.integers(0, 8))
def test_a_chart_never_shows_more_settings_than_can_be_read(some: list[Point], defaults: int) -> None:
    many = [Point(p.method, f"{i}", p.seconds, p.accuracy, 1, i < defaults) for i, p in enumerate([*some, *some])]
    shown = _chart.shown(Result("", "", (), tuple(many)))
    assert len(shown) == min(len(many), _chart.MAX_SETTINGS)
    assert [p for p in many if p in shown] == list(shown)


def test_a_curve_is_drawn_with_its_end(tmp_path: Path) -> None:
    curve = tuple(Point("a", "end" if i == 9 else "", 1.0 + i, float(i), 1) for i in range(10))
    assert _chart.shown(Result("", "", (), curve)) == curve


@pytest.mark.slow
def test_a_chart_is_the_same_every_time(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    wide = Result("t", "dB", (), tuple(Point("m", f"{i}", 1.0 + i, float(i), 10**i) for i in range(3)))
    one, two = (_chart.draw(wide, tmp_path / f"{name}.svg").read_text() for name in "ab")
    assert one == two
    assert "bytes (logarithmic" in one and "seconds (logarithmic" in one


def test_chart_errors_say_the_fix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(UserError, match="png"):
        _chart.draw(RESULT, tmp_path / "chart.gif")
    with pytest.raises(UserError, match="no points"):
        _chart.draw(Result("", "", (), ()), tmp_path / "chart.png")
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(BackendError, match=r"scenewright\[bench\]"):
        _chart.draw(RESULT, tmp_path / "chart.png")


def test_every_benchmark_plugs_in() -> None:
    assert "render" in harness.names() and "harness" not in harness.names()
    for name in harness.names():
        module = importlib.import_module(f"scenewright.benchmarks.{name}")
        wanted = ["quick", "parts"] if hasattr(module, "PARTS") else ["quick"]
        assert list(inspect.signature(module.run).parameters) == wanted, name
        assert module.__doc__, name


def test_an_unknown_benchmark_is_refused_with_the_names() -> None:
    with pytest.raises(UserError, match="render"):
        harness.run("rendr")


def test_the_render_benchmark_without_real_data(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SCENEWRIGHT_DATA", str(tmp_path))
    monkeypatch.setattr(render, "QUICK_SIZES", ((48, 32),))
    monkeypatch.setattr(render, "SYNTHETIC", 300)
    result = harness.run("render", quick=True)
    assert result.name == "render" and result.quick and result.seconds > 0
    assert any("synthetic" in note for note in result.notes)
    assert result.machine["cores"] >= 1 and "torch" in result.versions
    assert [point.setting for point in result.points if point.default] == ["full"]
    metrics = {metric.key: metric.value for metric in result.metrics}
    # float32 against float64 on a few hundred footprints; flips at alpha = 1/255 may cost some dB.
    assert metrics["spheres.48x32.cpu.psnr"] > 75
    assert metrics["spheres.48x32.stage.draw"] > 0
