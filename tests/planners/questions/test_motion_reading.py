"""How questions about scenes with time are read: times, deeds, and whole questions in the words of many people."""

from __future__ import annotations

import re

import pytest

from scenewright.planners.questions.reading.time.deeds import as_noun, said_in
from scenewright.planners.questions.reading.time.frames import frames
from scenewright.planners.questions.reading.time.moments import When, clauses, without_time
from scenewright.planners.questions.reading.time.notation import forms, pattern
from scenewright.planners.questions.reading.time.plainly import plainly
from scenewright.planners.questions.reading.words import plain_words


@pytest.mark.parametrize(
    ("said", "when", "rest"),
    [
        ("is the door open at 2.5 s", When("at", 2.5), "is the door open"),
        ("what is moving at 1.4", When("at", 1.4), "what is moving"),
        ("is it open at half a second", When("at", 0.5), "is it open"),
        ("where is it two and a half seconds in", When("at", 2.5), "where is it"),
        ("does it move in the first two secs", When("span", 0.0, 2.0), "does it move"),
        ("does it move between 1 and 2 s", When("span", 1.0, 2.0), "does it move"),
        ("does it move before second 3", When("span", 0.0, 3.0), "does it move"),
        ("does it move in the last second", When("last", 1.0), "does it move"),
        ("does it move after 3 seconds", When("after", 3.0), "does it move"),
        ("where is it at the end of the clip", When("end"), "where is it"),
        ("is it red the whole time", When("always"), "is it red"),
        ("does it ever touch the wall", When("ever"), "does it touch the wall"),
        ("how many chairs are at the table", None, "how many chairs are at the table"),
    ],
)
def test_times_are_taken_out(said: str, when: When | None, rest: str) -> None:
    assert without_time(said) == (when, rest)


def test_clauses_are_divided_but_not_plain_times() -> None:
    (found,) = clauses("where is the cat when the ball stops")
    assert found == (When("clause", conj="when", clause="the ball stops"), "where is the cat")
    (found,) = clauses("before it falls , where is the book")
    assert found == (When("clause", conj="before", clause="it falls"), "where is the book")
    assert list(clauses("does it move before 4 s")) == []


@pytest.mark.parametrize(
    ("said", "kind", "phase"),
    [
        ("rolls", "move", ""),
        ("start rolling", "move", "start"),
        ("come to rest", "move", "stop"),
        ("half open", "is_open", "half"),
        ("falls off", "fall", ""),
        ("hits the floor", "land", ""),
        ("bumps into", "reach", ""),
        ("makes a turn", "turn", ""),
        ("begins to open", "open", "start"),
        ("goes back in", "close", ""),
        ("stays where it is", "still", ""),
        ("stops turning", "turn", "stop"),
        ("keeps on rolling", "move", ""),
        ("has a fall", "fall", ""),
        ("a quarter open", "is_open", "quarter"),
        ("come back", "return", ""),
        ("goes past", "pass", ""),
        ("gets closer to", "approach", ""),
        ("slides out", "open", ""),
    ],
)
def test_deeds_by_their_verbs(said: str, kind: str, phase: str) -> None:
    start, stop, deed = next(said_in(said))
    assert (start, stop) == (0, len(said)) and (deed.kind, deed.phase) == (kind, phase)


def test_the_notation_stands_for_all_forms_optional_words_and_alternatives() -> None:
    row = re.compile(pattern("~come to [a|an] (rest|halt) | TURN away"))
    assert all(row.fullmatch(f"{said} ") for said in ("came to rest", "coming to a halt", "spun away"))
    assert not any(row.fullmatch(f"{said} ") for said in ("came to", "come to a a rest", "rolled away"))


@pytest.mark.parametrize(
    ("said", "plain"),
    [
        ("is there a moment when the chair moves", "the chair moves at some time"),
        ("the ball does it roll", "does the ball roll"),
        ("how far out of the dresser does it go", "how far does it go out of the dresser"),
        ("does only the fan turn", "nothing besides the fan turn"),
        ("how high is the chair", "how high is the chair"),
    ],
)
def test_plain_order(said: str, plain: str) -> None:
    assert plainly(said) == plain


def test_forms_and_nouns_of_deeds() -> None:
    assert set(forms("stop", "slide", "carry").strip("(?:)").split("|")) == {
        "stop",
        "stops",
        "stopping",
        "stopped",
        "slide",
        "slides",
        "sliding",
        "slid",
        "carry",
        "carries",
        "carrying",
        "carried",
    }
    fall = as_noun("the fall")
    assert fall is not None and fall.kind == "fall" and as_noun("the sofa") is None


def first(text: str) -> tuple[str, str, str]:
    """What the likeliest reading asks, of which deed, of what."""
    frame = frames(plain_words(text))[0]
    named = frame.what.subject
    thing = "" if named is None else "it" if named.last else " ".join((*named.colors, named.text))
    return frame.asks, frame.what.deed.kind if frame.what.deed is not None else "", thing


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("When does the ball reach the wall?", ("when", "reach", "ball")),
        ("When the ball is stopping?", ("when", "move", "ball")),
        ("when stops the fan", ("when", "move", "fan")),
        ("At what second does the red book begin to fall?", ("when", "fall", "red book")),
        ("How much time need the door for opening?", ("how_long", "open", "door")),
        ("how long does it take for the door to open", ("how_long", "open", "door")),
        ("How many seconds of rolling do I have in total?", ("how_long", "move", "")),
        ("How many turns makes the fan in all?", ("how_often", "", "fan")),
        ("fan rpm?", ("how_fast", "", "fan")),
        ("avg angular speed of the door in deg/s while it opens", ("how_fast", "", "door")),
        ("how many metres does it go before the turn?", ("how_far", "move", "it")),
        ("whats moving at 1.4", ("which", "move", "")),
        ("Which one is the last to fall?", ("which", "fall", "")),
        ("how many things they move?", ("how_many", "move", "")),
        ("The fan is starting immediately?", ("yesno", "move", "fan")),
        ("Is the fan still turning at 3?", ("yesno", "turn", "fan")),
        ("which way does the blue book go, up or down?", ("which_way", "move", "blue book")),
        ("What does the robot do at 2 seconds?", ("does", "", "robot")),
        ("In what order do the books fall?", ("order", "fall", "book")),
        ("How much time passes between the red and the blue drop?", ("between", "fall", "red ")),
    ],
)
def test_questions_in_many_words(text: str, told: tuple[str, str, str]) -> None:
    asks, deed, thing = told
    found = first(text)
    assert found[:2] == (asks, deed) and found[2].startswith(thing)


@pytest.mark.parametrize(
    "text",
    [
        "What time does the radio play jazz?",
        "The waiter sings before second 3?",
        "when does the ball dream of the wall",
        "why does the ball roll",
        "who opens the door?",
    ],
)
def test_words_that_belong_to_nothing_are_not_passed_over(text: str) -> None:
    assert not any(f.what.deed is not None for f in frames(plain_words(text)))


@pytest.mark.parametrize(
    ("said", "plain"),
    [
        ("what moves in here?", "what moves?"),
        ("what is moving up there?", "what is moving?"),
        ("anything moving?", "is anything moving?"),
        ("anything moving besides the door?", "does anything besides the door move?"),
        ("the lower drawer does it move?", "does the lower drawer move?"),
        ("at 4.5 the robot is still walking?", "is the robot still walking at 4.5?"),
        ("is the door open on the last frame?", "is the door open in the last frame?"),
        ("total time the drawer is in motion", "how long does the drawer move"),
        ("total path length of the robot?", "how far does the robot move?"),
        ("when does red land?", "when does the red thing land?"),
        ("Would the drawer be open at 3 s, or not?", "is the drawer open at 3 s?"),
        ("what moves at a second and a half?", "what moves at 1.5 s?"),
        ("what moves at two seconds and a half?", "what moves at 2.5 s?"),
        ("when does the robot stop for good?", "when does the robot stop for the last time?"),
        ("when is the door halfway through its swing?", "when is the door half open?"),
        ("from what height does the cup fall?", "how far does the cup fall?"),
        ("at what timecode does it stop?", "at what time does it stop?"),
        ("besides the fan, does anything else in the room move?", "does anything besides the fan move?"),
    ],
)
def test_what_people_say_is_read_as_what_is_asked_plainly(said: str, plain: str) -> None:
    found, wanted = (frames(tuple(plain_words(text))) for text in (said, plain))
    assert wanted and found[0] == wanted[0]
