"""Rows of repetition: the same bytes from the same input, in another process and with other numbers of threads."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from collections.abc import Iterator

from ...gaussians.errors import BackendError
from ...gaussians.language import encoders
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.resolve import resolve
from ...gaussians.render import render
from ...tools.execute import carry_out
from ...tools.operation import Context
from ...tools.registry import parse
from .._rows import Level, Row
from .._select import cases
from .ground import Ground

COUNTS = (1, 2, 3, 8)  # threads
SEED, DETAIL = 7204, 0.12
_CODE = "from scenewright.benchmarks._stability.threads import print_hashes; print_hashes()"


def rows(ground: Ground) -> Iterator[Row]:
    """All of them; none in a quick run."""
    if ground.quick:
        return
    own = hashes()
    yield _row("repeat.same_process", own, {"again": hashes()})
    yield _row("repeat.thread_count", own, {f"{count} threads": _in_process(count) for count in COUNTS})


def _row(name: str, own: dict[str, str], others: dict[str, dict[str, str]]) -> Row:
    levels = (Level(label, sum(own[key] == other[key] for key in own) / len(own)) for label, other in others.items())
    return Row(name, 1.0, tuple(levels), "hashes", len(own), law=True)


def hashes() -> dict[str, str]:
    """Hashes of a made room, its picture, its field, what a name selects, and the room without that and painted."""
    encoder = encoders.load("auto")
    case = cases.furnished(SEED, DETAIL)
    eye = case.scene.cameras[0]
    known = cases.embedded(case, encoder)
    field = known.scene.language
    assert field is not None
    name = next(o.kind for o in case.alone() if cases.ask(known, o.kind, encoder).verdict == "found")
    chosen = resolve(known.scene, Query(text=name), eye, encoder)
    after = known.scene
    for data in ({"op": "recolor", "color": "teal"}, {"op": "rotate", "degrees": 20}):
        op = parse({**data, "target": {"text": name}})
        after = carry_out(after, op, Context(eye, encoder=encoder), seen=False).scene
    return {
        "room": case.scene.cloud.digest(),
        "picture": _hash(render(case.scene.cloud, eye.resized(256, 192)).rgb.numpy().tobytes()),
        "groups": known.scene.cloud.digest(),
        "vectors": _hash(field.embeddings.tobytes()),
        "names": _hash(repr([(g.label, g.label_score, g.box) for g in field.groups]).encode()),
        "selection": _hash(chosen.ids.numpy().tobytes()),
        "edited": after.cloud.digest(),
    }


def print_hashes() -> None:
    """The hashes as JSON, for another process to read."""
    print(json.dumps(hashes()))


def _hash(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _in_process(threads: int) -> dict[str, str]:
    """The hashes with a number of threads.

    Raises:
        BackendError: the process failed.
    """
    names = ("OMP_NUM_THREADS", "NUMBA_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")
    surroundings = {**os.environ, **dict.fromkeys(names, str(threads))}
    ended = subprocess.run([sys.executable, "-c", _CODE], capture_output=True, text=True, check=False, env=surroundings)
    if ended.returncode:
        lines = ended.stderr.strip().splitlines() or ["no reason given"]
        raise BackendError(f"a process with {threads} threads failed: {lines[-1]}")
    found: dict[str, str] = json.loads(ended.stdout.splitlines()[-1])
    return found
