"""Answers are read strictly: one JSON object of the very types that edit, or an error that says what to mend."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from scenewright.planners.model.verify import reply
from scenewright.planners.model.verify.reply import MAX_CHARS, Reply, ReplyError, read
from scenewright.planners.plan import MAX_OPS
from scenewright.tools import registry

DELETE = {"op": "delete", "target": {"text": "rug"}}
OK = {"verdict": "ok", "ops": [DELETE]}


def said(**fields: Any) -> str:
    return json.dumps({**OK, **fields})


@pytest.mark.parametrize(
    "text",
    [
        "{}",
        " \n{}\n",
        "```json\n{}\n```",
        "```\n{}\n```",
        "Here is the plan:\n```json\n{}\n```\nI hope it helps!",
        "Sure. {} Done.",
        "\ufeff{}",
    ],
)
def test_one_object_is_found_between_words(text: str) -> None:
    assert read(text.replace("{}", json.dumps(OK))) == Reply.model_validate(OK)


def test_every_operation_is_read_from_its_example() -> None:
    for name, cls in registry.OPS.items():
        (op,) = read(said(ops=[cls.example[1]])).ops
        assert op.op == name and op == registry.parse(cls.example[1])


def test_null_is_not_given() -> None:
    text = said(reason=None, unknown=None, ops=[{**DELETE, "target": {"text": "rug", "size": None, "colors": None}}])
    assert read(text) == read(json.dumps(OK))


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "no JSON object"),
        ("I would delete the rug.", "no JSON object"),
        ("[]", "no JSON object"),
        (json.dumps(OK) + json.dumps(OK), "more than one"),
        (f"[{json.dumps(OK)}]", "more than one"),
        (json.dumps(OK)[:-1], "no valid JSON"),
        (json.dumps(OK).replace('"', "'"), "no valid JSON"),
        ('{"verdict": "ok", "ops": [], "ops": []}', "given twice"),
        ('{"a":' * 10_000, "nested too deeply"),
        ('{"a":' * 50 + "1" + "}" * 50, "nested too deeply"),
        ("{" * 20_000, "no valid JSON"),
        ("x" * (MAX_CHARS + 1), "answer shorter"),
        ("{}", "verdict"),
        (said(verdict="maybe"), "'ok', 'not_an_edit'"),
        (said(ops=[]), "at least one operation"),
        (said(verdict="unsafe", reason="no"), "takes no ops"),
        ('{"verdict": "unsafe"}', "needs a reason"),
        (said(ops=[DELETE] * (MAX_OPS + 1)), f"at most {MAX_OPS} items"),
        (said(ops=[{"op": "paint", "target": {}}]), "'recolor'"),
        (said(ops=[{"target": {}}]), "op"),
        (said(ops=["delete the rug"]), "ops.0"),
        (said(ops=[{**DELETE, "force": True}]), "force: there is no such field here; fields are op, target"),
        (said(thoughts="hm"), "thoughts: there is no such field here; fields are verdict, reason, unknown, ops"),
        (said(ops=[{"op": "delete", "target": {"name": "rug"}}]), "name: .* fields are text, colors"),
        (said(ops=[{"op": "delete", "target": {"text": "x" * 81}}]), "at most 80 characters"),
        (said(ops=[{"op": "delete", "target": {"groups": [-1]}}]), "greater than or equal to 0"),
        (said(ops=[{"op": "move", "target": {}}]), "exactly one of direction, toward and place"),
        (said(ops=[{"op": "move", "target": {}, "place": {"relation": "behind"}}]), "needs an anchor"),
        ('{"verdict": "ok", "ops": [{"op": "scale", "target": {}, "factor": NaN}]}', "NaN is no number"),
        ('{"verdict": "ok", "ops": [{"op": "scale", "target": {}, "factor": -Infinity}]}', "-Infinity is no number"),
        ('{"verdict": "ok", "ops": [{"op": "scale", "target": {}, "factor": 1e999}]}', "finite"),
        ('{"verdict": "ok", "ops": [{"op": "scale", "target": {}, "factor": 1e99}]}', "less than or equal to 100"),
        (f'{{"verdict": "ok", "ops": [{{"op": "scale", "target": {{}}, "factor": {"9" * 5000}}}]}}', "no valid JSON"),
    ],
)
def test_everything_else_is_refused_with_what_to_mend(text: str, complaint: str) -> None:
    with pytest.raises(ReplyError, match=complaint) as caught:
        read(text)
    assert len(str(caught.value)) < 1500


@given(cut=st.integers(0, len(json.dumps(OK)) - 1))
def test_no_part_of_an_answer_passes_for_the_whole(cut: int) -> None:
    with pytest.raises(ReplyError):
        read(json.dumps(OK)[:cut])
    with pytest.raises(ReplyError):
        read(json.dumps(OK)[len(json.dumps(OK)) - cut :])


@given(st.text(alphabet='{}[]":,abc0 \\n`', max_size=60))
def test_noise_is_refused_and_never_crashes(text: str) -> None:
    with pytest.raises(ReplyError):
        read(text)


def test_hesitant_verdicts_may_show_what_was_meant() -> None:
    for verdict in ("absent", "ambiguous"):
        assert read(said(verdict=verdict, reason="which?")).ops
        assert not read(json.dumps({"verdict": verdict, "reason": "which?"})).ops


def test_the_schema_is_that_of_the_type_and_tells_alternatives() -> None:
    made = reply.schema()
    assert set(made["properties"]) == set(Reply.model_fields)
    assert "description" not in json.dumps(made["$defs"]["Query"])
    ok, hesitant, refused = made["anyOf"]
    assert ok["properties"]["verdict"]["enum"] == ["ok"] and ok["properties"]["ops"]["minItems"] == 1
    assert hesitant["properties"]["verdict"]["enum"] == ["absent", "ambiguous"]
    assert refused["properties"]["ops"]["maxItems"] == 0


def test_the_schema_is_nobodys_to_change() -> None:
    before = json.dumps(reply.schema())
    reply.schema()["properties"] = {}
    assert json.dumps(reply.schema()) == before


def test_replies_are_frozen() -> None:
    with pytest.raises(ValidationError):
        read(json.dumps(OK)).verdict = "unsafe"  # type: ignore[misc]
