"""What a tightened schema allows is valid, whoever chooses the tokens: here dice do, which find every hole."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from pydantic import BaseModel, TypeAdapter, ValidationError

from scenewright.gaussians.language.query.query import Query
from scenewright.planners.model.backend import UnreachableError
from scenewright.planners.model.local.tightening import Limits, tighten
from scenewright.planners.model.verify.reply import Reply
from scenewright.planners.plan import EditPlan
from scenewright.planners.rooms.graph import SceneGraph
from scenewright.tools import registry

pytest.importorskip("llguidance", reason="pip install 'scenewright[models]'")
pytest.importorskip("tokenizers", reason="pip install 'scenewright[models]'")

from scenewright.planners.model.local.constrained import Constrained, Vocabulary

ONE_OP: TypeAdapter[Any] = TypeAdapter(registry.AnyOp)
TYPES: dict[str, TypeAdapter[Any]] = {
    "plan": TypeAdapter(EditPlan),
    "reply": TypeAdapter(Reply),
    "op": ONE_OP,
    "query": TypeAdapter(Query),
    "graph": TypeAdapter(SceneGraph),
}
# Checks that no schema can state: they compare the ids of a graph with each other.
BEYOND_SCHEMAS = ("same id", "no other node", "not there", "z axis points up")
LONG = 500  # tokens after which a text is closed


@pytest.fixture(scope="module")
def vocabulary() -> Vocabulary:
    """Bytes, some words, and pieces that cross the borders of JSON's parts, as real vocabularies have them."""
    from tokenizers import AddedToken, Tokenizer, decoders, models, pre_tokenizers

    letters = sorted(pre_tokenizers.ByteLevel.alphabet())
    pieces = ['"}', '"]', '":', '","', '":"', '"}]', "}}", "]}", '":[{"', "null", "true", "ch", "ai", "Ġr", "red", "00"]
    tokens = ["<end>", *letters, *pieces]
    coder = Tokenizer(models.BPE(vocab={t: i for i, t in enumerate(tokens)}, merges=[]))
    coder.pre_tokenizer = pre_tokenizers.ByteLevel(add_prefix_space=False)
    coder.decoder = decoders.ByteLevel()
    coder.add_special_tokens([AddedToken("<end>", special=True)])
    return Vocabulary(coder.to_str(), len(tokens) + 3, [0])


@pytest.fixture(scope="module")
def pieces() -> Vocabulary:
    """The other usual kind: characters, "▁" for a space, and bytes only for what is no known character."""
    from tokenizers import Tokenizer, decoders, models, normalizers

    tokens = ["<unk>", "<s>", "</s>", *(f"<0x{i:02X}>" for i in range(256)), "▁", *map(chr, range(33, 127))]
    tokens += ['"}', '":', '","', "▁ch", "air", "▁the"]
    vocab = {t: i for i, t in enumerate(tokens)}
    coder = Tokenizer(models.BPE(vocab=vocab, merges=[], byte_fallback=True, unk_token="<unk>", fuse_unk=True))
    coder.normalizer = normalizers.Sequence([normalizers.Prepend("▁"), normalizers.Replace(" ", "▁")])
    coder.decoder = decoders.Sequence(
        [decoders.Replace("▁", " "), decoders.ByteFallback(), decoders.Fuse(), decoders.Strip(" ", 1, 0)]
    )
    coder.add_special_tokens(["<s>", "</s>"])
    return Vocabulary(coder.to_str(), len(tokens), [2])


def thrown(vocabulary: Vocabulary, schema: dict[str, Any], seed: int, longest: int = LONG) -> tuple[str, bool]:
    """A text by dice that are loaded toward JSON's marks, each throw of a seed differently; whether it was closed."""
    dice, text = np.random.default_rng(seed), Constrained(vocabulary, schema)
    text.take_forced()
    marks = [vocabulary.characters[c] for c in '"}],']
    load = dice.random()
    while not text.done and len(text.tokens) < longest:
        allowed = np.flatnonzero(text.allowed())
        weights = np.where(np.isin(allowed, marks), 1 + load * len(allowed), 1.0)
        text.take(int(dice.choice(allowed, p=weights / weights.sum())))
    closed = not text.done
    text.close()
    assert text.done
    return text.text, closed


@pytest.mark.parametrize(
    ("name", "count"),
    [
        *[("plan", 15), ("reply", 10), ("op", 50), ("query", 15), ("graph", 10)],
        *[
            pytest.param(name, count, marks=pytest.mark.slow)
            for name, count in {"plan": 60, "reply": 40, "op": 150, "query": 60, "graph": 40}.items()
        ],
    ],
)
def test_whatever_the_dice_say_is_valid(vocabulary: Vocabulary, name: str, count: int) -> None:
    kind = TYPES[name]
    schema = kind.json_schema()
    for seed in range(count):
        text, _ = thrown(vocabulary, schema, seed)
        try:
            kind.validate_json(text)
        except ValidationError as error:
            assert all(any(known in e["msg"] for known in BEYOND_SCHEMAS) for e in error.errors()), f"{error}\n{text}"


@pytest.mark.parametrize("count", [8, pytest.param(30, marks=pytest.mark.slow)])
def test_vocabularies_of_pieces_will_do_as_well(pieces: Vocabulary, count: int) -> None:
    schema = EditPlan.model_json_schema()
    for seed in range(count):
        EditPlan.model_validate_json(thrown(pieces, schema, seed, 200)[0])


@pytest.mark.slow
def test_thousands_of_plans_are_valid(vocabulary: Vocabulary) -> None:
    schema = EditPlan.model_json_schema()
    for seed in range(1000, 4000):
        EditPlan.model_validate_json(thrown(vocabulary, schema, seed)[0])


@pytest.mark.parametrize("count", [1, pytest.param(3, marks=pytest.mark.slow)])
def test_from_anywhere_a_text_comes_to_a_valid_end(vocabulary: Vocabulary, count: int) -> None:
    """Cut at every length, in strings, numbers, names and between the bytes of a character."""
    schema, ends = EditPlan.model_json_schema(), []
    for seed in range(count):
        for longest in range(1, 160):
            text, closed = thrown(vocabulary, schema, seed, longest)
            EditPlan.model_validate_json(text)
            ends.append(closed)
    assert sum(ends) > 0.42 * len(ends)  # most of them were really cut


def loosened(schema: dict[str, Any]) -> dict[str, Any]:
    """The schema without the alternatives beside properties."""
    loose = copy.deepcopy(schema)
    for definition in loose["$defs"].values():
        definition.pop("anyOf", None)
    return loose


def reads(answer: Constrained, text: str) -> bool:
    """Whether a text, as JSON without spaces, is a whole answer; for a fresh one, which then cannot go on."""
    tokens = answer._vocabulary.reader.greedy_tokenize(text)
    return bool(answer._matcher.try_consume_tokens(tokens) == len(tokens)) and answer.done


@pytest.mark.parametrize("count", [200, 800])
@pytest.mark.slow
def test_schemas_say_exactly_what_validators_check(vocabulary: Vocabulary, count: int) -> None:
    """Operations that keep to their fields' types but not to what goes together: schema and validator agree on each."""
    schema = ONE_OP.json_schema()
    loose, verdicts = loosened(schema), []
    for seed in range(count):
        text, _ = thrown(vocabulary, loose, seed)
        try:
            ONE_OP.validate_json(text)
            valid = True
        except ValidationError:
            valid = False
        strict = Constrained(vocabulary, schema)
        assert reads(strict, text) == valid, text
        verdicts.append(valid)
    assert 0.1 < np.mean(verdicts) < 0.9  # both kinds were met


def test_every_example_can_be_said(vocabulary: Vocabulary) -> None:
    """Tightening takes nothing away that people ask for."""
    schema = ONE_OP.json_schema()
    for op, cls in registry.OPS.items():
        said = registry.parse(cls.example[1])
        text = said.model_dump_json(exclude_defaults=True)
        text = text if '"op"' in text else f'{{"op":"{op}",{text[1:]}'
        assert reads(Constrained(vocabulary, schema), text), text


def test_what_can_hold_itself_goes_in_only_so_far() -> None:
    def depth(node: Any) -> int:
        if isinstance(node, list):
            return max(map(depth, node), default=0)
        return 1 + max(map(depth, node.values()), default=0) if isinstance(node, dict) else 0

    def inlined(node: Any, definitions: dict[str, Any]) -> Any:
        if isinstance(node, dict):
            if "$ref" in node:
                return inlined(definitions[node["$ref"].removeprefix("#/$defs/")], definitions)
            return {k: inlined(v, definitions) for k, v in node.items() if k != "$defs"}
        return [inlined(v, definitions) for v in node] if isinstance(node, list) else node

    depths = []
    for nesting in (1, 2, 3):
        made = tighten(Query.model_json_schema(), Limits(nesting=nesting))
        depths.append(depth(inlined(made, made["$defs"])))  # a loop would never come back
    assert depths == sorted(set(depths))


@pytest.mark.parametrize(
    "hole",
    [
        {"type": "object", "properties": {}, "patternProperties": {"a": {"type": "null"}}},
        {"type": "string", "maxLength": 3, "format": "date"},
        {"type": "array", "items": {"type": "null"}, "uniqueItems": True},
        {"anyOf": [{"type": "null"}], "not": {"type": "null"}},
        {"title": "anything"},
        {"type": "array", "minItems": 1, "items": {"$ref": "#/$defs/Endless"}},
    ],
)
def test_what_it_does_not_know_it_refuses(vocabulary: Vocabulary, hole: dict[str, Any]) -> None:
    endless = {"type": "object", "properties": {"in": {"$ref": "#/$defs/Endless"}}, "required": ["in"]}
    with pytest.raises(UnreachableError, match="held to this schema"):
        Constrained(vocabulary, {**hole, "$defs": {"Endless": endless}})


def test_numbers_have_few_decimals_and_no_exponent(vocabulary: Vocabulary) -> None:
    class Measure(BaseModel):
        value: float

    schema = Measure.model_json_schema()
    for said, fine in [("0.125", True), ("-3", True), ("0.1250001", False), ("1e400", False), ("2000000", False)]:
        assert reads(Constrained(vocabulary, schema), f'{{"value":{said}}}') == fine, said
