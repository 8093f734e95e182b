"""Language models in a session: the edit, what the receipt, the log and the chat tell of them, and what stops them."""

from __future__ import annotations

import io
import json
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from prompt_toolkit.input import create_pipe_input
from prompt_toolkit.output import DummyOutput

from scenewright.agent.session.log import read_log
from scenewright.agent.session.session import Session
from scenewright.agent.terminal.chat import Chat
from scenewright.agent.terminal.output import Terminal
from scenewright.gaussians.errors import AmbiguousError, BackendError, UserError
from scenewright.gaussians.scene import Scene
from scenewright.planners import model as models
from scenewright.planners.plan import EditPlan, NoPlanError, Usage
from scenewright.tools.registry import parse

HARD = "frobnicate the green thing"
KEY = "sk-live-0123456789abcdefghijkl"
SPEC = "openai:fake@http://localhost:9/v1"


class Fake:
    """A planner that looks at the scene and paints what is green in it blue, by its group."""

    name = SPEC

    def __init__(self, *, pictures: bool = False, progress: Any = None, seconds: float = 60.0) -> None:
        self.pictures, self.progress, self.seconds = pictures, progress, seconds
        self.error: BaseException | None = None
        self.op: dict[str, Any] = {"op": "recolor", "color": "blue"}
        self.asked: list[str] = []
        self.saw: Any = None

    def plan(self, text: str, *, previous: str | None = None, observation: Any = None) -> EditPlan:
        self.asked.append(text)
        if self.error is not None:
            raise self.error
        graph = observation.graph()
        self.saw = observation.picture() if self.pictures else None
        self.progress("planning", 0.0)
        usage = Usage(model=SPEC, requests=2, input_tokens=1800, output_tokens=30, dollars=0.004, seconds=1.2)
        op = dict(self.op)
        if op["op"] != "insert":
            op["target"] = {"groups": [n.id for n in graph.nodes if "green" in n.color]}
        return EditPlan(
            instruction=text, planner=self.name, ops=(parse(op),), prompt_hash="abc123", usage=usage,
            reason="frobnicate read as paint", seconds=1.3,
        )  # fmt: skip


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> list[Fake]:
    """The planners that were made in place of models, newest last."""
    made: list[Fake] = []

    def load_planner(spec: str, **settings: Any) -> Fake:
        made.append(Fake(**settings))
        return made[-1]

    monkeypatch.setattr(models, "load_planner", load_planner)
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    return made


def test_an_instruction_beyond_the_grammar_is_done_and_accounted_for(
    boxes: Scene, encoder: Any, fake: list[Fake], tmp_path: Path
) -> None:
    session = Session(boxes, f"auto:{SPEC}", encoder, log=tmp_path / "log.jsonl", viewer=boxes.cameras[0])
    result = session.do(f"{HARD} {KEY}")
    changed = (result.scene.cloud.sh != boxes.cloud.sh).any(dim=(1, 2))
    assert bool((result.scene.cloud.group[changed] == 1).all()) and bool(changed.any())
    told = result.to_json()
    assert told["plan"]["planner"] == SPEC and told["plan"]["prompt_hash"] == "abc123"
    assert told["plan"]["usage"]["output_tokens"] == 30 and told["plan"]["usage"]["dollars"] == 0.004
    assert told["receipts"][0]["backends"]["planner"] == SPEC
    assert result.sentences()[0] == "note: frobnicate read as paint"
    assert session.spent is not None and session.spent.requests == 2
    session.do("delete the blue thing")
    assert len(fake[0].asked) == 1 and session.spent.requests == 2 and session.planned is not None
    session.close()
    deeds = [r for r in read_log(tmp_path / "log.jsonl").records if r["kind"] == "do"]
    assert [(r["plan"]["planner"], r["plan"]["usage"] is None) for r in deeds] == [(SPEC, False), ("grammar", True)]
    assert deeds[0]["plan"]["usage"]["input_tokens"] == 1800
    assert KEY not in (tmp_path / "log.jsonl").read_text()


def test_a_plan_of_a_model_replays(boxes: Scene, encoder: Any, fake: list[Fake], tmp_path: Path) -> None:
    session = Session(boxes, SPEC, encoder, log=tmp_path / "log.jsonl")
    session.do(HARD)
    session.close()
    again = Session(boxes, "grammar", encoder)
    again.replay(tmp_path / "log.jsonl")
    assert again.scene.cloud.digest() == session.scene.cloud.digest() and len(fake[0].asked) == 1


def test_a_model_alone_raises_and_one_behind_the_grammar_leaves_its_answer(
    boxes: Scene, encoder: Any, fake: list[Fake], tmp_path: Path
) -> None:
    alone = Session(boxes, SPEC, encoder, log=tmp_path / "log.jsonl")
    fake[0].error = BackendError("the server is down")
    with pytest.raises(BackendError, match="down"):
        alone.do("delete the green thing")
    alone.close()
    assert [r["kind"] for r in read_log(tmp_path / "log.jsonl").records] == ["open", "failed"]
    both = Session(boxes, f"auto:{SPEC}", encoder)
    both.do(HARD)
    fake[1].error = BackendError("the server is down")
    with pytest.raises(UserError, match=r"frobnicate.*the model gave no plan: the server is down"):
        both.do(HARD)
    assert len(both.done) == 1
    assert alone.scene is boxes


def test_a_used_up_budget_is_said(boxes: Scene, encoder: Any, fake: list[Fake]) -> None:
    session = Session(boxes, f"auto:{SPEC}", encoder, budget="9s,0.004usd")
    session.do(HARD)
    assert fake[0].seconds == 9
    with pytest.raises(UserError, match=r"the model was not asked: .* \$0.004 is used up"):
        session.do(HARD)
    session.planner = SPEC  # the account is the session's, whoever plans
    with pytest.raises(BackendError, match="used up"):
        session.do(HARD)
    with pytest.raises(UserError, match="not a budget"):
        Session(boxes, budget="much")


def test_an_unknown_planner_leaves_the_old_one(boxes: Scene, encoder: Any, fake: list[Fake]) -> None:
    session = Session(boxes, "grammar", encoder)
    with pytest.raises(UserError, match="planners are"):
        session.planner = "oracle"
    assert session.planner == "grammar"
    session.planner = f"auto:{SPEC}"
    assert session.planner == f"auto:{SPEC}" and fake == []


def test_a_planner_may_be_given_itself(boxes: Scene, encoder: Any) -> None:
    session = Session(boxes, Fake(progress=lambda stage, share: None), encoder)
    assert session.do(HARD).plan.planner == SPEC  # type: ignore[union-attr]


# -- what models see ---------------------------------------------------------------------------------------------------


def test_a_session_shows_its_present_scene_from_its_viewer(boxes: Scene, encoder: Any) -> None:
    session = Session(boxes, "grammar", encoder, viewer=boxes.cameras[0])
    graph = session.graph()
    assert {n.id: n.color for n in graph.nodes} == {0: "red", 1: "green", 2: "red"}
    assert graph.viewer is not None and graph.viewer.position == pytest.approx((0, -8, 2.5))
    toward = np.subtract(graph.viewer.target, graph.viewer.position)
    assert toward == pytest.approx(np.array([0, 8, -2.1]) / np.hypot(8, 2.1))
    session.do("delete the green thing")
    assert {n.id for n in session.graph().nodes} == {0, 2}
    picture = Image.open(io.BytesIO(session.picture()))
    assert picture.format == "PNG" and picture.size == (96, 64)


def test_a_large_view_is_drawn_smaller_for_a_model(boxes: Scene, encoder: Any) -> None:
    from scenewright.agent.session.observation import WIDTH
    from scenewright.gaussians.viewpoints.coverage import fit_camera

    session = Session(boxes, "grammar", encoder, viewer=fit_camera(boxes.cameras[0], 1536, 1024))
    assert Image.open(io.BytesIO(session.picture())).size == (WIDTH, 512)


def test_a_scene_is_embedded_only_when_a_planner_looks(
    boxes: Scene, encoder: Any, fake: list[Fake], monkeypatch: pytest.MonkeyPatch
) -> None:
    from scenewright.gaussians.language.field import embed as module

    begun: list[Scene] = []

    def embed(scene: Scene, encoder: Any, progress: Any = None) -> Scene:
        begun.append(scene)
        return boxes

    monkeypatch.setattr(module, "embed", embed)
    session = Session(boxes.replace(language=None), f"auto:{SPEC}", encoder, viewer=boxes.cameras[0])
    assert session.plan("delete the green thing").ok and begun == []
    assert session.plan(HARD).ok and len(begun) == 1
    session.plan(HARD)
    assert len(begun) == 1 and session.done == ()


@pytest.mark.parametrize("pictures", [True, False])
def test_pictures_are_shown_where_asked_for(boxes: Scene, encoder: Any, fake: list[Fake], pictures: bool) -> None:
    session = Session(boxes, SPEC, encoder, viewer=boxes.cameras[0], pictures=pictures)
    session.plan(HARD)
    assert (fake[0].saw is not None) == pictures


def test_a_written_graph_is_seen_with_rows_for_ids() -> None:
    from scenewright.agent.session.observation import GraphObservation
    from scenewright.agent.session.plan_report import graph_plan
    from scenewright.planners.rooms.graph import SceneGraph
    from scenewright.planners.rooms.graph_scene import Stage

    written = SceneGraph.model_validate(
        {
            "room": {"size": [4, 4, 3]},
            "nodes": [
                {"id": "table", "label": "table", "size": [1, 1, 0.7], "position": [0, 0, 0.35]},
                {"id": 40, "label": "mug", "color": "green", "size": [0.1, 0.1, 0.1], "position": [0, 0, 0.75],
                 "support": "table"},
            ],
            "relations": [[40, "on", "table"]],
        }
    )  # fmt: skip
    stage = Stage.of(written)
    seen = GraphObservation(stage).graph()
    assert [(n.id, n.support) for n in seen.nodes] == [(0, "floor"), (1, 0)] and seen.relations == ((1, "on", 0),)
    assert SceneGraph.model_validate(seen.model_dump()) == seen and GraphObservation(stage).picture() is None
    told = graph_plan(stage, Fake(progress=lambda stage, share: None), HARD)
    assert told["verdict"] == "ok" and told["steps"][0]["targets"] == [40]
    assert told["planner"] == SPEC and told["prompt_hash"] == "abc123" and told["usage"]["requests"] == 2
    assert told["reason"] == "frobnicate read as paint"


# -- the conversation --------------------------------------------------------------------------------------------------


def _talk(session: Session, *lines: str) -> str:
    terminal = Terminal(io.StringIO(), io.StringIO())
    with create_pipe_input() as pipe:
        pipe.send_text("".join(f"{line}\r" for line in (*lines, "/quit", "no")))
        Chat(session, terminal, pipe, DummyOutput()).run()
    assert isinstance(terminal.out, io.StringIO) and isinstance(terminal.err, io.StringIO)
    assert terminal.err.getvalue().count("asking") == 0  # no progress where nobody watches
    return terminal.out.getvalue()


def test_the_chat_tells_who_planned_and_what_it_took(boxes: Scene, encoder: Any, fake: list[Fake]) -> None:
    session = Session(boxes, f"auto:{SPEC}", encoder, viewer=boxes.cameras[0])
    out = _talk(session, HARD, "delete the blue thing", "/planner", "/planner grammar", HARD, "/planner oracle")
    assert out.count(f"planned by {SPEC} in 1.2 s, 2 requests, 1,830 tokens, $0.0040") == 1
    assert "note: frobnicate read as paint" in out
    assert f"planner: auto:{SPEC}" in out and "spent so far: 1.2 s, 2 requests, 1,830 tokens" in out
    assert "planner: grammar" in out and "unknown planner 'oracle'" in out
    assert len(fake[0].asked) == 1 and len(session.done) == 2


def test_what_a_refused_plan_took_is_told_once(boxes: Scene, encoder: Any, fake: list[Fake]) -> None:
    session = Session(boxes, SPEC, encoder, viewer=boxes.cameras[0])
    fake[0].op = {"op": "move", "place": {"relation": "on", "anchors": [{"colors": ["purple"]}]}}
    out = _talk(session, HARD, "/undo")
    assert session.scene is boxes and "nothing to undo" in out and out.count("planned by") == 1


def test_ctrl_c_while_a_model_plans_leaves_everything(boxes: Scene, encoder: Any, fake: list[Fake]) -> None:
    session = Session(boxes, f"auto:{SPEC}", encoder, viewer=boxes.cameras[0])
    session.do("make the green thing blue")
    before, last = session.scene, session.last
    session.plan("frobnicate the blue thing")
    fake[0].error = KeyboardInterrupt()
    out = _talk(session, "frobnicate the blue thing", "/history")
    assert "cancelled; nothing was changed" in out and "  1. make the green thing blue" in out
    assert session.scene is before and session.last is last and session.done == ("make the green thing blue",)


def test_an_interrupt_that_python_lost_is_passed_on(
    boxes: Scene, encoder: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    import signal

    terminal = Terminal(io.StringIO(), io.StringIO())

    class Busy(Fake):
        def plan(self, text: str, *, previous: str | None = None, observation: Any = None) -> EditPlan:
            with suppress(KeyboardInterrupt):  # as a weak reference's callback does
                signal.raise_signal(signal.SIGINT)
            return super().plan(text, previous=previous, observation=observation)

    handler = signal.getsignal(signal.SIGINT)
    session = Session(boxes, Busy(progress=terminal.progress), encoder, viewer=boxes.cameras[0])
    chat = Chat(session, terminal)
    chat.say(HARD)
    assert session.scene is boxes and "cancelled" in terminal.out.getvalue()  # type: ignore[attr-defined]
    assert signal.getsignal(signal.SIGINT) is handler
    session.planner = "grammar"
    chat.say("delete the green thing")
    assert session.done == ("delete the green thing",)


def test_an_answer_to_a_question_asks_no_model_and_another_instruction_asks_it_once(
    boxes: Scene, encoder: Any, fake: list[Fake]
) -> None:
    session = Session(boxes, f"auto:{SPEC}", encoder, viewer=boxes.cameras[0])
    with pytest.raises(AmbiguousError):
        session.do("delete the red thing")
    with pytest.raises(UserError):
        session.answer("the flurbly one")
    assert fake == []
    _talk(session, HARD)
    assert fake[0].asked == [HARD] and session.done == (HARD,)


# -- the command line --------------------------------------------------------------------------------------------------


class Screen(io.StringIO):
    """A stream that somebody watches."""

    def isatty(self) -> bool:
        return True


def test_progress_is_drawn_on_a_terminal_and_removed(boxes: Scene, encoder: Any, fake: list[Fake]) -> None:
    screen = Screen()
    terminal = Terminal(io.StringIO(), screen)
    Session(boxes, SPEC, encoder, progress=terminal.progress).plan(HARD)
    assert f"asking {SPEC}" in screen.getvalue() and screen.getvalue().endswith("\r\x1b[K")


@pytest.fixture
def command(call: Any) -> Any:
    """Runs the command line and sees that the key is never printed."""

    def run(*arguments: object) -> Any:
        answer = call(*arguments)
        assert KEY not in answer.out + answer.err
        return answer

    return run


@pytest.mark.slow
def test_edit_and_plan_tell_of_the_model(room: Path, fake: list[Fake], command: Any, tmp_path: Path) -> None:
    spec = ("--planner", f"auto:{SPEC}", "--budget", "9s,1usd", "--picture")
    code, out, err = command("edit", room, HARD, "-o", tmp_path / "out.ply", *spec)
    assert code == 0 and out.startswith("note: frobnicate read as paint\n")
    assert f"planned by {SPEC} in 1.2 s, 2 requests, 1,830 tokens, $0.0040" in err and "planned by" not in out
    assert fake[0].pictures and fake[0].seconds == 9
    code, out, err = command("edit", room, HARD, "--dry-run", "--json", *spec)
    assert code == 0 and json.loads(out)["plan"]["usage"]["dollars"] == 0.004 and "planned by" not in err
    code, out, err = command("plan", room, HARD, "--json", *spec)
    told = json.loads(out)
    assert code == 0 and told["planner"] == SPEC and told["usage"]["input_tokens"] == 1800
    assert told["reason"] == "frobnicate read as paint" and told["steps"][0]["targets"] == [1]
    code, out, err = command("plan", room, "delete the green thing", "--json", *spec)
    assert json.loads(out)["usage"] is None and json.loads(out)["planner"] == "grammar"


def test_a_refused_edit_tells_of_the_model_too(
    room: Path, fake: list[Fake], command: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Fake, "plan", lambda self, text, previous=None, observation=None: EditPlan(
        instruction=text, planner=SPEC, verdict="absent", reason="there is no widget",
        usage=Usage(model=SPEC, requests=1, seconds=2.0),
    ))  # fmt: skip
    code, out, err = command("edit", room, HARD, "--dry-run", "--json", "--planner", f"auto:{SPEC}")
    told = json.loads(out)
    assert (code, told["verdict"], told["usage"]["seconds"]) == (3, "absent", 2.0)
    assert f"planned by {SPEC} in 2.0 s\n" in err and "there is no widget" in err


@pytest.mark.parametrize(("verdict", "code"), [("not_understood", 2), ("not_an_edit", 2), ("impossible", 3)])
def test_whatever_is_refused_has_its_cost_in_the_answer(
    room: Path, boxes: Scene, encoder: Any, fake: list[Fake], command: Any,
    monkeypatch: pytest.MonkeyPatch, verdict: str, code: int,
) -> None:  # fmt: skip
    monkeypatch.setattr(Fake, "plan", lambda self, text, previous=None, observation=None: EditPlan(
        instruction=text, planner=SPEC, verdict=verdict, reason="as said", usage=Usage(model=SPEC, requests=3),
    ))  # fmt: skip
    left, out, err = command("edit", room, HARD, "--dry-run", "--json", "--planner", f"auto:{SPEC}")
    told = json.loads(out)
    assert left == told["exit_code"] == code and told["verdict"] == verdict and told["usage"]["requests"] == 3
    assert "as said" in told["reason"] and "as said" in err
    terminal = Terminal(io.StringIO(), io.StringIO())
    terminal.as_json = True
    Chat(Session(boxes, f"auto:{SPEC}", encoder, viewer=boxes.cameras[0]), terminal).say(HARD)
    said = json.loads(terminal.out.getvalue())  # type: ignore[attr-defined]
    assert (said["verdict"], said["usage"]["requests"], said["planner"]) == (verdict, 3, SPEC)


@pytest.mark.parametrize("verb", ["edit", "plan"])
def test_a_model_that_is_lost_has_cost_what_it_answered_before(
    room: Path, command: Any, verb: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def load_planner(spec: str, **_: Any) -> Fake:
        planner = Fake()
        planner.error = NoPlanError("the server is gone", Usage(model=SPEC, requests=2))
        return planner

    monkeypatch.setattr(models, "load_planner", load_planner)
    words = [HARD, "--dry-run"] if verb == "edit" else [HARD]
    code, out, _ = command(verb, room, *words, "--json", "--planner", SPEC)
    assert code == json.loads(out)["exit_code"] == 4 and json.loads(out)["usage"]["requests"] == 2


@pytest.mark.parametrize("verb", ["edit", "plan", "chat"])
def test_a_budget_that_is_none_is_refused(room: Path, command: Any, verb: str, fake: list[Fake]) -> None:
    words = {"edit": ["delete the green thing", "--dry-run"], "plan": ["delete the green thing"], "chat": []}[verb]
    code, _, err = command(verb, room, *words, "--budget", "a lot")
    assert code == 2 and "is not a budget" in err
