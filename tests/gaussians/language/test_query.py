"""Queries as data: their bounds, their words, and what a selection promises."""

from __future__ import annotations

from typing import Any

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import AbsentError, AmbiguousError
from scenewright.gaussians.language.query.query import Query, Relation
from scenewright.gaussians.language.query.selection import Candidate, Selection, nothing

CHAIR = Query(text="chair")


def cloud_of(ids: list[int]) -> GaussianCloud:
    n = len(ids)
    return GaussianCloud.create(
        torch.zeros(n, 3), torch.tensor([[1.0, 0, 0, 0]]).repeat(n, 1), torch.ones(n, 3), torch.full((n,), 0.5),
        torch.zeros(n, 1, 3), ids=torch.tensor(ids, dtype=torch.int64),
    )  # fmt: skip


@pytest.mark.parametrize(
    "fields",
    [
        {"text": "x" * 81},
        {"colors": ("red",) * 5},
        {"colors": ("x" * 81,)},
        {"not_colors": ("red",) * 5},
        {"size": "enormous"},
        {"pick": "first"},
        {"ordinal": 0},
        {"ordinal": 1001},
        {"count": 0},
        {"groups": (-1,)},
        {"groups": tuple(range(257))},
        {"exclude": (CHAIR,) * 5},
        {"also": (CHAIR,) * 9},
        {"relations": (Relation(name="on", anchors=(CHAIR,)),) * 5},
        {"negation": True},
        {"noun": "chair"},
    ],
)
def test_a_query_out_of_bounds_or_with_unknown_fields_is_refused(fields: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        Query(**fields)


@pytest.mark.parametrize(
    "fields",
    [
        {"name": "on", "anchors": ()},
        {"name": "on", "anchors": (CHAIR,) * 3},
        {"name": "over", "anchors": (CHAIR,)},
        {"name": "on", "anchors": (CHAIR,), "frame": "world"},
        {"name": "on", "anchors": (CHAIR,), "anchor": CHAIR},
    ],
)
def test_a_relation_out_of_bounds_is_refused(fields: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        Relation(**fields)


def test_a_query_is_frozen() -> None:
    with pytest.raises(ValidationError):
        CHAIR.text = "sofa"  # type: ignore[misc]


nouns = st.sampled_from(["", "chair", "coffee table"])
queries = st.recursive(
    st.builds(
        Query,
        text=nouns,
        colors=st.sampled_from([(), ("red",), ("dark green", "white")]),
        not_colors=st.sampled_from([(), ("blue",)]),
        size=st.sampled_from([None, "small", "tall"]),
        pick=st.sampled_from(["one", "all", "any", "largest", "nearest", "nth", "rest"]),
        ordinal=st.sampled_from([None, 1, 3]),
        count=st.sampled_from([None, 2]),
        last=st.booleans(),
        groups=st.sampled_from([(), (0, 4)]),
    ),
    lambda inner: st.builds(
        lambda q, a, name: q.model_copy(update={"relations": (Relation(name=name, anchors=(a,)),), "also": (a,)}),
        inner,
        inner,
        st.sampled_from(["left_of", "on", "next_to", "part_of"]),
    ),
    max_leaves=4,
)


@given(queries)
def test_a_query_survives_json(query: Query) -> None:
    assert Query.model_validate_json(query.model_dump_json()) == query


@given(queries)
def test_a_description_is_one_clean_line(query: Query) -> None:
    said = query.describe()
    assert said == " ".join(said.split())
    assert "_" not in said
    assert said[0].isalpha()


@pytest.mark.parametrize(
    ("query", "said"),
    [
        (CHAIR, "the chair"),
        (Query(), "the thing"),
        (Query(last=True), "it"),
        (Query(last=True, also=(CHAIR,)), "it and the chair"),
        (Query(text="chair", colors=("red",), size="small"), "the small red chair"),
        (Query(text="chair", not_colors=("red",)), "the chair that is not red"),
        (Query(text="chair", pick="any"), "any chair"),
        (Query(text="chair", pick="all"), "every chair"),
        (Query(text="chair", pick="rest"), "everything but the chair"),
        (Query(text="chair", pick="tallest"), "the tallest chair"),
        (Query(text="chair", pick="nth", ordinal=2), "the chair number 2"),
        (
            Query(text="chair", colors=("red",), relations=(Relation(name="left_of", anchors=(Query(text="sofa"),)),)),
            "the red chair left of the sofa",
        ),
        (
            Query(text="lamp", relations=(Relation(name="between", anchors=(Query(text="bed"), CHAIR)),)),
            "the lamp between the bed and the chair",
        ),
        (
            Query(text="chair", pick="all", exclude=(Query(text="chair", colors=("green",)),)),
            "every chair but not the green chair",
        ),
        (Query(text="chair", also=(Query(text="lamp"),)), "the chair and the lamp"),
    ],
)
def test_a_description_reads_as_english(query: Query, said: str) -> None:
    assert query.describe() == said


def test_require_returns_what_was_found_and_raises_otherwise() -> None:
    found = Selection(CHAIR, "found", torch.tensor([3]))
    assert found.require() is found
    with pytest.raises(AbsentError, match="the nearest is a stool"):
        nothing(CHAIR, "no chair; the nearest is a stool").require()
    with pytest.raises(AbsentError, match="the chair"):
        nothing(CHAIR, "").require()
    unsure = Selection(CHAIR, "ambiguous", torch.zeros(0, dtype=torch.int64), reason="2 things match")
    with pytest.raises(AmbiguousError, match="2 things match"):
        unsure.require()
    with pytest.raises(AmbiguousError, match="the chair"):
        Selection(CHAIR, "ambiguous", torch.zeros(0, dtype=torch.int64)).require()


@given(st.sets(st.integers(0, 40)), st.sets(st.integers(0, 40)))
def test_a_mask_marks_the_selected_rows_and_ignores_ids_that_are_gone(present: set[int], chosen: set[int]) -> None:
    rows = sorted(present, reverse=True)  # ids need not be in order
    selection = Selection(CHAIR, "found", torch.tensor(sorted(chosen), dtype=torch.int64))
    mask = selection.mask(cloud_of(rows))
    assert mask.dtype == torch.bool
    assert mask.tolist() == [i in chosen for i in rows]
    assert len(selection) == len(chosen)


def test_nothing_is_empty_and_absent() -> None:
    near = Candidate(4, "stool", "red", (0, 0, 0), (1, 1, 1), 0.2)
    answer = nothing(CHAIR, "no chair", (near,))
    assert (answer.verdict, len(answer), answer.groups, answer.candidates) == ("absent", 0, (), (near,))
    assert "red stool" in near.describe()
