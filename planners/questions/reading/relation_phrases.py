"""Reads phrases of the table of relations: "on top of", "underneath", "to the left of"."""

from __future__ import annotations

from functools import cache

from ....gaussians import late_re as re
from ....gaussians.world import relations
from .phrase_templates import Words

_VERBS = re.compile(
    r"^(?:standing|stood|sitting|sat|lying|laid|placed|put|hanging|hung|mounted|resting|leaning|located|positioned|"
    r"situated|kept|stored|set|stacked|parked|fixed|attached|found|arranged|"
    r"directly|right|immediately|just|straight|partly|anywhere|somewhere|over|up|down|out|perched|tucked|propped) "
)
_LEFT_OUT = {"next", "onto", "on to", "into", "around by", "to the top of"}


def relation(words: Words) -> str | None:
    """The name of the relation that all the words say, adverbs and verbs of place apart; None if they say none."""
    said = " ".join(words)
    for _ in range(4):
        if said in _phrases():
            return _phrases()[said]
        shorter = _VERBS.sub("", said)
        if shorter == said:
            return None
        said = shorter
    return None


_MUTUAL = re.compile(
    r"(?:(?:right |directly )?(?:next to|beside|near|near to|close to|by|adjacent to|alongside) (?:each other|one "
    r"another)|"
    r"side by side|close together|near each other|together|adjacent)"
)


def mutual(words: Words) -> str | None:
    """That things are next to each other."""
    return "next_to" if _MUTUAL.fullmatch(" ".join(words)) else None


@cache
def _phrases() -> dict[str, str]:
    """Every phrase said before one anchor, with the name of a relation that boxes decide."""
    found: dict[str, str] = {}
    for kind in relations.KINDS:
        name = kind.name if kind.used("query") or kind.own_frame else kind.query_as
        if not name or name == "between" or (relations.named(name).score is None and not kind.own_frame):
            continue
        for phrase in (*kind.phrases.in_commands(), *kind.phrases.in_descriptions()):
            if phrase not in _LEFT_OUT:
                found.setdefault(phrase, name)
    return found | {"around": "next_to", "all around": "next_to", "round": "next_to"}
