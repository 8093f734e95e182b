"""The grammar planner on its written set, and the laws that hold for every instruction."""

from __future__ import annotations

import json
import string
from pathlib import Path
from typing import Any

import pytest
from amounts import some
from hypothesis import example, given, settings
from hypothesis import strategies as st
from same_plan import same

from scenewright.gaussians.errors import UserError
from scenewright.planners import EditPlan, load
from scenewright.planners.grammar import GrammarPlanner
from scenewright.planners.grammar.tagging.words import MAX_CHARS
from scenewright.tools import registry

CASES: list[dict[str, Any]] = [
    json.loads(line) for line in (Path(__file__).parent / "instructions.jsonl").read_text(encoding="utf-8").splitlines()
]
EDITS = [c for c in CASES if "ops" in c]
PLANNER = GrammarPlanner()


@pytest.mark.parametrize("case", CASES, ids=[c["text"] for c in CASES])
def test_written_instruction(case: dict[str, Any]) -> None:
    plan = PLANNER.plan(case["text"], previous=case.get("previous"))
    assert plan.verdict == case.get("verdict", "ok"), plan.reason
    assert plan.ops == tuple(registry.parse(op) for op in case.get("ops", ()))
    if "unknown" in case:
        assert plan.unknown == tuple(case["unknown"])


def test_set_is_large_and_varied() -> None:
    kinds = {c["kind"] for c in CASES}
    assert len(CASES) >= 150
    assert kinds >= {"simple", "compound", "relation", "attribute", "negation", "quantity", "colloquial"}
    assert len({(c["text"], c.get("previous")) for c in CASES}) == len(CASES)


edits = st.sampled_from(EDITS)
POLITE = st.sampled_from(
    ["please ", "could you ", "Can you please ", "I'd like you to ", "now ", "ok, just ", "let's "]
)


@given(edits, st.sampled_from([str.upper, str.title, str.capitalize, str.lower]))
def test_case_does_not_matter(case: dict[str, Any], form: Any) -> None:
    plain = PLANNER.plan(case["text"], previous=case.get("previous"))
    assert same(PLANNER.plan(form(case["text"]), previous=case.get("previous")), plain)


@given(edits, st.sampled_from(["", ".", "!", " .", "...", ", please", ", thanks!", "  "]))
def test_closing_marks_do_not_matter(case: dict[str, Any], mark: str) -> None:
    text = case["text"].rstrip(".?!")
    plain = PLANNER.plan(text, previous=case.get("previous"))
    assert same(PLANNER.plan(text + mark, previous=case.get("previous")), plain)


@given(edits.filter(lambda c: c["kind"] in ("simple", "compound", "relation", "attribute", "negation")), POLITE)
def test_politeness_does_not_matter(case: dict[str, Any], words: str) -> None:
    plain = PLANNER.plan(case["text"])
    assert same(PLANNER.plan(words + case["text"]), plain)


@given(edits, st.text(alphabet=" \t ", min_size=1, max_size=4))
def test_spacing_does_not_matter(case: dict[str, Any], space: str) -> None:
    plain = PLANNER.plan(case["text"], previous=case.get("previous"))
    assert same(PLANNER.plan(space.join(case["text"].split()), previous=case.get("previous")), plain)


@given(st.sampled_from(CASES))
def test_plan_round_trips_as_json(case: dict[str, Any]) -> None:
    plan = PLANNER.plan(case["text"], previous=case.get("previous"))
    assert EditPlan.model_validate_json(plan.model_dump_json()) == plan


@given(edits, edits)
def test_sentences_add_up(a: dict[str, Any], b: dict[str, Any]) -> None:
    # Without words that point outside a sentence, two sentences mean what each means alone.
    pointing = (" it", " one", " other", " else", " them", "this", "that", "copy", "copies")
    if "previous" in a or "previous" in b or any(p in f" {c['text']}" for c in (a, b) for p in pointing):
        return
    alone = [PLANNER.plan(c["text"]) for c in (a, b)]
    together = PLANNER.plan(f"{a['text'].rstrip('.?')}. {b['text']}")
    assert together.ops == alone[0].ops + alone[1].ops


@pytest.mark.parametrize("bad", ["frobnicate the table", "paint the chair blorange", "delete the chair if it rains"])
@given(edits)
def test_nothing_is_half_done(bad: str, case: dict[str, Any]) -> None:
    text = case["text"].rstrip(".?")
    for both in (f"{text}. {bad}", f"{bad}. {text}"):
        plan = PLANNER.plan(both, previous=case.get("previous"))
        assert (plan.verdict, plan.ops) == ("not_understood", ())
        assert plan.unknown


VOCABULARY = sorted({w for c in CASES for w in c["text"].split()})


@settings(max_examples=some(300))
@given(st.lists(st.sampled_from(VOCABULARY), max_size=14).map(" ".join))
@example("the the of of and and")
@example("delete all all all but but")
@example("make the legs of the legs of the legs of the legs of the legs of the table red")
def test_word_salad_gives_a_valid_plan(text: str) -> None:
    plan = PLANNER.plan(text)
    assert EditPlan.model_validate_json(plan.model_dump_json()) == plan
    assert plan.ok or plan.reason


@settings(max_examples=some(300))
@given(st.text(max_size=MAX_CHARS), st.one_of(st.none(), st.text(max_size=80)))
@example("\x00\x07\x1b[31mdelete the chair\x1b[0m", None)
@example("delete the \u202echair\u202c", None)
@example("ＤＥＬＥＴＥ the chair", None)
@example("((((((((((" * 20, None)
@example("delete the 999999999999999999999999 chairs", None)
@example("move it 1/0 m left", None)
@example("make it 0% bigger", None)
@example("move it 0 m left", None)
@example("rotate it by 99999999 degrees", None)
@example("délete the chaise", None)
@example("删除椅子", None)
@example("👍" * 100, None)
def test_any_text_gives_a_valid_plan(text: str, previous: str | None) -> None:
    try:
        plan = PLANNER.plan(text, previous=previous)
    except UserError:
        return  # too many words, said so
    assert EditPlan.model_validate_json(plan.model_dump_json()) == plan


@pytest.mark.parametrize(
    "text",
    ["a" * (MAX_CHARS + 1), "a " * 400, "delete " + "the red " * 200, "and " * 240, string.punctuation * 40],
    ids=["one long word", "many words", "long phrase", "many ands", "marks"],
)
def test_what_is_too_long_is_refused_with_the_limit(text: str) -> None:
    with pytest.raises(UserError, match="at most"):
        PLANNER.plan(text)


@pytest.mark.parametrize(
    "text",
    [
        "select " + " and ".join(["the red chair"] * 50),
        "select " + "the lamp on " * 50 + "the table",
        "select everything " + "but the chair " * 50,
        "make it " + "red and " * 90 + "blue",
        "delete it. " * 60,
        "and " * 190,
    ],
    ids=["union", "nesting", "exclusions", "changes", "sentences", "ands"],
)
def test_what_is_allowed_to_be_long_ends_well(text: str) -> None:
    plan = PLANNER.plan(text)
    assert plan.ok or plan.reason


def test_a_plan_names_its_planner() -> None:
    plan = load("grammar").plan("delete the chair")
    assert (plan.planner, plan.prompt_hash, plan.instruction) == ("grammar", "", "delete the chair")
    assert plan.seconds > 0


def test_unknown_planner_is_refused() -> None:
    with pytest.raises(UserError, match="grammar"):
        load("crystal-ball")


def test_plan_is_all_or_nothing() -> None:
    with pytest.raises(ValueError, match="exactly if"):
        EditPlan(instruction="x", planner="test")
    with pytest.raises(ValueError, match="exactly if"):
        EditPlan(instruction="x", planner="test", verdict="absent", ops=PLANNER.plan("delete the chair").ops)
