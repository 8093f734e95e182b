"""What is not found by its name is offered by numbers; an answer edits it, and its name is kept."""

from __future__ import annotations

from typing import Any

import pytest

from scenewright.agent.session.offers import MOST, offered
from scenewright.agent.session.session import Session
from scenewright.gaussians.assets.furnishing.furnish import furnish
from scenewright.gaussians.errors import AbsentError, UserError
from scenewright.gaussians.language import encoders
from scenewright.gaussians.language.field.embed import embed
from scenewright.gaussians.scene import Scene

STRANGE = "delete the flumbergast"  # a word that no encoder knows


@pytest.fixture(scope="module")
def room() -> Scene:
    return embed(furnish(seed=7, detail=0.3).scene, encoders.load("auto"))


@pytest.fixture
def session(room: Scene) -> Session:
    return Session(room)


def asked(session: Session, text: str) -> Any:
    with pytest.raises(AbsentError):
        session.do(text)
    assert session.question is not None
    return session.question


@pytest.mark.slow
def test_an_unknown_word_is_offered_what_the_views_show_the_most_visible_first(session: Session, room: Scene) -> None:
    question = asked(session, STRANGE)
    scores = [c.score for c in question.candidates]
    assert question.offered and 3 <= len(scores) <= MOST and scores == sorted(scores, reverse=True)
    assert room.language is not None
    assert {room.language.groups[c.group].level for c in question.candidates} == {"object"}
    assert len({c.group for c in question.candidates}) == len(scores)


@pytest.mark.slow
def test_an_answer_edits_exactly_what_was_chosen_and_its_name_is_known_from_then_on(session: Session) -> None:
    question = asked(session, STRANGE.replace("delete", "raise") + " by 10 cm")
    chosen = question.candidates[1].group
    result = session.answer("2")
    assert result.selection is not None and result.selection.groups == (chosen,)
    assert session.do("make the flumbergast red").selection.groups == (chosen,)  # type: ignore[union-attr]


@pytest.mark.slow
def test_pieces_that_are_chosen_together_are_one_thing(session: Session) -> None:
    asked(session, STRANGE)
    assert session.question is not None
    pieces = [session.question.candidates[i].group for i in (0, 2)]
    before = len(session.scene.cloud)
    counts = [session.scene.language.groups[g].count for g in pieces]  # type: ignore[union-attr]
    result = session.answer("1 and 3")
    made = sum(f.gaussians for r in result.receipts for f in r.filled)  # what they hid is filled
    assert before + made - len(result.scene.cloud) == sum(counts)


def test_none_of_them_shows_others_until_there_are_no_more(session: Session) -> None:
    seen: set[int] = set()
    question = asked(session, STRANGE)
    for _ in range(100):
        groups = {c.group for c in question.candidates}
        assert not groups & seen
        seen |= groups
        error = session.offer_others()
        if error is None:
            break
        assert isinstance(error, AbsentError)
        question = session.question
    else:
        pytest.fail("the offers never end")
    with pytest.raises(UserError):
        session.answer("none")


def test_what_names_tell_to_be_absent_is_not_offered(session: Session) -> None:
    question = asked(session, "delete the bathtub")
    assert not question.offered
    assert offered(session.scene, question.selection, session.viewer, session.encoder, question.resolve) is None
