"""The stored tables of the grammar's parser give the same trees as the grammar, and never answer for another."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenewright.planners.grammar import parser_tables
from scenewright.planners.grammar.parser_tables import load_parser, tables_path
from scenewright.planners.grammar.parsing import _TagLexer
from scenewright.planners.grammar.tagging.tags import Tag

GRAMMAR = "start: first? SECOND+ -> said\nfirst: FIRST\n%declare FIRST SECOND\n"


def _tags(*types: str) -> list[Tag]:
    return [Tag(type=t, value=None, words=()) for t in types]


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path


def test_stored_tables_parse_as_built_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    built = load_parser(GRAMMAR, _TagLexer)
    written: list[Path] = []
    monkeypatch.setattr(parser_tables, "_write", lambda path, content: written.append(path))
    stored = load_parser(GRAMMAR, _TagLexer)
    assert not written  # nothing was built
    for said in (_tags("SECOND"), _tags("FIRST", "SECOND", "SECOND")):
        assert stored.parse(said) == built.parse(said)  # type: ignore[arg-type]
    assert stored.rules == built.rules


@pytest.mark.parametrize("content", ["", "{}", "[1, 2]", '{"data": {}, "memo": []}'])
def test_spoiled_tables_are_built_again(content: str) -> None:
    load_parser(GRAMMAR, _TagLexer)
    tables_path(GRAMMAR).write_text(content)
    assert load_parser(GRAMMAR, _TagLexer).parse(_tags("SECOND")).data == "said"  # type: ignore[arg-type]
    assert tables_path(GRAMMAR).read_text() != content


def test_a_folder_that_cannot_be_written_only_costs_time(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (cache / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(cache / "file"))
    assert load_parser(GRAMMAR, _TagLexer).parse(_tags("SECOND")).data == "said"  # type: ignore[arg-type]


def test_another_grammar_has_other_tables() -> None:
    assert tables_path(GRAMMAR) != tables_path(GRAMMAR + "\n")
