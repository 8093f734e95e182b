"""Operations as data: every file is found, every example is valid, and bad input is refused with a message."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel, ConfigDict

from scenewright.gaussians.errors import UserError
from scenewright.gaussians.scene import Frame
from scenewright.tools import ops
from scenewright.tools.docstrings import field_texts
from scenewright.tools.operation import Length
from scenewright.tools.registry import OPS, describe, parse, schema

CHAIR = {"text": "chair"}


def test_every_file_defines_the_operation_it_is_named_after() -> None:
    files = {p.stem for p in Path(ops.__path__[0]).glob("*.py")} - {"__init__"}
    assert files == set(OPS)


@pytest.mark.parametrize("name", sorted(OPS))
def test_an_example_is_valid_and_survives_json(name: str) -> None:
    words, data = OPS[name].example
    op = parse(data)
    assert words and op.op == name
    assert parse(op.model_dump_json()) == op


def test_the_schema_names_every_operation_and_allows_nothing_else() -> None:
    text = json.dumps(schema())
    assert all(f'"{name}"' in text for name in OPS)
    assert '"additionalProperties": true' not in text
    assert len(describe()) == len(OPS)


BAD: list[dict[str, Any]] = [
    {},
    {"op": "paint", "target": CHAIR},
    {"op": "select"},
    {"op": "isolate", "target": "chair"},
    {"op": "delete", "target": CHAIR, "force": True},
    {"op": "recolor", "target": CHAIR},
    {"op": "recolor", "target": CHAIR, "color": "x" * 50},
    {"op": "recolor", "target": CHAIR, "adjust": "toward"},
    {"op": "recolor", "target": CHAIR, "adjust": "darker", "color": "red"},
    {"op": "recolor", "target": CHAIR, "adjust": "darker", "amount": 0},
    {"op": "move", "target": CHAIR},
    {"op": "move", "target": CHAIR, "direction": "up", "toward": CHAIR},
    {"op": "move", "target": CHAIR, "direction": "north"},
    {"op": "move", "target": CHAIR, "direction": "up", "distance": {"value": -1, "unit": "m"}},
    {"op": "move", "target": CHAIR, "place": {"relation": "under"}},
    {"op": "move", "target": CHAIR, "place": {"relation": "on", "anchors": [CHAIR, CHAIR]}},
    {"op": "move", "target": CHAIR, "place": {"relation": "center"}, "distance": {"value": 1}},
    {"op": "rotate", "target": CHAIR, "degrees": float("nan")},
    {"op": "rotate", "target": CHAIR, "degrees": 1e9},
    {"op": "scale", "target": CHAIR, "factor": 0},
    {"op": "scale", "target": CHAIR, "factor": float("inf")},
    {"op": "duplicate", "target": CHAIR, "count": 0},
    {"op": "duplicate", "target": CHAIR, "count": 10**9},
    {"op": "duplicate", "target": CHAIR, "distance": {"value": 1}},
    {"op": "insert"},
    {"op": "insert", "asset": "", "count": 1},
    {"op": "insert", "asset": "mug", "height": {"value": 1, "unit": "furlong"}},
    {"op": "replace", "target": CHAIR},
    {"op": "opacity", "target": CHAIR, "value": 1.5},
]


@pytest.mark.parametrize("data", BAD, ids=lambda d: json.dumps(d)[:60])
def test_bad_input_is_refused(data: dict[str, Any]) -> None:
    with pytest.raises(UserError, match="not a valid operation"):
        parse(data)


@pytest.mark.parametrize("text", ["", "{", "[]", "null", '{"op": "select", "target": {"groups": [-1]}}'])
def test_bad_json_is_refused(text: str) -> None:
    with pytest.raises(UserError):
        parse(text)


def test_lengths_are_converted_by_the_scale_and_say_what_they_assume() -> None:
    frame = Frame(metres_per_unit=0.5)
    assert Length(value=1, unit="m").in_units(frame) == 2
    assert Length(value=1, unit="ft").in_units(frame) == pytest.approx(0.6096)
    assert Length(value=3, unit="units").in_units(frame) == 3
    assert Length(value=10, unit="in").in_units(Frame()) == pytest.approx(0.254)
    assert not Length(value=1, unit="m").assumption(frame) and not Length(value=1, unit="units").assumption(Frame())
    assert "scale is unknown" in Length(value=1, unit="cm").assumption(Frame())[0]


def test_texts_behind_fields_are_those_that_pydantic_reads() -> None:
    class Read(BaseModel):
        """A model."""

        model_config = ConfigDict(use_attribute_docstrings=True)

        first: int
        """One line."""
        silent: str = ""
        second: float = 1.0
        """Two
        lines."""

    assert field_texts(Read) == {n: f.description for n, f in Read.model_fields.items() if f.description is not None}
    assert set(field_texts(Read)) == {"first", "second"}
