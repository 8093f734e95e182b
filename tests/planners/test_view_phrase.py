"""Phrases that ask for a view, read into parts."""

from __future__ import annotations

import pytest

from scenewright.gaussians.errors import UserError
from scenewright.planners.grammar.view_phrase import ViewRequest, read_view


@pytest.mark.parametrize(
    ("phrase", "meant"),
    [
        ("the guitar from behind", ViewRequest("guitar", side="behind")),
        ("The guitar, seen from the back.", ViewRequest("guitar", side="behind")),
        ("rear view of the guitar", ViewRequest("the guitar", side="behind")),
        ("the lamp", ViewRequest("lamp")),
        ("show me the bookshelf from the front", ViewRequest("bookshelf", side="front")),
        ("a picture of the desk from its right side", ViewRequest("the desk", side="right")),
        ("the chair left of the table from the left", ViewRequest("chair left of the table", side="left")),
        ("the chair from above and close up", ViewRequest("chair", side="above", distance="close")),
        ("a close-up of the mug", ViewRequest("the mug", distance="close")),
        ("the lamp and the sofa from far away", ViewRequest("lamp and the sofa", distance="far")),
        ("the lamp on the table at eye level", ViewRequest("lamp on the table", eye_level=True)),
        ("the table seen from the door, at eye level", ViewRequest("table", stand="the door", eye_level=True)),
        ("the chair from the door", ViewRequest("chair", stand="the door")),
        ("the view from the sofa", ViewRequest(stand="the sofa")),
        ("the view from the sofa to the window", ViewRequest("the window", stand="the sofa")),
        ("the view of the table from the sofa", ViewRequest("the table", stand="the sofa")),
        ("what one sees sitting on the sofa", ViewRequest(stand="the sofa")),
        ("what would I see from the bed?", ViewRequest(stand="the bed")),
        ("What you see when seated on the sofa facing the TV", ViewRequest("the tv", stand="the sofa")),
        ("the whole room from above", ViewRequest(side="above")),
        ("floor plan", ViewRequest(side="above")),
        ("an overview", ViewRequest()),
        ("the bottle next to the window", ViewRequest("bottle next to the window")),
        ("the chair at the back", ViewRequest("chair at the back")),
    ],
)
def test_phrases(phrase: str, meant: ViewRequest) -> None:
    assert read_view(phrase) == meant


@pytest.mark.parametrize("phrase", ["", "  ", "?!", "x" * 500])
def test_no_words_or_too_many_are_refused(phrase: str) -> None:
    with pytest.raises(UserError):
        read_view(phrase)


@pytest.mark.parametrize("phrase", ["from behind", "the from the", "from from from", "view of of", "🎸 from behind"])
def test_odd_words_are_read_as_something(phrase: str) -> None:
    assert isinstance(read_view(phrase), ViewRequest)


def test_long_runs_of_words_are_read_quickly() -> None:
    read_view(("seen from " * 40).strip())
    read_view("what one sees " + "sitting on " * 30)
