"""Selection by sight: what a vision model points at becomes the selection, and the field keeps the name."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import Any

import pytest
from scripted_model import ScriptedModel

from scenewright.agent.session.looker import SceneLooker
from scenewright.agent.session.session import Session
from scenewright.gaussians.errors import AmbiguousError, BackendError
from scenewright.gaussians.scene import Scene
from scenewright.planners.model.backend import Message, UnreachableError

LEFT, GREEN, RIGHT = range(3)


def pointing(session: Callable[[], Session], groups: Sequence[int], *among: int, **more: Any) -> ScriptedModel:
    """A model that points at groups by the numbers that they have in the pictures."""

    def answer(messages: Sequence[Message]) -> str:
        looker = SceneLooker(session().scene, session().viewer)
        looker.overview(among, 2)
        numbers = {group: number for number, group in looker.numbers.items()}
        meant = [numbers[g] for g in groups]
        return json.dumps({"meant": meant, "none": not meant, "confidence": 0.9, **more})

    return ScriptedModel(answer, sees=True)


def opened(scene: Scene, encoder: Any, model: ScriptedModel | None) -> Session:
    return Session(scene, planner="grammar", encoder=encoder, vlm=model)


def seeing(
    scene: Scene, encoder: Any, groups: Sequence[int], *among: int, **more: Any
) -> tuple[Session, ScriptedModel]:
    made: list[Session] = []
    model = pointing(lambda: made[0], groups, *among, **more)
    made.append(opened(scene, encoder, model))
    return made[0], model


def test_without_a_vision_model_an_ambiguity_stays(boxes: Scene, encoder: Any) -> None:
    assert opened(boxes, encoder, None).select("the red thing").verdict == "ambiguous"


@pytest.mark.slow
def test_an_ambiguity_is_settled_by_sight(boxes: Scene, encoder: Any) -> None:
    session, model = seeing(boxes, encoder, [RIGHT], LEFT, RIGHT)
    found = session.select("the red thing")
    assert (found.verdict, found.groups) == ("found", (RIGHT,))
    assert "pointed out by scripted" in found.reason
    assert len(model.asked) <= 2 and sum(len(m.pictures) for talk in model.asked for m in talk) <= 3


def test_a_phrase_is_asked_once(boxes: Scene, encoder: Any) -> None:
    session, model = seeing(boxes, encoder, [RIGHT], LEFT, RIGHT)
    session.select("the red thing")
    asked = len(model.asked)
    assert session.select("the red thing").groups == (RIGHT,)
    assert len(model.asked) == asked


@pytest.mark.slow
def test_an_instruction_is_settled_by_sight_and_undone(boxes: Scene, encoder: Any) -> None:
    session, _ = seeing(boxes, encoder, [LEFT], LEFT, RIGHT)
    before = session.scene.cloud.digest()
    result = session.do("delete the red thing")
    assert result.selection is None or LEFT in result.plan.ops[0].query().groups  # type: ignore[union-attr]
    assert any("pointed out" in line for line in result.sentences())
    assert session.scene.language is not None and session.scene.language.groups[LEFT].count == 0
    session.undo()
    assert session.scene.cloud.digest() == before


@pytest.mark.slow
def test_none_of_them_leaves_the_verdict_and_says_who_looked(boxes: Scene, encoder: Any) -> None:
    session, _ = seeing(boxes, encoder, [], LEFT, RIGHT)
    found = session.select("the red thing")
    assert found.verdict == "ambiguous" and "scripted sees no such thing" in found.reason
    with pytest.raises(AmbiguousError, match="sees no such thing"):
        session.do("delete the red thing")


def test_a_model_that_is_unsure_decides_nothing(boxes: Scene, encoder: Any) -> None:
    session, _ = seeing(boxes, encoder, [LEFT], LEFT, RIGHT, confidence=0.2)
    assert session.select("the red thing").verdict == "ambiguous"


@pytest.mark.parametrize("reply", ["", "the left one", '{"meant": [77], "confidence": 1}', '{"meant": "1"}'])
def test_a_reply_of_no_use_leaves_the_verdict(boxes: Scene, encoder: Any, reply: str) -> None:
    session = opened(boxes, encoder, ScriptedModel(reply, sees=True))
    found = session.select("the red thing")
    assert found.verdict == "ambiguous" and "no help" in found.reason


def test_a_dead_server_leaves_the_verdict(boxes: Scene, encoder: Any) -> None:
    session = opened(boxes, encoder, ScriptedModel(UnreachableError("nobody there"), sees=True))
    assert "nobody there" in session.select("the red thing").reason


def test_a_model_without_eyes_is_refused(boxes: Scene, encoder: Any) -> None:
    session = opened(boxes, encoder, ScriptedModel("{}", sees=False))
    assert "reads no pictures" in session.select("the red thing").reason
    with pytest.raises(BackendError, match="reads no pictures"):
        session.name_all()


def test_all_things_are_named_and_sure_names_stay(boxes: Scene, encoder: Any) -> None:
    numbers = [1, 2, 3]
    names = json.dumps(
        {
            "scene": "Three cubes.",
            "captions": [{"number": n, "name": "crate", "caption": f"Crate {n}."} for n in numbers],
        }
    )
    session = opened(boxes, encoder, ScriptedModel(names, sees=True))
    kept = session.name_all()
    assert not kept.names and len(kept.kept) == 3
    named = session.name_all(overwrite=True)
    assert set(named.names.values()) == {"crate"}
    assert session.scene.language is not None
    assert {g.named_by for g in session.scene.language.objects()} == {"caption"}


@pytest.mark.slow
def test_what_was_pointed_at_is_forgotten_when_the_scene_changes(boxes: Scene, encoder: Any) -> None:
    session, model = seeing(boxes, encoder, [RIGHT], LEFT, RIGHT)
    session.select("the red thing")
    asked = len(model.asked)
    session.do("delete the green thing")
    assert session.scene.language is not None and session.scene.language.groups[GREEN].count == 0
    session.select("the red thing")
    assert len(model.asked) > asked
    asked = len(model.asked)
    session.undo()
    assert session.select("the red thing").groups == (RIGHT,)
    assert len(model.asked) == asked  # of the scene before the edit it is still known


def test_what_an_earlier_step_inserts_is_not_looked_for_in_the_scene_before(boxes: Scene, encoder: Any) -> None:
    session, model = seeing(boxes, encoder, [LEFT], LEFT, RIGHT)
    with pytest.raises(AmbiguousError, match="no group to point at"):
        session.do("add a red ball next to the green thing, then delete the red thing")
    assert not model.asked
