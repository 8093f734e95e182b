"""Batches by URL: every job is done exactly once in stores that cannot rename, whatever fails or is killed."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from scenewright.agent.batch import store
from scenewright.agent.batch.engines import Here
from scenewright.agent.batch.jobs import Job
from scenewright.agent.batch.running import Totals, run_batch
from scenewright.agent.cli import main
from scenewright.gaussians.assets import make
from scenewright.gaussians.errors import FileError, ScenewrightError, UserError
from scenewright.gaussians.files import save
from scenewright.gaussians.scene import Scene

fsspec = pytest.importorskip("fsspec")
from fsspec.implementations.dirfs import DirFileSystem  # noqa: E402
from fsspec.implementations.memory import MemoryFileSystem  # noqa: E402

OUT = "memory://out/batch"


class Failing(MemoryFileSystem):
    """A store that fails at some of the operations that write: `failing://`."""

    protocol = "failing"
    store: dict[str, Any] = {}  # noqa: RUF012
    pseudo_dirs = [""]  # noqa: RUF012
    chance = random.Random(0)
    share = 0.0
    asked = 0

    @classmethod
    def _strip_protocol(cls, path: str) -> str:
        return str(super()._strip_protocol(path.replace("failing://", "memory://")))

    def _maybe(self) -> None:
        type(self).asked += 1
        if self.chance.random() < self.share:
            raise OSError("the store failed")

    def put_file(self, *args: Any, **kwargs: Any) -> Any:
        self._maybe()
        return super().put_file(*args, **kwargs)

    def pipe_file(self, *args: Any, **kwargs: Any) -> Any:
        self._maybe()
        return super().pipe_file(*args, **kwargs)

    def _open(self, path: str, mode: str = "rb", **kwargs: Any) -> Any:
        if mode == "xb":
            self._maybe()
        return super()._open(path, mode, **kwargs)


@pytest.fixture
def memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """An empty store in memory, and a cache of its own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    fsspec.register_implementation("failing", Failing, clobber=True)
    fs = fsspec.filesystem("memory")
    for one in (fs.store, Failing.store):
        one.clear()
    monkeypatch.setattr(Failing, "share", 0.0)
    yield fs
    for one in (fs.store, Failing.store):
        one.clear()


@pytest.fixture(scope="module")
def stool(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A scene of one thing, as a file."""
    path = tmp_path_factory.mktemp("scene") / "stool.ply"
    save(Scene(make("stool", 0, detail=0.1).cloud), path)
    return path.read_bytes()


def _jobs(url: str, count: int) -> list[Job]:
    run = ("convert", url, "{out}/c.splat", "--crop-sphere")
    return [Job(id=f"j{k}", run=(*run, f"0,0,0,{1 + k}")) for k in range(count)]


def _complete(fs: Any, root: str, jobs: list[Job]) -> None:
    """Each job has one receipt, and exactly the results that it names."""
    fs.invalidate_cache()
    there = {path[len(root) + 1 :]: info["size"] for path, info in fs.find(root, detail=True).items()}
    receipts = [json.loads(line) for line in fs.cat_file(f"{root}/receipts.jsonl").splitlines()]
    assert [r["id"] for r in receipts] == [job.id for job in jobs] and not any(r["code"] for r in receipts)
    named = {f"{r['folder']}/{name}": size for r in receipts for name, size in r["files"].items()}
    kept = {f"receipts/{job.key()}.json" for job in jobs} | {"receipts.jsonl"}
    assert set(there) == set(named) | kept
    assert all(there[name] == size for name, size in named.items()) and len(named) == len(jobs)


@pytest.mark.slow
def test_scenes_and_results_by_url(memory: Any, stool: bytes, tmp_path: Path) -> None:
    memory.pipe_file("/in/stool.ply", stool)
    jobs = _jobs("memory://in/stool.ply", 3)
    totals = run_batch(jobs, OUT, Here())
    assert (totals.done, totals.failed) == (3, 0)
    _complete(memory, "/out/batch", jobs)
    receipt = totals.receipts[0]
    assert receipt["result"]["path"] == f"{OUT}/{receipt['folder']}/c.splat"
    (tmp_path / "stool.ply").write_bytes(stool)
    run_batch(_jobs(str(tmp_path / "stool.ply"), 3), tmp_path / "plain", Here())
    for k, receipt in enumerate(totals.receipts):
        plain = (tmp_path / "plain" / f"j{k}" / "c.splat").read_bytes()
        assert memory.cat_file(f"/out/batch/{receipt['folder']}/c.splat") == plain
    assert run_batch(jobs, OUT, Here()).kept == 3
    memory.pipe_file("/in/stool.ply", stool + b" ")
    assert run_batch(jobs[:1], OUT, Here()).done == 1


def test_an_embedding_leaves_the_field_as_its_result(memory: Any, stool: bytes) -> None:
    memory.pipe_file("/in/stool.ply", stool)
    totals = run_batch([Job(id="e", run=("embed", "memory://in/stool.ply"))], OUT, Here())
    assert list(totals.receipts[0]["files"]) == ["stool.ply.field.safetensors"]
    assert sorted(path for path in memory.find("/in")) == ["/in/stool.ply"]


def test_results_that_are_gone_or_receipts_that_are_torn_are_made_again(memory: Any, stool: bytes) -> None:
    memory.pipe_file("/in/stool.ply", stool)
    jobs = _jobs("memory://in/stool.ply", 3)
    receipts = run_batch(jobs, OUT, Here()).receipts
    memory.rm_file(f"/out/batch/{receipts[0]['folder']}/c.splat")
    memory.pipe_file(f"/out/batch/receipts/{jobs[1].key()}.json", b'{"code": 0, "ke')
    assert (again := run_batch(jobs, OUT, Here())).done == 2 and again.kept == 1
    _complete(memory, "/out/batch", jobs)


def test_what_failed_is_repeated_if_asked(memory: Any, stool: bytes) -> None:
    jobs = [Job(id="a", run=("info", "memory://in/stool.ply"))]
    failed = run_batch(jobs, OUT, Here())
    assert failed.failed == 1 and "no such file" in failed.receipts[0]["messages"]
    assert run_batch(jobs, OUT, Here()).kept == 1
    assert run_batch(jobs, OUT, Here(), again=True).failed == 1
    memory.pipe_file("/in/stool.ply", stool)
    assert run_batch(jobs, OUT, Here()).done == 1


def test_what_changes_while_a_job_reads_it_does_not_count(memory: Any, stool: bytes) -> None:
    memory.pipe_file("/in/stool.ply", stool)

    class Changing(Here):
        def outcomes(self, tasks: Any) -> Any:
            for outcome in super().outcomes(tasks):
                memory.pipe_file("/in/stool.ply", stool)
                yield outcome

    totals = run_batch(_jobs("memory://in/stool.ply", 1), OUT, Changing())
    assert totals.failed == 1 and "changed while it ran" in totals.receipts[0]["messages"]


def test_results_that_do_not_arrive_do_not_count(memory: Any, stool: bytes) -> None:
    memory.pipe_file("/in/stool.ply", stool)

    class Losing(Here):
        def outcomes(self, tasks: Any) -> Any:
            for outcome in super().outcomes(tasks):
                for path in memory.find("/out/batch/j0"):
                    memory.rm_file(path)
                yield outcome

    totals = run_batch(_jobs("memory://in/stool.ply", 1), OUT, Losing())
    assert totals.failed == 1 and "did not arrive" in totals.receipts[0]["messages"]


@pytest.mark.slow
def test_a_store_that_fails_now_and_then_costs_repetitions_and_no_result(
    memory: Any, stool: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    memory.pipe_file("/in/stool.ply", stool)
    monkeypatch.setattr(Failing, "share", 0.3)
    monkeypatch.setattr("scenewright.agent.batch.working._PAUSE", 0.0)
    jobs, runs = _jobs("memory://in/stool.ply", 8), list[Totals]()
    for _ in range(60):
        try:
            runs.append(run_batch(jobs, "failing://out", Here(), again=True))
        except FileError as error:
            assert "the store failed" in str(error)
        if runs and not any(receipt["code"] for receipt in runs[-1].receipts):
            break
    monkeypatch.setattr(Failing, "share", 0.0)
    run_batch(jobs, "failing://out", Here())
    _complete(fsspec.filesystem("failing"), "/out", jobs)


def test_two_batches_do_not_share_a_store(memory: Any) -> None:
    class Nested(Here):
        def outcomes(self, tasks: Any) -> Any:
            with pytest.raises(UserError, match="another batch"):
                run_batch([Job(id="b", run=("schema", "plan"))], OUT, Here())
            yield from super().outcomes(tasks)

    run_batch([Job(id="a", run=("info", "x"))], OUT, Nested())
    assert not memory.exists("/out/batch/lock.json")


@pytest.mark.slow
def test_the_lock_of_a_dead_batch_is_taken_over_and_that_of_a_live_one_elsewhere_is_not(
    memory: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    jobs = [Job(id="a", run=("info", "x"))]
    lock = {"token": "other", "host": store._host(), "process": 1, "since": "1", "beat": 0}
    memory.pipe_file("/out/batch/lock.json", json.dumps(lock).encode())
    assert run_batch(jobs, OUT, Here()).failed == 1  # process 1 was started at another time: that one has gone
    monkeypatch.setattr(store, "LEASE", 0.3)
    monkeypatch.setattr(store, "_LOOK", 0.05)
    for said in (json.dumps({**lock, "host": "elsewhere"}).encode(), b'{"tok'):
        memory.pipe_file("/out/batch/lock.json", said)
        assert run_batch(jobs, OUT, Here()).kept == 1
    beats = iter(range(10**6))
    real = store._Lock._read

    def beating(self: Any) -> bytes | None:
        if real(self) is not None:
            self._fs.pipe_file(self._path, json.dumps({**lock, "host": "elsewhere", "beat": next(beats)}).encode())
        return real(self)

    memory.pipe_file("/out/batch/lock.json", json.dumps({**lock, "host": "elsewhere"}).encode())
    monkeypatch.setattr(store._Lock, "_read", beating)
    with pytest.raises(UserError, match="another batch"):
        run_batch(jobs, OUT, Here())


def test_a_batch_whose_lock_was_taken_over_stops_and_the_first_receipt_counts(
    memory: Any, stool: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    memory.pipe_file("/in/stool.ply", stool)
    monkeypatch.setattr(store, "BEAT", 0.02)
    jobs = _jobs("memory://in/stool.ply", 2)

    class Overtaken(Here):
        def outcomes(self, tasks: Any) -> Any:
            for k, outcome in enumerate(super().outcomes(tasks)):
                if not k:
                    memory.rm_file("/out/batch/lock.json")
                    run_batch(jobs, OUT, Here())
                    memory.pipe_file("/out/batch/lock.json", b'{"token": "other"}')
                    time.sleep(0.3)
                yield outcome

    with pytest.raises(FileError, match="took over"):
        run_batch(jobs, OUT, Overtaken())
    memory.rm_file("/out/batch/lock.json")
    assert run_batch(jobs, OUT, Here()).kept == 2
    _complete(memory, "/out/batch", jobs)


def test_a_receipt_is_made_once(memory: Any, tmp_path: Path) -> None:
    for fs in (memory, fsspec.filesystem("file"), DirFileSystem(str(tmp_path / "dir"), fsspec.filesystem("file"))):
        path = str(tmp_path / "a.json") if fs is not memory else "/a.json"
        path = "a.json" if isinstance(fs, DirFileSystem) else path
        fs.makedirs(str(tmp_path / "dir"), exist_ok=True) if not isinstance(fs, DirFileSystem) else None
        assert store.created(fs, path, b"one") and not store.created(fs, path, b"two")
        assert fs.cat_file(path) == b"one"


def test_secrets_of_urls_are_in_no_receipt(memory: Any, stool: bytes) -> None:
    memory.pipe_file("/me:pass-word@in/stool.ply", stool)
    jobs = [
        Job(id="a", run=("info", "memory://me:pass-word@in/stool.ply?sig=abc")),
        Job(id="b", run=("info", "memory://me:pass-word@in/stool.ply")),
    ]
    run_batch(jobs, "memory://me:pass-word@out/batch", Here())
    kept = [memory.cat_file(path) for path in memory.find("/me:pass-word@out/batch")]
    assert len(kept) >= 3 and not any(b"pass-word" in text or b"sig=abc" in text for text in kept)


def test_single_commands_read_urls_and_write_paths(
    memory: Any, stool: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    memory.pipe_file("/in/stool.ply", stool)
    assert _code("info", "memory://in/stool.ply", "--json") == 0
    assert json.loads(capsys.readouterr().out)["gaussians"] > 0
    assert _code("convert", "memory://in/stool.ply", str(tmp_path / "a.splat")) == 0
    assert _code("embed", "memory://in/stool.ply") == 2 and "writes beside" in capsys.readouterr().err
    assert _code("edit", "memory://in/stool.ply", "make it red", "-o", "memory://in/red.ply") == 2
    assert "scenewright batch" in capsys.readouterr().err
    assert _code("info", "s9://in/stool.ply") == 2


def _code(*words: str) -> int:
    with pytest.raises(SystemExit) as end:
        main(list(words))
    return int(end.value.code or 0)


@pytest.mark.slow
def test_heads_and_workers_that_are_killed_lose_nothing_in_a_shared_folder_by_url(stool: bytes, tmp_path: Path) -> None:
    """`kill -9` of the head and of workers at random moments, again and again; the same command goes on."""
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "stool.ply").write_bytes(stool)
    jobs = _jobs(f"file://{tmp_path}/in/stool.ply", 14)
    (tmp_path / "jobs.jsonl").write_text("".join(job.model_dump_json(include={"id", "run"}) + "\n" for job in jobs))
    command = [sys.executable, "-m", "scenewright", "batch", str(tmp_path / "jobs.jsonl"), "-o"]
    command += [f"file://{tmp_path}/out", "--workers", "2", "--json"]
    chance, receipts, killed = random.Random(0), tmp_path / "out" / "receipts", 0
    for _ in range(3):
        before = len(list(receipts.glob("*.json"))) if receipts.is_dir() else 0
        head = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while head.poll() is None and (not receipts.is_dir() or len(list(receipts.glob("*.json"))) < before + 3):
            time.sleep(0.02)
        time.sleep(chance.uniform(0.0, 0.3))
        asked = ["pgrep", "-P", str(head.pid), "-f", "batch.worker"]
        for worker in subprocess.run(asked, capture_output=True, text=True, check=False).stdout.split()[:1]:
            os.kill(int(worker), signal.SIGKILL)
            killed += 1
        head.kill()
        head.wait()
    kept = {path.name: path.read_bytes() for path in receipts.glob("*.json")}
    told = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    assert killed and told["failed"] == [] and told["kept"] + told["done"] == 14 and told["kept"] >= 9
    assert sum((receipts / name).read_bytes() == data for name, data in kept.items()) >= told["kept"]
    _complete(fsspec.filesystem("file"), f"{tmp_path}/out", jobs)


@pytest.mark.parametrize("url", ["dir://out", "local"])
def test_local_and_nested_file_systems(url: str, stool: bytes, tmp_path: Path, memory: Any) -> None:
    (tmp_path / "stool.ply").write_bytes(stool)
    jobs = _jobs(f"file://{tmp_path}/stool.ply", 2)
    if url == "local":
        assert run_batch(jobs, f"file://{tmp_path}/out", Here()).done == 2
        _complete(fsspec.filesystem("file"), f"{tmp_path}/out", jobs)
        return
    inside = DirFileSystem("/deep", memory)
    fs_of = store.opened

    def nested(given: str) -> tuple[Any, str]:
        return (inside, given.partition("://")[2]) if given.startswith("dir://") else fs_of(given)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(store, "opened", nested)
        patch.setattr("scenewright.gaussians.files.remote.opened", nested)
        assert run_batch(jobs, url, Here()).done == 2
    _complete(memory, "/deep/out", jobs)


def test_a_place_that_cannot_be_written_is_said(memory: Any) -> None:
    with pytest.raises(ScenewrightError):
        run_batch([Job(id="a", run=("info", "x"))], "nonsense://out", Here())
