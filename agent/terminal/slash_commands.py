"""What begins with a slash in a conversation: each command, what it does in a line, and what it answers.

Knows what a session can be asked besides instructions. Refuses to know where lines come from, and how an answer gets to
the eye: that is the chat's.
"""

from __future__ import annotations

import shlex
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from ...gaussians.errors import UserError
from ..session.model_usage import asked, took
from ..session.resolved_plan import plan_lines, selection_json
from .tables import table

if TYPE_CHECKING:
    from ...planners.plan import EditPlan
    from ..session.result import Result
    from ..session.session import Session

STEP = 0.05  # metres by which a selection grows or shrinks if nothing is said
_EXAMPLES = (
    "make the armchair teal and remove the coffee table",
    "move the plant 50 cm to the left",
    "put a red ball on the table",
)


class Conversation(Protocol):
    """What a command may use of the chat that it is given in; see `chat.Chat`."""

    session: Session
    planned: EditPlan | None
    saved: bool
    over: bool

    def tell(self, text: str, data: dict[str, Any], style: str = "default") -> None: ...
    def show_result(self, result: Result) -> None: ...
    def show_picture(self) -> None: ...


class Slash(NamedTuple):
    """A command: what `/help` says of it, and what it does with the rest of its line."""

    says: str
    do: Callable[[Conversation, str], None]


def carry_out(chat: Conversation, line: str) -> None:
    """Do what a line that begins with a slash asks.

    Raises:
        UserError: there is no such command, or what follows it is not what it takes.
        ScenewrightError: it cannot be done.
    """
    name, _, rest = line.partition(" ")
    if (slash := SLASHES.get(name.lower())) is None:
        raise UserError(f"there is no command {name}; /help lists them")
    slash.do(chat, rest.strip())


def _help(chat: Conversation, _: str) -> None:
    from ...tools.registry import describe

    says = {name: slash.says for name, slash in SLASHES.items()}
    operations = table(("operation", "for example"), [(name, words) for name, _, words, _ in describe()])
    commands = table(("command", "does"), list(says.items()))
    said = "\n".join(["Say what to do, for example:", *(f"  {e}" for e in _EXAMPLES)])
    chat.tell(f"{said}\n\n{operations}\n\n{commands}", {"commands": says})


def _undo(chat: Conversation, _: str) -> None:
    chat.show_result(chat.session.undo())


def _redo(chat: Conversation, _: str) -> None:
    chat.show_result(chat.session.redo())


def _plan(chat: Conversation, text: str) -> None:
    if text:
        result = chat.session.preview(text)
        planned = plan_lines(result.plan) if result.plan is not None else []
        lines = [*planned, *result.sentences(), *asked(result.plan), "(not done)"]
        chat.tell("\n".join(lines), result.to_json())
        return
    if chat.planned is None:
        raise UserError("nothing was planned yet; /plan TEXT shows what an instruction would do")
    chat.tell("\n".join(plan_lines(chat.planned)), chat.planned.model_dump(mode="json"))


def _select(chat: Conversation, text: str) -> None:
    if not text:
        raise UserError("say what to select: /select the red chair")
    found = chat.session.select(text)
    if found.verdict == "found":
        things = ", ".join(c.describe() for c in found.candidates) or found.query.describe()
        chat.tell(f"{len(found):,} Gaussians: {things}", selection_json(found))
        return
    lines = [found.reason, *(f"  {i}. {c.describe()}" for i, c in enumerate(found.candidates, start=1))]
    chat.tell("\n".join(lines), selection_json(found))


def _why(chat: Conversation, text: str) -> None:
    if not text:
        raise UserError("say what to explain: /why the red chair")
    explained = chat.session.explain(text)
    chat.tell("\n".join(explained.lines()), explained.to_json())


def _grow(chat: Conversation, text: str) -> None:
    chat.show_result(chat.session.adjust(grow=_metres(text)))


def _shrink(chat: Conversation, text: str) -> None:
    chat.show_result(chat.session.adjust(grow=-_metres(text)))


def _metres(text: str) -> float:
    """How far a selection is to grow or shrink.

    Raises:
        UserError: the text is no such distance.
    """
    try:
        by = float(text.removesuffix("m").strip() or STEP)
    except ValueError as error:
        raise UserError(f"{text!r} is no distance; say metres, for example /grow 0.05") from error
    if not 0 < by <= 100:
        raise UserError(f"a selection grows by metres above 0 and up to 100, not by {by:g}")
    return by


def _invert(chat: Conversation, _: str) -> None:
    chat.show_result(chat.session.adjust(invert=True))


def _show(chat: Conversation, view: str) -> None:
    from ..pictures.named_cameras import choose_view

    if view:
        chat.session.viewer = choose_view(chat.session.scene, view)
    chat.show_picture()


def _things(chat: Conversation, _: str) -> None:
    from ...gaussians.color import name_of
    from .thing_names import name_of_thing

    language = chat.session.embed().language
    assert language is not None
    rows = [(g.id, f"{name_of(g.lab)} {name_of_thing(g)}", g.count) for g in language.objects() if g.count]
    data = {"things": [{"group": i, "name": name, "gaussians": n} for i, name, n in rows]}
    shown = [(i, name, f"{n:,}") for i, name, n in rows]
    chat.tell(table(("group", "thing", "Gaussians"), shown), data)


def _planner(chat: Conversation, spec: str) -> None:
    if spec:
        chat.session.planner = spec
    budget, spent = chat.session.budget, chat.session.spent
    dollars = f", ${budget.dollars:.4g} a session" if budget.dollars is not None else ""
    lines = [
        f"planner: {chat.session.planner}",
        f"models may take {budget.seconds:g} s an instruction{dollars}",
        f"spent so far: {took(spent).removeprefix('in ')}" if spent else "no model was asked so far",
    ]
    data = {
        "planner": chat.session.planner,
        "budget": {"seconds": budget.seconds, "dollars": budget.dollars},
        "spent": spent.model_dump(mode="json") if spent else None,
    }
    chat.tell("\n".join(lines), data)


def _history(chat: Conversation, _: str) -> None:
    done = chat.session.done
    chat.tell("\n".join(f"  {i}. {t}" for i, t in enumerate(done, 1)) or "nothing was done yet", {"done": list(done)})


def _save(chat: Conversation, arguments: str) -> None:
    try:
        words = shlex.split(arguments)
    except ValueError as error:
        raise UserError("a quotation mark is open; write for example /save 'my room.ply'") from error
    names = [w for w in words if w != "--force"]
    if len(names) != 1:
        raise UserError("say where to: /save out.ply (add --force to overwrite)")
    chat.session.save(names[0], force="--force" in words)
    chat.saved = True
    chat.tell(f"wrote {names[0]}", {"verdict": "ok", "path": names[0]})


def _quit(chat: Conversation, _: str) -> None:
    chat.over = True


SLASHES: dict[str, Slash] = {
    "/help": Slash("what can be said", _help),
    "/undo": Slash("take the last instruction back", _undo),
    "/redo": Slash("do again what was taken back", _redo),
    "/plan": Slash("TEXT: what an instruction would do, without doing it; alone: the last plan", _plan),
    "/select": Slash("TEXT: what a phrase means; 'it' then means that", _select),
    "/why": Slash("TEXT: why a phrase means what it means, term by term", _why),
    "/grow": Slash("[METRES]: take in what lies around the selection (0.05 m if not said)", _grow),
    "/shrink": Slash("[METRES]: draw the selection back from what lies around it", _shrink),
    "/invert": Slash("select everything but what is selected", _invert),
    "/show": Slash("a picture of the current view; /show 2 looks through the scene's camera 2", _show),
    "/things": Slash("what is in the scene", _things),
    "/planner": Slash(
        "[NAME]: who reads what is said, and what that cost; with a name, another one from now on", _planner
    ),
    "/history": Slash("the instructions that led here", _history),
    "/save": Slash("FILE [--force]: write the scene", _save),
    "/quit": Slash("end the conversation", _quit),
}
