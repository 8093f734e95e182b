"""Existence, counts, colours, sizes, comparisons, superlatives and lists, each in many wordings, in one known room."""

from __future__ import annotations

import json
from typing import Any

import pytest

from scenewright.gaussians.errors import UserError
from scenewright.planners.questions.asking import NOT_READ, answer, route
from scenewright.planners.questions.survey import Survey
from scenewright.planners.rooms.graph import SceneGraph


def _node(id: int, label: str, color: str, size: tuple[float, ...], at: tuple[float, ...], on: Any = "floor") -> dict:
    return {"id": id, "label": label, "color": color, "size": size, "position": at, "support": on}


ROOM = {
    "room": {"size": [5.0, 4.0, 2.5]},
    "nodes": [
        _node(1, "sofa", "blue", (2.0, 0.9, 0.8), (0.0, 1.5, 0.4)),
        _node(2, "coffee table", "brown", (1.0, 0.6, 0.4), (0.0, 0.3, 0.2)),
        _node(3, "chair", "red", (0.5, 0.5, 0.9), (-2.0, -1.0, 0.45)),
        _node(4, "chair", "white", (0.45, 0.5, 0.85), (2.0, -1.0, 0.425)),
        _node(5, "bookshelf", "white", (1.2, 0.3, 1.9), (-2.3, 1.0, 0.95)),
        _node(6, "floor lamp", "black", (0.3, 0.3, 1.6), (1.6, 1.6, 0.8)),
        _node(7, "vase", "blue", (0.15, 0.15, 0.3), (0.2, 0.3, 0.55), 2),
        _node(8, "painting", "red", (0.8, 0.04, 0.6), (0.0, 1.98, 1.5), "wall"),
        _node(9, "pendant lamp", "black", (0.4, 0.4, 0.4), (0.0, 0.0, 2.3), "ceiling"),
    ],
}


@pytest.fixture(scope="module")
def survey() -> Survey:
    return Survey.of_graph(SceneGraph.model_validate_json(json.dumps(ROOM)))


@pytest.mark.parametrize(
    ("wordings", "value"),
    [
        ("is there a sofa|Is there a couch in here?|do you see any sofas|Have we got a settee?|"
         "has the room got a sofa|Aren't there any sofas?|there's a sofa, right?|I was wondering if there is a sofa",
         "yes"),
        ("is there a piano|got a piano?|Any chance there's a piano lying about?|is there no piano|isn't there a piano?|"
         "I don't suppose there's a piano anywhere", "no"),
        ("is there a vase on the table|is there something blue on the coffee table?|anything blue on the table?",
        "yes"),
        ("is there a chair and a piano|are there at least three chairs|are there more than two lamps|is there only one "
         "chair|are there three chairs|is there a green thing", "no"),
        ("is there a piano or a chair?|are there two chairs?|is there more than one lamp|anything to sit on?|"
         "are there fewer than five chairs|is there somewhere to sit", "yes"),
        ("how many chairs are there|number of chairs?|count the chairs please|How many chairs can you see in this room|"
         "what's the number of chairs|how many lamps are there", 2),
        ("how many seats are there|how many places to sit do we have|how many places are there to sit", 3),
        ("how many blue or red things on the floor|how many blue and red things are on the floor", 2),
        ("how many beds are there|how many green chairs|How many lamps are on the table?", 0),
        ("how many things are there not counting the sofa", 8),
        ("how many lamps hang from the ceiling|how many chairs are red|how many of the chairs are white", 1),
        ("are there more chairs than tables|are there as many lamps as chairs|is the number of chairs even", "yes"),
        ("is the number of chairs odd or even", "even"),
        ("what colour is the sofa|the sofa is what color?|what's the colour of the settee|couch colour?|tell me what "
         "color the sofa is|what is the sofa's colour|is the sofa red or blue", "blue"),
        ("is the sofa blue|isn't the sofa blue?|are both lamps black|is anything brown|are the lamps the same colour|"
         "is the painting the same colour as the red chair", "yes"),
        ("is the sofa green|are all the chairs white|is everything blue|do the chairs have the same colour", "no"),
        ("how tall is the bookshelf|what is the height of the bookshelf|bookshelf height?|how high is the bookcase|the "
         "height of the bookshelf in metres", 1.9),
        ("how tall is the bookshelf in cm|How many centimetres tall is the bookshelf?", 190.0),
        ("how wide is the sofa|sofa width|what width is the sofa|how long is the couch", 2.0),
        ("is the sofa wider than 1.5 m|is the bookshelf over 180 cm tall|is the bookshelf taller than me|is the vase "
         "less than half a metre tall", "yes"),
        ("is the sofa more than 3 metres wide|is the vase taller than 1 m", "no"),
        ("which is taller, the sofa or the bookshelf|between the sofa and the bookshelf, which is higher?|the sofa "
         "or the "
         "bookshelf, which one's taller|is the sofa or the bookshelf taller|which of the sofa and the bookshelf is "
          "taller",
         "bookshelf"),
        ("is the sofa bigger than the coffee table|is the vase smaller than the sofa|is the red chair taller than the "
         "white one|does the sofa take up more space than the coffee table", "yes"),
        ("how much taller is the bookshelf than the floor lamp|what's the difference in height between the lamp on the "
         "floor and the bookshelf", 0.3),
        ("what is the tallest thing in the room|tallest object?|which thing is the tallest|name the tallest item|what "
         "has the greatest height", "bookshelf"),
        ("what's the second tallest thing|what is the tallest thing except the bookshelf|apart from the bookshelf, "
         "what "
         "is the tallest thing?", "floor lamp"),
        ("what is the smallest thing|smallest thing on the table|which is the smallest, the vase, the sofa or the "
         "chair "
         "on the left?", "vase"),
        ("is the sofa the biggest thing in the room|is anything taller than the sofa", "yes"),
        ("what is object 5?|what's number 5|describe thing 5", "bookshelf"),
        ("what is the brown thing", "coffee table"),
    ],
)  # fmt: skip
def test_every_wording_has_the_same_answer(survey: Survey, wordings: str, value: str | float) -> None:
    got = {w: answer(w, survey) for w in wordings.split("|")}
    if isinstance(value, str):
        assert {w: a.answer for w, a in got.items()} == dict.fromkeys(got, value)
    else:
        assert {w: a.answer for w, a in got.items()} == {w: pytest.approx(value) for w in got}
    assert all(a.source == "geometry" for a in got.values())


@pytest.mark.parametrize(
    ("wordings", "labels"),
    [
        ("list all the lamps|which lamps are there?|what lamps can you see|give me a list of the lamps|show me the "
         "lamps|"
         "name all black things|which things are black", ["floor lamp", "pendant lamp"]),
        ("list the chairs with their colours|make a table of the chairs|list the chairs with their sizes",
         ["chair", "chair"]),
        ("what are the two largest things|name the 2 biggest things", ["sofa", "bookshelf"]),
        ("list everything|what is in this room|what can you see?|what's in here|name all objects",
         [n["label"] for n in ROOM["nodes"]]),
    ],
)  # fmt: skip
def test_lists_hold_the_labels(survey: Survey, wordings: str, labels: list[str]) -> None:
    for wording in wordings.split("|"):
        got = answer(wording, survey)
        assert got.answer_type == "list", wording
        assert isinstance(got.answer, tuple) and sorted(got.answer) == sorted(labels), wording
        assert len(got.evidence.ids) == len(labels), wording


def test_a_table_has_a_row_a_thing_with_the_columns_asked_for(survey: Survey) -> None:
    table = answer("make a table of the chairs with their colours and sizes", survey).table
    assert [row["id"] for row in table] == [3, 4]
    assert set(table[0]) == {"id", "thing", "color", "width", "depth", "height"}
    assert (table[0]["color"], table[0]["height"]) == ("red", 0.9)


def test_candidates_that_agree_are_answered_and_others_are_told(survey: Survey) -> None:
    assert answer("is the chair taller than the coffee table?", survey).answer == "yes"
    told = answer("what colour is the chair?", survey)
    assert (told.answer, told.source) == (None, "none")
    assert "red" in told.text and "white" in told.text
    assert set(told.evidence.ids) == {3, 4}


def test_a_phrase_within_a_phrase_is_told_apart_too(survey: Survey) -> None:
    assert answer("what colour is the thing on the table?", survey).answer == "blue"
    assert answer("how many things are next to the unicorn?", survey).answer == 0


def test_what_is_absent_has_no_measure_and_names_what_is_near(survey: Survey) -> None:
    for text in (
        "how tall is the wardrobe?",
        "what colour is the wardrobe",
        "which is bigger, the sofa or the wardrobe?",
    ):
        got = answer(text, survey)
        assert (got.answer, got.source) == (None, "none"), text
        assert "wardrobe" in got.text and got.evidence.ids, text
    assert answer("is the wardrobe blue?", survey).answer == "no"


def test_a_narrow_margin_lowers_the_confidence(survey: Survey) -> None:
    close = answer("is the red chair taller than the white chair?", survey)
    clear = answer("is the bookshelf taller than the white chair?", survey)
    assert close.confidence < 0.85 < clear.confidence


def test_things_are_named_by_what_tells_them_apart(survey: Survey) -> None:
    names = {t.id: survey.named(t) for t in survey.things}
    assert (names[1], names[3]) == ("the sofa", "the red chair")
    assert len(set(names.values())) == len(names)


def test_evidence_is_what_the_answer_is_about(survey: Survey) -> None:
    assert answer("which is taller, the sofa or the bookshelf?", survey).evidence.ids == (5, 1)
    assert answer("how many chairs are there", survey).evidence.ids == (3, 4)


@pytest.mark.parametrize(
    ("text", "sight"),
    [
        ("who owns the sofa?", False), ("how much did the sofa cost", False), ("what brand is the lamp?", False),
        ("how old is the chair", False), ("how heavy is the sofa?", False), ("is the sofa comfortable", False),
        ("what does it smell like in here", False), ("why is there a vase?", False), ("do you like the sofa", False),
        ("what is the sofa made of?", True), ("is the table wooden", True), ("is the lamp on?", True),
        ("is the lamp switched off or on", True), ("what is painted on the picture", True), ("is the vase empty", True),
        ("does the room look cosy?", True), ("what style is the room", True), ("is the sofa dirty", True),
        ("what is written on the painting", True), ("is the bookshelf full?", True), ("what shape is the table", True),
    ],
)  # fmt: skip
def test_what_geometry_cannot_tell_is_said_and_sight_may_help(survey: Survey, text: str, sight: bool) -> None:
    read = route(text, survey)
    assert (read.answer.answer, read.answer.source, read.kind) == (None, "none", "undecidable")
    assert read.sight == sight
    assert read.answer.text != NOT_READ


@pytest.mark.parametrize(
    "text",
    ["is the lamp on the table?", "is the vase on the table", "what is the vase on?",
    "how far is the lamp from the sofa",
     "is the painting above the sofa", "which chair is nearest to the sofa"],
)  # fmt: skip
def test_questions_about_places_are_not_taken_for_states(survey: Survey, text: str) -> None:
    assert route(text, survey).kind != "undecidable"


@pytest.mark.parametrize(
    "text",
    ["", "?", " , , ", "the", "of of of of", "is is is is the the", "how how many many", "sofa " * 110, "or " * 100,
     "what is the the the tallest", "\u0000\u202e", "how many [chairs] (are|is) {x}", "a" * 1000, "1 2 3 4 5 6",
     "is the sofa " + "and the chair " * 30, "which is taller, " + "the sofa or " * 30 + "the chair"],
)  # fmt: skip
def test_hostile_texts_get_an_answer_without_a_guess(survey: Survey, text: str) -> None:
    got = answer(text, survey)
    assert got.source in ("geometry", "none")
    assert got.to_json()


def test_too_many_words_are_refused(survey: Survey) -> None:
    with pytest.raises(UserError, match="121 words"):
        answer("sofa " * 121, survey)
