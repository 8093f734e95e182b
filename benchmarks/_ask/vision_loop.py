"""The loop that asks vision models: three wire formats over loopback servers, spoiled replies, a tiny LLaVA.

The servers and models are those of the tests (`tests/support`), so that this needs a checkout. It does not measure how
well a model sees, but what is sent to it and what becomes of its replies.
"""

from __future__ import annotations

import importlib
import io
import json
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from PIL import Image

from ...gaussians.errors import BackendError
from ...gaussians.torchvision_fix import import_torchvision
from ...planners.budget import Budget, Ledger
from ...planners.model import load, pictures
from ...planners.model.backend import Message, UnreachableError
from ...planners.questions.answer import Answer
from ...planners.vision.answering import SeenReply, Terms, ask_about
from ...planners.vision.asking import Purse, read, schema
from ...planners.vision.captions import CaptionsReply, captions
from ...planners.vision.facts import Facts
from ...planners.vision.judging import VerdictReply, verdict
from ...planners.vision.pointing import PointReply, point
from .._select.cases import Part
from ..harness import Metric
from .hostile_replies import COUNT, GOOD, spoiled

SUPPORT = Path(__file__).resolve().parents[2] / "tests" / "support"
LIMITS = {"openai": pictures.OPENAI, "anthropic": pictures.ANTHROPIC, "google": pictures.GOOGLE}
REPLIES = 40  # of the tiny LLaVA
KINDS = (SeenReply, CaptionsReply, VerdictReply, PointReply)
YES = json.dumps({"because": "It is tidy.", "answer": "yes", "answer_type": "yesno", "confidence": 0.9})
MORE = json.dumps({"answer_type": "yesno", "confidence": 0.2, "need_more": ["close:#2", "plan"]})

Ask = Callable[..., tuple[Answer, list[Any], Any]]  # turns of the server to the answer, the requests and the looker


def measure(quick: bool) -> Part:
    """All figures; what needs a package that is not installed is left out, with a note."""
    if not SUPPORT.is_dir():
        return Part(notes=("vlm: needs a checkout with tests/support.",))
    with _support():
        parts = (_wires(), _hostile(100 if quick else COUNT), _llava(4 if quick else REPLIES))
    return Part(tuple(m for p in parts for m in p.metrics), (), tuple(n for p in parts for n in p.notes))


@contextmanager
def _support() -> Iterator[None]:
    """The stand-ins of the tests can be imported, no proxy is in the way, and a key is set."""
    proxies = ("HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY", "http_proxy", "https_proxy", "all_proxy")
    kept = {name: os.environ.get(name) for name in (*proxies, "SCENEWRIGHT_API_KEY")}
    sys.path.insert(0, str(SUPPORT))
    for name in proxies:
        os.environ.pop(name, None)
    os.environ["SCENEWRIGHT_API_KEY"] = "sk-scenewright-0123456789-abcdefghij"
    try:
        yield
    finally:
        sys.path.remove(str(SUPPORT))
        for name, value in kept.items():
            os.environ.pop(name, None)
            if value is not None:
                os.environ[name] = value


def _wires() -> Part:
    """Share of checks of the protocol that pass, over all wire formats."""
    if find_spec("pydantic_ai") is None:
        return Part(notes=("vlm.wires: needs pip install 'scenewright[llm]'.",))
    wires: Any = importlib.import_module("loopback")
    looking: Any = importlib.import_module("scripted_looker")
    passed, failed = 0, list[str]()
    for wire in (wires.OpenAI, wires.Anthropic, wires.Google):

        def ask(*script: Any, wire: Any = wire, size: tuple[int, int] = (32, 24), **terms: Any) -> Any:
            looker = looking.ScriptedLooker(size=size)
            with wires.serving(*script) as server:
                backend = load(f"{wire.kind}:small@{server.url}")
                return ask_about("is it tidy?", Facts(), looker, backend, Terms(**terms)), server.asked, looker

        for name, check in CHECKS.items():
            try:
                fine = check(wire, ask)
            except BackendError:
                fine = False
            passed += fine
            failed += [] if fine else [f"{wire.kind}: {name}"]
    share = passed / (3 * len(CHECKS))
    notes = (f"vlm.wires failed: {', '.join(failed)}.",) if failed else ()
    return Part((Metric("vlm.wires", share, "share", "higher", goal=1.0),), (), notes)


def _several(wire: Any, ask: Ask) -> bool:
    answer, (sent,), _ = ask(wire.answer(YES))
    return answer.answer == "yes" and len(wire.pictures(sent.body)) == 3


def _more(wire: Any, ask: Ask) -> bool:
    answer, sent, looker = ask(wire.answer(MORE), wire.answer(YES))
    shown = [len(wire.pictures(one.body)) for one in sent]
    return answer.answer == "yes" and shown == [3, 5] and looker.made[-2:] == ["close:20", "plan"]


def _sizes(wire: Any, ask: Ask) -> bool:
    limits = LIMITS[wire.kind]
    for size in ((limits.long + 64, 100), (64, 48)):
        _, (sent,), _ = ask(wire.answer(YES), size=size, first=1)
        (arrived,) = wire.pictures(sent.body)
        if Image.open(io.BytesIO(arrived)).size != limits.size(*size):
            return False
    return True


def _streamed(wire: Any, ask: Ask) -> bool:
    heard: list[str] = []
    pieces = [YES[i : i + 20] for i in range(0, len(YES), 20)]
    answer, _, _ = ask(wire.stream(pieces), progress=lambda stage, share: heard.append(stage))
    return answer.answer == "yes" and len(heard) > 3


def _repaired(wire: Any, ask: Ask) -> bool:
    answer, sent, _ = ask(wire.answer(YES.replace("0.9", "9")), wire.answer(YES))
    return answer.answer == "yes" and len(sent) == 2


def _retried(wire: Any, ask: Ask) -> bool:
    busy = wire.error(429, "slow down", **{"retry_after": "0.1"})
    answer, sent, _ = ask(busy, wire.answer(YES))
    return answer.answer == "yes" and len(sent) == 2


def _loosened(wire: Any, ask: Ask) -> bool:
    answer, sent, _ = ask(wire.error(400, "response_format and tools are not supported"), wire.answer(YES))
    return answer.answer == "yes" and len(sent) == 2


def _spent(wire: Any, ask: Ask) -> bool:
    answer, sent, looker = ask(wire.answer(MORE), ledger=Ledger(Budget(tokens=18, views=2)))
    return answer.answer is None and len(sent) == 1 and len(looker.made) == 2


def _late(wire: Any, ask: Ask) -> bool:
    try:
        ask(wire.stream([YES], pause=3.0), ledger=Ledger(Budget(seconds=0.3)))
    except UnreachableError:
        return True
    return False


def _refused(wire: Any, ask: Ask) -> bool:
    try:
        ask(wire.error(401, "no such key"))
    except UnreachableError as error:
        return "sk-scenewright" not in str(error)
    return False


CHECKS: dict[str, Callable[[Any, Ask], bool]] = {
    "several pictures": _several,
    "pictures that it asks for": _more,
    "sizes": _sizes,
    "streams": _streamed,
    "repairs": _repaired,
    "retries": _retried,
    "a refused schema": _loosened,
    "tokens and views": _spent,
    "seconds": _late,
    "a refused key": _refused,
}


def _hostile(count: int) -> Part:
    """How many spoiled replies raise anything but a message, and how many name what no picture shows."""
    kinds, crashed, strange, used = sorted(GOOD), 0, 0, 0
    for seed in range(count):
        kind = kinds[seed % len(kinds)]
        try:
            said, groups = _heard(kind, spoiled(kind, seed))
        except BackendError:
            continue
        except Exception:  # whatever a reply brings about is what is counted here
            crashed += 1
            continue
        used += bool(said)
        strange += not groups <= {10, 20, 30} or any(not text.isprintable() for text in said)
    return Part(
        (
            Metric("vlm.hostile", count, "count"),
            Metric("vlm.hostile.crashed", crashed, "count", "lower", goal=0.0),
            Metric("vlm.hostile.strange", strange, "count", "lower", goal=0.0),
            Metric("vlm.hostile.used", used / count, "share"),
        ),
        (),
        ("vlm.hostile: replies spoiled by a seeded generator; used: valid all the same, as one without an optional "
         "field; strange: what is used names groups that no picture shows, or holds control characters.",),
    )  # fmt: skip


def _heard(kind: str, text: str) -> tuple[list[str], set[Any]]:
    """The texts and the ids of groups that are taken from a reply; no texts if none is."""
    looker: Any = importlib.import_module("scripted_looker").ScriptedLooker(size=(4, 4))
    model: Any = importlib.import_module("scripted_model").ScriptedModel(text, sees=True)
    if kind == "ask":
        answer = ask_about("is it tidy?", Facts(), looker, model, Terms(samples=1, first=1))
        return [answer.text] if answer.answer is not None else [], set(answer.evidence.ids)
    if kind == "caption":
        found = captions((10, 20, 30), Facts(), looker, model, Purse(views=1))
        told = [text for c in found.groups.values() for text in (c.name, c.text)]
        return [found.scene, *told], set(found.groups)
    if kind == "judge":
        shown = looker.overview((), 2)
        judged = verdict("delete the cup", shown[:1], shown[1:], model)
        return [judged.reason, *judged.side_effects], set()
    meant = point("the cup", (), looker, model, Purse(views=2))
    return [meant.because, "meant"], set(meant.groups)


def _llava(count: int) -> Part:
    """Share of the replies of a tiny LLaVA of random weights that are valid by their type."""
    if any(find_spec(name) is None for name in ("transformers", "llguidance", "torchvision")):
        return Part(notes=("vlm.llava: needs pip install 'scenewright[models]'.",))
    import_torchvision()
    from ...planners.model.local import backend, checkpoint

    wires: Any = importlib.import_module("loopback")
    models: Any = importlib.import_module("tiny_models")
    with tempfile.TemporaryDirectory() as place:
        llama, llava = Path(place, "llama"), Path(place, "llava")
        models.save_llama(llama)
        models.save_llava(llava, llama)
        parts = checkpoint.read(str(llava))
    valid = ended = 0
    for seed in range(count):
        kind = KINDS[seed % len(KINDS)]
        model = backend.LocalModel(parts, "transformers:tiny", temperature=0.7, seed=seed + 1, max_tokens=500)
        messages = [Message("system", "Answer with JSON."), Message("user", "look", (wires.png(28, 28, seed),))]
        answer = model.answer(messages, schema(kind), seconds=120)
        if answer.end != "done":
            continue
        ended += 1
        try:
            read(answer.text, kind)
        except ValueError:
            continue
        valid += 1
    return Part(
        (
            Metric("vlm.llava.valid", valid / max(ended, 1), "share", "higher", goal=1.0),
            Metric("vlm.llava.ended", ended / count, "share", "higher"),
        )
    )
