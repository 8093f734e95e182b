"""What jobs ask for: it is written down, refused where no machine has it, and shared out where one has."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from scenewright.agent.batch import engines
from scenewright.agent.batch.engines import Here, Processes, _refuse, _Stock
from scenewright.agent.batch.jobs import Job, needing, read_jobs
from scenewright.agent.batch.resources import Resources, of_this_machine, parse_needs
from scenewright.agent.batch.running import run_batch
from scenewright.agent.batch.working import Outcome, Task
from scenewright.gaussians.errors import UserError

MANY = Resources(num_cpus=4000)


def test_needs_of_verbs_and_of_jobs(tmp_path: Path) -> None:
    path = tmp_path / "jobs.jsonl"
    path.write_text(
        '{"id": "a", "run": ["fit", "x"], "resources": {"num_gpus": 0.5}}\n{"id": "b", "run": ["info", "x"]}\n'
    )
    verb, needs = parse_needs("fit:num_gpus=1,memory=16GB")
    fit, info = needing(read_jobs(path), {verb: needs})
    assert fit.resources.asked() == {"num_gpus": 0.5, "memory": "16GB"} and not info.resources.asked()
    assert fit.resources.amounts() == {"num_gpus": 0.5, "memory": 16e9}
    assert fit.key() == Job(id="c", run=fit.run).key()  # it is the same work
    for wrong in ("fit", "fit:gpus=1", "fit:memory=much", "fit:num_cpus=0"):
        with pytest.raises(UserError, match="write for example"):
            parse_needs(wrong)
    with pytest.raises(UserError, match="no verb for batches"):
        needing([info], {"chat": needs})
    path.write_text('{"id": "a", "run": ["fit", "x"], "resources": {"num_cpus": -1}}\n')
    with pytest.raises(UserError, match=r"line 1: resources\.num_cpus"):
        read_jobs(path)


@pytest.mark.parametrize("engine", [Here(), Processes(1)])
def test_what_is_not_there_is_said_before_any_job_is_done(engine: engines.Engine, tmp_path: Path) -> None:
    jobs = [Job(id="a", run=("info", "x")), Job(id="b", run=("fit", "y"), resources=MANY)]
    with pytest.raises(UserError, match=r"fit y.* asks for 4,000 CPUs, and there are \d+ on this machine"):
        run_batch(jobs, tmp_path / "out", engine)
    assert not list((tmp_path / "out" / "receipts").iterdir())


def test_a_gpu_that_is_not_there_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("torch.cuda.device_count", lambda: 0)
    task = Task(["fit", "x"], "out", resources=Resources(num_gpus=1))
    with pytest.raises(UserError, match="asks for 1 GPUs, and there are 0"):
        next(Here().outcomes({"a": task}))
    assert of_this_machine(gpus=True)["num_gpus"] == 0 and of_this_machine(gpus=False)["memory"] > 1e8


def test_one_machine_has_to_have_all_of_it() -> None:
    task = Task(["fit", "x"], "out", resources=Resources(num_cpus=4, num_gpus=1))
    machines = [{"num_cpus": 2.0, "num_gpus": 1.0}, {"num_cpus": 8.0}]
    with pytest.raises(UserError, match="on Ray"):
        _refuse({"a": task}, machines, "Ray")
    _refuse({"a": task}, [*machines, {"num_cpus": 4.0, "num_gpus": 1.0}], "Ray")
    with pytest.raises(UserError, match="there is none"):
        _refuse({"a": task}, [], "Ray")


def test_jobs_wait_until_what_they_need_is_free() -> None:
    stock, running, most = _Stock({"num_cpus": 3.0}), [0], [0]
    lock = threading.Lock()

    def job() -> None:
        with stock.taken(Task([], "", resources=Resources(num_cpus=1.5))):
            with lock:
                running[0] += 1
                most[0] = max(most[0], running[0])
            threading.Event().wait(0.02)
            with lock:
                running[0] -= 1

    threads = [threading.Thread(target=job) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(10)
    assert most[0] == 2 and not any(thread.is_alive() for thread in threads)


def test_receipts_tell_what_was_asked_for_and_why_jobs_were_repeated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A worker that is ended by a signal, then one that ends by itself, then one that works."""
    (tmp_path / "worker.py").write_text(
        "import json, os, sys\n"
        f"seen = {str(tmp_path / 'seen')!r}\n"
        "for line in sys.stdin:\n"
        "    times = len(open(seen).read()) if os.path.exists(seen) else 0\n"
        "    open(seen, 'a').write('x')\n"
        "    if times == 0:\n"
        "        os.kill(os.getpid(), 9)\n"
        "    if times == 1:\n"
        "        sys.exit(7)\n"
        "    print(json.dumps({'code': 0, 'result': None, 'messages': '', 'seconds': 0}), flush=True)\n"
    )
    real = subprocess.Popen
    monkeypatch.setattr(
        subprocess, "Popen", lambda _, **how: real([sys.executable, str(tmp_path / "worker.py")], **how)
    )
    run_batch([Job(id="a", run=("info", "x"), resources=Resources(num_cpus=1))], tmp_path / "out", Processes(1))
    receipt = json.loads((tmp_path / "out" / "receipts.jsonl").read_text())
    assert receipt["resources"] == {"num_cpus": 1.0}
    assert receipt["retries"] == ["the worker was ended by signal 9", "the worker ended with 7"]


@pytest.mark.slow
def test_ray_says_what_no_machine_has_and_tells_why_jobs_were_repeated(tmp_path: Path) -> None:
    pytest.importorskip("ray")
    lines = [{"id": "a", "run": ["info", "x"], "resources": {"num_gpus": 64}}]
    said = _on_ray(tmp_path, lines)
    assert said.returncode == 2 and "asks for 64 GPUs" in said.stderr
    said = _on_ray(tmp_path, [{**lines[0], "resources": {"num_cpus": 2, "memory": "200MB"}}])
    assert said.returncode == 3  # there is no such scene: it was tried
    assert json.loads((tmp_path / "out" / "receipts.jsonl").read_text())["resources"]["memory"] == "200MB"


def _on_ray(tmp_path: Path, lines: list[dict[str, object]]) -> subprocess.CompletedProcess[str]:
    (tmp_path / "jobs.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    command = [sys.executable, "-m", "scenewright", "batch", str(tmp_path / "jobs.jsonl"), "-o", str(tmp_path / "out")]
    return subprocess.run(
        [*command, "--ray", "local", "--workers", "2"],
        capture_output=True,
        text=True,
        check=False,
        env=dict(os.environ),
    )


def _outcome() -> Outcome:
    return Outcome(code=0, result=None, messages="", seconds=0.0)


def test_a_job_with_which_workers_die_tells_why_each_did() -> None:
    failed = engines.died(["one", "two"])
    assert failed["code"] == 4 and failed["retries"] == ["one", "two"] and "died 2 times" in failed["messages"]
    assert "retries" not in engines._told(_outcome(), []) and engines._told(_outcome(), ["one"])["retries"] == ["one"]
