"""Whether a lamp is on or off at a time, in a scene in which it is turned off at 2 s of 4 s, or in which nothing is."""

from __future__ import annotations

import pytest

from scenewright.agent.session.session import Session
from scenewright.planners.rooms.build import construct
from scenewright.planners.rooms.graph import SceneGraph


@pytest.fixture(scope="module")
def evening() -> Session:
    nodes = [
        {"id": 0, "label": "floor lamp", "size": (0.35, 0.35, 1.6), "position": (1.2, 1.2, 0.8)},
        {"id": 1, "label": "chair", "size": (0.45, 0.5, 0.9), "position": (-0.5, -0.8, 0.45)},
    ]
    graph = SceneGraph.model_validate({"room": {"size": (4.0, 4.0, 2.6)}, "nodes": nodes})
    session = Session(construct(graph, seed=3, detail=0.3).scene)
    session.do("move the chair 50 cm to the left from 0 to 4 s")
    session.do("turn off the lamp at 2 s")
    return session


@pytest.mark.parametrize(
    ("question", "answer"),
    [
        ("is the lamp off at 3 s?", "yes"), ("is the lamp off at 1 s?", "no"), ("is the lamp on at 3 s?", "no"),
        ("is the lamp on at 1 s?", "yes"), ("is the lamp switched off at 3 s?", "yes"),
        ("is the lamp turned off at 1 s?", "no"), ("is the floor lamp off at the end?", "yes"),
        ("is the lamp not off at 3 s?", "yes"), ("is the lamp still at 3 s?", "yes"), ("does the lamp move?", "no"),
    ],
)  # fmt: skip
def test_a_lamp_that_is_turned_off(evening: Session, question: str, answer: str) -> None:
    told = evening.ask(question)
    assert told.answer == answer
    if " off" in question or " on " in question:
        assert "stands still" not in told.text


def test_of_a_lamp_that_never_changes_nothing_is_told(evening: Session) -> None:
    evening.undo()
    assert evening.ask("is the lamp off at 3 s?").answer is None
