"""More or less of the last edit: from its start, with another strength, as if it had been asked for so at once."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import pytest

from scenewright.agent.session.log import read_log
from scenewright.agent.session.session import Session
from scenewright.agent.session.strength import stronger_plan, times_asked
from scenewright.gaussians.errors import ScenewrightError
from scenewright.gaussians.scene import Scene
from scenewright.planners.plan import EditPlan
from scenewright.tools.registry import parse

ASKED = {
    "more": 2.0, "a bit more": 1.5, "a little stronger, please": 1.5, "even more": 2.0, "much more": 3.0,
    "Less.": 0.5, "slightly less": 0.75, "a lot less": 0.25, "make it a bit less": 0.75, "weaker": 0.5,
    "twice as much": 2.0, "half as strong": 0.5, "that's too much": 0.5, "too weak": 2.0, "not enough": 2.0,
    "ok, a touch gentler": 0.75, "not so strong": 0.5, "triple it": 3.0,
}  # fmt: skip
OTHERWISE = (
    "more chairs", "a bit more blue", "less light", "make it darker", "more or less", "a bit bigger", "undo", "yes",
    "move it more to the left", "the other one", "too dark", "once more", "remove more of the chairs",
    "half transparent",
)  # fmt: skip


@pytest.mark.parametrize(("text", "times"), ASKED.items())
def test_words_for_more_and_less(text: str, times: float) -> None:
    assert times_asked(text) == times


@pytest.mark.parametrize("text", OTHERWISE)
def test_other_words_are_left_to_the_planner(text: str) -> None:
    assert times_asked(text) is None


@pytest.fixture
def session(boxes: Scene, encoder: Any) -> Session:
    return Session(boxes, planner="grammar", encoder=encoder, viewer=boxes.cameras[0], vlm=None)


def direct(boxes: Scene, encoder: Any, text: str) -> str:
    """The digest of a scene after one instruction."""
    session = Session(boxes, planner="grammar", encoder=encoder, viewer=boxes.cameras[0], vlm=None)
    session.do(text)
    return session.digest


@pytest.mark.parametrize(
    ("text", "said", "once"),
    [
        ("turn the green thing 30 degrees", "more", "turn the green thing 60 degrees"),
        ("turn the green thing 30 degrees", "half", "turn the green thing 15 degrees"),
        ("move the green thing 40 cm up", "half as much", "move the green thing 20 cm up"),
        ("make the green thing 50% transparent", "more", "make the green thing 75% transparent"),
    ],
)
def test_it_is_as_if_it_had_been_asked_for_at_once(
    session: Session, boxes: Scene, encoder: Any, text: str, said: str, once: str
) -> None:
    session.do(text)
    result = session.do(said)
    assert session.digest == direct(boxes, encoder, once)
    assert result.before.cloud is boxes.cloud and "from its start" in result.sentences()[0]


def test_steps_up_and_down_end_where_they_began(session: Session, boxes: Scene) -> None:
    """1.5 times and then two thirds is not in the words, but twice and then half is."""
    session.do("make the green thing darker")
    first = session.digest
    assert session.do("more").scene.cloud.digest() != first
    assert session.do("less").scene.cloud.digest() == first
    assert len(session.done) == 1  # one edit, however often its strength changed
    assert session.undo().scene.cloud is boxes.cloud


def test_after_an_undo_it_is_the_edit_that_was_undone(session: Session, boxes: Scene, encoder: Any) -> None:
    session.do("turn the green thing 60 degrees")
    session.do("undo")
    session.do("less")
    assert session.digest == direct(boxes, encoder, "turn the green thing 30 degrees")


def test_a_colour_goes_part_of_the_way_and_no_further_than_all(session: Session, boxes: Scene) -> None:
    full = session.do("make the green thing blue").scene.cloud
    part = session.do("less").scene.cloud
    assert part.digest() not in (full.digest(), boxes.cloud.digest())
    rows = boxes.cloud.group == 1
    was, some, whole = (c.sh[rows, 0].mean(dim=0) for c in (boxes.cloud, part, full))
    assert 0 < float((some - was).norm()) < float((whole - was).norm())


def test_what_has_no_strength_is_left_to_the_planner(session: Session) -> None:
    session.do("delete the green thing")
    before = session.digest
    with pytest.raises(ScenewrightError):
        session.do("more")
    assert session.digest == before and len(session.done) == 1


def test_nothing_was_edited(session: Session) -> None:
    with pytest.raises(ScenewrightError):
        session.do("a bit more")


def test_what_cannot_be_done_leaves_the_edit_as_it_was(session: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    session.do("make the green thing twice as big")
    before, scene = session.digest, session.scene

    def fails(*_: Any, **__: Any) -> Any:
        raise ScenewrightError("no room")

    monkeypatch.setattr("scenewright.agent.session.session.run_plan", fails)
    with pytest.raises(ScenewrightError, match="no room"):
        session.do("more")
    assert session.scene is scene and session.digest == before and len(session.done) == 1


def test_the_log_tells_it_as_an_undo_and_an_edit_and_is_replayed(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    log = tmp_path / "log.jsonl"
    session = Session(boxes, planner="grammar", encoder=encoder, viewer=boxes.cameras[0], vlm=None, log=log)
    session.do("turn the green thing 30 degrees")
    session.do("a bit more")
    session.close()
    records = read_log(log).records
    assert [r["kind"] for r in records] == ["open", "do", "undo", "do"]
    assert all(a["after"] == b["before"] for a, b in itertools.pairwise(records[1:]))
    again = Session(boxes, planner="grammar", encoder=encoder, viewer=boxes.cameras[0], vlm=None)
    assert [r.error for r in again.replay(log)] == [None]
    assert again.digest == session.digest


@pytest.mark.parametrize(
    "data",
    [
        {"op": "recolor", "target": {"text": "box"}, "adjust": "darker", "amount": 0.3},
        {"op": "opacity", "target": {"text": "box"}, "value": 0.4},
        {"op": "scale", "target": {"text": "box"}, "factor": 1.3},
        {"op": "rotate", "target": {"text": "box"}, "degrees": -40},
        {"op": "move", "target": {"text": "box"}, "direction": "up", "distance": {"value": 40, "unit": "cm"}},
        {"op": "delete", "target": {"text": "floater", "pick": "all"}},
        {"op": "reframe", "degrees": 20},
        {"op": "reframe", "factor": 1.5},
    ],
)
def test_strength_is_a_group(data: dict[str, Any]) -> None:
    """Twice and then half is the operation itself; more and less move apart."""
    op = parse(data)
    more, less = op.stronger(2.0), op.stronger(0.5)
    assert more is not None and less is not None and more != op != less
    back = more.stronger(0.5)
    assert back is not None and parse(back.model_dump(mode="json")) == back
    for name, value in back.model_dump(mode="json").items():
        was = op.model_dump(mode="json")[name]
        assert value == (pytest.approx(was) if isinstance(was, float) else was)


@pytest.mark.parametrize(
    "data",
    [
        {"op": "delete", "target": {"text": "box"}},
        {"op": "insert", "asset": "stool"},
        {"op": "scale", "target": {"text": "box"}, "height": {"value": 1}},
        {"op": "rotate", "target": {"text": "box"}, "toward": {"text": "sofa"}},
        {"op": "opacity", "target": {"text": "box"}, "value": 0},
    ],
)
def test_operations_without_a_strength(data: dict[str, Any]) -> None:
    plan = EditPlan(instruction="x", ops=(parse(data),), planner="said")
    assert parse(data).stronger(2.0) is None and stronger_plan(plan, 2.0) is None
