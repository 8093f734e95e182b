"""Measures the head nouns that the planner reads in real descriptions of objects (Nr3D).

No sentence of the data set is quoted: failures are reported as pairs of words with their number.
"""

from __future__ import annotations

import gzip
import json
import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from ..planners.plan import Planner
from ..planners.rooms.label_encoder import THRESHOLD, agreement
from . import _data
from ._head_noun import head_noun, relations_named

_FILE = "nr3d_utterances.json.gz"
# What people say for a label of this set, beyond everyday synonyms (gaussians/world/kinds.json): the label is one
# annotator's choice among several words for the thing.
SAID = {
    "storage bin": ("box", "container", "tote", "bin", "crate"),
    "picture": ("frame", "picture frame"),
    "toilet paper": ("roll", "toilet roll"),
    "paper towel dispenser": ("towel dispenser", "paper dispenser", "dispenser"),
    "computer tower": ("tower", "computer", "cpu", "hard drive"),
    "sofa chair": ("chair", "armchair", "couch", "sofa"),
    "bathroom stall door": ("stall", "bathroom stall", "door"),
    "bathroom stall": ("stall", "toilet", "bathroom"),
    "kitchen cabinet": ("cupboard", "counter"),
    "kitchen cabinets": ("cupboard", "counter"),
    "recycling bin": ("bin", "trash can", "recycle bin"),
    "end table": ("side table", "table", "nightstand"),
    "coffee table": ("table",),
    "clothes": ("clothing", "shirt", "jacket"),
    "ledge": ("window ledge", "shelf"),
    "rail": ("railing", "handrail", "banister"),
    "bookshelf": ("shelf",),
    "shelf": ("bookshelf", "bookcase"),
    "monitor": ("computer", "screen"),
    "couch": ("sofa", "sectional", "loveseat"),
    "desk": ("table",),
    "table": ("desk",),
    "cabinet": ("cupboard", "dresser"),
    "backpack": ("bag",),
    "bag": ("backpack",),
}
# Words that name a relation, to see which sentences hold one at all.
_CUES = re.compile(
    r"\b(?:next to|beside|left of|right of|behind|in front of|under|underneath|below|above|on top of|between|near|"
    r"closest to|nearest|farthest from|furthest from|close to|inside|by the|on the)\b",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class Nouns:
    """What was measured, shares in [0, 1].

    Attributes:
        sentences: how many were read.
        named: share that name the class, or a listed synonym, at all.
        right: share whose head noun is the class.
        right_of_named: the same among those that name the class.
        answered: share that the planner reads as one selection.
        right_of_answered: share of these whose query is for the class.
        relations: share of the sentences with a relation word in which one is recognised.
        failures: the commonest (class, found, number), the most frequent first.
    """

    sentences: int
    named: float
    right: float
    right_of_named: float
    answered: float
    right_of_answered: float
    relations: float
    failures: tuple[tuple[str, str, int], ...]


def find() -> Path | None:
    """The file of sentences, None where the data is not there."""
    folder = _data.folder("language")
    return folder / _FILE if folder is not None and (folder / _FILE).is_file() else None


def sentences(path: Path, every: int = 1) -> list[tuple[str, str]]:
    """Class and sentence, each `every`-th."""
    with gzip.open(path, "rt", encoding="utf-8") as file:
        rooms = json.load(file)
    return [(label, said) for told in rooms.values() for label, said in told][::every]


def is_class(noun: str, label: str) -> bool:
    """Whether a noun names the labelled class, or one of the words that count as the same."""
    if not noun:
        return False
    names = (label, *SAID.get(label, ()))
    return max(*agreement(noun, names), agreement(label, (noun,))[0]) >= THRESHOLD


def _is_named(label: str, said: str) -> bool:
    found = re.findall(r"[a-z']+", said.lower())
    return any(is_class(" ".join(found[i : i + n]), label) for n in (1, 2, 3) for i in range(len(found) - n + 1))


def measure(rows: list[tuple[str, str]], planner: Planner) -> Nouns:
    """Head nouns, the planner's readings and relations of the sentences."""
    right = named = named_right = answered = answered_right = cued = seen = 0
    failures: Counter[tuple[str, str]] = Counter()
    for label, said in rows:
        noun = head_noun(said[:900])
        hit = is_class(noun, label)
        right += hit
        if not hit:
            failures[label, noun or "(none)"] += 1
        if _is_named(label, said):
            named += 1
            named_right += hit
        if (text := _query_text(planner, said[:900])) is not None:
            answered += 1
            answered_right += is_class(text, label)
        if _CUES.search(said):
            cued += 1
            seen += bool(relations_named(said[:900]))
    return Nouns(
        len(rows), named / len(rows), right / len(rows), named_right / max(named, 1), answered / len(rows),
        answered_right / max(answered, 1), seen / max(cued, 1),
        tuple((label, noun, n) for (label, noun), n in failures.most_common(20)),
    )  # fmt: skip


def _query_text(planner: Planner, said: str) -> str | None:
    """What the planner would look for, None if it does not read the sentence as one selection."""
    for text in (f"select {said}", said):
        plan = planner.plan(text)
        query = plan.ops[0].query() if len(plan.ops) == 1 else None
        if query is not None:
            return query.text
    return None
