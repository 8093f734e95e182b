"""Parses the tokens of a clause into a tree (grammar.lark, LALR) and names the offending words if that fails."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

from lark import Lark, Token, Tree
from lark.exceptions import UnexpectedInput, UnexpectedToken
from lark.lexer import Lexer

from ...gaussians.world.spelling import did_you_mean
from .parser_tables import load_parser
from .tagging.lookahead import color_at
from .tagging.tags import Clause, Tag
from .vocabulary import lexicon, nouns

Node = Tree[Token]


class Refusal(Exception):
    """A clause cannot be planned.

    Attributes:
        verdict: verdict of the plan.
        words: the words that caused the refusal, as written.
        remark: whether it is of a sentence that only says how things are.
        firm: whether the words are understood and may mean two things, so that no other reading may decide.
    """

    def __init__(self, reason: str, *words: str, verdict: str = "not_understood", firm: bool = False) -> None:
        super().__init__(reason)
        self.verdict = verdict
        self.words = words
        self.remark = False
        self.firm = firm or verdict in ("impossible", "unsafe")


def tag_of(token: Token) -> Tag:
    """The tag that a token of the parser carries."""
    value: Tag = token.value
    return value


def tokens(node: Node, *types: str) -> list[Tag]:
    """The tags of these types directly below a node."""
    return [tag_of(c) for c in node.children if isinstance(c, Token) and c.type in types]


def trees(node: Node, *names: str) -> list[Node]:
    """The children with these names."""
    return [c for c in node.children if isinstance(c, Tree) and (not names or c.data in names)]


class _TagLexer(Lexer):
    """A lark lexer that passes on the tags of the tagger as tokens."""

    def __init__(self, _conf: object) -> None:
        pass

    def lex(self, data: Sequence[Tag]) -> Iterator[Token]:  # type: ignore[override]
        for i, tag in enumerate(data):
            token = Token(tag.type, "", start_pos=i)
            token.value = tag
            yield token


@cache
def _parser() -> Lark:
    grammar = Path(__file__).with_name("grammar.lark").read_text(encoding="utf-8")
    return load_parser(grammar, _TagLexer)


def parse(clause: Clause) -> Node:
    """The parse tree of a clause.

    Raises:
        Refusal: the clause does not parse; names the words that did not fit.
    """
    try:
        return _parser().parse(clause.tags)
    except UnexpectedToken as error:
        at = error.token.start_pos if error.token.type != "$END" else None
        raise _refusal_at(clause, at) from None
    except UnexpectedInput as error:
        raise Refusal("this cannot be parsed") from error


def _refusal_at(clause: Clause, at: int | None) -> Refusal:
    """The refusal that names the offending words; `at` is the index of the token that did not fit, None for the end."""
    tags = clause.tags
    if not clause.verb:
        return _unknown_verb(first_words(clause)[0])
    if at is None:
        tail = _unknown_tail(tags[-1]) if tags else ()
        if tail:
            return Refusal(f"“{' '.join(tail)}” is not understood", " ".join(tail))
        return Refusal(f"something is missing after “{tags[-1].text}”")
    found = tags[at]
    if found.type in ("DET", "PRON", "EVERYTHING") and at > 1 and tags[at - 1].type == "NOUN":
        found = tags[at - 1]
    elif found.type not in ("NOUN", "UNKNOWN"):
        strange = (t for t in tags[at + 1 :] if t.type == "UNKNOWN" or (t.type == "NOUN" and not _is_known(t)))
        found = next(strange, found)
    return Refusal(f"“{found.text}” is not understood here", found.text)


def _unknown_verb(word: str) -> Refusal:
    verbs = [v[0] for v in lexicon.VERB_PHRASES if len(v) == 1]
    hint = did_you_mean(word, verbs, most=1, likeness=0.75)
    return Refusal(f"“{word}” is not a verb that this planner knows" + (hint and f"; {hint}"), word)


def first_words(clause: Clause) -> tuple[str, ...]:
    """The first word of a clause, as the words of a refusal."""
    return (clause.tags[0].words[0].text,) if clause.tags else ("",)


def _is_known(tag: Tag) -> bool:
    return any(nouns.is_known(w) for w in tag.text.split())


def _unknown_tail(tag: Tag) -> tuple[str, ...]:
    """The words behind the last known noun of a tag ("wall blorange"), or the last word if none is known."""
    if tag.type != "NOUN" or color_at([w.text for w in tag.words], 0):
        return ()
    texts = tag.text.split()
    known = [i for i, w in enumerate(texts) if nouns.is_known(w)]
    if known:
        return tuple(texts[known[-1] + 1 :])
    return (texts[-1],) if len(texts) > 1 else ()
