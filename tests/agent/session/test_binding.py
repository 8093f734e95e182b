"""What all steps of an instruction are about is settled before the first step, in a session and on a graph."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from scenewright.agent.session.session import Session
from scenewright.gaussians.errors import ScenewrightError
from scenewright.gaussians.scene import Scene
from scenewright.planners import load
from scenewright.planners.rooms.graph import SceneGraph
from scenewright.planners.rooms.graph_scene import Stage
from scenewright.planners.rooms.plan_on_graph import Resolved, resolve_text

PLANNER = load("grammar")
WRITTEN = Path(__file__).parents[2] / "planners" / "written"
CLASSROOM = Stage.of(SceneGraph.read(WRITTEN / "classroom.json"))


@pytest.fixture
def session(boxes: Scene, encoder: Any) -> Session:
    return Session(boxes, encoder=encoder, viewer=boxes.cameras[0])


def colors(scene: Scene) -> dict[int, str]:
    """The colour of each box by what a red, a green and a blue one look like."""
    mean = {g: scene.cloud.sh[scene.cloud.group == g, 0].mean(dim=0) for g in (0, 1, 2)}
    return {g: "rgb"[int(m.argmax())] for g, m in mean.items()}


def ask(text: str) -> Resolved:
    return resolve_text(CLASSROOM, PLANNER, text)


def test_colors_change_places(session: Session) -> None:
    """What is painted green first is no "green thing" for the second step."""
    result = session.do("paint the rightmost red thing green and the green thing red")
    assert colors(result.scene) == {0: "r", 1: "r", 2: "g"}


def test_swapped_colors_are_those_before(session: Session) -> None:
    result = session.do("swap the colours of the rightmost red thing and the green thing")
    assert colors(result.scene) == {0: "r", 1: "r", 2: "g"}


def test_the_order_of_independent_steps_does_not_matter(session: Session) -> None:
    one = session.do("paint the green thing blue and the rightmost red thing green").scene
    session.undo()
    other = session.do("paint the rightmost red thing green and the green thing blue").scene
    assert colors(one) == colors(other) == {0: "r", 1: "b", 2: "g"}


def test_it_is_what_the_step_before_was_about_where_that_stood(session: Session) -> None:
    """The left box lies to the left of the green one before that is moved to the far left."""
    result = session.do("move the green thing 4 m to the left and delete the red thing left of it")
    assert set(result.scene.cloud.group.tolist()) >= {1, 2} and 0 not in result.scene.cloud.group.tolist()


def test_what_a_step_takes_away_is_gone_for_the_next(session: Session) -> None:
    before = session.scene
    with pytest.raises(ScenewrightError):
        session.do("delete the green thing and paint the green thing red")
    assert session.scene is before


def test_steps_of_a_graph_are_bound_as_well() -> None:
    swapped = ask("paint the blue chairs red and the red chair orange and the orange chair blue")
    assert [s.targets for s in swapped.steps] == [(10, 12), (11,), (13,)]
    alike = ask("swap the colours of the red beanbag and the yellow beanbag")
    assert [(s.targets, s.op.color) for s in alike.steps] == [((16,), "yellow"), ((17,), "red")]


def test_what_a_step_makes_is_found_when_its_turn_comes() -> None:
    found = ask("add a red stool next to the whiteboard and paint it blue")
    assert found.verdict == "ok" and found.steps[1].targets == ("new 1",)
