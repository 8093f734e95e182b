"""Batches: every job is done exactly once, whatever is killed, repeated, wrong or full."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from scenewright.agent.batch.engines import TRIES, Here, Processes
from scenewright.agent.batch.jobs import Job, arguments, read_jobs
from scenewright.agent.batch.running import run_batch
from scenewright.agent.batch.working import Outcome, Task, work
from scenewright.agent.cli import main
from scenewright.gaussians.assets import make
from scenewright.gaussians.errors import FileError, UserError
from scenewright.gaussians.files import save
from scenewright.gaussians.scene import Scene


class Counting:
    """Writes a file for each task, counts them, and stops after some."""

    def __init__(self, until: int = 99, code: int = 0) -> None:
        self.done, self._until, self._code = list[str](), until, code

    def outcomes(self, tasks: Mapping[str, Task]) -> Iterator[tuple[str, Outcome]]:
        for name, task in tasks.items():
            if len(self.done) == self._until:
                raise KeyboardInterrupt
            self.done.append(task.command[1])
            Path(task.folder).mkdir(parents=True)
            (Path(task.folder) / "a.txt").write_text(task.command[1])
            yield name, Outcome(code=self._code, result={"file": f"{task.folder}/a.txt"}, messages="", seconds=0.0)


def _job(name: str, *words: str) -> Job:
    return Job(id=name, run=("info", *words))


def _receipts(out: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in (out / "receipts.jsonl").read_text().splitlines()]


def test_each_job_is_done_once_also_after_a_stop(tmp_path: Path) -> None:
    jobs, out = [_job(str(k), f"word{k}") for k in range(6)], tmp_path / "out"
    stopped = Counting(until=3)
    with pytest.raises(KeyboardInterrupt):
        run_batch(jobs, out, stopped)
    rest = Counting()
    totals = run_batch(jobs, out, rest)
    assert sorted(stopped.done + rest.done) == [f"word{k}" for k in range(6)]
    assert (totals.kept, totals.done, totals.failed) == (3, 3, 0)
    assert [r["id"] for r in _receipts(out)] == [job.id for job in jobs]
    for k, receipt in enumerate(_receipts(out)):
        assert receipt["result"] == {"file": str(out / str(k) / "a.txt")}
        assert (out / str(k) / "a.txt").read_text() == f"word{k}"
    assert not (out / ".work").exists()
    idle = Counting()
    run_batch(jobs, out, idle)
    assert not idle.done


def test_jobs_in_this_process_leave_the_output_of_the_batch_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "jobs.jsonl").write_text('{"id": "a", "run": ["info", "nowhere.ply", "--json"]}\n')
    with pytest.raises(SystemExit):
        main(["batch", str(tmp_path / "jobs.jsonl"), "-o", str(tmp_path / "out"), "--workers", "0"])
    assert "1 failed" in (said := capsys.readouterr().out) and not said.startswith("{")


def test_the_same_job_is_done_once_and_another_content_is_another_job(tmp_path: Path) -> None:
    scene, out = tmp_path / "a.ply", tmp_path / "out"
    scene.write_bytes(b"one")
    jobs, engine = [_job("a", str(scene)), _job("b", str(scene))], Counting()
    run_batch(jobs, out, engine)
    assert len(engine.done) == 1
    assert [r.get("same_as") for r in _receipts(out)] == [None, "a"]
    assert _receipts(out)[1]["folder"] == "a"
    scene.write_bytes(b"two")
    assert jobs[0].key() != _receipts(out)[0]["key"]
    run_batch(jobs, out, engine)
    assert len(engine.done) == 2


def test_folders_of_others_stay_and_results_of_other_words_do_not_count(tmp_path: Path) -> None:
    out, engine = tmp_path / "out", Counting()
    (out / "a").mkdir(parents=True)
    (out / "a" / "photo.jpg").write_bytes(b"mine")
    with pytest.raises(UserError, match="no batch wrote it"):
        run_batch([_job("a", "x")], out, engine)
    assert (out / "a" / "photo.jpg").read_bytes() == b"mine" and not engine.done
    for word in ("red", "teal", "red"):
        run_batch([_job("b", word)], out, engine)
    assert engine.done == ["red", "teal", "red"] and (out / "b" / "a.txt").read_text() == "red"
    (tmp_path / "jobs.jsonl").write_text('{"id": "receipts", "run": ["info", "x.ply"]}')
    with pytest.raises(UserError, match="what the batch itself writes"):
        read_jobs(tmp_path / "jobs.jsonl")


def test_a_job_with_debug_fails_with_its_own_error(tmp_path: Path) -> None:
    outcome = work(Task(["info", "nowhere.ply", "--debug"], str(tmp_path / "w")))
    assert outcome["code"] == 4 and "no such file" in outcome["messages"]


def test_results_that_are_gone_or_receipts_that_are_torn_are_made_again(tmp_path: Path) -> None:
    jobs, out = [_job("a", "x"), _job("b", "y")], tmp_path / "out"
    run_batch(jobs, out, Counting())
    shutil.rmtree(out / "a")
    (out / "receipts" / f"{jobs[1].key()}.json").write_text('{"code": 0, "ke')
    engine = Counting()
    run_batch(jobs, out, engine)
    assert engine.done == ["x", "y"]


def test_what_failed_is_not_repeated_unless_asked(tmp_path: Path) -> None:
    jobs, out = [_job("a", "x")], tmp_path / "out"
    totals = run_batch(jobs, out, Counting(code=3))
    assert totals.failed == 1 and not (out / "a").exists()
    idle, again = Counting(), Counting()
    assert run_batch(jobs, out, idle).receipts[0]["code"] == 3
    assert run_batch(jobs, out, again, again=True).receipts[0]["code"] == 0
    assert (len(idle.done), len(again.done)) == (0, 1)


def test_an_interrupt_ends_the_batch_and_fails_no_job(tmp_path: Path) -> None:
    jobs, out = [_job("a", "x"), _job("b", "y")], tmp_path / "out"
    with pytest.raises(KeyboardInterrupt):
        run_batch(jobs, out, Counting(code=130))
    assert not list((out / "receipts").iterdir())
    assert run_batch(jobs, out, Counting()).done == 2


def test_two_batches_do_not_share_a_folder(tmp_path: Path) -> None:
    class Nested(Counting):
        def outcomes(self, tasks: Mapping[str, Task]) -> Iterator[tuple[str, Outcome]]:
            with pytest.raises(UserError, match="another batch"):
                run_batch([_job("b", "y")], tmp_path / "out", Counting())
            yield from super().outcomes(tasks)

    run_batch([_job("a", "x")], tmp_path / "out", Nested())
    (tmp_path / "file").write_text("")
    with pytest.raises(FileError, match="choose another folder"):
        run_batch([_job("a", "x")], tmp_path / "file", Counting())


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("nonsense", "line 2 is no job"),
        ('{"id": "b"}', "run: Field required"),
        ('{"id": "b", "run": ["info"], "more": 1}', "Extra inputs"),
        ('{"id": "../b", "run": ["info"]}', "no name of a folder"),
        ('{"id": "a", "run": ["info"]}', "that of line 1"),
        ('{"id": "b", "run": ["chat", "x.ply"]}', "no verb for batches"),
        ('{"id": "b", "run": "info \'x"}', "No closing quotation"),
        ('{"id": "b", "run": []}', "no verb for batches"),
    ],
)
def test_lines_that_are_no_jobs_are_named(tmp_path: Path, line: str, said: str) -> None:
    path = tmp_path / "jobs.jsonl"
    path.write_text('{"id": "a", "run": "info room.ply"}\n' + line + "\n")
    with pytest.raises(UserError, match=said):
        read_jobs(path)


def test_a_run_is_words_or_a_line(tmp_path: Path) -> None:
    path = tmp_path / "jobs.jsonl"
    path.write_text('{"id": "a", "run": "edit r.ply \'make it red\' -o {out}/a.ply"}\n\n')
    (job,) = read_jobs(path)
    assert arguments(job.run, "/o") == ["edit", "r.ply", "make it red", "-o", "/o/a.ply", "--json"]
    path.write_text("\n")
    with pytest.raises(UserError, match="no jobs"):
        read_jobs(path)
    with pytest.raises(FileError):
        read_jobs(tmp_path / "nowhere.jsonl")


@pytest.fixture(scope="module")
def chair(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scene of one thing."""
    path = tmp_path_factory.mktemp("scene") / "chair.ply"
    save(Scene(make("stool", 0, detail=0.1).cloud), path)
    return path


def test_a_command_line_has_an_outcome_whatever_it_does(chair: Path, tmp_path: Path) -> None:
    good = work(Task(["info", str(chair), "--json"], str(tmp_path / "w")))
    assert good["code"] == 0 and good["result"]["gaussians"] > 0
    bad = work(Task(["info", str(tmp_path / "nowhere.ply"), "--json"], str(tmp_path / "w")))
    assert bad["code"] == 4 and "nowhere.ply" in bad["messages"]
    assert work(Task(["info", "--nonsense"], str(tmp_path / "w")))["code"] == 2


def _batch(tmp_path: Path, chair: Path, count: int, *options: str) -> int:
    lines = [
        {"id": f"j{k}", "run": ["convert", str(chair), "{out}/c.splat", "--crop-sphere", f"0,0,0,{1 + k}"]}
        for k in range(count)
    ]
    lines.append({"id": "bad", "run": ["convert", str(tmp_path / "nowhere.ply"), "{out}/c.splat"]})
    (tmp_path / "jobs.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    with pytest.raises(SystemExit) as end:
        main(["batch", str(tmp_path / "jobs.jsonl"), "-o", str(tmp_path / "out"), *options])
    return int(end.value.code or 0)


def test_the_verb_does_real_jobs_and_goes_on_when_one_fails(
    chair: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert _batch(tmp_path, chair, 2, "--workers", "0", "--json") == 3
    told = json.loads(capsys.readouterr().out)
    assert (told["done"], told["failed"]) == (2, ["bad"])
    assert all((tmp_path / "out" / f"j{k}" / "c.splat").stat().st_size > 0 for k in range(2))
    assert _batch(tmp_path, chair, 2, "--workers", "0") == 3
    assert "2 were done before" not in (said := capsys.readouterr().out)
    assert "0 done" in said and "3 were done before" in said


@pytest.mark.slow
def test_processes_do_what_the_loop_does_and_outlive_killed_workers(chair: Path, tmp_path: Path) -> None:
    folders = [f"{tmp_path}/w{k}" for k in range(6)]
    tasks = {f: Task(["convert", str(chair), f"{f}/c.splat", "--json"], f) for f in folders}
    killed, found = 0, dict[str, Outcome]()
    for name, outcome in Processes(2).outcomes(tasks):
        found[name] = outcome
        asked = ["pgrep", "-P", str(os.getpid()), "-f", "batch.worker"]
        children = subprocess.run(asked, capture_output=True, text=True, check=False).stdout.split()
        if killed < 2 and children:
            os.kill(int(children[0]), signal.SIGKILL)
            killed += 1
    assert killed == 2 and len(found) == 6
    assert all(outcome["code"] == 0 for outcome in found.values())
    written = {f: Path(f, "c.splat").read_bytes() for f in folders}
    plain = dict(Here().outcomes(tasks))
    for name in tasks:
        assert plain[name]["code"] == found[name]["code"] and plain[name]["messages"] == found[name]["messages"]
        assert Path(name, "c.splat").read_bytes() == written[name]


@pytest.mark.slow
def test_a_job_with_which_workers_die_fails_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A worker that ends at the word "die"."""
    (tmp_path / "worker.py").write_text(
        "import json, sys\n"
        "for line in sys.stdin:\n"
        "    task = json.loads(line)\n"
        "    if 'die' in task[0]:\n"
        "        sys.exit(9)\n"
        "    print(json.dumps({'code': 0, 'result': task[0], 'messages': '', 'seconds': 0}), flush=True)\n"
    )
    real = subprocess.Popen
    monkeypatch.setattr(
        subprocess, "Popen", lambda _, **how: real([sys.executable, str(tmp_path / "worker.py")], **how)
    )
    tasks = {name: Task([name], "x") for name in ("a", "die", "b")}
    found = dict(Processes(1).outcomes(tasks))
    assert [found[n]["code"] for n in tasks] == [0, 4, 0]
    assert list(found) == ["a", "b", "die"]  # it waits behind the others each time
    assert f"died {TRIES} times" in found["die"]["messages"]


@pytest.mark.slow
def test_a_head_that_is_killed_loses_nothing(chair: Path, tmp_path: Path) -> None:
    jobs, out = tmp_path / "jobs.jsonl", tmp_path / "out"
    run = ["convert", str(chair), "{out}/c.splat", "--crop-sphere"]
    lines = [{"id": f"j{k}", "run": [*run, f"0,0,0,{1 + k}"]} for k in range(12)]
    jobs.write_text("".join(json.dumps(line) + "\n" for line in lines))
    command = [sys.executable, "-m", "scenewright", "batch", str(jobs), "-o", str(out), "--workers", "2"]
    head = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    receipts = out / "receipts"
    while head.poll() is None and (not receipts.is_dir() or len(list(receipts.glob("*.json"))) < 3):
        time.sleep(0.02)
    head.kill()
    head.wait()
    before = {p.name: p.read_bytes() for p in receipts.glob("*.json")}
    ended = subprocess.run([*command, "--json"], capture_output=True, text=True, check=True)
    told = json.loads(ended.stdout)
    assert told["kept"] == len(before) and told["done"] == 12 - len(before)
    assert all((receipts / name).read_bytes() == data for name, data in before.items())


@pytest.mark.slow
def test_ray_does_what_the_loop_does_listens_on_loopback_alone_and_outlives_killed_workers(
    chair: Path, tmp_path: Path
) -> None:
    pytest.importorskip("ray")
    jobs, out = tmp_path / "jobs.jsonl", tmp_path / "out"
    run = ["convert", str(chair), "{out}/c.splat", "--crop-sphere"]
    lines = [{"id": f"j{k}", "run": [*run, f"0,0,0,{1 + k}"]} for k in range(12)]
    jobs.write_text("".join(json.dumps(line) + "\n" for line in lines))
    command = [sys.executable, "-m", "scenewright", "batch", str(jobs), "--json"]
    head = subprocess.Popen(
        [*command, "-o", str(out), "--ray", "local", "--workers", "2"], stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL, start_new_session=True,
    )  # fmt: skip
    killed, open_to_all = 0, set[str]()
    while head.poll() is None:
        of_session = ["ps", "-o", "pid=,args=", "--sid", str(head.pid)]
        told = subprocess.run(of_session, capture_output=True, text=True, check=False).stdout.splitlines()
        open_to_all |= _open_to_all([int(line.split()[0]) for line in told])
        busy = [int(line.split()[0]) for line in told if "ray::_work_in" in line]
        if killed < 2 and busy:
            os.kill(busy[0], signal.SIGKILL)
            killed += 1
        time.sleep(0.2)
    assert head.stdout is not None
    told_all = json.loads(head.stdout.read())
    assert killed == 2 and (told_all["done"], told_all["failed"]) == (12, [])
    assert not open_to_all
    subprocess.run([*command, "-o", str(tmp_path / "plain"), "--workers", "0"], capture_output=True, check=True)
    for k in range(12):
        assert (out / f"j{k}/c.splat").read_bytes() == (tmp_path / f"plain/j{k}/c.splat").read_bytes()


def _open_to_all(processes: list[int]) -> set[str]:
    """Addresses at which some processes listen, unless of the loopback interface, as the system writes them."""
    sockets = set[str]()
    for pid in processes:
        for handle in Path(f"/proc/{pid}/fd").glob("*"):
            try:
                sockets.add(os.readlink(handle))
            except OSError:  # closed meanwhile
                continue
    found = set[str]()
    for table in ("tcp", "tcp6"):
        for line in Path(f"/proc/net/{table}").read_text().splitlines()[1:]:
            words = line.split()
            address = words[1].partition(":")[0]
            if words[3] == "0A" and f"socket:[{words[9]}]" in sockets and not address.endswith("0100007F"):
                found.add(words[1])
    return found


@pytest.mark.slow
def test_results_that_find_no_room_fail_their_jobs_and_are_made_when_there_is_room(chair: Path, tmp_path: Path) -> None:
    """Files may not grow beyond some bytes, in the batch and in its workers, which stands for a full disk."""
    jobs, out = tmp_path / "jobs.jsonl", tmp_path / "out"
    lines = [{"id": f"j{k}", "run": ["convert", str(chair), f"{{out}}/c{k}.splat"]} for k in range(2)]
    jobs.write_text("".join(json.dumps(line) + "\n" for line in lines))
    command = ["-m", "scenewright", "batch", str(jobs), "-o", str(out), "--workers", "1"]
    limited = (
        f"import os, resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, ({chair.stat().st_size // 8},) * 2); "
        "os.execv(sys.executable, [sys.executable, *sys.argv[1:]])"
    )
    full = subprocess.run([sys.executable, "-c", limited, *command], capture_output=True, text=True, check=False)
    assert full.returncode == 3, full.stderr
    assert all(r["code"] == 4 and "File too large" in r["messages"] for r in _receipts(out))
    assert sorted(p.name for p in out.iterdir()) == [".lock", "receipts", "receipts.jsonl"]
    subprocess.run([sys.executable, *command, "--again"], capture_output=True, check=True)
    assert all((out / f"j{k}" / f"c{k}.splat").stat().st_size > 0 for k in range(2))
