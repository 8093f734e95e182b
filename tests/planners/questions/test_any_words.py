"""No question raises an error, whatever things its words name: floor and walls, people, absent and repeated things."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator

import pytest

from scenewright.agent.session.session import Session
from scenewright.benchmarks._ask import sentences, sentences_held
from scenewright.planners.questions.asking import answer
from scenewright.planners.questions.survey import Survey
from scenewright.planners.rooms.graph import SceneGraph

ASKED = 150  # questions a room
NOUNS = (
    "the floor", "the ceiling", "the wall", "the walls", "every wall", "the left wall", "the chair", "the chairs", "it",
    "the piano", "the thing on the floor", "the furniture", "the room", "the middle of the room", "me", "number 12",
    "the corner", "the window", "the chair and the piano", "two chairs", "the biggest thing", "the chair on the wall",
)  # fmt: skip
ROOM = SceneGraph.model_validate(
    {
        "room": {"size": [5.0, 4.0, 2.5]},
        "nodes": [
            {"id": 10, "label": "door", "size": [0.9, 0.06, 2], "position": [0, -1.97, 1], "support": "wall"},
            {"id": 11, "label": "chair", "color": "red", "size": [0.5, 0.5, 0.9], "position": [-2, 1, 0.45]},
            {"id": 12, "label": "piano", "color": "black", "size": [1.4, 0.6, 1.2], "position": [0, 1.6, 0.6]},
            {"id": 13, "label": "chair", "color": "red", "size": [0.5, 0.5, 0.7], "position": [2, 0, 0.35]},
            {"id": 14, "label": "chair", "color": "red", "size": [0.5, 0.5, 0.7], "position": [2, -1.2, 0.35]},
        ],
    }
)


def phrasings(value: object) -> Iterator[str]:
    """Every text in a table of sentences."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        yield from (text for item in value.values() for text in phrasings(item))
    elif isinstance(value, tuple | list):
        yield from (text for item in value for text in phrasings(item))


def questions(seed: int) -> list[str]:
    """Sentences of the benchmark with any nouns in their holes."""
    tables = [v for module in (sentences, sentences_held) for k, v in sorted(vars(module).items()) if k.isupper()]
    texts = sorted({text for table in tables for text in phrasings(table) if "{" in text})
    draw = random.Random(seed)
    return [re.sub(r"\{[^}]*\}", lambda _: draw.choice(NOUNS), draw.choice(texts)) for _ in range(ASKED)]


@pytest.fixture(scope="module", params=["measured", "written", "empty"])
def survey(request: pytest.FixtureRequest) -> Survey:
    if request.param == "measured":
        return Session(ROOM.build(detail=0.1)).survey()
    return Survey.of_graph(ROOM if request.param == "written" else ROOM.model_copy(update={"nodes": ()}))


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.slow
def test_no_question_raises_an_error(survey: Survey, seed: int) -> None:
    for text in questions(seed):
        assert answer(text, survey).text, text
