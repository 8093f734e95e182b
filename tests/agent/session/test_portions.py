"""Answers that mean a portion of what is offered: what they are read as, and that exactly that portion is edited."""

from __future__ import annotations

import pytest
import torch

from scenewright.agent.session.portions import read
from scenewright.agent.session.session import Session
from scenewright.gaussians.assets.furnishing.furnish import furnish
from scenewright.gaussians.errors import AbsentError, UserError
from scenewright.gaussians.language import encoders
from scenewright.gaussians.language.field.embed import embed
from scenewright.gaussians.scene import Scene


@pytest.fixture(scope="module")
def room() -> Scene:
    return embed(furnish(seed=7, detail=0.3).scene, encoders.load("auto"))


@pytest.fixture
def session(room: Scene) -> Session:
    asked = Session(room)
    with pytest.raises(AbsentError):
        asked.do("make the flumbergast teal")
    return asked


@pytest.mark.parametrize(
    ("said", "kind", "places", "words", "without"),
    [
        ("the red part of 2", "colors", (1,), ("red",), False),
        ("only the red part of 1 and 3", "colors", (0, 2), ("red",), False),
        ("the dark green bits of 3", "colors", (2,), ("dark green",), False),
        ("the red and white part of 2", "colors", (1,), ("red", "white"), False),
        ("3, only the white part", "colors", (2,), ("white",), False),
        ("2 but not the black part", "colors", (1,), ("black",), True),
        ("3 without the wall", "behind", (2,), (), True),
        ("the top half of 3", "side", (2,), ("top",), False),
        ("the lower part of 2", "side", (1,), ("bottom",), False),
        ("pieces of 3", "pieces", (2,), (), False),
        ("zoom in on 2", "pieces", (1,), (), False),
        ("something smaller", "pieces", (), (), False),
        ("all of 3", "whole", (2,), (), False),
    ],
)
def test_portions_are_read(
    said: str, kind: str, places: tuple[int, ...], words: tuple[str, ...], without: bool
) -> None:
    found = read(said, 3)
    assert found is not None
    assert (found.kind, found.places, found.words, found.without) == (kind, places, words, without)


def test_portions_are_joined_and_subtracted() -> None:
    joined = read("1 and the red part of 3", 3)
    assert joined is not None and joined.places == (0,) and [p.words for p in joined.more] == [("red",)]
    less = read("3 without 1", 3)
    assert less is not None and (less.places, less.less) == ((2,), (0,))


@pytest.mark.parametrize(
    "said", ["2", "1 and 2", "all", "delete it", "make it red", "move 3 to the left", "left of 2", "the red one", "4"]
)
def test_what_is_no_portion_is_left_to_others(said: str) -> None:
    assert read(said, 3) is None


def test_each_of_many_portions_that_are_joined_is_kept() -> None:
    found = read("1 and the red part of 2, the left half of 3 and the blue part of 3", 3)
    assert found is not None and found.places == (0,)
    assert [(p.places, p.words, p.more) for p in found.more] == [
        ((1,), ("red",), ()), ((2,), ("left",), ()), ((2,), ("blue",), ()),
    ]  # fmt: skip


def test_a_long_list_is_read_in_time() -> None:
    """A reader that tries every way to join its 60 items would never end."""
    assert read(", ".join(["1", "2", "3"] * 20) + " and wool", 3) is None
    assert read(", ".join(["a"] * 60), 3) is None


def test_without_a_number_a_portion_is_of_the_one_thing_that_is_asked_about() -> None:
    assert read("the red part", 3) is None
    found = read("only the red part", 1, single=True)
    assert found is not None and found.places == (0,)


@pytest.mark.slow
def test_a_side_is_edited_alone_and_keeps_the_name(session: Session, room: Scene) -> None:
    assert session.question is not None and room.language is not None
    chosen = session.question.candidates[1].group
    own = torch.isin(room.cloud.group, torch.tensor(room.language.leaves(chosen), dtype=torch.int32))
    result = session.answer("the top half of 2")
    changed = (result.scene.cloud.sh != room.cloud.sh).flatten(1).any(dim=1)
    up = torch.from_numpy(room.frame.up_vector).float()
    heights = room.cloud.means @ up
    assert bool(changed.any()) and not bool((changed & ~own).any())
    assert float(heights[changed].min()) >= float(heights[own].min() + heights[own].max()) / 2 - 0.05
    assert result.selection is not None and session.scene.language is not None
    assert session.scene.language.groups[result.selection.groups[0]].label == "flumbergast"
    assert session.undo().scene.cloud.sh is room.cloud.sh


def test_both_halves_are_all_of_it(session: Session, room: Scene) -> None:
    assert session.question is not None and room.language is not None
    chosen = session.question.candidates[1].group
    result = session.answer("the top half of 2 and the bottom half of 2")
    assert result.selection is not None
    assert len(result.selection) == room.language.groups[chosen].count


def test_pieces_are_offered_and_one_of_them_is_edited(session: Session, room: Scene) -> None:
    assert session.question is not None and room.language is not None
    chosen = session.question.candidates[0].group
    own = torch.isin(room.cloud.group, torch.tensor(room.language.leaves(chosen), dtype=torch.int32))
    with pytest.raises(AbsentError, match="numbered pieces"):
        session.answer("pieces of 1")
    assert session.question is not None and len(session.question.candidates) >= 2
    result = session.answer("2")
    changed = (result.scene.cloud.sh != room.cloud.sh).flatten(1).any(dim=1)
    assert bool(changed.any()) and not bool((changed & ~own).any()) and bool((own & ~changed).any())


def test_a_colour_that_is_not_there_is_refused_with_those_that_are(session: Session, room: Scene) -> None:
    with pytest.raises(UserError, match="its colours are"):
        session.answer("the turquoise part of 1")
    assert session.question is not None and session.scene.cloud is room.cloud


def test_numbers_without_others_leave_these_out(session: Session) -> None:
    with pytest.raises(UserError, match="nothing would be left"):
        session.answer("2 without 2")


def test_numbers_of_an_earlier_page_are_kept(session: Session, room: Scene) -> None:
    assert session.question is not None and room.language is not None
    first = session.question.candidates[1].group
    with pytest.raises(AbsentError, match="are kept"):
        session.answer("2 and more")
    assert session.question is not None and [c.group for c in session.question.kept] == [first]
    second = session.question.candidates[0].group
    result = session.answer("1")
    assert result.selection is not None
    assert len(result.selection) == room.language.groups[first].count + room.language.groups[second].count


def test_one_of_two_names_can_be_dropped(room: Scene) -> None:
    asked = Session(room)
    with pytest.raises(AbsentError, match="this asks for"):
        asked.do("make the flumbergast and the wuggle teal")
    assert asked.question is not None
    chosen = asked.question.candidates[0].group
    with pytest.raises(AbsentError, match="this asks for"):
        asked.answer("1")
    result = asked.answer("that is all")
    assert result.selection is not None and result.selection.groups == (chosen,)
