"""A thousand spoiled replies of a vision model: none crashes, none is believed, none reaches a terminal raw."""

from __future__ import annotations

import json
import unicodedata
from collections import Counter

import pytest
from scripted_looker import ScriptedLooker
from scripted_model import ScriptedModel

from scenewright.benchmarks._ask.hostile_replies import COUNT, GOOD, NUMBERS, ORDERS, spoiled
from scenewright.planners.model.prompt.labels import plain
from scenewright.planners.plan import NoPlanError
from scenewright.planners.questions.answer import Answer
from scenewright.planners.vision.answering import Terms, ask_about
from scenewright.planners.vision.asking import Purse
from scenewright.planners.vision.captions import captions
from scenewright.planners.vision.facts import Facts
from scenewright.planners.vision.judging import verdict
from scenewright.planners.vision.pointing import point


def sound(text: str, most: int) -> None:
    assert len(text) <= most and not any(unicodedata.category(c)[0] == "C" for c in text)


def check_answer(answer: Answer) -> str:
    sound(answer.text, 1500)
    assert 0 <= answer.confidence <= 1
    assert set(answer.evidence.ids) <= {10, 20, 30} and len(answer.evidence.views) <= 8
    if isinstance(answer.answer, str):
        sound(answer.answer, 400)
    assert (answer.source == "none") == (answer.answer is None)
    json.dumps(answer.to_json(), allow_nan=False)
    return answer.source


def heard(kind: str, text: str) -> str:
    """What becomes of a spoiled reply: "used" as far as it is valid, or "none"."""
    looker, backend = ScriptedLooker(size=(4, 4)), ScriptedModel(text, sees=True)
    if kind == "ask":
        answer = ask_about("is it tidy?", Facts(), looker, backend, Terms(samples=1, first=1))
        return {"vlm": "used", "none": "none"}[check_answer(answer)]
    try:
        if kind == "caption":
            found = captions([10, 20, 30], Facts(), looker, backend, Purse(views=1))
            sound(found.scene, 400)
            for group, caption in found.groups.items():
                assert group in (10, 20, 30) and (not caption.name or plain(caption.name))
                sound(caption.text, 240)
        elif kind == "judge":
            shown = looker.overview((), 2)
            judged = verdict("delete the cup", shown[:1], shown[1:], backend)
            sound(judged.reason, 400)
            assert all(
                isinstance(f, bool) for f in (judged.done, judged.right_thing, judged.residue, judged.looks_right)
            )
            assert len(judged.side_effects) <= 8
        else:
            meant = point("the cup", (), looker, backend, Purse(views=2))
            sound(meant.because, 300)
            assert set(meant.groups) <= {10, 20, 30} and 0 <= meant.confidence <= 1
    except NoPlanError as error:
        sound(str(error), 600)
        return "none"
    return "used"


@pytest.mark.parametrize("kind", GOOD)
def test_the_unspoiled_reply_is_used(kind: str) -> None:
    assert heard(kind, json.dumps(GOOD[kind])) == "used"


@pytest.mark.parametrize("count", [300, pytest.param(COUNT, marks=pytest.mark.slow)])
def test_a_thousand_spoiled_replies(count: int) -> None:
    kinds = sorted(GOOD)
    outcomes = Counter(
        heard(kinds[seed % len(kinds)], spoiled(kinds[seed % len(kinds)], seed)) for seed in range(count)
    )
    assert outcomes.total() == count
    assert (
        outcomes["none"] > count / 2
    )  # what still is used was spoiled within its limits, as by an optional field gone


def test_what_is_used_is_only_what_the_schema_allows() -> None:
    """A reply whose decisive field is replaced by words or numbers out of range is never believed."""
    for value in (*(v for v in ORDERS if v != "yes"), *NUMBERS):
        if isinstance(value, int) and value > 10**300:
            continue
        reply = GOOD["ask"] | {"answer": value, "need_more": ["plan"]}
        assert heard("ask", json.dumps(reply)) == "none"


def test_the_generator_is_seeded_and_varied() -> None:
    made = [spoiled("ask", seed) for seed in range(200)]
    assert made == [spoiled("ask", seed) for seed in range(200)] and len(set(made)) > 130
