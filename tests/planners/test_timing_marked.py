"""Wishes about motion that no rule reads are told by their kind, and only where nothing that they name is left out."""

from __future__ import annotations

from typing import Any

import pytest

from scenewright.planners.grammar.planner import SUPPOSED, GrammarPlanner, _operations, _thing
from scenewright.planners.grammar.timing.marked.events import told_by_event
from scenewright.planners.grammar.timing.marked.kinds import is_clear, likely, marked
from scenewright.planners.grammar.timing.marked.lost import leaves_out
from scenewright.planners.grammar.timing.reading import TimeReader
from scenewright.tools.when import When
from scenewright.training.timed_words import FILES
from scenewright.training.wording import sentences

PLANNER = GrammarPlanner()


def planned(text: str) -> list[dict[str, Any]]:
    return [op.model_dump(exclude_defaults=True, mode="json") | {"op": op.op} for op in PLANNER.plan(text).ops]


KINDS = [
    ("the swing is much too wild for me, calm it down", "speed"),
    ("nobody should see the ladder until the cat jumps", "hide"),
    ("let's have the gate remain wide open, no shutting", "stay"),
    ("could the train hold for two seconds at the platform", "pause"),
    ("i'd rather the windmill ran the opposite way", "reverse"),
    ("those two cars ought to set off at the same moment", "together"),
    ("give the bench a coat of green once the tram has left", "recolor"),
    ("the lift goes up far too late, have it begin at one second", "begin"),
]


@pytest.mark.parametrize(("text", "kind"), KINDS)
def test_the_kind_of_a_wish_is_told(text: str, kind: str) -> None:
    """None of these was learned from."""
    assert text not in {sentence.said for sentence in sentences(FILES["wishes"])}
    assert likely(text)[0][0] == kind


@pytest.mark.parametrize(
    "text", ["what a lovely film", "when does the ball stop?", "the lamp could be a bit brighter", "is the door open?"]
)
def test_what_is_no_wish_about_motion_has_no_kind(text: str) -> None:
    assert likely(text) == []


@pytest.mark.parametrize(
    ("text", "plainly"),
    [
        ("It makes me dizzy, that fan, let it turn half as fast.", "play the fan at half speed"),
        ("While it's on the rug I'd love the ball to be yellow, then red again afterwards.",
         "make the ball yellow while it is on the rug"),
        ("Could the middle drawer be pink while the top one is sliding out, please?",
         "make the middle drawer pink while the top drawer is opening"),
        ("The robot, he should change to orange when he arrives at the bed.",
         "make the robot orange when it arrives at the bed"),
        ("Stretch the red book's fall to two seconds, I want to see it in the air.", "let the red book fall in 2 s"),
        ("The blue book stays up on the shelf, it doesnt fall.", "keep the blue book still"),
        ("Sorry, the coat rack looks so messy, can we not see it in the last two seconds",
         "hide the coat rack for the last two seconds"),
        ("ball is way too slow, i want it going twice as fast", "play the ball twice as fast"),
        ("Keep the fan going right to the end will you, no stopping at four", "let the fan keep turning"),
        ("Have the car spin on the spot once the robot parks at the bed, folks love that",
         "let the car spin once the robot has stopped"),
        ("Desk slides over to the bookshelf, three secs to four, let's go",
         "move the desk to the bookshelf from 3 s to 4 s"),
        ("fan off at 2 seconds please, it's giving me a headache", "stop the fan at 2 s"),
        ("i want the books to fall in super slow mo like 4 times slower", "play the books at quarter speed"),
    ],
)  # fmt: skip
def test_a_wish_is_planned_as_a_plain_command_of_its_kind(text: str, plainly: str) -> None:
    assert planned(text) == planned(plainly) != []


@pytest.mark.parametrize(
    "text",
    [
        "have the lift rise one second earlier and more slowly",  # two wishes
        "the ball could go slower, and when the cat jumps, turn green",  # a time that belongs to one of them
        "i fancy the drawer coming out twice as far at 2 s",  # how far cannot be told in times
        "snorkle the fan until 3 s",  # no word
        "never paint the robot green while it walks",  # a prohibition
    ],
)
def test_nothing_that_is_named_is_left_out(text: str) -> None:
    assert PLANNER.plan(text).ops == ()


def test_a_plan_says_that_it_was_supposed_and_is_not_sure() -> None:
    text = "It makes me dizzy, that fan, let it turn half as fast."
    assert PLANNER.plan(text).reason == SUPPOSED
    assert not PLANNER.is_sure(text) and PLANNER.is_sure("play the fan at half speed")


@pytest.mark.parametrize(
    ("text", "tag", "said"),
    [
        ("make the kettle blue once the tram has gone by", "from", "once the tram has gone by"),
        ("let the swing take three seconds for it, not two", "not", ", not two"),
        ("push the crate over to the wall by the end of the film", "to", "by the end of the film"),
        ("push the crate over to the wall by the end of the film", "y", "the wall"),
        ("lower the flag by half a metre, it looks odd", "by", "by half a metre"),
    ],
)
def test_words_are_marked(text: str, tag: str, said: str) -> None:
    words = text.replace(",", " ,").split()
    assert said in [" ".join(words[start:stop]) for own, start, stop in marked(words) if own == tag]


@pytest.mark.parametrize(
    ("text", "plainly"),
    [
        ("the red book is to hang in the air halfway down for one second, then drop on", None),
        ("I'd love the vase to twirl about itself two times a second while the fan is turning",
         "spin the vase two times a second while the fan turns"),
        ("once it's open give it a second, then close the door again", None),
    ],
)  # fmt: skip
def test_halfway_rates_and_lengths_of_what_happens(text: str, plainly: str | None) -> None:
    ops = planned(text)
    if plainly is not None:
        assert ops == planned(plainly) != []
    elif "halfway" in text:
        assert ops[0]["change"] == "stop" and ops[0]["when"]["lasting"] == 1.0
        assert ops[0]["when"]["during"] == {"state": "halfway", "part": "from"}
    else:
        assert ops[0]["when"]["start"] == 1.0 and ops[0]["when"]["during"] == {"state": "fully_open", "part": "from"}


@pytest.mark.parametrize(
    "text",
    [
        "slow mo the blue book, like it takes 2 whole seconds to fall, and 4 for the red one",  # a number too many
        "By the time the drawer is out I want the chair over at the bed at 1 second, at 2 seconds.",
    ],
)
def test_no_time_number_or_colour_is_lost(text: str) -> None:
    assert planned(text) == []


def test_words_about_a_course_delete_nothing() -> None:
    text = "would it be possible for the robot to set off at 1 second, so the room gets a moment alone"
    assert planned(text) == planned("let the robot start at 1 s") != []


@pytest.mark.parametrize(
    "text",
    [
        "don't remove the ball when it stops",  # asks for nothing
        "speed up the first half of the ball's roll",  # a part of a movement
        "make everything twice as slow but the fan",
        "the ball must not turn red while it rolls",
    ],
)
def test_the_contrary_is_not_done(text: str) -> None:
    assert planned(text) == []


def test_what_is_kept_is_not_removed() -> None:
    (op,) = planned("Keep the crib and the rocking chair, nothing else.")
    assert op["op"] == "isolate" and op["target"]["text"] == "crib"


def test_to_stop_at_the_end_goes_without_saying() -> None:
    assert planned("let the door swing to 45 degrees then stop") == planned("let the door swing to 45 degrees") != []
    assert planned("freeze everything at 2.5") == planned("stop everything at 2.5 s") != []


def test_what_comes_back_was_hidden() -> None:
    assert planned("the ball should be gone from 2 s on, then come back at 4") == planned("hide the ball from 2 to 4 s")
    assert planned("let the ball roll up the wall") == []
    assert planned("paint the door blue before it opens and red afterwards") == []


def test_a_share_in_percent_is_in_the_plan() -> None:
    (op,) = planned("make the ball 30 percent slower after 1 second")
    assert op["factor"] == pytest.approx(0.7)


@pytest.mark.parametrize(
    ("text", "plainly"),
    [  # kinds that are not the likeliest, but that a word says
        (
            "I would like the ball to wait till two seconds have gone before it sets off",
            "keep the ball still until 2 s",
        ),
        ("so the mirror, hide the mirror from two to four seconds", "hide the mirror from 2 to 4 s"),
        ("car shouldnt be there at first, make it spawn at 3 seconds", "hide the car until 3 s"),
    ],
)
def test_a_less_likely_kind_is_taken_where_a_word_says_it(text: str, plainly: str) -> None:
    assert planned(text) == planned(plainly) != []


def test_a_kind_is_clear_by_chance_or_by_words() -> None:
    assert is_clear("halt", 0.5, "freeze it") and not is_clear("halt", 0.5, "it at 2 s")
    assert is_clear("halt", 0.95, "it at 2 s")
    assert not is_clear("hide", 0.5, "keep it away") and is_clear("hide", 0.5, "it vanishes")


def test_one_colour_after_another_has_the_time_after_it() -> None:
    for text, stop in (
        ("make the ball green until 2 s, then yellow", 2.0),
        ("paint it green for 1 s, then yellow", 1.0),
    ):
        green, yellow = planned(text)
        assert (green["color"], yellow["color"], yellow["when"]) == ("green", "yellow", {"start": stop})
    assert planned("make the ball red for the first 2 seconds then green again") == planned(
        "make the ball red until 2 s"
    )


@pytest.mark.parametrize(
    "text",
    [
        "make the ball red while it rolls, it should stay blue otherwise",
        "make the ball green before the robot comes over",
        "the ball should not disappear at 2 s",
        "let the door open quickly and the drawer slowly",
        "the door closes too late",
        "hide the vase from 1 to 2 s, except in the mirror",
    ],
)
def test_half_of_a_wish_is_not_done(text: str) -> None:
    assert planned(text) == []


@pytest.mark.parametrize(
    ("text", "change", "state"),
    [
        ("could u have the drawer come out slower, take 2 seconds over it", "begin", "opening"),
        ("the drawer should close twice as fast", "speed", "closing"),
        ("let the drawer close one second earlier", "later", "closing"),
    ],
)
def test_one_of_two_movements_is_meant(text: str, change: str, state: str) -> None:
    (op,) = planned(text)
    assert (op["change"], op["when"]["during"]["state"]) == (change, state)


def test_times_by_what_things_do() -> None:
    (op,) = planned("make the door stop for a second when it is half open")
    assert op["when"] == {"lasting": 1.0, "during": {"state": "halfway", "part": "from"}}
    (op,) = planned("let the robot wait halfway for one second")
    assert op["when"]["during"]["state"] == "halfway"
    (op,) = planned("make the ball red until the fall of the book is over")
    assert op["when"]["during"] == {"state": "moving", "of": {"text": "book"}, "part": "until_end"}
    (op,) = planned("make the wardrobe green while the drawer is going out")
    assert op["when"]["during"] == {"state": "opening", "of": {"text": "drawer"}}


@pytest.mark.parametrize(
    ("text", "when"),
    [
        (
            "make the robot red from when it turns until it reaches the bed",
            {
                "during": {"state": "turning", "part": "from"},
                "until": {"state": "touches", "anchors": [{"text": "bed"}], "part": "until"},
            },
        ),
        (
            "turn the bed blue when the drawer has come out until it starts to go in again",
            {
                "during": {"state": "opening", "of": {"text": "drawer"}, "part": "after"},
                "until": {"state": "closing", "of": {"text": "drawer"}, "part": "until"},
            },
        ),
        (
            "could the sofa turn green from 2 s until the ball comes to rest?",
            {"start": 2.0, "until": {"state": "moving", "of": {"text": "ball"}, "part": "until_end"}},
        ),
        (
            "have the robot go blue after it turns, then green again when it gets to the bed",
            {
                "during": {"state": "turning", "part": "after"},
                "until": {"state": "touches", "anchors": [{"text": "bed"}], "part": "until"},
            },
        ),
    ],
)
def test_a_time_may_begin_and_end_with_what_happens(text: str, when: dict[str, Any]) -> None:
    (op,) = planned(text)
    assert op["op"] == "recolor" and op["when"] == when


@pytest.mark.parametrize(
    ("text", "change"),
    [
        ("the red book should float down, give it two full seconds to reach the floor", {"when": {"lasting": 2.0}}),
        ("The ball crawls. It should take half a second.", {"when": {"lasting": 0.5}}),
        (
            "the train ought to start only after one second; until then it should be motionless",
            {"when": {"start": 1.0}},
        ),
        ("make the ball wait another second before it sets off", {"change": "later", "seconds": 1.0}),
        ("Hold the drawer back a touch, everything it does half a second later", {"change": "later", "seconds": 0.5}),
    ],
)
def test_how_long_and_how_much_later(text: str, change: dict[str, Any]) -> None:
    (op,) = planned(text)
    assert op["op"] == "pace" and change.items() <= op.items()


@pytest.mark.parametrize(
    ("text", "op", "color"),
    [
        ("for the first second and a half I want the bed in navy blue", "recolor", "navy"),
        ("could the sofa read as a deep green from 2 s on", "recolor", "deep green"),
        ("white door please, from the moment it begins to move", "recolor", "white"),
    ],
)
def test_colours_of_several_words(text: str, op: str, color: str) -> None:
    (made,) = planned(text)
    assert (made["op"], made["color"]) == (op, color)


@pytest.mark.parametrize(
    "text",
    [
        "get the robot there by 3 seconds, he's dawdling",  # hides nothing
        "I think the ball should only roll about two metres and then have a rest",  # puts no rest in
    ],
)
def test_operations_are_those_of_the_likeliest_kind(text: str) -> None:
    (op,) = planned(text)
    assert op["op"] == "pace"


@pytest.mark.parametrize(
    "text",
    [
        "let the ball roll to the wall in 2 s, I want it to explode there",
        "flash the desk red each time a book lands",
    ],
)
def test_what_no_operation_tells_is_refused(text: str) -> None:
    assert planned(text) == []


@pytest.mark.parametrize(
    ("text", "first"),
    [
        ("it is the blue book who must fall the first, before the red and the green", "blue red green"),
        ("The order is wrong: the blue book should fall first, then the green, and lastly the red.", "blue green red"),
        ("swap the order: blue book comes down first, then green, red one last", "blue green red"),
        ("I'd prefer the green book falling first, before the red one", "green red"),
        ("the red book is to fall after the blue one", "blue red"),
        ("let the red ball and the green ball fall after the blue ball", "blue red green"),
        ("have the red block go last, and the blue block just before it, the green block leading", "green blue red"),
        (
            "New falling order: number one the blue book, number two the red one, number three the green one.",
            "blue red green",
        ),
        ("the books should fall like this: 1. green, 2. blue, 3. red", "green blue red"),
        ("Let the red book fall in the middle: after the blue one, before the green one.", "blue red green"),
        ("Start with the blue book, finish with the green one, the red one in between.", "blue red green"),
        ("I would rather the books fell from right to left: blue, green, red.", "blue green red"),
        ("the green book is to fall first, the red one second; the blue one can stay third", "green red"),
        ("Could the blue book jump the queue and drop before the other two?", "blue"),
    ],
)
def test_an_order_is_told_by_colours(text: str, first: str) -> None:
    (op,) = planned(text)
    assert op["op"] == "order" and [c for q in op["first"] for c in q["colors"]] == first.split()


@pytest.mark.parametrize(
    ("text", "when"),
    [
        ("I'd love the vase yellow from halfway through till the end", {"start": "middle"}),
        ("give the fan a rest from one second to two and a half, then off she goes again", {"start": 1.0, "stop": 2.5}),
        ("can the door shut again at the end, say from four seconds", {"start": 4.0}),
        ("paint the robot red from when it turns till it reaches the bed, then return it to green", None),
        ("As the door begins to open, let the plant disappear, and bring it back when the door is fully open.", None),
        ("turn the bed red once the drawer is fully out, and back to normal when it starts to slide back", None),
    ],
)
def test_times_with_two_ends(text: str, when: dict[str, object] | None) -> None:
    (op,) = planned(text)
    if when is None:
        assert op["when"]["during"]["part"] == "from" and op["when"]["until"]["part"] == "until"
    else:
        assert op["when"] == when


@pytest.mark.parametrize(
    ("text", "op"),
    [
        ("I'd love the wardrobe painted pink for my little girls", "recolor"),
        ("Could the vase be cream instead of blue? It'd match the linens.", "recolor"),
        ("I would love the coffee table gone, it only gets in our way", "delete"),
        ("Coat rack's in the way of the shot. Get rid of it.", "delete"),
        ("The wardrobe would show far better in white, if you can manage that", "recolor"),
        ("bottom drawer can be red i guess", "recolor"),
        ("remove the chair, too cluttered", "delete"),
    ],
)
def test_wishes_without_a_time(text: str, op: str) -> None:
    (made,) = planned(text)
    assert made["op"] == op and "when" not in made


@pytest.mark.parametrize(
    "text",
    [
        "I would like to know whether the sofa is red",
        "the neighbours think the sofa is red",
        "is the wardrobe painted pink in all of the pictures?",
        "my granddaughter has the same bed in pink",
        "how about not making the sofa blue",
        "I would like the sofa to be anything but blue",
        "will the lamp be red",
        "please check the lamp is red",
        "I said I want the sofa blue yesterday",
        "it would look better if you left the sofa blue",
        "take the blue sofa apart",
        "the sofa would look better blue, but leave it",
        "bin it or paint the lamp red",
        "do not be alarming",
        "lower the lamp to 30 cm off the floor at 2 s",
    ],
)
def test_what_tells_or_asks_paints_nothing(text: str) -> None:
    assert planned(text) == []


def test_words_are_read_as_they_are_spoken() -> None:
    for spoken, written in (
        ("don't be openin that door till 3 seconds", "don't start opening that door till 3 seconds"),
        ("hide the lamp soon as the ball stops rollin", "hide the lamp as soon as the ball stops rolling"),
    ):
        assert planned(spoken) == planned(written) != []
    assert planned("move the basin to the cabin") == planned("Move the basin to the cabin.")


@pytest.mark.parametrize(
    "text",
    [
        "the red ball fell before the blue ball",
        "I see the red ball fall first and the blue ball last",
        "between the red ball and the blue ball the green ball should fall",
    ],
)
def test_what_tells_no_order_orders_nothing(text: str) -> None:
    assert not any(op["op"] == "order" for op in planned(text))


def test_what_ends_a_look_is_about_what_began_it() -> None:
    (red,) = planned("paint the lamp red when the drawer opens and back to normal when it slides back")
    assert (red["when"]["during"]["state"], red["when"]["until"]["state"]) == ("opening", "closing")
    (red,) = planned("paint the lamp red once the ball hits the floor and revert when it rolls off it")
    assert red["when"]["until"]["anchors"] == [{"text": "floor"}]


def test_a_motion_is_changed_as_its_kind_says() -> None:
    (repeat,) = planned("do the red book falling again at 3 secs, that was funny")
    assert repeat["change"] == "repeat"
    (still,) = planned("turn that fan off after 2 seconds, I get cold just looking at it")
    assert (still["op"], still["change"], still["when"]) == ("pace", "stop", {"start": 2.0})


def test_what_only_tells_where_or_when_is_not_removed() -> None:
    for text in (
        "I'm afraid I don't care for the umbrella stand beside the bench; could you take it away?",
        "That bedside lamp is too bright, could you get rid of it when the drawer closes?",
    ):
        assert all(op["target"]["text"] not in ("bench", "drawer") for op in planned(text))


def test_where_something_goes_by_itself_may_be_named() -> None:
    (stop,) = planned("the robot should pause for one second where it turns, then continue walking to the bed po")
    assert (stop["change"], stop["when"]["lasting"], stop["when"]["during"]["state"]) == ("stop", 1.0, "turning")
    assert planned("stop the fan at 2 s, and the lamp should sing") == []


def test_what_is_turned_slowly_over_all_of_a_time_takes_all_of_it() -> None:
    (turn,) = planned("I want to see the vase rotate gently, one full turn over the last two seconds.")
    assert turn["when"] == {"start": -2.0, "stop": "end"}
    (turn,) = planned("have the plant turn around once, slowly, over the whole film")
    assert turn["when"] == {"stop": "end"}


def test_one_begins_when_the_other_has_stopped() -> None:
    (begin,) = planned("the red book should fall last, after the blue one")
    assert begin["change"] == "begin" and begin["target"]["colors"] == ["red"]
    assert begin["when"]["during"] == {"state": "moving", "of": {"text": "book", "colors": ["blue"]}, "part": "after"}


def test_what_travels_the_other_way_goes_back() -> None:
    (back,) = planned("Could we have the ball travelling the other way, starting from the wall?")
    assert (back["op"], back["change"]) == ("pace", "reverse")


@pytest.mark.parametrize(
    ("phrase", "during"),
    [
        ("on fan stop", {"state": "moving", "of": {"text": "fan"}, "part": "after"}),
        ("having made its turn", {"state": "turning", "of": {"last": True}, "part": "after"}),
        ("the second the drawer is all the way out", {"state": "fully_open", "of": {"text": "drawer"}, "part": "from"}),
        ("until the ball bumps into the wall",
         {"state": "touches", "anchors": [{"text": "wall"}], "of": {"text": "ball"}, "part": "until"}),
        ("for as long as the gate stays ajar", {"state": "open", "of": {"text": "gate"}}),
    ],
)  # fmt: skip
def test_times_are_told_by_what_happens(phrase: str, during: dict[str, Any]) -> None:
    """None of these was learned from."""
    assert phrase not in {sentence.said for sentence in sentences(FILES["events"])}
    tag = "to" if phrase.startswith("until") else "in" if phrase.startswith("for") else "from"
    told = told_by_event(tag, phrase, TimeReader(_operations, _thing).thing)
    assert told is not None and told[1] is not None
    assert told[1].during.model_dump(exclude_defaults=True, mode="json") == during


@pytest.mark.parametrize("phrase", ["at 2 s", "twice as fast", "", "when the snork frobs", "before it comes over"])
def test_what_tells_no_happening_tells_no_time(phrase: str) -> None:
    assert told_by_event("from", phrase, TimeReader(_operations, _thing).thing) is None


@pytest.mark.parametrize(
    ("text", "plainly"),
    [
        ("bed and shelf, both in blue for the whole film", "make the bed and the shelf blue for the whole film"),
        ("on fan stop, the vase goes red", "make the vase red once the fan has stopped"),
    ],
)
def test_marks_make_commands(text: str, plainly: str | None) -> None:
    ops = planned(text)
    if plainly is not None:
        assert (
            [(op["op"], op.get("color"), op.get("when")) for op in ops]
            == [(op["op"], op.get("color"), op.get("when")) for op in planned(plainly)]
            != []
        )
    else:
        assert ops[0]["change"] == "stop" and ops[0]["when"]["lasting"] == 0.5
        assert ops[0]["when"]["during"]["state"] == "turning" and ops[0]["when"]["during"]["part"] == "from"


def test_a_number_of_a_time_is_never_left_out() -> None:
    """Other numbers may be, where no time has its unit: "the door shuts four times"."""
    words, spans = ["the", "door", "shuts", "by", "four", "and", "a", "half"], [("x", 0, 2), ("to", 3, 7)]
    assert leaves_out(words, ({"op": "articulate"},), spans=spans)
    assert not leaves_out(words, ({"op": "articulate", "when": When(stop=4.5)},), spans=spans)
    assert not leaves_out(["the", "door", "shuts", "four", "times"], ({"op": "articulate"},), spans=[("x", 0, 2)])


def test_a_color_in_an_order_is_a_thing_unless_it_is_denied() -> None:
    spans, op = [("not", 0, 2), ("x", 3, 4), ("x", 5, 6)], {"op": "order", "first": ["red book", "blue book"]}
    assert leaves_out(["rather", "green", "then", "red", "then", "blue"], (op,), spans=spans)
    assert not leaves_out(["not", "green", "then", "red", "then", "blue"], (op,), spans=spans)


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("I'd rather nobody saw the sofa until the fan has stopped", "hide"),
        ("the cart should take half a second", "duration"),
    ],
)
def test_words_that_say_a_kind_are_of_it(text: str, kind: str) -> None:
    assert likely(text)[0][0] == kind
