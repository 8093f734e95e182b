"""Names that a scene lacks, as the ones that are meant (`named_there`): "the dinning table", "the wee robot"."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache

from pydantic import BaseModel

from ...gaussians import late_re as re
from ...gaussians.language.query.nested import with_queries
from ...gaussians.language.query.query import Query
from ...gaussians.world import kinds
from ...gaussians.world.words import singular
from .meaning.changes import Fields
from .tagging.spelling import is_common, misspelled_name
from .timing.verbs import SENSES, has_form
from .vocabulary import nouns

_SAID_FIRST = ("scale", "set", "speed", "slow", "time")  # what is done, where no article stands before a name
_FEELS = re.compile(  # words that say what one thinks of a thing, and not which it is: no "garage door" is a door
    r"wee|yon|yonder|poor|dear|cute|silly|daft|blasted|bloody|damn|darn|blessed|beloved|trusty|sorry|"
    r"[a-z]{3,}(?:tly|rly|ous|ful|ish|some)",
)


def named_there(ops: Sequence[Fields], lacks: Callable[[Query], bool]) -> Iterator[Fields]:
    """Operations whose things a scene has, where it has them by a name that is spelt right, by another name of their
    kind, or without words that only say what one thinks of them.

    Args:
        lacks: whether the scene has nothing that a query names.
    """

    def renamed(query: Query) -> Query:
        others = [] if query.last else [query.model_copy(update={"text": text}) for text in _as_near(query.text)]
        beside = tuple(own for own in query.relations if not any(anchor.text == "wall" for anchor in own.anchors))
        if beside != query.relations and query.text:  # "the bookshelf of the left wall", which stands before it
            others.append(query.model_copy(update={"relations": beside}))
        return next((other for other in others if not lacks(other)), query) if others and lacks(query) else query

    for op in ops:
        made = {
            key: with_queries(value, renamed)
            for key, value in op.items()
            if key in ("target", "when", "toward") and isinstance(value, BaseModel)
        }
        yield {**op, **made}


def _as_near(text: str) -> Iterator[str]:
    """Other names that a name may stand for."""
    words = text.split(" ")
    right = [
        word if nouns.is_known(word) or is_common(word) else misspelled_name(word, _nouns()) or word for word in words
    ]
    if right != words:
        yield " ".join(right)
    known = next((at for at, word in enumerate(words) if not _FEELS.fullmatch(word)), len(words))
    if 0 < known < len(words):
        yield " ".join(words[known:])
    if (
        len(words) > 1
        and nouns.is_known(words[-1])
        and (words[0] in _SAID_FIRST or has_form(words[0], tuple(SENSES), "plain"))
    ):
        yield " ".join(words[1:])  # "scale robot speed by 1.5"
    kind = kinds.find(text)
    if kind is not None and singular(kind.name) != text:  # "the ventilator" is the fan
        yield singular(kind.name)


@cache
def _nouns() -> frozenset[str]:
    return nouns.everyday() | kinds.every_word()
