"""Split a description into words, and detect texts that are no description, such as questions and edits.

Handles typography and typing errors. `read.py` interprets the words.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence

from ....gaussians.world.finishes import single_words
from ....gaussians.world.words import singular
from ...grammar.tagging.lookahead import match
from ...grammar.tagging.spelling import misspelled_name
from ...grammar.tagging.words import split
from ...grammar.vocabulary import lexicon
from .. import knowledge
from ..brief import RefusedError
from . import vocabulary

# Parts of a thing that its adjective counts, and shapes by letters: "two-tier", "l-shaped".
_COUNTED = re.compile(
    r"\b(?:(?:one|two|three|four|five|six|seven|eight|twin|double|multi|half|\d{1,2})[- ](?:tiere?d?|legged|doors?|"
    r"doored|drawers?|burner|panell?e?d?|stor(?:e?y|ied)|levell?e?d?|armed|sided|ring|pieces?|wheele?d?|hob|branche?d?|"
    r"masted|tap|arm|step|rung)|[ltuvxcs][- ]shaped)\s+(?=\w)",
    re.IGNORECASE,
)
_GREETINGS = frozenset({"hi", "hello", "hey"})


def words_of(cleaned: str) -> tuple[list[str], list[str]]:
    """The words in lower case, possessives joined ("childrens room"), typing errors corrected; a remark for each error.

    A correction is kept only where it completes a whole name: "gravel" does not become "travel" of "travel bag".
    """
    joined: list[str] = []
    plain = "".join(c for c in unicodedata.normalize("NFKD", cleaned) if not unicodedata.combining(c))  # "cafe"
    for word in split(_COUNTED.sub("", plain)):
        if word.text == "'s" and joined:
            joined[-1] += "" if joined[-1].endswith("s") else "s"
        elif word.text not in ('"', "'"):
            joined.append(word.text)
    joined = _spelt_out(joined)
    slips = {
        i: s for i, t in enumerate(joined) if not _is_known(t) and (s := misspelled_name(t, knowledge.every_word()))
    }
    fixed = [slips.get(i, text) for i, text in enumerate(joined)]
    named = {j for i in range(len(fixed)) if (n := knowledge.longest_name(fixed, i)) for j in range(i, i + n)}
    told = [f"read “{joined[i]}” as {meant}" for i, meant in slips.items() if i in named]
    return [text if i in named else joined[i] for i, text in enumerate(fixed)], told


def _spelt_out(texts: list[str]) -> list[str]:
    """The words with "&", "+", "w/" and "w/o" written out."""
    found: list[str] = []
    i = 0
    while i < len(texts):
        if texts[i] in "&+":
            found.append("and")
        elif texts[i] == "w" and texts[i + 1 : i + 2] == ["/"]:
            without = texts[i + 2 : i + 3] == ["o"]
            found.append("without" if without else "with")
            i += 1 + without
        else:
            found.append("with" if texts[i] == "w" else texts[i])
        i += 1
    return found


def _is_known(text: str) -> bool:
    known = knowledge.every_word() | vocabulary.FILLER | vocabulary.ABSTRACT | vocabulary.PEOPLE | single_words()
    return text in known or singular(text) in known


def refuse_others(texts: Sequence[str]) -> None:
    """Raise `RefusedError` for greetings, texts without words, questions, and edits of an existing scene."""
    words = [t for t in texts if t not in ("please", ",", *_GREETINGS)]
    first = words[0] if words else ""
    if not any(w[0].isalpha() for w in words if w) and set(texts) & _GREETINGS:
        raise RefusedError("this is a greeting; describe a room, or say what is in it", "not_an_edit")
    if not any(t[0].isalpha() for t in texts if t):
        raise RefusedError("the text has no words; describe a room", "not_an_edit")
    asks = texts[-1] == "?" or first in ("what", "where", "who", "why", "how", "which", "when")
    if asks and not set(words) & (vocabulary.BUILD | {"room"}):
        raise RefusedError("this is a question; describe a room", "not_an_edit", (first,))
    verb = match(lexicon.VERB_PHRASES, words, 0)
    if (
        verb
        and first not in vocabulary.BUILD
        and verb[0][0] in vocabulary.EDITS
        and not knowledge.lookup(knowledge.thing_words(), words, 0)
    ):
        raise RefusedError(
            f"“{first}” edits an existing scene; describe a room, or use `scenewright edit`",
            "impossible",
            (first,),
        )
