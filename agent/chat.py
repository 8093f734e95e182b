"""The conversation: a line in, an edit and a picture out.

Knows commands that begin with a slash, how to ask back, and what to show. Refuses to know how an instruction is carried
out: that is the session's. Works on a terminal with history and completion, and on a pipe line by line.
"""

from __future__ import annotations

import os
import shlex
import shutil
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..gaussians.errors import AbsentError, InstructionError, ScenewrightError, UserError
from .asked import asked, took
from .halfblocks import depth_of, draw
from .refusal import verdict_of
from .resolved import candidate_json, plan_lines, planner_json, selection_json
from .tables import coloured, table

if TYPE_CHECKING:
    from prompt_toolkit import PromptSession
    from prompt_toolkit.input import Input
    from prompt_toolkit.output import Output as ScreenOutput

    from ..planners.plan import EditPlan
    from .result import Result
    from .session import Session
    from .terminal import Terminal

COMMANDS = {
    "/help": "what can be said",
    "/undo": "take the last instruction back",
    "/redo": "do again what was taken back",
    "/plan": "TEXT: what an instruction would do, without doing it; alone: the last plan",
    "/select": "TEXT: what a phrase means; 'it' then means that",
    "/why": "TEXT: why a phrase means what it means, term by term",
    "/grow": "[METRES]: take in what lies around the selection (0.05 m if not said)",
    "/shrink": "[METRES]: draw the selection back from what lies around it",
    "/invert": "select everything but what is selected",
    "/show": "a picture of the current view; /show 2 looks through the scene's camera 2",
    "/things": "what is in the scene",
    "/planner": "[NAME]: who reads what is said, and what that cost; with a name, another one from now on",
    "/history": "the instructions that led here",
    "/save": "FILE [--force]: write the scene",
    "/quit": "end the conversation",
}
ENDS = ("/quit", "/exit", "quit", "exit")  # with and without the stroke: nothing else can be meant
STEP = 0.05  # metres by which a selection grows or shrinks if nothing is said
_EXAMPLES = (
    "make the armchair teal and remove the coffee table",
    "move the plant 50 cm to the left",
    "put a red ball on the table",
)


class Chat:
    """One conversation.

    Args:
        session: what is talked about.
        terminal: where answers go.
        input, output: prompt_toolkit's, for tests; by default the process's terminal, or its pipe.
    """

    def __init__(
        self,
        session: Session,
        terminal: Terminal,
        input: Input | None = None,
        output: ScreenOutput | None = None,
    ) -> None:
        self.session = session
        self.terminal = terminal
        self._pipe_input, self._screen = input, output
        self._planned: EditPlan | None = None
        self._before: EditPlan | None = None
        self._saved = True

    # -- the loop ---------------------------------------------------------------------------------------------------

    def run(self) -> None:
        """Read lines until one of `ENDS` or the end of input. Ctrl-C ends the instruction, not the conversation."""
        if self._interactive():
            self._greet()
        for line in self._lines():
            if line.strip().lower() in ENDS:
                break
            if line.strip():
                self.say(line.strip())
        if not self._saved:
            self.terminal.say("the edited scene was not saved")

    def say(self, line: str) -> None:
        """One line: a command, an answer to an open question, or an instruction. Errors become one sentence."""
        self._before = self.session.planned
        try:
            with self.terminal.interruptible():
                self._command(line) if line.startswith("/") else self._instruction(line)
        except KeyboardInterrupt:
            self._tell("cancelled; nothing was changed", {"verdict": "cancelled"})
        except InstructionError as error:
            self._ask_back(error)
        except ScenewrightError as error:
            if self.terminal.debug:
                raise
            said = "\n".join([str(error), *self._asked_in_vain()])
            self._tell(said, {"verdict": verdict_of(error), "reason": str(error)}, "red")
        except Exception as error:  # a mistake of ours must not cost the user what was not saved yet
            if self.terminal.debug:
                raise
            reason = f"internal error ({type(error).__name__}: {error}); the scene is as it was. Please report it"
            self._tell(reason, {"verdict": "internal", "reason": reason}, "red")

    def _instruction(self, text: str) -> None:
        if self.session.question is not None and self.session.question.selection.verdict == "ambiguous":
            try:
                result = self.session.answer(text)
            except UserError:
                plan = self.session.plan(text)
                if not plan.ops:
                    raise  # neither an answer nor an instruction: the question stands
                result = self.session.apply(plan, planned_in=plan.seconds)  # which drops the question
        else:
            result = self.session.do(text)
        self._show_result(result)

    def _show_result(self, result: Result) -> None:
        self._planned, self._saved = result.plan or self._planned, False
        lines = list(result.sentences()) or [result.text]
        lines += asked(result.plan)
        if sum(result.seconds.values()) > 0:
            lines.append(f"({sum(result.seconds.values()):.2f} s)")
        self._tell("\n".join(lines), result.to_json(), "green")
        if self._interactive():
            self._picture()

    def _asked_in_vain(self) -> tuple[str, ...]:
        """What asking a model took where nothing came of it."""
        return asked(self.session.planned) if self.session.planned is not self._before else ()

    def _ask_back(self, error: InstructionError) -> None:
        question = self.session.question
        candidates = question.candidates if question else ()
        lines = [str(error)]
        if isinstance(error, AbsentError) and candidates:
            lines.append("The nearest things that are there:")
        lines += [f"  {i}. {c.describe()}" for i, c in enumerate(candidates, start=1)]
        if question is not None and question.selection.verdict == "ambiguous":
            lines.append("Which one? A number, 'all', or for example 'the left one'.")
        data = {
            "verdict": verdict_of(error),
            "reason": str(error),
            "candidates": [candidate_json(c) for c in candidates],
            **planner_json(question.plan if question else None),
        }
        self._tell("\n".join([*lines, *self._asked_in_vain()]), data, "yellow")

    # -- commands ---------------------------------------------------------------------------------------------------

    def _command(self, line: str) -> None:
        name, _, rest = line.partition(" ")
        handlers: dict[str, Callable[[str], None]] = {
            "/help": self._help,
            "/undo": lambda _: self._show_result(self.session.undo()),
            "/redo": lambda _: self._show_result(self.session.redo()),
            "/plan": self._plan,
            "/select": self._select,
            "/why": self._why,
            "/grow": lambda rest: self._adjust(rest, 1),
            "/shrink": lambda rest: self._adjust(rest, -1),
            "/invert": lambda _: self._show_result(self.session.adjust(invert=True)),
            "/show": self._show,
            "/things": self._things,
            "/planner": self._planner,
            "/history": self._history,
            "/save": self._save,
        }
        if name not in handlers:
            raise UserError(f"there is no command {name}; /help lists them")
        handlers[name](rest.strip())

    def _help(self, _: str) -> None:
        from ..tools.registry import describe

        operations = table(("operation", "for example"), [(name, words) for name, _, words, _ in describe()])
        commands = table(("command", "does"), list(COMMANDS.items()))
        said = "\n".join(["Say what to do, for example:", *(f"  {e}" for e in _EXAMPLES)])
        self._tell(f"{said}\n\n{operations}\n\n{commands}", {"commands": COMMANDS})

    def _plan(self, text: str) -> None:
        if text:
            result = self.session.preview(text)
            planned = plan_lines(result.plan) if result.plan is not None else []
            lines = [*planned, *result.sentences(), *asked(result.plan), "(not done)"]
            self._tell("\n".join(lines), result.to_json())
            return
        if self._planned is None:
            raise UserError("nothing was planned yet; /plan TEXT shows what an instruction would do")
        self._tell("\n".join(plan_lines(self._planned)), self._planned.model_dump(mode="json"))

    def _select(self, text: str) -> None:
        if not text:
            raise UserError("say what to select: /select the red chair")
        found = self.session.select(text)
        if found.verdict == "found":
            things = ", ".join(c.describe() for c in found.candidates) or found.query.describe()
            self._tell(f"{len(found):,} Gaussians: {things}", selection_json(found))
            return
        lines = [found.reason, *(f"  {i}. {c.describe()}" for i, c in enumerate(found.candidates, start=1))]
        self._tell("\n".join(lines), selection_json(found))

    def _why(self, text: str) -> None:
        if not text:
            raise UserError("say what to explain: /why the red chair")
        explained = self.session.explain(text)
        self._tell("\n".join(explained.lines()), explained.to_json())

    def _adjust(self, text: str, sign: int) -> None:
        """Grow (`sign` 1) or shrink (-1) the selection by the metres in `text`."""
        try:
            by = float(text.removesuffix("m").strip() or STEP)
        except ValueError as error:
            raise UserError(f"{text!r} is no distance; say metres, for example /grow 0.05") from error
        if not 0 < by <= 100:
            raise UserError(f"a selection grows by metres above 0 and up to 100, not by {by:g}")
        self._show_result(self.session.adjust(grow=sign * by))

    def _show(self, view: str) -> None:
        from .views import choose_view

        if view:
            self.session.viewer = choose_view(self.session.scene, view)
        self._picture()

    def _things(self, _: str) -> None:
        from ..gaussians.color import name_of
        from .things import name_of_thing

        language = self.session.embed().language
        assert language is not None
        rows = [(g.id, f"{name_of(g.lab)} {name_of_thing(g)}", g.count) for g in language.objects() if g.count]
        data = {"things": [{"group": i, "name": name, "gaussians": n} for i, name, n in rows]}
        shown = [(i, name, f"{n:,}") for i, name, n in rows]
        self._tell(table(("group", "thing", "Gaussians"), shown), data)

    def _planner(self, spec: str) -> None:
        if spec:
            self.session.planner = spec
        budget, spent = self.session.budget, self.session.spent
        dollars = f", ${budget.dollars:.4g} a session" if budget.dollars is not None else ""
        lines = [
            f"planner: {self.session.planner}",
            f"models may take {budget.seconds:g} s an instruction{dollars}",
            f"spent so far: {took(spent).removeprefix('in ')}" if spent else "no model was asked so far",
        ]
        data = {"planner": self.session.planner, "budget": {"seconds": budget.seconds, "dollars": budget.dollars},
                "spent": spent.model_dump(mode="json") if spent else None}  # fmt: skip
        self._tell("\n".join(lines), data)

    def _history(self, _: str) -> None:
        done = self.session.done
        self._tell(
            "\n".join(f"  {i}. {t}" for i, t in enumerate(done, 1)) or "nothing was done yet", {"done": list(done)}
        )

    def _save(self, arguments: str) -> None:
        try:
            words = shlex.split(arguments)
        except ValueError as error:
            raise UserError("a quotation mark is open; write for example /save 'my room.ply'") from error
        names = [w for w in words if w != "--force"]
        if len(names) != 1:
            raise UserError("say where to: /save out.ply (add --force to overwrite)")
        self.session.save(names[0], force="--force" in words)
        self._saved = True
        self._tell(f"wrote {names[0]}", {"verdict": "ok", "path": names[0]})

    # -- what the user sees -----------------------------------------------------------------------------------------

    def _tell(self, text: str, data: dict[str, Any], style: str = "default") -> None:
        """An answer, its first line in a colour that says how it went."""
        self.terminal.result(coloured(text, style, self.terminal.out), data)

    def _picture(self) -> None:
        """The current view, as large as the terminal allows and the eye needs."""
        from ..gaussians.language.views import fit_camera
        from ..gaussians.render import render

        size = shutil.get_terminal_size((80, 24))
        columns, rows = min(size.columns, 100), min(size.lines - 4, 40)
        camera = fit_camera(self.session.viewer, 4 * columns, 4 * round(columns * 2 / 3))
        image = render(self.session.scene.cloud, camera).to_uint8()
        self.terminal.picture(draw(image, columns, max(rows, 8), depth_of(self.terminal.out)))

    def _greet(self) -> None:
        path, count = self.session.scene.path, len(self.session.scene.cloud)
        self.terminal.say(
            f"{path.name if path else 'scene'}: {count:,} Gaussians. Say what to change; /help lists more."
        )
        self._picture()

    # -- reading lines ----------------------------------------------------------------------------------------------

    def _interactive(self) -> bool:
        if self.terminal.as_json:
            return False
        return self._pipe_input is not None or (sys.stdin.isatty() and sys.stdout.isatty())

    def _lines(self) -> Iterator[str]:
        if not self._interactive():
            for line in sys.stdin:
                yield line.rstrip("\n")
            return
        prompt = self._prompt()
        while True:
            try:
                yield prompt.prompt("› ")
            except KeyboardInterrupt:
                continue
            except EOFError:
                return

    def _prompt(self) -> PromptSession[str]:
        from prompt_toolkit import PromptSession
        from prompt_toolkit.auto_suggest import AutoSuggestFromHistory
        from prompt_toolkit.history import FileHistory, History, InMemoryHistory

        from .completion import ChatCompleter

        history: History = InMemoryHistory()
        if self._pipe_input is None and (file := history_file()) is not None:
            history = FileHistory(str(file))
        return PromptSession(
            history=history,
            auto_suggest=AutoSuggestFromHistory(),
            completer=ChatCompleter(tuple(COMMANDS), self._words),
            complete_while_typing=False,
            input=self._pipe_input,
            output=self._screen,
        )

    def _words(self) -> Iterable[str]:
        """What may be completed in an instruction: operations, and the names of things in the scene."""
        from ..tools.registry import OPS

        language = self.session.scene.language
        labels = {g.label for g in language.groups if g.label and g.count} if language else set()
        return sorted({*OPS, *labels})


def history_file() -> Path | None:
    """Where typed lines are kept between conversations; None if that folder cannot be made."""
    root = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state") / "scenewright"
    try:
        root.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None
    return root / "chat_history" if os.access(root, os.W_OK) else None
