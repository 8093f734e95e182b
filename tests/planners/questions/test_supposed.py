"""Questions about time that no frame reads are put plainly by their kind, and only where nothing is left out."""

from __future__ import annotations

from typing import get_args

import pytest

from scenewright.planners.grammar.tagging.words import bag
from scenewright.planners.questions.reading.time.situated import situated
from scenewright.planners.questions.reading.time.supposed.forms import Form, chance_of, form_of
from scenewright.planners.questions.reading.time.supposed.gaps import gap
from scenewright.planners.questions.reading.time.supposed.kinds import kinds_of, marked_ways
from scenewright.planners.questions.reading.time.supposed.likely import without_options
from scenewright.planners.questions.reading.time.supposed.plainly import supposed
from scenewright.planners.questions.reading.time.supposed.said import Said
from scenewright.planners.questions.reading.time.supposed.times import from_one_to_another, plain_time, times_of
from scenewright.planners.questions.reading.time.supposed.wordings import PLAIN

NAMES = bag("ball sofa rug lamp table wall floor door plant drawer fan book robot car bed shelf")


@pytest.mark.parametrize(
    ("text", "plainly"),
    [
        ("what sort of distance does the little robot cover, in cm?", "how far does the robot move in cm"),
        ("top speed of the ball?", "what is the maximum speed of the ball"),
        ("I wonder whether the drawer goes shut again", "does the drawer close"),
        ("which of the books is first to drop, please?", "which book falls first"),
        ("when does the rolling ball end up touching the wall", "when does the ball reach the wall"),
        ("how often does the drawer pop open", "how often does the drawer open"),
        ("is the door still open at like 4 secs, yes?", "is the door open at 4 secs"),
        ("how many rounds does the fan do in all", "how many turns does the fan make"),
        ("did the green book drop ahead of the red book", "does the green book fall before the red book"),
        ("where does the ball finish up", "where does the ball stop"),
        ("duration of the drawer's opning?", "how long does the drawer take to open"),
        ("be so kind and name the drawers that are shut at 2.5 s", "which drawers are closed at 2.5 s"),
        ("which of the books have yet to tumble at 1.1 s", "which books have not fallen at 1.1 s"),
        ("rug, sofa, wall: which does the ball come by first, which next, which last",
         "in what order does the ball pass the rug and the sofa and the wall"),
        ("as the crow flies, how far from its start does the robot end up",
         "how far does the robot move as the crow flies"),
        ("how high up did the red book come from", "how far does the red book fall"),
        ("mention the second at which the robot begins to turn", "when does the robot turn"),
        ("what average pace was the ball keeping on its way over", "what is the average speed of the ball"),
        ("out of sofa, ball and table, which never budge?", "what does not move, the sofa, the ball or the table"),
    ],
)  # fmt: skip
def test_a_question_is_put_plainly(text: str, plainly: str) -> None:
    assert supposed(text, NAMES) == (plainly,)


def test_a_time_that_is_told_by_what_happens_is_put_plainly_too() -> None:
    (said, plainly) = supposed("where is the robot once it's got to the end of its bend", NAMES)
    assert "the end of its bend" in said and plainly == "where is the robot after it has turned"
    assert plain_time("at 2 s") is None and plain_time("until the film is over") == ""
    assert plain_time("during its first walk") == "before it turns"


@pytest.mark.parametrize(
    "text",
    [
        "when does the ball not reach the wall?",  # a negation
        "is the robot quicker on its second trip?",  # a rank
        "is the ball faster than the robot?",  # a comparison of what is no kind
        "why does the ball roll?",
        "who painted the door?",
        "stop the ball at 2 s",  # an order
        "before the robot changes direction the third time, which way does it turn?",  # a time that no mark tells
    ],
)
def test_what_says_more_is_not_put_plainly(text: str) -> None:
    assert supposed(text, NAMES) == ()


@pytest.mark.parametrize("text", ["", " . ", "?", "[x", "ball " * 300, "\u2026 , ;"])
def test_what_says_nothing_is_no_question(text: str) -> None:
    assert supposed(text, NAMES) == ()


def test_kinds_and_marks_are_told() -> None:
    text = "can you tell me how many metres the cat covers before it sits down"
    words = text.split()
    assert kinds_of(words)[0][0] == "far"
    found = {tag: " ".join(words[a:b]) for tag, a, b in marked_ways(words)[0]}
    assert found["x"] == "the cat" and found["t"] == "before it sits down"


@pytest.mark.parametrize(
    ("text", "plainly"),
    [
        ("What interval elapsed between the onset of the red book's fall and that of the blue book's?",
         "how much time is there between the red book falling and the blue book falling"),
        ("What was the robot's average speed during its first leg, in m/s?",
         "how fast does the robot move in m / s before it turns"),
        ("Over the five seconds recorded, the fan is at rest for how long?", "how long does the fan stand still"),
        ("how many times did the old fan go round before it gave up?", "how many turns does the fan make"),
    ],
)  # fmt: skip
def test_gaps_legs_and_whole_films(text: str, plainly: str) -> None:
    assert supposed(text, NAMES | {"red", "blue"})[:1] == (plainly,)


@pytest.mark.parametrize(
    "text", ["was the blue book frightened when it fell?", "how's the robot feeling once he's done, happy or tired?"]
)
def test_what_is_felt_is_not_asked_about(text: str) -> None:
    assert supposed(text, NAMES) == ()


@pytest.mark.parametrize(
    ("text", "plainly"),
    [
        ("Say I'm at 1.7 seconds. What's the ball on then?", "What's the ball on at 1.7 seconds?"),
        ("It's 1.5 seconds, is the book still up there?", "is the book still up there at 1.5 seconds?"),
        ("1.8s and the blue book is up there?", "the blue book is up there at 1.8s?"),
        ("What is the ball rolling over, love?", "what is the ball on?"),
        (
            "By what length, in centimetres, does the drawer slide out?",
            "how far in centimetres does the drawer slide out?",
        ),
        ("Yellow car. Does it move at any point?", "Does the yellow car move at any point?"),
        ("By what angle has the door swung once it is fully open?", "By what angle has the door swung?"),
        ("Does the ball stop?", "Does the ball stop?"),
    ],
)
def test_a_question_is_put_into_its_time(text: str, plainly: str) -> None:
    assert situated(text) == plainly


@pytest.mark.parametrize(
    ("text", "plainly"),
    [
        ("top or middle or bottom, which drawer is the one that opens?", "which drawer is the one that opens ?"),
        ("which drawer is operated: top, middle or bottom?", "which drawer is operated ?"),
        (
            "does the top or the bottom drawer open?",
            "does the top or the bottom drawer open ?",
        ),  # is no choice of which
    ],
)
def test_ranks_to_choose_from_ask_which_one(text: str, plainly: str) -> None:
    words = tuple(text.replace(",", " ,").replace("?", " ?").replace(":", " :").split())
    assert " ".join(without_options(words)) == plainly


@pytest.mark.parametrize(
    ("kind", "said", "plainly"),
    [
        ("if_open", "once the clock 's hit 4.8", "at 4.8 s"),
        ("if_moves", "when clock shows three seconds", "at 3 s"),
        ("what_on", "by 3 s", "at 3 s"),
        ("what_on", "by the time 3 seconds have passed", "at 3 seconds"),
        ("where_at", "right about 1.8 seconds", "at 1.8 seconds"),
        ("where_at", "when our story is over", "at the end"),
        ("fast", "from departure until stop", ""),
        ("fast", "between its departure and its arrival at the wall", ""),
        ("long_moves", "from its first stirring to its last", ""),
        ("long_open", "between the outward slide and the return", ""),
        ("long_on", "till it drops off the far side", ""),
        ("fast", "going out", "while it is opening"),
        ("if_moves", "while the ball crosses the room", "while the ball moves"),
    ],
)
def test_times_in_other_words(kind: str, said: str, plainly: str) -> None:
    assert next(times_of(kind, (said,))) == plainly


@pytest.mark.parametrize(
    ("first", "second", "plainly"),
    [
        ("the red one dropping off", "the green one following", "the red one falling and the green one falling"),
        ("red starting down", "green starting down", "the red one falling and the green one falling"),
        (
            "first book leaving the shelf",
            "until last one has landed",
            "the first book starting and the last book landing",
        ),
        ("the book starting", "the ball stopping", "the book starting and the ball stopping"),
    ],
)
def test_gaps_between_what_two_things_do(first: str, second: str, plainly: str) -> None:
    said = Said("", "", f"{first} {second}", "", " how long is it between ", (first, second), names=NAMES)
    assert next(gap(said)) == f"how much time is there between {plainly}"


def test_a_pause_is_no_gap_between_two_beginnings() -> None:
    said = Said(
        "", "", "", "", " the pause between ", ("the fall of the green book", "that of the red one"), names=NAMES
    )
    assert not any("falling" in plain for plain in gap(said))


@pytest.mark.parametrize(
    ("text", "plainly"),
    [
        ("does the robot pivot to the left?", "does the robot turn to the left"),
        ("the bench on the left, does it shift at all?", "does the left bench move"),
        ("do all three of the books lie on the floor at 3 s?", "are all three books on the floor at 3 s"),
        ("when does our small green wanderer set off?", "when does the green one start to move"),
        ("which toy never budges?", "which toys do not move"),
    ],
)
def test_names_sides_and_all_of_several(text: str, plainly: str) -> None:
    assert supposed(text, NAMES | {"bench", "toy", "green"})[:1] == (plainly,)


@pytest.mark.parametrize(
    "text",
    [
        "is anything apart from the ball in motion?",
        "until what second does the door remain shut?",
        "does the robot head over to the bed because he's sleepy?",
        "what knocked those books off the shelf?",
        "the door's swing as a fraction of a full turn?",
    ],
)
def test_what_is_left_apart_or_caused_or_shared_is_not_put_plainly(text: str) -> None:
    assert supposed(text, NAMES) == ()


@pytest.mark.parametrize(
    ("text", "form"),
    [
        ("how much time does the ball spend on the rug", "duration"),
        ("when does the drawer pop open", "moment"),
        ("does the ball reach the wall", "yesno"),
        ("how many rounds does the fan do in all", "number"),
        ("out of sofa, ball and table, which never budge?", "name"),
    ],
)
def test_the_form_of_an_answer_is_that_of_its_kind(text: str, form: Form) -> None:
    chances = {other: chance_of(text, other) for other in get_args(Form)}
    assert max(chances, key=chances.__getitem__) == form and chances[form] > 0.5


def test_every_kind_has_a_form() -> None:
    assert {form_of(kind) for kind in PLAIN} == set(get_args(Form))
    assert form_of("when_stops") == "moment" and form_of("long_open") == "duration" and form_of("near") == "name"


@pytest.mark.parametrize(
    ("kind", "said", "plainly"),
    [
        ("turns", "come three seconds", "by three seconds"),
        ("where_at", "1.7 seconds on the clock", "at 1.7 s"),
        ("where_at", "one and a half seconds gone", "at 1.5 s"),
        ("if_open", "with two on the clock", "at 2 s"),
        ("far", "as the clock strikes three", "by 3 s"),
        ("fast", "on the outbound leg", "while it is opening"),
        ("near", "at the end of everything", "at the end"),
        ("far_turns", "from zero till t = 1.5", "from 0 s till 1.5 s"),
        ("if_moves", "when the fan 's going", "when the fan is moving"),
        ("fast", "from start of motion till it stops", ""),
        ("long_opens", "from the first little move", ""),
        ("turns", "before they grow still", ""),
    ],
)
def test_whole_movements_and_clocks(kind: str, said: str, plainly: str) -> None:
    assert next(times_of(kind, (said,))) == plainly


@pytest.mark.parametrize(
    ("text", "plainly"),
    [
        ("the drawer lingers in its outermost position; over what span of time?",
         "how long does the drawer stay fully open"),
        ("which of them refuses to be static, this film?", "what moves"),
        ("at one and a half seconds, how many books are still sitting up on the shelf?",
         "how many books are on the shelf at one and a half seconds"),
        ("how many books are off the shelf by 1.1 s", "how many books have fallen at 1.1 s"),
        ("once the door is wide open, how many seconds of film are left?",
         "how long is it from when the door is fully open to the end of the film"),
        ("fan off at what time please", "when does the fan stop moving"),
        ("The ventilator up on the ceiling, until what second it turns?", "when does the ventilator stop moving"),
        ("From which second begins the door to open, per favore?", "when does the door start to open"),
        ("ball comes off the far edge of the rug when, roughly", "when does the ball leave the rug"),
    ],
)  # fmt: skip
def test_poses_and_what_is_left(text: str, plainly: str) -> None:
    assert plainly in supposed(text, NAMES)


def test_a_gap_is_told_by_what_happens_at_its_ends() -> None:
    named = NAMES.__contains__
    between = from_one_to_another(("the door 's first twitch", "its standstill"), "", lambda said: named(said[4:]))
    assert between == "how long is it from when the door starts to move to when the door stops"
    left = from_one_to_another(("the fan 's last quiver", "the final frame"), "", lambda said: named(said[4:]))
    assert left == "how long is it from when the fan stops to the end of the film"
    assert from_one_to_another(("at 1 s", "at 2 s"), "", lambda said: False) is None


def test_a_word_that_may_tell_more_bars_a_question_only_strictly() -> None:
    text = "I wonder, is the ball ever rolling?"
    assert supposed(text, NAMES) and supposed(text, NAMES, strictly=True) == ()
