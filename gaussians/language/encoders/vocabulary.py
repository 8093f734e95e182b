"""The names that an encoder can propose and tell apart: kinds, their synonyms, broader terms and non-objects."""

from __future__ import annotations

import json
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Self

from ...world import kinds as world
from ...world.words import AFTER_HEAD, normalise


@dataclass(frozen=True)
class Vocabulary:
    """The names that a text encoder chooses from.

    Attributes:
        kinds: canonical name of each kind of whole object, to its synonyms (the name itself not among them).
        broader: terms that cover several kinds ("lamp": floor lamp, table lamp). A term may also be the name of one
            kind, which then takes precedence.
        negatives: captions of what is not one whole object ("part of something", "a piece of wall").
        modifiers: single words that do not change what a thing is (colours, materials, sizes).
    """

    kinds: Mapping[str, tuple[str, ...]]
    broader: Mapping[str, tuple[str, ...]]
    negatives: tuple[str, ...]
    modifiers: frozenset[str] = frozenset()

    @property
    def names(self) -> tuple[str, ...]:
        """The canonical names, in their fixed order."""
        return tuple(self.kinds)

    @cached_property
    def _phrases(self) -> dict[tuple[str, ...], frozenset[str]]:
        """Normalised phrase to the kinds it names; a kind's own name replaces a broader term, a synonym does not."""
        table: dict[tuple[str, ...], frozenset[str]] = {}
        for kind, synonyms in self.kinds.items():
            for name in synonyms:
                table[normalise(name)] = table.get(normalise(name), frozenset()) | {kind}
        for term, kinds in self.broader.items():
            table[normalise(term)] = table.get(normalise(term), frozenset()) | frozenset(kinds)
        table.update({normalise(kind): frozenset({kind}) for kind in self.kinds})
        return table

    def covered(self, text: str, loose: bool = False) -> frozenset[str]:
        """The kinds a noun phrase means, by its head: "small red couch" to {"sofa"}; empty if it names none.

        With `loose`, a word that is both a kind and a broader term covers all of the broader term's kinds.
        """
        phrase, found = self.head(text)
        return found | (self._wider(phrase) if loose and found else frozenset())

    def head(self, text: str) -> tuple[tuple[str, ...], frozenset[str]]:
        """The longest name that a noun phrase ends in, normalised, and the kinds it means: "small red couch" to
        `(("couch",), {"sofa"})`; both empty if it ends in none."""
        words = normalise(text)
        cut = next((i for i, w in enumerate(words) if i and w in AFTER_HEAD), len(words))
        for phrase in (words, words[:cut]):
            for start in range(len(phrase)):
                if found := self._phrases.get(phrase[start:]):
                    return phrase[start:], found
        return (), frozenset()

    def _wider(self, phrase: tuple[str, ...]) -> frozenset[str]:
        """Kinds of the broader term spelt like `phrase`, if there is one."""
        terms = (kinds for term, kinds in self.broader.items() if normalise(term) == phrase)
        return frozenset(kind for kinds in terms for kind in kinds)

    def to_json(self) -> dict[str, Any]:
        """Plain lists and dictionaries, in a fixed order."""
        return {
            "kinds": {k: list(v) for k, v in self.kinds.items()},
            "broader": {k: list(v) for k, v in self.broader.items()},
            "negatives": list(self.negatives),
            "modifiers": sorted(self.modifiers),
        }

    @classmethod
    def household(cls) -> Self:
        """The names that ship with the embedded encoder: kinds of things, and captions of non-objects."""
        words = Path(__file__).parent / "weights" / "words.json"
        return cls.trained(json.loads(words.read_text(encoding="utf-8"))["vocabulary"])

    @classmethod
    def trained(cls, data: Mapping[str, Any]) -> Self:
        """The names and phrases that an encoder was trained with; the table of kinds says which kind a phrase means.

        A phrase of a kind that the encoder was not trained on means a trained kind that is alike or has the same role
        ("loveseat": sofa); if there is none, the phrase is left out. Names that the table does not hold ("barrel") keep
        every phrase that means no trained kind, and broader terms keep them as members.
        """
        found: dict[str, list[str]] = {name: [] for name in data["kinds"]}
        for name, phrases in data["kinds"].items():
            for phrase in phrases:
                meant = world.find(phrase)
                wanted = (name,) if meant is None else (meant.name, *meant.alike, meant.role)
                ours = name not in world.table().kinds
                if (known := next((w for w in wanted if w in found), name if ours else None)) is not None:
                    found[known].append(phrase)
        return cls(
            {name: tuple(dict.fromkeys(phrases)) for name, phrases in found.items()},
            {term: members for term, said in data["broader"].items() if (members := _members(term, said, found))},
            tuple(data["negatives"]),
            frozenset(data["modifiers"]),
        )

    @classmethod
    def everyday(cls) -> Self:
        """The household names and all independent names of the table, for encoders that read any name.

        The further names also improve refusal: household names are similar to each other, so that among them alone a
        thing's own name gets too small a share. With real ViT-B/32 vectors of household classes, 13 % of the present
        are refused against household names and 6 % against these, of the absent 98 % and 97 % (`home` in
        `benchmarks/_clip.py`).
        """
        table = world.table()
        home = cls.household().within(table.kinds)
        own = [k for k in table.kinds.values() if not (k.like or k.alike or k.one or k.name in home.kinds)]
        named = set(home._phrases)
        beyond = {
            k.name: tuple(n for n in k.names[1:] if normalise(n) not in named)
            for k in own
            if normalise(k.name) not in named
        }
        beyond |= {name: () for name in table.others}
        return cls({**home.kinds, **beyond}, home.broader, home.negatives, home.modifiers)

    def within(self, names: Container[str]) -> Self:
        """The vocabulary with the kinds of these names only."""
        kept = {k: v for k, v in self.kinds.items() if k in names}
        terms = {term: tuple(k for k in members if k in kept) for term, members in self.broader.items()}
        return type(self)(kept, {t: m for t, m in terms.items() if m}, self.negatives, self.modifiers)

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Self:
        """The inverse of `to_json`."""
        return cls(
            {k: tuple(v) for k, v in data["kinds"].items()},
            {k: tuple(v) for k, v in data["broader"].items()},
            tuple(data["negatives"]),
            frozenset(data["modifiers"]),
        )


def _members(term: str, said: Sequence[str], known: Container[str]) -> tuple[str, ...]:
    """The known members of a broader term: those of the table's family, and further ones that the table lacks."""
    family = world.table().families.get(term, said)
    return tuple(k for k in dict.fromkeys((*family, *(k for k in said if k not in world.table().kinds))) if k in known)
