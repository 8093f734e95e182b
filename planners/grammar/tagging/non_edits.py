"""Detects clauses that ask for no change: questions, statements, chat, session commands and prohibitions.

planner.py decides what such a clause means for the other clauses of the instruction.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..parsing import Refusal
from ..vocabulary import lexicon
from .tags import Clause
from .words import Word, bag

CHAT = "this asks for nothing"
QUESTION = "this is a question, not an edit"
FORBIDDEN = "it says what not to do, and asks for no change"
STATEMENT = "this is a statement, not an edit"
_JUDGING = bag("looks look seems seem feels sounds works good great nice fine better perfect lovely")
_BEING = bag("is are was were should")
# Statements that ask for an edit: "the pot and the plant are one thing".
_SAYING = ("SHOULD", "BEONE", "BEMANY", "PARTOF")
_EDIT_TYPES = ("DIR", "HUE", "LIGHT", "GROWN", "ONE", "OTHER", "OTHERS", "LENGTH", "DEGREE")


def refuse_non_edit(clause: Clause, sentence: Sequence[Word], mark: str) -> None:
    """Raise if the clause is a question, a statement, chat, a session command or a prohibition.

    Args:
        clause: the tagged clause.
        sentence: the words of the sentence it belongs to.
        mark: the punctuation mark that ends the sentence.

    Raises:
        Refusal: it is; the verdict is `not_an_edit`.
    """
    if clause.negated:
        raise Refusal(FORBIDDEN, "not", verdict="not_an_edit")
    asked = clause.tags[1] if clause.verb == "SELECT" and len(clause.tags) > 1 else None
    if asked and asked.type != "EVERYTHING" and asked.words[0].text in lexicon.QUESTION:
        raise Refusal(QUESTION, clause.tags[1].text, verdict="not_an_edit")
    if clause.verb or clause.unsupported:
        return
    texts = [w.text for w in sentence if w.text != ","]
    first = next((t for t in texts if t not in ("and", "so", "well", "but", "ok", "okay", "hey", "hi", "please")), "")
    polite = {w for p in (*lexicon.FILLER, *lexicon.POLITE) for w in p} | lexicon.CHAT
    if first in lexicon.COMMANDS:
        raise Refusal(
            f"{first} is a command, not an edit; /help lists those of the chat and the page",
            first,
            verdict="not_an_edit",
        )
    asks_for_edit = any(t.type in _EDIT_TYPES for t in clause.tags)
    if not asks_for_edit and all(t in polite for t in texts) and any(t in lexicon.CHAT for t in texts):
        raise Refusal(CHAT, verdict="not_an_edit")
    if texts[:3] == ["do", "the", "same"] or any(t.type in _SAYING for t in clause.tags):
        return
    if first in lexicon.QUESTION or first in lexicon.ASKING or mark == "?":
        raise Refusal(QUESTION, first, verdict="not_an_edit")
    own = [w.text for t in clause.tags for w in t.words]
    judges = own[:1] in (["that"], ["this"], ["it"], ["looks"]) and bool(_JUDGING & set(own))
    if first in lexicon.STATEMENT or judges or _BEING & set(texts):
        raise Refusal(STATEMENT, first, verdict="not_an_edit")


def is_chat(refusal: Refusal) -> bool:
    """Whether a clause was refused as chat."""
    return str(refusal) == CHAT


def empty_refusal(words: Sequence[Word]) -> Refusal:
    """The refusal of an instruction that consists of filler only."""
    said = tuple(w.text for w in words if w.text[0].isalpha())
    if any(w in lexicon.CHAT for w in said):
        return Refusal(CHAT, verdict="not_an_edit")
    return (
        Refusal("it does not say what to do", *said) if said else Refusal("there are no words", verdict="not_an_edit")
    )
