"""The slash commands of the chat and of the page: each one's help line, and the function that runs it."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol

from ...gaussians.errors import UserError
from ..session.plan_report import format_usage, plan_lines, selection_json, usage_lines

if TYPE_CHECKING:
    from pathlib import Path

    from ..pictures.scene_pictures import Picture
    from ..session.dialogue import Dialogue
    from ..session.result import Result
    from ..session.session import Session

STEP = 0.05  # metres, default distance by which a selection grows or shrinks
_EXAMPLES = (
    "make the armchair teal and remove the coffee table",
    "move the plant 50 cm to the left",
    "put a red ball on the table",
    "look from the left, closer",
)


class Conversation(Protocol):
    """Where commands are typed: the chat on a terminal, or the page in a browser.

    Attributes:
        elsewhere: what to do instead of the commands that do not work here, by their names.
    """

    elsewhere: ClassVar[Mapping[str, str]]
    session: Session
    dialogue: Dialogue

    def tell(self, text: str, data: dict[str, Any]) -> None: ...
    def note(self, text: str) -> None: ...
    def table(self, columns: Sequence[str], rows: Sequence[Sequence[object]]) -> str: ...
    def show_result(self, result: Result) -> None: ...
    def show_picture(self) -> None: ...
    def show_image(self, image: Picture) -> None: ...
    def file(self, name: str) -> Path: ...
    def save(self, name: str, force: bool) -> str: ...
    def end(self) -> None: ...


class SlashCommand(NamedTuple):
    """A command: its line in `/help`, and the function that runs it with the rest of the input line."""

    help: str
    run: Callable[[Conversation, str], None]


def run_command(chat: Conversation, line: str) -> None:
    """Run a line that begins with a slash.

    Raises:
        UserError: there is no such command, or its arguments are not valid.
        ScenewrightError: the command failed.
    """
    name, _, rest = line.partition(" ")
    if (command := SLASH_COMMANDS.get(name.lower())) is None:
        raise UserError(f"there is no command {name}; /help lists them")
    if (instead := chat.elsewhere.get(name.lower())) is not None:
        raise UserError(instead)
    command.run(chat, rest.strip())


def _help(chat: Conversation, _: str) -> None:
    from ...tools.registry import describe

    help_lines = {name: command.help for name, command in SLASH_COMMANDS.items() if name not in chat.elsewhere}
    operations = chat.table(("operation", "for example"), [(name, words) for name, _, words, _ in describe()])
    commands = chat.table(("command", "does"), list(help_lines.items()))
    examples = "\n".join(["Say what to do, for example:", *(f"  {e}" for e in _EXAMPLES)])
    chat.tell(f"{examples}\n\n{operations}\n\n{commands}", {"commands": help_lines})


def _plan(chat: Conversation, text: str) -> None:
    if text:
        result = chat.session.preview(text)
        planned = plan_lines(result.plan) if result.plan is not None else []
        lines = [*planned, *result.sentences(), *usage_lines(result.plan), "(not done)"]
        chat.tell("\n".join(lines), result.to_json())
        return
    if chat.dialogue.planned is None:
        raise UserError("nothing was planned yet; /plan TEXT shows what an instruction would do")
    chat.tell("\n".join(plan_lines(chat.dialogue.planned)), chat.dialogue.planned.model_dump(mode="json"))


def _preview(chat: Conversation, text: str) -> None:
    from ..pictures.change_pictures import change_of

    if not text:
        raise UserError("say what to try: /preview remove the floaters")
    result = chat.session.preview(text)
    change = change_of(result, chat.session.viewer)
    lines = [*result.sentences(), f"it would change {change.sentence()}", "(not done)"]
    chat.tell("\n".join(lines), result.to_json() | {"preview": change.to_json()})
    chat.show_image(change.marked)


def _select(chat: Conversation, text: str) -> None:
    if not text:
        raise UserError("say what to select: /select the red chair")
    found = chat.session.select(text)
    if found.chosen:
        things = ", ".join(c.describe() for c in found.candidates) or found.query.describe()
        doubt = f"\nunconfirmed: {found.reason}" if found.verdict == "unconfirmed" else ""
        chat.tell(f"{len(found):,} Gaussians: {things}{doubt}", selection_json(found))
        return
    lines = [found.reason, *(f"  {i}. {c.describe()}" for i, c in enumerate(found.candidates, start=1))]
    chat.tell("\n".join(lines), selection_json(found))


def _why(chat: Conversation, text: str) -> None:
    if not text:
        raise UserError("say what to explain: /why the red chair")
    explained = chat.session.explain(text)
    chat.tell("\n".join(explained.lines()), explained.to_json())


def _metres(text: str) -> float:
    """The distance of /grow and /shrink; `STEP` if the text is empty. Raises UserError if the text is not a distance
    above 0 and up to 100 m."""
    try:
        by = float(text.removesuffix("m").strip() or STEP)
    except ValueError as error:
        raise UserError(f"{text!r} is not a distance; give metres, for example /grow 0.05") from error
    if not 0 < by <= 100:
        raise UserError(f"a selection grows by metres above 0 and up to 100, not by {by:g}")
    return by


def _show(chat: Conversation, view: str) -> None:
    from ..pictures.named_cameras import choose_view

    if view:
        chat.session.viewer, chat.dialogue.home = choose_view(chat.session.scene, view), None
    chat.show_picture()


def _things(chat: Conversation, _: str) -> None:
    from ...gaussians.color import name_of
    from .thing_names import name_of_thing

    language = chat.session.embed().language
    assert language is not None
    rows = [(g.id, f"{name_of(g.lab)} {name_of_thing(g)}", g.count) for g in language.objects() if g.count]
    data = {"things": [{"group": i, "name": name, "gaussians": n} for i, name, n in rows]}
    shown = [(i, name, f"{n:,}") for i, name, n in rows]
    chat.tell(chat.table(("group", "thing", "Gaussians"), shown), data)


def _planner(chat: Conversation, spec: str) -> None:
    if spec:
        chat.session.planner = spec
    budget, spent = chat.session.budget, chat.session.spent
    dollars = f", ${budget.dollars:.4g} a session" if budget.dollars is not None else ""
    lines = [
        f"planner: {chat.session.planner}",
        f"models may take {budget.seconds:g} s an instruction{dollars}",
        f"spent so far: {format_usage(spent).removeprefix('in ')}" if spent else "no model was asked so far",
    ]
    data = {
        "planner": chat.session.planner,
        "budget": {"seconds": budget.seconds, "dollars": budget.dollars},
        "spent": spent.model_dump(mode="json") if spent else None,
    }
    chat.tell("\n".join(lines), data)


def _judge(chat: Conversation, name: str) -> None:
    if name:
        chat.session.judge = "built-in" if name == "on" else name
    judge = chat.session.judge or "off"
    chat.tell(f"judge: {judge}", {"judge": judge})


def _reference(chat: Conversation, arguments: str) -> None:
    words = shlex.split(arguments)
    if words:
        try:
            width = float(words[1]) if len(words) > 1 else None
        except ValueError:
            raise UserError("say /reference FILE, or /reference FILE METRES for how wide the place is") from None
        if len(words) > 2:
            raise UserError("say /reference FILE, or /reference FILE METRES for how wide the place is")
        chat.session.add_reference(chat.file(words[0]), width)
    known = list(chat.session.references)
    told = f"photographs: {', '.join(known)}" if known else "no photograph was given; /reference FILE gives one"
    chat.tell(told, {"references": known})


def _history(chat: Conversation, _: str) -> None:
    done = chat.session.done
    chat.tell("\n".join(f"  {i}. {t}" for i, t in enumerate(done, 1)) or "nothing was done yet", {"done": list(done)})


def _replay(chat: Conversation, which: str) -> None:
    from ..session.log import read_log
    from ..session.log_sessions import logged_session, sessions_of

    log = chat.session.log_path
    if log is None:
        raise UserError("this chat has no log; begin it with --log FILE")
    earlier = sessions_of(read_log(log))[:-1]
    if not earlier:
        raise UserError(f"{log} holds no session before this one")
    chosen = logged_session(log, which) if which else earlier[-1]
    replayed = chat.session.replay(log, session=chosen.number - 1)
    chat.tell(f"replayed {chosen.describe()}", {"verdict": "ok", "session": chosen.to_json()})
    for done in replayed:
        if done.note:
            chat.note(done.note)
        if done.result is not None:
            chat.show_result(done.result)


def _save(chat: Conversation, arguments: str) -> None:
    name, force = _file_of(arguments, "/save")
    chat.tell(chat.save(name, force), {"verdict": "ok", "path": name})


def _export(chat: Conversation, arguments: str) -> None:
    from ...gaussians.assets.exporting import export

    name, force = _file_of(arguments, "/export")
    if chat.session.last is None:
        raise UserError("nothing is selected; say for example /select the red chair")
    export(chat.session.scene, chat.session.last.ids, chat.file(name), force)
    chat.tell(f"wrote {name}: {len(chat.session.last):,} Gaussians", {"verdict": "ok", "path": name})


def _file_of(arguments: str, command: str) -> tuple[str, bool]:
    """The file that a command is to write, and whether it may overwrite it."""
    try:
        words = shlex.split(arguments)
    except ValueError as error:
        raise UserError(f"a quotation mark is open; write for example {command} 'my room.ply'") from error
    names = [w for w in words if w != "--force"]
    if len(names) != 1:
        raise UserError(f"give a file: {command} out.ply (add --force to overwrite)")
    return names[0], "--force" in words


def _time(chat: Conversation, text: str) -> None:
    session = chat.session
    if text:
        try:
            session.time = float(text.removesuffix("s").strip())
        except ValueError as error:
            raise UserError(f"give seconds: /time 2.5, not {text!r}") from error
        chat.show_picture()
    motion = session.scene.motion
    told = "nothing moves in this scene"
    if motion is not None:
        told = f"{session.time:g} s, of {motion.start:g} to {motion.stop:g} s"
    chat.tell(told, {"verdict": "ok", "time": session.time})


def _quit(chat: Conversation, _: str) -> None:
    chat.end()


SLASH_COMMANDS: dict[str, SlashCommand] = {
    "/help": SlashCommand("list the operations and the commands", _help),
    "/undo": SlashCommand("undo the last instruction", lambda chat, _: chat.show_result(chat.session.undo())),
    "/redo": SlashCommand("redo what was undone last", lambda chat, _: chat.show_result(chat.session.redo())),
    "/plan": SlashCommand("TEXT: what an instruction would do, without doing it; alone: the last plan", _plan),
    "/preview": SlashCommand("TEXT: how much an instruction would change, with a picture, without doing it", _preview),
    "/select": SlashCommand("TEXT: select the things that a phrase describes; 'it' then refers to them", _select),
    "/why": SlashCommand("TEXT: explain what a phrase selects, with the score of each term", _why),
    "/grow": SlashCommand(
        "[METRES]: add the Gaussians around the selection (default 0.05 m)",
        lambda chat, text: chat.show_result(chat.session.adjust(grow=_metres(text))),
    ),
    "/shrink": SlashCommand(
        "[METRES]: remove the Gaussians at the border of the selection",
        lambda chat, text: chat.show_result(chat.session.adjust(grow=-_metres(text))),
    ),
    "/invert": SlashCommand(
        "select everything that is not selected", lambda chat, _: chat.show_result(chat.session.adjust(invert=True))
    ),
    "/show": SlashCommand("a picture of the current view; /show 2 changes to the scene's camera 2", _show),
    "/time": SlashCommand("[SECONDS]: at which time of a scene with motion words are meant; alone: at which", _time),
    "/things": SlashCommand("list the things in the scene", _things),
    "/planner": SlashCommand("[NAME]: the planner and what its models cost; with a name, change the planner", _planner),
    "/judge": SlashCommand("[NAME|on|off]: judge each edit after it was made; alone: who judges", _judge),
    "/reference": SlashCommand(
        "[FILE [METRES]]: a photograph that instructions may name ('like in the photo'), and how wide the place is",
        _reference,
    ),
    "/history": SlashCommand("list the instructions that led to this scene", _history),
    "/replay": SlashCommand("[ID]: repeat the edits of an earlier session in the log; alone: the last one", _replay),
    "/save": SlashCommand("FILE [--force]: write the scene", _save),
    "/export": SlashCommand("FILE [--force]: write the selection: Gaussians, or a coloured mesh (.glb)", _export),
    "/quit": SlashCommand("end the chat", _quit),
}
