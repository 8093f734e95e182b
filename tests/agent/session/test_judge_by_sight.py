"""The judge with a vision model: what it is shown, what its verdict changes, and what happens where it is no help."""

from __future__ import annotations

import io
import json
from typing import Any

import numpy as np
import pytest
from PIL import Image
from scripted_model import ScriptedModel

from scenewright.agent.session.judge import JudgedError
from scenewright.agent.session.judge_by_sight import PAIRS, pictures
from scenewright.agent.session.session import Session
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.scene import Scene
from scenewright.planners.model.backend import UnreachableError
from scenewright.planners.plan import EditPlan, Usage
from scenewright.tools.registry import parse

TEXT = "make the green thing blue"


def says(**more: Any) -> str:
    fine = {"reason": "As asked.", "done": True, "right_thing": True, "residue": False, "looks_right": True}
    return json.dumps(fine | more)


def judged(scene: Scene, encoder: Any, *script: Any) -> tuple[Session, ScriptedModel]:
    model = ScriptedModel(*script, sees=True)
    return Session(scene, planner="grammar", encoder=encoder, viewer=scene.cameras[0], judge="vlm", vlm=model), model


def sent(model: ScriptedModel) -> list[np.ndarray[Any, Any]]:
    """The pictures of the last request."""
    return [np.asarray(Image.open(io.BytesIO(p))) for m in model.asked[-1] for p in m.pictures]


def blue(picture: np.ndarray[Any, Any]) -> int:
    red, green, blue = (picture[..., i].astype(int) for i in range(3))
    return int(((blue > red + 40) & (blue > green + 20)).sum())


def test_it_sees_the_change_from_the_same_places(boxes: Scene, encoder: Any) -> None:
    session, model = judged(boxes, encoder, says())
    (receipt,) = session.do(TEXT).receipts
    assert receipt.judged is not None and receipt.judged.judge == "built-in, scripted"
    assert {c.name for c in receipt.judged.checks} >= {"seen: done", "seen: no side effects", "nothing else changed"}
    shown = sent(model)
    assert 2 <= len(shown) <= 2 * PAIRS and len({p.shape for p in shown}) == 1
    for old, new in zip(shown[::2], shown[1::2], strict=True):
        assert blue(old) < 20 < blue(new)
    assert TEXT in model.asked[-1][1].text


@pytest.mark.parametrize(
    "text",
    ["delete the green thing", "move the green thing 90 cm to the left", "add a stool", "duplicate the green thing"],
)
def test_the_pictures_show_where_things_were_and_where_they_are(boxes: Scene, encoder: Any, text: str) -> None:
    session, model = judged(boxes, encoder, says())
    session.do(text)
    shown = sent(model)
    assert any((np.abs(a.astype(int) - b).max(axis=2) > 30).sum() > 100
               for a, b in zip(shown[::2], shown[1::2], strict=True))  # fmt: skip


@pytest.mark.parametrize(
    ("fault", "check"),
    [
        ({"done": False, "right_thing": False}, "seen: done"),
        ({"right_thing": False}, "seen: right thing"),
        ({"residue": True}, "seen: no residue"),
        ({"looks_right": False}, "seen: plausible"),
        ({"side_effects": ["the left box is gone"]}, "seen: no side effects"),
    ],
)
def test_a_bad_verdict_takes_the_edit_back(boxes: Scene, encoder: Any, fault: dict[str, Any], check: str) -> None:
    session, _ = judged(boxes, encoder, says(**fault))
    with pytest.raises(JudgedError) as told:
        session.do(TEXT)
    assert check in {c.name for c in told.value.judgement.checks if not c.passed}
    assert session.scene is boxes and check in str(told.value)


@pytest.mark.slow
def test_an_insertion_that_looks_wrong_is_made_anew(boxes: Scene, encoder: Any) -> None:
    session, model = judged(boxes, encoder, says(looks_right=False, reason="It floats."), says())
    judgement = session.do("add a stool").receipts[0].judged
    assert judgement is not None and [r.tried for r in judgement.repairs] == ["another design"]
    assert judgement.repairs[0].failed[0].sentence == "It floats." and len(model.asked) == 2


@pytest.mark.parametrize("reply", [UnreachableError("the server is down"), "no JSON", says(done="yes")])
def test_a_model_that_is_no_help_leaves_the_measured_verdict(boxes: Scene, encoder: Any, reply: Any) -> None:
    session, _ = judged(boxes, encoder, reply)
    (receipt,) = session.do(TEXT).receipts
    assert receipt.judged is not None and receipt.judged.passed and session.scene is not boxes
    assert any("the vision model was no help" in note for note in receipt.notes)


@pytest.mark.slow
def test_a_compound_instruction_is_seen_once_as_a_whole(boxes: Scene, encoder: Any) -> None:
    session, model = judged(boxes, encoder, says())
    receipts = session.do(f"{TEXT} and delete the blue thing").receipts
    assert len(model.asked) == 1 and all(r.judged is not None for r in receipts)
    assert any(c.name == "seen: done" for c in receipts[-1].judged.checks)  # type: ignore[union-attr]
    session, model = judged(boxes, encoder, says(done=False, right_thing=False))
    with pytest.raises(JudgedError, match="taken back"):
        session.do(f"{TEXT} and delete the blue thing")
    assert session.scene is boxes


class Replanning:
    """A planner with a model that gives the next of some plans each time it is asked."""

    name = "scripted"

    def __init__(self, *plans: EditPlan) -> None:
        self.plans = list(plans)

    def plan(self, text: str, **more: Any) -> EditPlan:
        return self.plans.pop(0) if len(self.plans) > 1 else self.plans[0]


def planned(color: str) -> EditPlan:
    op = parse({"op": "recolor", "target": {"groups": [1]}, "color": color})
    return EditPlan(instruction=TEXT, ops=(op,), planner="scripted", usage=Usage(model="scripted", requests=1))


def test_a_model_plans_again_once_if_its_plan_was_judged_a_failure(boxes: Scene, encoder: Any) -> None:
    wrong = says(done=False, right_thing=False)
    session, _ = judged(boxes, encoder, wrong, says())
    session.planner = Replanning(planned("teal"), planned("blue"))
    result = session.do(TEXT)
    assert result.plan is not None and result.plan.ops[0].color == "blue"  # type: ignore[attr-defined]
    assert "planned again, as the judge refused the first plan (seen: done" in result.sentences()[0]
    session, model = judged(boxes, encoder, wrong)
    session.planner = Replanning(planned("teal"))
    with pytest.raises(JudgedError):
        session.do(TEXT)
    assert session.scene is boxes and len(model.asked) == 1


def test_a_judge_by_sight_needs_eyes(boxes: Scene, encoder: Any) -> None:
    with pytest.raises(UserError, match="needs a vision model; name one with --vlm"):
        Session(boxes, encoder=encoder, judge="vlm", vlm=None)


def test_nothing_changed_is_shown_as_an_overview_and_both_pictures_are_equal(boxes: Scene) -> None:
    pairs = pictures(boxes, boxes)
    assert pairs and all(old.png == new.png and old.name == new.name for old, new in pairs)
