"""A model that looks before it plans: what it is told, what it is spared, and that its plans are checked as ever."""

from __future__ import annotations

import json
from typing import Any

import pytest
from scripted_model import ScriptedModel

from scenewright.agent.session.session import Session
from scenewright.agent.toolbox.looking_model import LOOKS, LookingModel, looking_planner, with_look
from scenewright.gaussians.errors import BackendError, ScenewrightError
from scenewright.gaussians.scene import Scene
from scenewright.planners.model.backend import Answer, Message, UnreachableError
from scenewright.planners.model.local.tightening import tighten
from scenewright.planners.model.verify import reply
from scenewright.planners.plan import Usage

PLAN = {"verdict": "ok", "ops": [{"op": "recolor", "target": {"colors": ["green"]}, "color": "blue"}]}


@pytest.fixture
def session(boxes: Scene, encoder: Any) -> Session:
    return Session(boxes, encoder=encoder, viewer=boxes.cameras[0])


def look(tool: str, words: str = "") -> str:
    return json.dumps({"look": {"tool": tool, "words": words}})


@pytest.mark.slow
def test_a_model_looks_and_then_plans(session: Session, boxes: Scene) -> None:
    model = ScriptedModel(look("select", "the red thing"), look("check"), json.dumps({"answer": PLAN}))
    session.planner = looking_planner(session, model)
    result = session.do("give the green thing the colour of the sky")
    assert [r.op["op"] for r in result.receipts] == ["recolor"] and len(model.asked) == 3
    assert "2 things match" in model.asked[1][-1].text and "group 0" in model.asked[1][-1].text
    assert result.plan is not None and result.plan.usage is not None and result.plan.usage.requests == 3
    assert session.spent == result.plan.usage
    assert "look" in model.asked[0][0].text and session.undo().scene.cloud is boxes.cloud


def test_an_answer_without_the_frame_is_one_too(session: Session) -> None:
    session.planner = looking_planner(session, ScriptedModel(json.dumps(PLAN)))
    assert session.do("make the green thing blue").receipts


def test_looks_do_not_change_what_it_means_nor_the_scene(session: Session, boxes: Scene) -> None:
    session.select("the green thing")
    session.planner = looking_planner(session, ScriptedModel(look("select", "red things"), json.dumps(PLAN)))
    session.plan("make the green thing blue")
    assert session.last is not None and session.last.groups == (1,) and session.question is None
    assert session.scene is boxes


@pytest.mark.parametrize("sees", [False, True])
def test_pictures_are_shown_to_models_that_see(session: Session, sees: bool) -> None:
    model = ScriptedModel(look("render", "viewer"), json.dumps(PLAN), sees=sees)
    looking_planner(session, model).plan("make the green thing blue", observation=session)
    assert len(model.asked[1][-1].pictures) == sees


@pytest.mark.parametrize(
    "wrong",
    [
        '{"look": {"tool": "delete", "words": "everything"}}', '{"look": "select"}', '{"look": {}}',
        '{"look": {"tool": "save", "words": "../x.ply"}}', look("select", "\x00"), look("render", "no such camera"),
        '{"look": {"tool": "select", "words": "' + "x" * 401 + '"}}', look("ask", ""), look("select"),
    ],
)  # fmt: skip
def test_a_wrong_look_is_told_to_the_model(session: Session, boxes: Scene, wrong: str) -> None:
    model = ScriptedModel(wrong, json.dumps(PLAN))
    plan = looking_planner(session, model).plan("make the green thing blue", observation=session)
    assert plan.ops and len(model.asked) == 2 and model.asked[1][-1].text and session.scene is boxes


def test_looks_are_bounded(session: Session) -> None:
    model = ScriptedModel(look("check"))
    with pytest.raises(BackendError):
        looking_planner(session, model).plan("make the green thing blue", observation=session)
    assert len(model.asked) == 3 * (LOOKS + 1)  # three attempts
    assert "answer now" in model.asked[LOOKS][-1].text


def test_plans_after_looks_are_guarded(session: Session) -> None:
    """A removal that nobody asked for is refused, whatever the model was told."""
    wipe = {"verdict": "ok", "ops": [{"op": "delete", "target": {"text": "", "pick": "all"}}]}
    model = ScriptedModel(look("select", "everything"), json.dumps({"answer": wipe}))
    session.planner = looking_planner(session, model)
    with pytest.raises(ScenewrightError):
        session.do("make the green thing blue")
    assert not session.done


def test_usage_before_an_outage_is_counted(session: Session) -> None:
    model = ScriptedModel(look("check"), UnreachableError("down", Usage(model="scripted", requests=1)))
    with pytest.raises(UnreachableError) as raised:
        LookingModel(model, session).answer([Message("system", "s"), Message("user", "u")], reply.schema(), seconds=9)
    assert raised.value.usage is not None and raised.value.usage.requests == 2


@pytest.mark.parametrize("end", ["cut", "closed", "declined"])
def test_an_unfinished_look_is_not_carried_out(session: Session, end: Any) -> None:
    model = ScriptedModel(Answer(look("check"), Usage(model="scripted", requests=1), end))
    answer = LookingModel(model, session).answer([Message("system", "s"), Message("user", "u")], {}, seconds=9)
    assert answer.end == end and len(model.asked) == 1


@pytest.mark.slow
def test_the_schema_is_valid_for_both_and_can_be_tightened() -> None:
    jsonschema = pytest.importorskip("jsonschema")
    schema = with_look(reply.schema())
    tight = tighten(schema)
    for good in ({"look": {"tool": "check"}}, {"look": {"tool": "ask", "words": "how many?"}}, {"answer": PLAN}):
        jsonschema.validate(good, schema)
    jsonschema.validate({"answer": PLAN}, tight)
    for bad in ({}, {"look": {"tool": "delete"}}, {"look": {"tool": "check"}, "answer": PLAN}, PLAN):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(bad, schema)
