"""The messages that ask a language model for a plan: rules, operations and examples, then the scene and the words.

Knows what goes into a prompt and how much fits. Refuses to know what a model answers. The same input gives the same
bytes, and the first message depends on nothing but how much fits, so that providers can keep it.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import cache

from .... import prompts
from ....gaussians.errors import BackendError
from ...rooms.graph import SceneGraph
from ..backend import Message
from . import examples, operations
from .pruning import MOST_TOKENS, described, tokens

ECHO_CHARS = 2000  # of an answer that is shown to the model again
FAULT_CHARS = 1500
_LEAST_ANSWER = 2048  # tokens left to the answer, and to what is said about one that was no good
_REQUEST = 1200  # tokens that examples leave to the scene and the instruction
_LEAST_SCENE = 200  # tokens; with less no scene is worth showing
_PICTURE = 1100  # tokens; what providers count for a picture of 768 pixels across, rather too many
_FILES = ("plan", "plan_request", "plan_repair", "plan_examples")
_NO_SCENE = "(none is shown: answer in words, without ids, and without the verdicts absent and ambiguous)"


@dataclass(frozen=True)
class Request:
    """What a model is told about one instruction.

    Attributes:
        text: the instruction.
        previous: the instruction before.
        graph: the scene with names that a model may see (see `labels.cleaned`); None if nobody looked.
        picture: the viewer's view as PNG.
    """

    text: str
    previous: str | None = None
    graph: SceneGraph | None = None
    picture: bytes | None = None


@cache
def prompt_hash() -> str:
    """Of the files that every prompt is made of."""
    return prompts.short_hash(*(prompts.load(name).hash for name in _FILES))


def messages(request: Request, window: int) -> tuple[Message, ...]:
    """The conversation so far: the rules, then the request.

    Args:
        window: tokens that prompt and answer may have together.

    Raises:
        BackendError: not even the rules fit.
    """
    room = window - max(_LEAST_ANSWER, window // 8) - (_PICTURE if request.picture else 0)
    rules = system(room)
    bare = _asked(request, _NO_SCENE)
    left = room - tokens(rules) - tokens(bare)
    if left < (_LEAST_SCENE if request.graph is not None else 0):
        need = math.ceil((window - left + _LEAST_SCENE) / 1024)
        raise BackendError(
            f"the model's window of {window} tokens is too short for the rules of planning; use a model, or set its "
            f"server, to {need}k tokens or more"
        )
    asked = bare
    if request.graph is not None:
        asked = _asked(request, described(request.graph, _said(request), min(left, MOST_TOKENS)))
    return Message("system", rules), Message("user", asked, request.picture)


def repaired(first: tuple[Message, ...], answer: str, fault: str) -> tuple[Message, ...]:
    """The conversation with a bad answer, cut short, and what was wrong with it; only the last one is kept."""
    echo = answer if len(answer) <= ECHO_CHARS else answer[:ECHO_CHARS] + " …"
    told = prompts.load("plan_repair").fill(fault=fault[:FAULT_CHARS])
    return (*first, Message("assistant", echo.strip() or "(nothing)"), Message("user", told))


@cache
def system(room: int) -> str:
    """The rules, with as many examples as fit, the most telling first.

    Args:
        room: tokens that the rules and the request may have together.
    """
    scene, every = _examples()
    bare = _rules("(none)")
    left = room - tokens(bare) - _REQUEST - tokens(scene)
    kept = [scene]
    for example in every:
        left -= tokens(example) + 1
        if left < 0:
            break
        kept.append(example)
    return _rules("\n\n".join(kept)) if len(kept) > 1 else bare


def _rules(shown: str) -> str:
    return prompts.load("plan").fill(operations=operations.described(), examples=shown)


@cache
def _examples() -> tuple[str, tuple[str, ...]]:
    graph, every = examples.parse(prompts.load("plan_examples").text)
    return "Scene of the examples:\n" + described(graph, (), MOST_TOKENS), tuple(example.told() for example in every)


def _asked(request: Request, scene: str) -> str:
    before = _quoted(request.previous) if request.previous else "(none)"
    return prompts.load("plan_request").fill(scene=scene, before=before, instruction=_quoted(request.text))


def _said(request: Request) -> tuple[str, ...]:
    return (request.text, *([request.previous] if request.previous else []))


def _quoted(text: str) -> str:
    """The words on one line, so that they end where they end."""
    return json.dumps(text, ensure_ascii=False)
