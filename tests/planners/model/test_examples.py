"""The examples that models are shown are right: valid replies that touch on their scene what they say they touch."""

from __future__ import annotations

from typing import get_args

import pytest

from scenewright import prompts
from scenewright.gaussians.language.query.nested import queries
from scenewright.planners.grammar import GrammarPlanner
from scenewright.planners.model.prompt import examples
from scenewright.planners.model.prompt.labels import sanitize
from scenewright.planners.model.verify import reply
from scenewright.planners.model.verify.guard import Guard
from scenewright.planners.model.verify.rehearsal import Rehearsal
from scenewright.planners.plan import Verdict
from scenewright.tools import registry

SCENE, EXAMPLES = examples.parse(prompts.load("plan_examples").text)


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda e: e.instruction)
def test_an_example_touches_what_it_says(example: examples.Example) -> None:
    said = reply.read(example.answer)
    if not said.ops:
        assert not example.touches
        return
    played = Rehearsal(SCENE, example.previous, GrammarPlanner()).dry_run(said.ops)
    assert played is not None
    assert played.verdict == said.verdict, played.reason
    assert tuple(step.targets for step in played.steps) == example.touches


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda e: e.instruction)
def test_the_guard_has_nothing_against_an_example(example: examples.Example) -> None:
    said = reply.read(example.answer)
    guard = Guard(example.instruction, example.previous, SCENE, GrammarPlanner())
    assert guard.drop_unstated(said.ops) == said.ops
    # Examples of absent and ambiguous things are there to show exactly this one fault.
    assert [f.kind for f in guard.faults(said.ops)] == ([said.verdict] if said.ops and said.verdict != "ok" else [])


def test_every_operation_and_every_verdict_is_shown() -> None:
    said = [reply.read(e.answer) for e in EXAMPLES]
    assert {op.op for r in said for op in r.ops} == set(registry.OPS)
    assert {r.verdict for r in said} == set(get_args(Verdict))


def test_every_way_of_pointing_is_shown() -> None:
    said = [(e, reply.read(e.answer)) for e in EXAMPLES]
    asked = [q for _, r in said for _, q in queries(r.ops)]
    assert any(len(r.ops) > 1 for _, r in said)  # compound
    assert any(e.previous and any(q.last for _, q in queries(r.ops)) for e, r in said)  # "it"
    assert any(q.relations for q in asked)
    assert any(q.colors for q in asked)
    assert any(q.exclude for q in asked) and any(q.not_colors for q in asked)
    assert any(q.groups and q.text for q in asked)
    assert not any(q.groups and not q.text for q in asked)  # ids never stand alone


def test_the_scene_of_the_examples_has_only_names_that_models_see() -> None:
    assert sanitize(SCENE) == SCENE


@pytest.mark.parametrize(
    "text",
    [
        "",
        "## make it red\n```json\n{}\n```\n",
        "## Scene\nno block\n",
        '## Scene\n```json\n{"room": {"size": [1, 1, 1]}}\n```\n\n## delete it\nno block\n',
    ],
)
def test_text_that_is_not_of_the_form_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="Scene"):
        examples.parse(text)
