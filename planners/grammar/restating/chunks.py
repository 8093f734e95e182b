"""Cuts tagged words into chunks: noun phrases, places, colours, amounts, directions, each with its position."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

from ..parsing import Refusal, parse
from ..tagging.lookahead import compounds, match, may_be_noun
from ..tagging.tagger import clauses
from ..tagging.tags import Clause, Tag
from ..tagging.words import Word, bag
from ..vocabulary import doings, lexicon

_SPEAKING = bag("try i we you he she could would should must looks look seems")  # never within a noun phrase
DOING = bag(
    "belongs belong lives needs wants looks wobbles wobble squeaks leaks creaks rattles flickers buzzes sags stinks "
    "smells clashes goes hang hangs stands sits"
)
_MODIFIERS = ("DET", "NUMBER", "OF", "COLOR", "COLORS", "SIZE", "SUP", "ORDINAL", "ADJ", "NONCOLOR", "OTHER", "TALL")
_HEADS = ("NOUN", "ONE", "THING", "PRON", "EVERYTHING", "OTHERS")
_PLACING = ("PREP", "NEAR", "BETWEEN", "CENTER", "TO", "TOWARD", "FROM")
_AMOUNTS = ("LENGTH", "ANGLE", "PERCENT", "TIMES", "FRACTION", "NUMBER", "DEGREE")


@dataclass(frozen=True)
class Chunk:
    """A part of a clause.

    Attributes:
        kind: "thing", "place" (a preposition with its thing), "hue", "way", "amount", "verb", "joint" or "other".
        start, end: its words.
        head: the position of its noun, -1 if it has none.
    """

    kind: str
    start: int
    end: int
    head: int = -1


def as_words(texts: Sequence[str]) -> tuple[Word, ...]:
    """Words whose positions are their numbers."""
    return tuple(Word(text, i, i + 1) for i, text in enumerate(texts))


@lru_cache(maxsize=256)
def chunks(texts: tuple[str, ...]) -> tuple[Chunk, ...]:
    """The chunks of a sentence, in order."""
    tags = [t for clause in clauses(as_words(texts)) for t in clause.tags if t.words]
    found: list[Chunk] = []
    i = 0
    while i < len(tags):
        j, chunk = _chunk(tags, i)
        found.append(chunk)
        i = j
    return tuple(found)


def _chunk(tags: Sequence[Tag], i: int) -> tuple[int, Chunk]:
    """The chunk at tag `i`, and the tag behind it."""
    tag = tags[i]
    if tag.type in _PLACING and i + 1 < len(tags):
        j, thing = _chunk(tags, i + 1)
        if thing.kind == "thing":
            return j, Chunk("place", tag.words[0].start, thing.end, thing.head)
    j = i
    while j < len(tags) and tags[j].type in _MODIFIERS:
        j += 1
    if j < len(tags) and tags[j].type in _HEADS:
        return j + 1, Chunk("thing", tag.words[0].start, tags[j].words[-1].end, tags[j].words[-1].start)
    if j > i + 1 and tags[i].type == "DET":
        return j, Chunk("thing", tag.words[0].start, tags[j - 1].words[-1].end, -1)
    kind = "other"
    if tag.type in ("HUE", "COLOR"):
        kind = "hue"
    elif tag.type in _AMOUNTS:
        kind = "amount"
    elif tag.type == "DIR":
        kind = "way"
    elif tag.type in ("SIDE", "SPOT"):
        kind = "place"
    elif tag.type in ("AND", "COMMA"):
        kind = "joint"
    elif tag.type in ("GROWN", "LIGHT"):
        kind = "grown"
    return i + 1, Chunk(kind, tag.words[0].start, tag.words[-1].end)


def _does(texts: Sequence[str]) -> bool:
    """Whether words say what a thing does, other than to describe it ("the lamp that stands on the desk")."""
    if any(w in DOING and not (i and texts[i - 1] in ("that", "which", "who")) for i, w in enumerate(texts)):
        return True
    kept = ("keep", "keeps", "kept", "is", "are")
    if any(w.endswith("ing") and before in ("keep", "keeps", "kept") for before, w in pairwise(texts)):
        return True  # "the mat keeps sliding"
    doing = (i for i, w in enumerate(texts) if i and w in doings.ongoing() and texts[i - 1] in kept)
    return any(i < 2 or texts[i - 2] not in ("that", "which", "who") for i in doing)


@lru_cache(maxsize=512)
def is_thing(texts: tuple[str, ...]) -> bool:
    """Whether words are one noun phrase or a list of them, with what describes it, and nothing else."""
    if not texts or len(texts) > 24 or not (may_be_noun(texts[-1]) or texts[-1] in ("me", "else", "it", "them", "all")):
        return False
    if not _SPEAKING.isdisjoint(texts) or _does(texts):
        return False
    if (texts[0],) in lexicon.VERB_PHRASES and texts[0] not in lexicon.NOUN_VERBS and not match(compounds(), texts, 0):
        return False
    found = clauses(as_words(("select", *texts)))
    if len(found) != 1 or found[0].verb != "SELECT" or found[0].unsupported or found[0].negated:
        return False
    kinds = [t.type for t in found[0].tags]
    if any(k in ("DIR", "SHOULD", "GOES") or (k == "HUE" and kinds[i - 1] != "REL") for i, k in enumerate(kinds)):
        return False
    try:
        tree = parse(Clause(found[0].tags, "SELECT"))
    except Refusal:
        return False
    return bool(tree)


def last_of(found: Sequence[Chunk], kind: str) -> Chunk | None:
    """The last chunk of a kind."""
    return next((c for c in reversed(found) if c.kind == kind), None)
