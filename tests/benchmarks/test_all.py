"""All benchmarks in one run: repeats are merged to medians, one revision only, failures are told, the page links."""

from __future__ import annotations

import importlib
import itertools
import json
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from scenewright.agent.cli import command_line
from scenewright.benchmarks import harness
from scenewright.benchmarks._all import guard, page, running
from scenewright.benchmarks._all.repeats import joined, merged
from scenewright.benchmarks.harness import Metric, Point, Result
from scenewright.gaussians.errors import FileError, UserError

BENCH = command_line(["bench"])


def result(value: float = 2.0, name: str = "plan", **fields: Any) -> Result:
    return Result(
        "how often plans are right",
        "share",
        (Metric("right", value, "share", "higher", 0.05, goal=1.0),),
        (Point("grammar", "plain", value / 10, value, 100, default=True),),
        name=name,
        seconds=value,
        processor=fields.pop("processor", value),
        machine={"cpu": "a", "cores": 2},
        versions={"python": "3"},
        revision="abc",
        **fields,
    )


@given(st.lists(st.floats(0.1, 10), min_size=1, max_size=5))
def test_of_repeats_the_median_and_the_spread_are_kept(values: list[float]) -> None:
    found = merged([result(v) for v in values])
    (metric,) = found.metrics
    assert metric.low == min(values) and metric.high == max(values)
    assert metric.low <= metric.value <= metric.high
    assert found.repeats == len(values)
    assert found.seconds == pytest.approx(sum(values)) == found.processor
    assert merged([result(v) for v in reversed(values)]).metrics == found.metrics
    assert Result.from_json(found.to_json()) == found


def test_results_of_different_revisions_are_not_merged() -> None:
    with pytest.raises(ValueError, match="repeats of one benchmark"):
        merged([result(), replace(result(), revision="def")])
    with pytest.raises(ValueError, match="repeats of one benchmark"):
        merged([result(), result(name="ask")])


def test_spread_stands_in_the_table() -> None:
    text = merged([result(1.0), result(2.0), result(4.0)]).to_markdown()
    assert "2 (1 to 4) share" in text and "3 runs: medians" in text


@pytest.fixture
def processes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[str]:
    """Runs of benchmarks that end at once: "render" fails, "fit" is of another revision, "edit" prints no result."""
    ran: list[str] = []
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))

    def run(command: list[str], **_: Any) -> subprocess.CompletedProcess[str]:
        name = command[4]
        ran.append(name)
        if name == "render":
            return subprocess.CompletedProcess(command, 2, "", "warning\nscenewright: no captures\n")
        text = {"edit": "{}", "fit": replace(result(name="fit"), revision="other").to_json()}
        return subprocess.CompletedProcess(command, 0, text.get(name, result(name=name).to_json()), "")

    monkeypatch.setattr(running.subprocess, "run", run)
    monkeypatch.setattr(running._machine, "revision", lambda: "abc")
    return ran


def test_every_benchmark_runs_once_and_again_while_there_is_time(processes: list[str]) -> None:
    once = running.measured(["relight", "render"], True, lambda _: None, seconds=1e-9)
    assert processes == ["relight", "render"] and once.results[0].repeats == 1
    processes.clear()
    thrice = running.measured(["relight", "render"], True, lambda _: None, seconds=1e6)
    assert processes == ["relight", "render", "relight", "relight"] and thrice.results[0].repeats == 3
    assert thrice.failed == {"render": "no captures"}


def test_what_is_timed_runs_first_and_again(processes: list[str]) -> None:
    found = running.measured(["slim", "relight"], True, lambda _: None, seconds=1e6)
    assert processes == ["relight", "slim", "relight", "relight"]
    assert [(r.name, r.repeats) for r in found.results] == [("slim", 1), ("relight", 3)]
    assert set(harness.names()) >= running.TOGETHER


def test_whole_runs_divide_long_benchmarks_into_parts_that_there_are(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, shared in running.SHARED_PARTS.items():
        known = importlib.import_module(f"scenewright.benchmarks.{name}").PARTS
        left = [part for part in known if f"{name} {part}" in running.LEFT_OUT]
        assert sorted([*itertools.chain(*shared), *running.TIMED_PARTS[name], *left]) == sorted(known)
    todo = running.jobs(["relight", "slim", "select"], False)
    assert [job.title for job in todo if not job.shares] == ["relight", "select costs"]
    assert [job.title for job in todo[2:4]] == ["slim", "select captures"]

    def run(command: list[str], env: dict[str, str], **_: Any) -> subprocess.CompletedProcess[str]:
        part = command[command.index("--part") + 1]
        assert ("OMP_NUM_THREADS" in env) == (part != "speed")
        if part == "speed":
            return subprocess.CompletedProcess(command, 2, "", "scenewright: lost\n")
        own = replace(result(name="ask"), metrics=(Metric(part, 1, "share"),))
        return subprocess.CompletedProcess(command, 0, own.to_json(), "")

    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    monkeypatch.setattr(running.subprocess, "run", run)
    monkeypatch.setattr(running._machine, "revision", lambda: "abc")
    found = running.measured(["ask"], False, lambda _: None)
    firsts = {parts[0] for parts in running.SHARED_PARTS["ask"]}
    assert {m.key for r in found.results for m in r.metrics} == firsts and found.failed == {"ask speed": "lost"}


def test_quick_runs_make_one_job_of_the_parts_that_share_the_cores() -> None:
    timed, shared = running.jobs(["ask"], True)
    assert timed == running.Job("ask", ("speed",)) and shared.shares
    assert shared.parts == running.QUICK_PARTS["ask"]
    assert set(shared.parts) < set(itertools.chain(*running.SHARED_PARTS["ask"]))
    assert running.jobs(["relight"], True) == [running.Job("relight")]
    names = [job.name for job in running.jobs(["files", "edit", "slim", "ask"], True)]
    assert names == ["ask", "ask", "slim", "edit", "files"]


def test_parts_are_joined_to_one_result() -> None:
    one, other = result(), replace(result(), metrics=(Metric("more", 1, "share"),), notes=("a", "b"), seeds=(1,))
    found = joined([replace(one, notes=("a",)), other])
    assert [m.key for m in found.metrics] == ["right", "more"] and found.notes == ("a", "b") and found.seeds == (1,)
    assert len(found.points) == 2 and found.seconds == 4.0
    with pytest.raises(ValueError, match="parts of one benchmark"):
        joined([result(), result(name="ask")])
    with pytest.raises(UserError, match="no part 'verbs'; choose timed, nouns"):
        harness.run("plan", parts=("verbs",))


def test_finished_jobs_are_kept_until_the_revision_changes(processes: list[str], tmp_path: Path) -> None:
    for _ in range(2):
        found = running.measured(["relight", "render"], True, lambda _: None, seconds=1e-9, kept=tmp_path)
        assert [r.name for r in found.results] == ["relight"] and found.failed == {"render": "no captures"}
    assert processes == ["relight", "render", "render"]  # what failed is measured again


def test_quick_and_whole_results_are_not_compared(tmp_path: Path) -> None:
    (tmp_path / "plan.json").write_text(result(3.0).to_json())
    for command in (["all", "-o", str(tmp_path / "new")], ["plan"]):
        earlier = tmp_path if command[0] == "all" else tmp_path / "plan.json"
        with pytest.raises(UserError, match=r"whole run .* leave out --quick"):
            CliRunner().invoke(BENCH, ["bench", *command, "--quick", "--against", str(earlier)], catch_exceptions=False)


def test_whole_runs_compare_with_earlier_ones_of_which_some_are_in_quick_form(
    tmp_path: Path, processes: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(harness, "names", lambda: ("mesh", "plan"))
    monkeypatch.setattr(running, "prepare", lambda say: None)
    monkeypatch.setattr(page, "write", lambda folder, *_: (folder / page.PAGE,))
    (tmp_path / "mesh.json").write_text(result(name="mesh", quick=True).to_json())
    (tmp_path / "plan.json").write_text(result().to_json())
    command = ["bench", "all", "-o", str(tmp_path / "new"), "--against", str(tmp_path)]
    assert CliRunner().invoke(BENCH, command, catch_exceptions=False).exit_code == 0
    assert sorted(processes[:2]) == ["mesh", "plan"]
    mixed = [result(name="mesh", quick=True), result()]
    assert "the full forms" in page.text(mixed, {}) and "the quick forms" in page.text(mixed[:1], {})


def test_a_benchmark_that_takes_too_long_is_stopped_and_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def run(command: list[str], timeout: float, **_: Any) -> subprocess.CompletedProcess[str]:
        raise subprocess.TimeoutExpired(command, timeout)

    monkeypatch.setattr(running.subprocess, "run", run)
    found = running.measured(["render"], False, lambda _: None)
    assert "stopped after 1500 s" in found.failed["render"] and not found.results


def test_what_is_of_another_revision_or_unreadable_is_a_failure(processes: list[str]) -> None:
    found = running.measured(["relight", "fit", "edit"], True, lambda _: None, seconds=1e-9)
    assert [r.name for r in found.results] == ["relight"]
    assert "changed" in found.failed["fit"] and "--json" in found.failed["edit"]


def test_the_page_has_each_chart_table_and_failure(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    page.write(tmp_path, [result(0.9, processor=150.0), result(1.0, "select")], {"ask": "no captures"}, elapsed=181.0)
    text = (tmp_path / "README.md").read_text()
    assert "**ask** failed: no captures" in text and "revision abc" in text
    assert "in 3 minutes (3 minutes of the processor)" in text
    assert "in several starts" in page.text([result()], {})
    assert "| [plan](#plan) | 1 | 900 ms | 150 s | 0 of 1 | right 0.9 of 1 share |" in text
    for name in ("plan", "select"):
        assert f"({name}.svg)" in text and (tmp_path / f"{name}.svg").exists()
        assert Result.from_json((tmp_path / f"{name}.json").read_text()).name == name


@pytest.mark.slow
def test_the_command_writes_the_page_and_tells_what_is_worse(
    tmp_path: Path, processes: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("matplotlib")
    monkeypatch.setattr(harness, "names", lambda: ("plan", "files"))
    earlier = tmp_path / "earlier"
    earlier.mkdir()
    (earlier / "plan.json").write_text(result(3.0, quick=True).to_json())
    command = ["bench", "all", "--quick", "-o", str(tmp_path / "new"), "--json"]
    done = CliRunner().invoke(BENCH, [*command, "--against", str(earlier)])
    assert done.exit_code == 3 and "worse: plan: right: 3 -> 2 share" in done.stderr
    told = json.loads(done.stdout)
    assert told["page"] == str(tmp_path / "new" / "README.md") and len(told["results"]) == 2
    with pytest.raises(UserError, match="--force"):
        CliRunner().invoke(BENCH, command, catch_exceptions=False)
    monkeypatch.setattr(harness, "names", lambda: ("plan", "render", "files"))
    (tmp_path / "new" / "render.json").write_text("stale")
    assert CliRunner().invoke(BENCH, [*command, "--force"]).exit_code == 1  # "render" failed
    assert not (tmp_path / "new" / "render.json").exists()


def test_the_guard_tells_what_is_worse_and_what_is_gone_and_looks_at_no_times() -> None:
    before = Result(
        "", "", (Metric("a.right", 0.9, "share", "higher", 0.05), Metric("a.said", 0.5, "share", "higher")), ()
    )
    now = Result("", "", (Metric("a.right", 0.8, "share", "higher", 0.05), Metric("b.new", 1, "share", "higher")), ())
    told = guard.worse(now, before)
    assert told == ("a.right: 0.9 -> 0.8 share", "a.said: was 0.5 share, is not measured")
    assert guard.worse(before, before) == ()
    assert not guard.is_accuracy(Metric("a.seconds", 1, "s", "lower"))
    assert not guard.is_accuracy(Metric("a.asked", 1, "count"))
    assert guard.is_accuracy(Metric("a.psnr", 30, "dB", "higher"))


def test_the_guard_measures_without_data_and_fails_with_a_benchmark(processes: list[str]) -> None:
    now = guard.measured(lambda _: None, ("plan", "select"))
    assert {m.key for m in now.metrics} == {"plan.right", "select.right"}
    with pytest.raises(FileError, match="bench render failed: no captures"):
        guard.measured(lambda _: None, ("plan", "render"))


def test_the_committed_baseline_holds_what_is_guarded() -> None:
    baseline = Result.from_json(guard.BASELINE.read_text())
    assert {m.key.split(".")[0] for m in baseline.metrics} == set(guard.GUARDED)
    assert all(guard.is_accuracy(m) for m in baseline.metrics)
