"""Build the messages that ask a language model for a plan: rules, operations and examples, then scene and instruction.

The same input gives the same bytes. The first message depends only on the token budget, so that providers can cache it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

from .... import prompts
from ....gaussians.errors import BackendError
from ...plan import PromptSize
from ...rooms.graph import SceneGraph
from ..backend import Message
from . import examples, operations
from .pruning import MAX_TOKENS, Shown, described, tokens

ECHO_CHARS = 2000  # of an answer that is shown to the model again
FAULT_CHARS = 1500
_LEAST_ANSWER = 2048  # tokens reserved for the answer and for the repair message
_REQUEST = 1200  # tokens reserved for the scene and the instruction when examples are chosen
_SHORT_REQUEST = 470  # the same where the decisive examples would not fit; most things are then told by name alone
_LEAST_SCENE = 200  # tokens; with less, no scene is shown
_DECISIVE = 8  # examples, the first ones of the file, for which the operations are told more briefly
_PICTURE = 1100  # tokens; a generous estimate of what providers count for an image 768 pixels wide
_FILES = ("plan", "plan_request", "plan_repair", "plan_examples")
_NO_SCENE = "(none is shown: answer in words, without ids, and without the verdicts absent and ambiguous)"


@dataclass(frozen=True)
class Request:
    """Input of the prompt for one instruction.

    Attributes:
        text: the instruction.
        previous: the previous instruction.
        graph: the scene with sanitised names (see `labels.sanitize`); None if there is none.
        picture: the viewer's view as PNG.
    """

    text: str
    previous: str | None = None
    graph: SceneGraph | None = None
    picture: bytes | None = None


@cache
def prompt_hash() -> str:
    """Hash of the prompt files."""
    return prompts.short_hash(*(prompts.load(name).hash for name in _FILES))


@dataclass(frozen=True)
class Prompt:
    """The initial messages of a request: the rules, then the request; and how much of scene and examples they hold."""

    messages: tuple[Message, ...]
    size: PromptSize


def prompt(request: Request, window: int) -> Prompt:
    """The prompt of a request.

    Args:
        window: tokens of prompt and answer together.

    Raises:
        BackendError: the rules do not fit the window.
    """
    room = window - max(_LEAST_ANSWER, window // 8) - (_PICTURE if request.picture else 0)
    rules = system(room)
    bare = _asked(request, _NO_SCENE)
    left = room - tokens(rules.text) - tokens(bare)
    if left < (_LEAST_SCENE if request.graph is not None else 0):
        need = math.ceil((window - left + _LEAST_SCENE) / 1024)
        raise BackendError(
            f"the model's window of {window} tokens is too short for the rules of planning; use a model, or set its "
            f"server, to {need}k tokens or more (--window or SCENEWRIGHT_WINDOW says what it has, if it does not tell)"
        )
    asked, shown = bare, Shown("")
    if request.graph is not None:
        shown = described(request.graph, (request.text, request.previous or ""), min(left, MAX_TOKENS))
        asked = _asked(request, shown.text)
    pictures = (request.picture,) if request.picture is not None else ()
    size = PromptSize(
        tokens=tokens(rules.text) + tokens(asked) + len(pictures) * _PICTURE,
        window=window,
        things=shown.whole,
        named_only=shown.named,
        of_things=len(request.graph.nodes) if request.graph is not None else 0,
        examples=rules.examples,
        of_examples=len(_examples()[1]),
    )
    return Prompt((Message("system", rules.text), Message("user", asked, pictures)), size)


def repaired(first: tuple[Message, ...], answer: str, fault: str) -> tuple[Message, ...]:
    """The conversation with a bad answer, cut short, and what was wrong with it; only the last one is kept."""
    echo = answer if len(answer) <= ECHO_CHARS else answer[:ECHO_CHARS] + " …"
    told = prompts.load("plan_repair").fill(fault=fault[:FAULT_CHARS])
    return (*first, Message("assistant", echo.strip() or "(nothing)"), Message("user", told))


@dataclass(frozen=True)
class Rules:
    """The first message, and how many of the examples it holds."""

    text: str
    examples: int


@cache
def system(room: int) -> Rules:
    """The rules, with as many examples as fit.

    The operations are told in as much detail as leaves room for the decisive examples.

    Args:
        room: tokens of the rules and the request together.
    """
    scene, every = _examples()
    least = tokens(scene) + sum(tokens(e) + 1 for e in every[:_DECISIVE])
    cost = {d: tokens(_rules("(none)", d)) for d in operations.DETAILS}
    detail = next((d for d in operations.DETAILS if cost[d] + least + _REQUEST <= room), operations.DETAILS[-1])
    request = _REQUEST if cost[detail] + least + _REQUEST <= room else _SHORT_REQUEST
    left = room - request - cost[detail] - tokens(scene)
    kept = [scene]
    for example in every:
        left -= tokens(example) + 1
        if left < 0:
            break
        kept.append(example)
    shown = "\n\n".join(kept) if len(kept) > 1 else "(none)"
    return Rules(_rules(shown, detail), len(kept) - 1)


def _rules(shown: str, detail: operations.Detail) -> str:
    return prompts.load("plan").fill(operations=operations.described(detail), examples=shown)


@cache
def _examples() -> tuple[str, tuple[str, ...]]:
    graph, every = examples.parse(prompts.load("plan_examples").text)
    return "Scene of the examples:\n" + described(graph, (), MAX_TOKENS).text, tuple(
        example.told() for example in every
    )


def _asked(request: Request, scene: str) -> str:
    before = examples.quoted(request.previous) if request.previous else "(none)"
    return prompts.load("plan_request").fill(scene=scene, before=before, instruction=examples.quoted(request.text))
