"""Whether an instruction names or points at the target of a step, asks for several, or says that a thing is unwanted.

Of a single step on a named thing no verb is required: "rug out, please" removes the rug, since nothing else is said of
it. Only English is read; for other languages every step counts as asked for, and `removal_words` still guards removals.
What else the words say of a step is in `said`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import cache

from ....gaussians.world import kinds
from ....gaussians.world.words import is_plural
from ....tools.operation import EditOp
from ...grammar.tagging.words import bag
from ...grammar.vocabulary.lexicon import CLOSED_PHRASES, VERB_PHRASES
from ...grammar.vocabulary.quantities import NUMBERS
from ...grammar.vocabulary.verbs import VERBS
from ...rooms.label_encoder import words

_WORD = re.compile(r"[^\W\d_]+|\d+(?:[.,]\d+)?|%|°")
_ENGLISH = bag(
    "the a an this that these those my our your to of on in into at by next with and or but please i we you it them is "
    "are can could would should want need like make move put delete remove paint turn add all every under over behind "
    "near"
)
_MOSTLY = 0.7  # share of known words from which a text without any of these is English
# Words for things of any kind, which need no name.
_GENERAL = bag(
    "other others another rest else everything anything all both each every any thing things stuff object objects "
    "furniture room scene place here some something whatever what where who whose lot decor clutter mess whole entire "
    "machine tool item items anyone"
)
# What says that a thing is unwanted, without a verb of removal.
_UNWANTED = re.compile(
    r"\b(?:out|off|away|no|not|never|nothing|none|without|enough|bye|goodbye|farewell|begone|hate|hates|ugly|hideous|eyesore|"
    r"useless|pointless|tired|sick|fed up|history|had it|past it|unneeded|redundant|surplus|scram|adios|rid|"
    r"clutter|gone|"
    r"unnecessary|n't|outta|sell|skip|tip|dump)\b|n't\b"
)
_REMOVALS = ("DELETE", "CLEAR", "HIDE", "ISOLATE", "TAKE", "DROP", "REPLACE", "SWAP", "CROP", "FADE")
_NEUTRAL = ("WANT", "SELECT", "SAME", "KEEP", "MAKE", "ADD", "GIVE", "PUT")


def is_english(text: str) -> bool:
    """Whether an instruction seems to be English: one of its words is among the commonest, or most are known."""
    said = [w.lower() for w in _WORD.findall(text) if w[0].isalpha()]
    if not text.isascii() or not said:
        return False
    known = sum(w in _vocabulary() for w in said)
    return not _ENGLISH.isdisjoint(said) or known >= _MOSTLY * len(said)


@cache
def _vocabulary() -> frozenset[str]:
    """Words of the grammar's closed classes, and of the names of kinds."""
    closed = (w for phrase in (*CLOSED_PHRASES, *VERB_PHRASES) for w in phrase)
    return frozenset((*closed, *NUMBERS, *kinds.every_word()))


def unwanted(text: str) -> bool:
    """Whether an instruction says without a verb that something is to go, and has no verb that asks for another "
    "thing."""
    said = text.lower().replace("’", "'")
    return bool(_UNWANTED.search(said)) and not any(v in said.split() for v in _other_verbs())


@cache
def _other_verbs() -> frozenset[str]:
    """The verbs of one word that ask for something else than a removal."""
    kinds = (*_REMOVALS, *_NEUTRAL)
    return frozenset(phrase for phrase, (kind, _) in VERBS.items() if " " not in phrase and kind not in kinds)


def speaks_of_any(text: str | None) -> bool:
    """Whether an instruction speaks of things without naming them ("everything", "the rest")."""
    return bool(text) and not _GENERAL.isdisjoint(w.lower() for w in _WORD.findall(text or ""))


def clears(text: str) -> bool:
    """Whether an instruction asks to clear a thing, which means what stands on it."""
    return re.search(r"\b(?:clear|empty|tidy|strip|declutter|clean)", text.lower()) is not None


def names_target(op: EditOp, text: str, previous: str | None) -> bool:
    """Whether the noun of a step's target is in the instruction, or in the one before."""
    query = op.query()
    if query is None or query.last:
        return True
    heard = _stems(f"{text} {previous or ''}")
    return bool(set(words(query.text)[-1:]) & heard)


_SEVERAL = frozenset(
    (*(n for n in NUMBERS if n != "one"), "some", "few", "couple", "pair", "several", "each", "every", "both", "all")
) | {"more", "twice", "times"}


def too_many(ops: Sequence[EditOp], text: str, previous: str | None) -> Iterator[EditOp]:
    """The steps that add several things although the instruction speaks of one."""
    heard = [w.lower() for w in _WORD.findall(f"{text} {previous or ''}")]
    counted = any(w[0].isdigit() or w in _SEVERAL or (len(w) > 3 and is_plural(w)) for w in heard)
    for op in ops:
        if op.op in ("insert", "duplicate") and (getattr(op, "count", 1) or 1) > 1 and not counted:
            yield op


def _stems(text: str) -> set[str]:
    return {s for w in _WORD.findall(text.lower()) for s in (w, *words(w))}
