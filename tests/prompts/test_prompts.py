"""Prompts are loaded strictly: what a file declares, what it holds and what is filled in must agree."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright import prompts
from scenewright.prompts import PromptError

FILE = "---\nplaceholders: thing, place\n---\nPut {{thing}} on {{place}}; {{thing}} again.\n"


def test_every_prompt_of_the_package_loads() -> None:
    assert {"plan", "plan_examples", "plan_repair", "plan_request"} <= set(prompts.names())
    for name in prompts.names():
        assert prompts.load(name).text.strip()


def test_filling_exchanges_every_occurrence_and_keeps_the_rest() -> None:
    prompt = prompts.parse("p", FILE)
    assert prompt.fill(thing="a mug", place="it") == "Put a mug on it; a mug again.\n"


@given(st.text(), st.text())
def test_values_are_filled_in_as_they_are(thing: str, place: str) -> None:
    # Values with placeholders, backslashes or group references of their own must not be read again.
    filled = prompts.parse("p", FILE).fill(thing=thing, place=place)
    assert filled == f"Put {thing} on {place}; {thing} again.\n"


@pytest.mark.parametrize("values", [{"thing": "x"}, {"thing": "x", "place": "y", "more": "z"}, {}])
def test_missing_and_unknown_values_are_refused(values: dict[str, str]) -> None:
    with pytest.raises(PromptError, match=r"missing|unknown"):
        prompts.parse("p", FILE).fill(**values)


@pytest.mark.parametrize(
    ("source", "complaint"),
    [
        ("Put {{thing}}.\n", "must begin"),
        ("---\nplaceholders: thing\n---\nPut it.\n", "declares"),
        ("---\nplaceholders:\n---\nPut {{thing}}.\n", "declares"),
        ("---\nplaceholders: thing, thing\n---\nPut {{thing}}.\n", "declares"),
        ("---\nplaceholders: thing\n---\nPut {{ thing }}.\n", "not the name of a placeholder"),
        ("---\nplaceholders: thing\n---\nPut {{thing}} {{Other}}.\n", "not the name of a placeholder"),
        ("", "must begin"),
    ],
)
def test_a_file_that_disagrees_with_its_header_is_refused(source: str, complaint: str) -> None:
    with pytest.raises(PromptError, match=complaint):
        prompts.parse("p", source)


@pytest.mark.parametrize("name", ["nothing", "../plan", "Plan", "", "plan.md", "__init__"])
def test_unknown_names_say_what_there_is(name: str) -> None:
    with pytest.raises(PromptError, match="plan_request"):
        prompts.load(name)


@pytest.mark.parametrize("saved", [FILE.replace("\n", "\r\n"), "\ufeff" + FILE, FILE.rstrip() + "  \n\n"])
def test_how_a_file_was_saved_changes_neither_text_nor_hash(saved: str) -> None:
    assert prompts.parse("p", saved) == prompts.parse("p", FILE)


def test_every_change_of_a_file_changes_the_hash() -> None:
    hashes = {prompts.parse("p", FILE.replace("Put", word)).hash for word in ("Put", "put", "Lay", "Put  it")}
    assert len(hashes) == 4
    assert all(len(h) == 16 and set(h) <= set("0123456789abcdef") for h in hashes)


def test_composed_and_decomposed_characters_are_one() -> None:
    assert prompts.normalised("caf\u00e9") == prompts.normalised("cafe\u0301")
