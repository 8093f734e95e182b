"""How answers to written questions and effects of written instructions about scenes with time are judged."""

from __future__ import annotations

import numpy as np
import pytest

from scenewright.benchmarks._motion.asking import judged
from scenewright.benchmarks._motion.instructing import _Effect, _wrong
from scenewright.benchmarks._motion.written import cases
from scenewright.gaussians.motion.motion import Motion, Track
from scenewright.gaussians.scene import Scene
from scenewright.planners.questions.answer import Answer
from tests.support.moving_blocks import blocks


def said(answer: object, unit: str = "", text: str = "") -> Answer:
    kind = "number" if isinstance(answer, float) else "list" if isinstance(answer, tuple) else "text"
    return Answer(answer=answer, answer_type=kind, text=text, unit=unit)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("expect", "answer", "outcome"),
    [
        ({"kind": "seconds", "value": 3.5, "tolerance": 0.3}, said(3.3, "s"), "right"),
        ({"kind": "seconds", "value": 3.5, "tolerance": 0.3}, said(3.1, "s"), "wrong"),
        ({"kind": "seconds", "value": 3.5, "tolerance": 0.3}, said(3.5, "m"), "wrong"),
        ({"kind": "number", "value": 60, "tolerance": 4, "unit": "rpm"}, said(1.0, "turns/s"), "right"),
        ({"kind": "number", "value": 2, "tolerance": 0.7, "unit": "cm"}, said(0.02, "m"), "right"),
        ({"kind": "yesno", "value": True}, said("yes"), "right"),
        ({"kind": "yesno", "value": True}, said(None), "refused"),
        ({"kind": "refuse", "value": None}, said(None), "right"),
        ({"kind": "refuse", "value": None}, said("no"), "wrong"),
        ({"kind": "names", "value": ["top drawer"]}, said(("drawer",)), "right"),
        ({"kind": "names", "value": ["red book"]}, said(("red book", "blue book")), "wrong"),
        ({"kind": "place", "value": "table"}, said("on it", text="It is on the table."), "right"),
        ({"kind": "order", "value": ["red book", "blue book"]}, said(("blue book", "red book")), "wrong"),
    ],
)
def test_answers_are_judged(expect: dict[str, object], answer: Answer, outcome: str) -> None:
    assert judged(expect, answer) == outcome


THINGS = {
    "cart": ((0.0, 0.0, 0.1), (0.2, 0.2, 0.2)), "post": ((2.0, 0.0, 0.5), (0.2, 0.2, 1.0)),
    "floor": ((0.0, 0.0, -0.01), (8.0, 8.0, 0.02)),
}  # fmt: skip
DRIVES = {"kind": "path", "thing": "cart", "start": 1, "stop": 3, "toward": "post", "distance_m": 1.8, "duration_s": 2}


def driving(start: float, stop: float, way: float) -> Scene:
    return blocks(
        THINGS, lambda ids: Track.slide(ids("cart"), [start, stop], [0, way], (1, 0, 0), smooth=False), stop=5.0
    )


def test_effects_are_judged_by_what_they_change() -> None:
    still = driving(1, 3, 0.5).replace(motion=Motion((), (), (), 0.0, 5.0))
    assert _wrong(DRIVES, _Effect(still, driving(1, 3, 1.8))) == ""
    assert "begins at 2.0" in _wrong(DRIVES, _Effect(still, driving(2, 4, 1.8)))
    assert "moves by 1.00 m" in _wrong(DRIVES, _Effect(still, driving(1, 3, 1.0)))
    assert _wrong(DRIVES, _Effect(still, still)) == "it does not move"
    assert "the cart moves, too" in _wrong(DRIVES | {"thing": "post", "factor": 0}, _Effect(still, driving(1, 3, 1.8)))
    twice = {"kind": "pace", "thing": "cart", "factor": 2, "stop": 2}
    assert _wrong(twice, _Effect(driving(1, 3, 1.0), driving(1, 2, 1.0))) == ""
    assert "times the former" in _wrong(twice | {"factor": 3}, _Effect(driving(1, 3, 1.0), driving(1, 2, 1.0)))


def test_several_things_are_judged_by_the_first_and_the_last() -> None:
    def both(start: float) -> Scene:
        return blocks(
            {**THINGS, "box": ((0.0, 2.0, 0.1), (0.2, 0.2, 0.2))},
            lambda ids: Track.slide(ids("cart"), [start, start + 1], [0, 1], (1, 0, 0), smooth=False),
            lambda ids: Track.slide(ids("box"), [start + 1, start + 2], [0, 1], (1, 0, 0), smooth=False),
            stop=5.0,
        )

    expect = {"kind": "pace", "thing": ["cart", "box"], "start": 2, "stop": 4}
    assert _wrong(expect, _Effect(both(1.0), both(2.0))) == ""
    assert _wrong(expect, _Effect(both(1.0), both(1.0))) == "they begin at 1.00 s"


def test_hidden_things_are_gone_for_that_time_only() -> None:
    import torch

    from scenewright.gaussians.motion.motion import Look

    scene = driving(1, 3, 1.0)
    assert scene.motion is not None
    look = Look(np.arange(125), 2.0, 3.0, None, torch.zeros(125))
    hidden = scene.replace(motion=scene.motion.replace(looks=(look,)))
    expect = {"kind": "hide", "thing": "cart", "start": 2, "stop": 3}
    assert _wrong(expect, _Effect(scene, hidden)) == ""
    assert "it is there" in _wrong(expect | {"stop": 4}, _Effect(scene, hidden))
    assert _wrong({"kind": "refuse", "thing": "cat"}, _Effect(scene, hidden)) == "something was done"


def test_what_was_seen_and_what_is_held_back_are_others() -> None:
    for name in ("questions", "instructions"):
        seen, held = cases(name), cases(f"held_{name}")
        assert len(seen) == 120 and len(held) > 50
        for found in (seen, held):
            assert {c["room"] for c in found} == {"ball", "door", "drawer", "fan", "books", "toy"}
        assert not {c["text"].lower() for c in seen} & {c["text"].lower() for c in held}


def test_what_must_stand_still_may_stand_still_for_a_while() -> None:
    before, after = driving(0, 4, 1.0), driving(0, 2, 1.0)
    still = {"kind": "pace", "thing": "cart", "start": 2.0, "stop": None, "frozen": True}
    assert _wrong(still, _Effect(before, after)) == ""
    assert "it moves between" in _wrong(still | {"start": 1.0}, _Effect(before, after))


def test_a_thing_is_found_by_its_whole_name_and_its_place_in_a_stack() -> None:
    size = (0.2, 0.2, 0.2)
    scene = blocks({
        "door frame": ((0.0, 0.0, 0.1), size), "door": ((1.0, 0.0, 0.1), size), "drawer 1": ((2.0, 0.0, 0.9), size),
        "drawer 2": ((2.0, 0.0, 0.1), size), "drawer 3": ((2.0, 0.0, 0.5), size),
    })  # fmt: skip
    effect = _Effect(scene, scene)
    assert [effect.group(n) for n in ("door", "top drawer", "middle drawer", "bottom drawer")] == [1, 2, 4, 3]


def test_what_cannot_be_seen_is_hidden() -> None:
    scene = driving(1, 3, 0.5)
    clear = scene.cloud.replace(opacities=scene.cloud.opacities.masked_fill(scene.cloud.group == 1, 0.0))
    hides = {"kind": "hide", "thing": "post", "start": None, "stop": None}
    assert _wrong(hides, _Effect(scene, scene.replace(cloud=clear))) == ""
    assert "there" in _wrong(hides, _Effect(scene, scene))
