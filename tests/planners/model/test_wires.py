"""The model planner over servers that speak the three wire formats: words become a checked plan, whatever comes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import loopback as wires
import pytest

from scenewright.planners import model
from scenewright.planners.model.backend import UnreachableError
from scenewright.planners.model.planner import ModelPlanner
from scenewright.planners.plan import EditPlan, NoPlanError
from scenewright.planners.rooms.graph import SceneGraph

pytest.importorskip("pydantic_ai", reason="needs the extra llm")

Wire = Any
WIRES = [wires.OpenAI, wires.Anthropic, wires.Google]
each_wire = pytest.mark.parametrize("wire", WIRES, ids=[wire.kind for wire in WIRES])

LIVING_ROOM = SceneGraph.read(Path(__file__).parents[1] / "written" / "living_room.json")
PNG = wires.png(40, 30)
PLAN = json.dumps({"verdict": "ok", "ops": [{"op": "delete", "target": {"text": "vase"}}]})
REFUSED = json.dumps({"verdict": "ok", "ops": [{"op": "isolate", "target": {"text": "vase"}}]})


class Seen:
    def graph(self) -> SceneGraph:
        return LIVING_ROOM

    def picture(self) -> bytes | None:
        return PNG


@pytest.fixture(autouse=True)
def key(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY", "http_proxy", "https_proxy", "all_proxy"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("SCENEWRIGHT_API_KEY", "sk-scenewright-0123456789-abcdefghij")


def plan(wire: Wire, *script: Any, text: str = "delete the vase", **settings: Any) -> tuple[EditPlan, list[Any]]:
    with wires.serving(*script) as server:
        planner = model.load_planner(f"{wire.kind}:small@{server.url}", **settings)
        return planner.plan(text, observation=Seen()), server.asked


@each_wire
def test_words_become_a_plan(wire: Wire) -> None:
    made, asked = plan(wire, wire.answer(PLAN))
    assert made.ok and made.ops[0].subject() == "the vase" and len(asked) == 1
    assert made.planner.startswith(f"{wire.kind}:small")
    assert made.usage is not None and (made.usage.input_tokens, made.usage.output_tokens) == (11, 7)
    assert "18: blue vase" in json.dumps(asked[0].body)
    assert "Delete" in wire.schema(asked[0].body)["$defs"]


@each_wire
def test_a_streamed_answer_shows_life(wire: Wire) -> None:
    heard: list[float] = []
    made, _ = plan(wire, wire.stream([PLAN[:20], PLAN[20:]]), progress=lambda stage, share: heard.append(share))
    assert made.ok and heard[0] == 0.0 and heard[-1] == 1.0 and len(heard) >= 3


@each_wire
def test_an_invalid_answer_is_repaired_in_the_same_conversation(wire: Wire) -> None:
    invalid = PLAN.replace("delete", "obliterate")
    made, asked = plan(wire, wire.answer(invalid), wire.answer(PLAN))
    assert made.ok and len(asked) == 2
    assert made.usage is not None and (made.usage.requests, made.usage.input_tokens) == (2, 22)
    second = json.dumps(asked[1].body)
    assert "obliterate" in second and "does not match any of the expected tags" in second


@each_wire
def test_what_nobody_asked_for_is_never_a_plan(wire: Wire) -> None:
    made, asked = plan(wire, wire.answer(REFUSED), text="paint the vase red")
    assert (made.verdict, made.ops, len(asked)) == ("not_understood", (), 2)


@each_wire
def test_an_answer_that_is_cut_to_the_end_is_no_plan(wire: Wire) -> None:
    cut = {"openai": "length", "anthropic": "max_tokens", "google": "MAX_TOKENS"}[wire.kind]
    with pytest.raises(NoPlanError, match="gave no valid plan in 2 attempt"):
        plan(wire, wire.answer(PLAN[:30], cut), attempts=2)


@each_wire
def test_a_server_that_fails_says_so(wire: Wire) -> None:
    with pytest.raises(UnreachableError):
        plan(wire, wire.error(401, "no such key"))


@each_wire
def test_the_view_is_shown_to_a_model_that_sees(wire: Wire) -> None:
    with wires.serving(wire.answer(PLAN)) as server:
        backend = model.load(f"{wire.kind}:small@{server.url}")
        assert ModelPlanner(backend, pictures=True).plan("delete the vase", observation=Seen()).ok
        shown = "iVBORw0KGgo" in json.dumps(server.asked[0].body)
    assert shown == backend.sees
