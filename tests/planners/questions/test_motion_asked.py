"""Questions about a scene with time whose motion is known in closed form, and the same about a static one."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from scenewright.agent.session.session import Session
from scenewright.gaussians.motion.motion import Motion, Track
from scenewright.gaussians.scene import Scene
from scenewright.planners.questions.answer import Answer
from scenewright.planners.rooms.graph import SceneGraph

ROOM = SceneGraph.model_validate(
    {
        "room": {"size": [6.0, 4.0, 2.5]},
        "nodes": [
            {"id": 0, "label": "ball", "color": "red", "size": [0.2, 0.2, 0.2], "position": [-2.0, -1.0, 0.1]},
            {"id": 1, "label": "rug", "color": "blue", "size": [1.0, 1.0, 0.01], "position": [0.5, -1.0, 0.005]},
            {"id": 2, "label": "chair", "size": [0.5, 0.5, 0.9], "position": [-2.0, 1.0, 0.45]},
            {"id": 3, "label": "desk", "size": [1.2, 0.6, 0.75], "position": [2.0, 1.6, 0.375]},
            {
                "id": 4,
                "label": "book",
                "color": "green",
                "size": [0.2, 0.15, 0.03],
                "position": [1.7, 1.7, 0.765],
                "support": 3,
            },
            {
                "id": 5,
                "label": "book",
                "color": "red",
                "size": [0.2, 0.15, 0.03],
                "position": [2.3, 1.7, 0.765],
                "support": 3,
            },
            {"id": 6, "label": "clock", "size": [0.3, 0.05, 0.3], "position": [-1.0, 1.97, 1.6], "support": "wall"},
        ],
    }
)
ROLLS, FALLS = (1.0, 3.0), ((0.5, 0.9), (2.0, 2.4))  # seconds


def moving() -> Scene:
    """For four seconds: the ball slides 4 m along x from 1 to 3 s, the books drop from the desk one after the other,
    and the clock turns half a turn a second."""
    scene = ROOM.build(detail=0.1)
    language = scene.language
    assert language is not None

    def ids(label: str, which: int = 0) -> NDArray[np.int64]:
        group = [g.id for g in language.groups if g.label == label][which]
        return np.asarray(scene.cloud.ids[scene.cloud.group == group].numpy())

    def dropped(which: int, start: float, stop: float) -> Track:
        share = np.linspace(0, 1, 9)
        path = np.stack([0 * share, -0.6 * share, -0.75 * share**2], axis=1)
        return Track.along(ids("book", which), start + (stop - start) * share, path, smooth=False)

    tracks = (
        Track.slide(ids("ball"), ROLLS, [0.0, 4.0], (1, 0, 0), smooth=False),
        dropped(0, *FALLS[0]),
        dropped(1, *FALLS[1]),
        Track.spin(ids("clock"), 0.5, (0, 1, 0), (-1.0, 1.97, 1.6)),
    )
    return scene.replace(motion=Motion(tracks, (), (), 0.0, 4.0))


@pytest.fixture(scope="module")
def session() -> Session:
    return Session(moving())


def said(session: Session, text: str) -> Answer:
    session.recall(None)
    return session.ask(text)


NEAR = 0.03  # seconds


@pytest.mark.parametrize(
    ("text", "value", "unit"),
    [
        ("when does the ball start to roll?", 1.0, "s"),
        ("when does the ball stop?", 3.0, "s"),
        ("how long does the ball roll?", 2.0, "s"),
        ("how long is the ball on the rug?", 0.5, "s"),
        ("when does the ball leave the rug", 2.5, "s"),
        ("when does the red book fall?", 2.0, "s"),
        ("when does the green book hit the floor?", 0.9, "s"),
        ("how much time is between the two falls of the books", None, ""),
        ("how much later does the red book fall than the green one?", 1.5, "s"),
        ("how far does the ball roll?", 4.0, "m"),
        ("how far does the ball roll in the first 2 seconds", 2.0, "m"),
        ("how fast is the ball at 2 s, in km/h", 7.2, "km/h"),
        ("how fast does the ball roll?", 2.0, "m/s"),
        ("how fast does the clock turn?", 0.5, "turns/s"),
        ("clock rpm", 30.0, "rpm"),
        ("how many turns does the clock make?", 2.0, ""),
        ("how many things move?", 4.0, ""),
        ("how many books fall?", 2.0, ""),
        ("how many books fall before 1.5 s", 1.0, ""),
        ("how many books have not fallen by 1.5 s?", 1.0, ""),
        ("how far does the ball roll as the crow flies?", 4.0, "m"),
        ("ball stop time", 3.0, "s"),
        ("until when does the ball roll?", 3.0, "s"),
        ("how long before the end of the clip does the ball stop?", 1.0, "s"),
        ("when has the ball crossed the rug?", 2.5, "s"),
        ("when have both books landed?", 2.4, "s"),
        ("the pause between the fall of the green book and that of the red one is how long", 1.1, "s"),
        ("how long is the pause between the fall of the green book and the fall of the red book?", 1.1, "s"),
        ("when has the clock made one full turn?", 2.0, "s"),
        ("how many times a minute does the clock turn?", 30.0, "rpm"),
        ("once the ball has stopped, how much of the film is left?", 1.0, "s"),
        ("from when the ball stops, how many seconds until the end?", 1.0, "s"),
        ("how fast does the ball roll between 1,0 s and 3,0 s?", 2.0, "m/s"),
        ("when does the chair move?", None, ""),
        ("when does the cat jump?", None, ""),
        ("when does the book fall?", None, ""),
        ("how many fall off the board altogether?", 2.0, ""),
        ("how many books are on the floor at 1.5 s?", 1.0, ""),
        ("turns per second of the clock?", 0.5, "turns/s"),
        ("how long is it from when the ball stops to the end of the film?", 1.0, "s"),
        ("by what second have both the books landed?", 2.4, "s"),
        ("total transit time of the ball from departure to final standstill?", 2.0, "s"),
        ("After leavin' the rug, how many seconds does the ball need to reach the desk?", None, ""),
        ("come two seconds, how many whole turns has that clock put behind it?", 1.0, ""),
        ("Does the ball roll far? I saw a chair. When does it stop?", 3.0, "s"),
    ],
)
def test_numbers(session: Session, text: str, value: float | None, unit: str) -> None:
    given = said(session, text)
    assert (given.answer is None) == (value is None) and given.unit == unit, given.text
    if value is not None:
        assert given.answer == pytest.approx(value, rel=0.02, abs=NEAR), given.text


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("does the chair move?", "no"),
        ("does the ball move?", "yes"),
        ("is the ball moving at 2 s?", "yes"),
        ("is the ball moving at 3.5 s?", "no"),
        ("does anything move?", "yes"),
        ("does the ball touch the chair?", "no"),
        ("is the ball on the rug at 2.2 s?", "yes"),
        ("is the ball on the rug?", "no"),
        ("is the ball ever on the rug?", "yes"),
        ("is the ball red the whole time?", "yes"),
        ("does the green book fall before the red one?", "yes"),
        ("is the red book on the floor at the end?", "yes"),
        ("is the red book on the floor at 1 s?", "no"),
        ("does the ball stop before 2 s?", "no"),
        ("does the chair stay where it is?", "yes"),
        ("which book falls first?", "green book"),
        ("which way does the red book go, up or down?", "down"),
        ("what moves between 1.2 and 1.8 s?", ("clock", "ball")),
        ("in what order do the books fall?", ("green book", "red book")),
        ("what colour is the book that falls last?", "red"),
        ("what does the ball cross?", "rug"),
        ("is the clock moving or still at 1 s?", "moving"),
        ("is the rug ever touched by the ball?", "yes"),
        ("does the chair get hit?", "no"),
        ("the ball never stops, does it?", "no"),
        ("does the ball come back?", "no"),
        ("does the ball go straight?", "yes"),
        ("does the ball roll from left to right?", "yes"),
        ("does only the ball move?", "no"),
        ("do the books fall at the same time?", "no"),
        ("do the ball and the cat move at the same time?", None),
        ("is the red book the last to fall?", "yes"),
        ("is the ball faster at 2 s than at 3.5 s?", "yes"),
        ("did the ball stop before or after 2 s?", "after"),
        ("which falls earlier, the red or the green book?", "green book"),
        ("what is the ball on at 2.2 s?", "rug"),
        ("which books have not fallen at 1.5 s?", "red book"),
        ("what has not fallen by 1.5 s?", "red book"),
        ("what has not fallen by 3 s?", ()),
        ("which books have fallen when the red book lands?", ("green book", "red book")),
        ("in what order does the ball pass the rug and the chair?", ("chair", "rug")),
        ("what does the ball do?", "moves to the right"),
        (
            "put in order: ball comes to rest, ball starts rolling, ball reaches rug",
            ("ball starts rolling", "ball reaches rug", "ball comes to rest"),
        ),
        ("sort the ball's events by time: stops, cat jumps, starts rolling", None),
        ("out of the chair, the ball and the desk, which never budge?", ("chair", "desk")),
        ("the ball comes to rest at 3 s, doesn't it?", "yes"),
        ("who moves the ball?", None),
        ("does the sofa move?", None),
        ("does a cat ever sit on the chair?", None),
        ("who turns off the clock?", None),
        ("who stops the ball?", None),
        ("please tell me, at 2.2 s the ball is rolling on which thing?", None),
        ("where is the ball at which second?", None),
    ],
)
def test_words(session: Session, text: str, value: str | tuple[str, ...] | None) -> None:
    given = said(session, text)
    assert given.answer == value, given.text


def test_what_falls_is_on_no_floor_until_it_lands(session: Session) -> None:
    """The green book drops from 0.5 to 0.9 s."""
    for time, on, yes in ((0.8, "air", "no"), (1.5, "floor", "yes")):
        assert said(session, f"what is the green book on at {time} s?").answer == on
        assert said(session, f"is the green book on the floor at {time} s?").answer == yes
    assert said(session, "is the green book on the desk at 0.8 s?").answer == "no"
    assert "in the air" in str(said(session, "where is the green book at 0.8 s?").answer)
    assert "book" not in str(said(session, "what is on the floor at 0.8 s?").answer)


def test_it_is_what_the_sentence_before_names(session: Session) -> None:
    assert said(session, "I have a chair here. Did it move at all?").answer == "no"
    assert said(session, "That ball is new. Did it move at all?").answer == "yes"
    assert said(session, "Somebody lost the cat. When does it move?").answer is None
    assert said(session, "I need a sound for the ball. How long should it last?").answer is None


def test_an_event_is_that_behind_the_one_it_is_told_after(session: Session) -> None:
    """The ball stands still from the start, and again from 3 s."""
    told = said(session, "how much time passes from when the ball starts to move until the ball is still?")
    assert told.answer == pytest.approx(2.0, abs=NEAR)


def test_an_answer_of_another_form_than_is_asked_for_gives_way(session: Session) -> None:
    """The rules read the first as a question for yes or no, and the second as one for a moment."""
    for text, form in (("Green book. Time of its departure?", float), ("which wall's the clock on?", str)):
        told = said(session, text).answer
        assert told is None or (isinstance(told, form) and told not in ("yes", "no"))
    assert said(session, "is the clock moving or still at 1 s?").answer == "moving"  # what it offers is its answer


def test_answers_show_the_time_that_they_are_about(session: Session) -> None:
    assert said(session, "when does the ball stop?").evidence.time == pytest.approx(3.0, abs=NEAR)
    given = said(session, "where is the red book at the end?")
    assert given.evidence.time == 4.0 and given.text.startswith("At 4 s: ")
    now = said(session, "where is the ball?")
    assert "(This is at 0 s; the ball moves from 1 s to 3 s.)" in now.text
    assert said(session, "how wide is the chair?").text.endswith("wide.")
    assert (
        "the film ends at 4 s" in said(session, "how long is it from when the ball stops to the end of the film?").text
    )
    assert said(session, "what does the ball do?").text.endswith("; then it stands still.")


def test_it_is_the_thing_that_was_asked_of(session: Session) -> None:
    session.recall(None)
    session.ask("does the ball move?")
    assert session.ask("when does it stop?").answer == pytest.approx(3.0, abs=NEAR)
    assert "time" in session.ask("when does it stop?").to_json()["evidence"]


def test_a_static_scene_says_that_nothing_moves() -> None:
    still = Session(moving().replace(motion=None))
    for text in ("when does the ball stop?", "what moved?", "how fast does the clock turn?", "which book falls first?"):
        given = still.ask(text)
        assert given.answer is None and given.text == "Nothing moves in this scene.", text
    assert still.ask("what colour is the ball?").answer == "red"


def test_what_is_hidden_then_has_no_place() -> None:
    session = Session(moving())
    session.do("hide the ball from 3.2 s on")
    answer = session.ask("where is the ball at 3.5 s?")
    assert not answer.answer and "not to be seen" in answer.text


@pytest.mark.parametrize("text", ["", "?", "..."])
def test_a_question_without_words_is_not_understood(text: str) -> None:
    assert "not understood" in Session(moving()).ask(text).text


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("What pace did the ball average on that run, in metres per second, from kick-off to standstill?", 2.0),
        ("What is the ball's mean speed between the kick and the moment it comes to rest?", 2.0),
        ("What percentage of the four seconds does the ball spend in motion?", 50.0),
        ("What percentage of the film shows the ball in motion?", 50.0),
        ("How long does the ball just lie there before it gets going?", 1.0),
        ("Through what angle has the clock turned after 2 s?", 360.0),
    ],
)
def test_times_that_are_told_by_a_movement(session: Session, text: str, value: float) -> None:
    assert said(session, text).answer == pytest.approx(value, rel=0.06)


def test_a_number_is_no_answer_for_yes_or_no(session: Session) -> None:
    assert not isinstance(said(session, "Does the clock turn a whole right angle, like 90 degrees?").answer, float)
