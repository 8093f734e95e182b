"""Edits of what was chosen without a confirmed name: nothing changes until somebody says yes, whoever asks."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import pytest
from prompt_toolkit.input import create_pipe_input
from prompt_toolkit.output import DummyOutput

from scenewright.agent.session.log import read_log
from scenewright.agent.session.session import Session
from scenewright.agent.terminal.chat import Chat
from scenewright.agent.terminal.output import Terminal
from scenewright.agent.toolbox.toolbox import Toolbox
from scenewright.gaussians.errors import AbsentError, AmbiguousError, UnconfirmedError, UserError
from scenewright.gaussians.language.query.query import Query, Relation
from scenewright.gaussians.scene import Scene
from scenewright.planners.plan import EditPlan
from scenewright.tools.ops.delete import Delete

ORDER = "make the green gizmo blue"


@pytest.fixture
def session(unsure: Scene, gizmo_encoder: Any) -> Session:
    return Session(unsure, encoder=gizmo_encoder, viewer=unsure.cameras[0])


def test_a_thing_chosen_by_colour_is_unconfirmed_and_the_reason_tells_which(session: Session) -> None:
    found = session.select("the green gizmo")
    assert found.verdict == "unconfirmed" and found.chosen and found.groups == (1,) and len(found) == 343
    assert all(word in found.reason for word in ("gizmo", "green", "0.6 x 0.6 x 0.6 m", "in the middle of the view"))
    with pytest.raises(UnconfirmedError, match="gizmo"):
        found.require()
    assert session.select("the green thing").verdict == "found"


def test_an_edit_waits_for_a_yes(session: Session, unsure: Scene) -> None:
    with pytest.raises(UnconfirmedError):
        session.do(ORDER)
    assert session.scene is unsure and session.question is not None
    assert session.question.selection.verdict == "unconfirmed"
    result = session.answer("yes")
    changed = (result.scene.cloud.sh != unsure.cloud.sh).any(dim=(1, 2))
    assert set(result.scene.cloud.group[changed].tolist()) == {1}
    assert result.receipts[0].selection.verdict == "found" and "confirmed" in result.receipts[0].selection.reason


def test_a_no_offers_other_things_once_and_other_words_leave_it_open(session: Session, unsure: Scene) -> None:
    with pytest.raises(UnconfirmedError):
        session.do(ORDER)
    with pytest.raises(UserError, match="'yes'"):
        session.answer("flurble")
    assert session.question is not None
    with pytest.raises(AbsentError, match=r"nothing was changed.*its number"):
        session.answer("no")
    assert session.scene is unsure and session.question is not None and session.question.offered
    first = session.question.candidates[0].group
    result = session.answer("1")
    assert result.selection is not None and result.selection.groups == (first,)


def test_every_doubtful_thing_of_an_instruction_is_asked_about(session: Session, unsure: Scene) -> None:
    with pytest.raises(UnconfirmedError, match="in the middle"):
        session.do("put a ball on the green gizmo")
    with pytest.raises(UnconfirmedError, match="in the middle"):
        session.do(f"{ORDER}, then delete the green gizmo")
    with pytest.raises(AbsentError, match="step 2"):  # the first step, which is confirmed, leaves no green thing
        session.answer("yes")
    assert session.scene is unsure


def test_what_it_means_stays_in_doubt(session: Session, unsure: Scene) -> None:
    session.select("the green gizmo")
    with pytest.raises(UnconfirmedError):
        session.do("delete it")
    assert session.scene is unsure
    session.answer("yes")
    assert 1 not in session.scene.cloud.group.tolist()


def test_what_rests_on_a_doubtful_anchor_or_remainder_is_in_doubt(session: Session) -> None:
    doubtful = Query(text="gizmo", colors=("green",))
    beside = Query(
        text="thing", colors=("red",), pick="any", relations=(Relation(name="left_of", anchors=(doubtful,)),)
    )
    assert session.select(beside).verdict == "unconfirmed"
    others = Query(text="thing", pick="all", exclude=(doubtful,))
    assert session.select(others).verdict == "unconfirmed" and set(session.select(others).groups) == {0, 2}
    sure = doubtful.model_copy(update={"confirmed": True})
    assert session.select(others.model_copy(update={"exclude": (sure,)})).verdict == "found"


def test_a_session_may_accept_what_is_not_confirmed(unsure: Scene, gizmo_encoder: Any) -> None:
    session = Session(unsure, encoder=gizmo_encoder, viewer=unsure.cameras[0], accept_unconfirmed=True)
    session.do(ORDER)
    assert session.done == (ORDER,)
    assert session.select("the red gizmo").verdict == "ambiguous"  # what is ambiguous is not accepted
    with pytest.raises(AmbiguousError):
        session.do("delete the red gizmo")


def test_a_confirmation_holds_for_the_scene_it_was_given_for(unsure: Scene, gizmo_encoder: Any, tmp_path: Path) -> None:
    first = Session(unsure, encoder=gizmo_encoder, viewer=unsure.cameras[0], log=tmp_path / "log.jsonl")
    with pytest.raises(UnconfirmedError):
        first.do(ORDER)
    edited = first.answer("yes").scene
    first.close()
    kinds = [(r["kind"], r.get("error")) for r in read_log(tmp_path / "log.jsonl").records]
    assert ("failed", "UnconfirmedError") in kinds and kinds[-1][0] == "do"
    same = Session(unsure, encoder=gizmo_encoder, viewer=unsure.cameras[0])
    same.replay(tmp_path / "log.jsonl")
    assert same.scene.cloud.digest() == edited.cloud.digest()
    moved = unsure.replace(cloud=unsure.cloud.replace(means=unsure.cloud.means + 0.01))
    other = Session(moved, encoder=gizmo_encoder, viewer=unsure.cameras[0])
    with pytest.raises(UnconfirmedError, match="replay stopped"):
        other.replay(tmp_path / "log.jsonl")
    assert other.scene.cloud is moved.cloud


@pytest.mark.parametrize(("answer", "done"), [("yes", (ORDER,)), ("no", ()), ("make the green thing red", ("red",))])
def test_the_chat_asks(unsure: Scene, gizmo_encoder: Any, answer: str, done: tuple[str, ...]) -> None:
    out = io.StringIO()
    session = Session(unsure, encoder=gizmo_encoder, viewer=unsure.cameras[0])
    with create_pipe_input() as pipe:
        pipe.send_text("".join(f"{line}\r" for line in (ORDER, answer, "/quit", "no")))  # "no": unsaved edits are left
        Chat(session, Terminal(out, io.StringIO()), pipe, DummyOutput()).run()
    assert "Is that meant? 'yes' or 'no'." in out.getvalue()
    assert len(session.done) == len(done) and all(word in said for word, said in zip(done, session.done, strict=True))


def test_the_toolbox_asks_back(session: Session) -> None:
    toolbox = Toolbox(session)
    reply = toolbox.call("do", {"instruction": ORDER})
    assert (
        reply.failed
        and reply.data["verdict"] == "unconfirmed"
        and reply.asks
        and "'yes'" in reply.data["how_to_answer"]
    )
    assert toolbox.call("select", {"target": "the green gizmo"}).data["verdict"] == "unconfirmed"
    reply = toolbox.call("do", {"instruction": ORDER})
    done = toolbox.call("answer", {"answer": "yes", "question": reply.asks})
    assert not done.failed and session.done == (ORDER,)


def test_planners_and_agents_cannot_confirm(session: Session) -> None:
    assert "confirmed" not in str(Query.model_json_schema())
    claimed = {"text": "gizmo", "colors": ["green"], "confirmed": True}
    toolbox = Toolbox(session)
    assert toolbox.call("recolor", {"target": claimed, "color": "blue"}).data["verdict"] == "unconfirmed"
    assert toolbox.call("select", {"target": claimed}).data["verdict"] == "unconfirmed"


def test_a_plan_of_a_model_that_claims_a_confirmation_is_asked_about(unsure: Scene, gizmo_encoder: Any) -> None:
    class Claims:
        name = "claims"

        def plan(self, instruction: str, *, previous: str | None = None, observation: Any = None) -> EditPlan:
            target = Query(text="gizmo", colors=("green",), confirmed=True)
            return EditPlan(instruction=instruction, ops=(Delete(target=target),), planner=self.name)

    session = Session(unsure, planner=Claims(), encoder=gizmo_encoder, viewer=unsure.cameras[0])
    with pytest.raises(UnconfirmedError):
        session.do(ORDER)
    assert session.scene is unsure
