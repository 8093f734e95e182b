"""Attach relations to things: "next to it", "a counter with a pastry display", "one on each side of it".

Depends on the order of things and places in a sentence only; `read.py` recognises the names.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

from ....gaussians.world.relations import WishName
from ...grammar.tagging.lookahead import match
from ...layout.problem import Wall
from . import vocabulary
from .drafts import Draft, Link, Reading, Said, changed

_SKIPPED = frozenset({"the", "a", "an", "one", "each", "every", "all", "both", "opposite", "that", "my", "its", "two"})
_AT_WINDOW = frozenset({"next_to", "under", "below", "at", "in_front_of", "against", "inside"})


@dataclass
class _Waiting:
    """A relation whose object has not been read yet; None as subject stands for the next thing."""

    subject: Draft | None
    name: str
    found: tuple[Draft, ...] = ()


class Linker:
    """The things and relations read so far, and the relation that the next thing completes."""

    def __init__(self) -> None:
        self.reading = Reading()
        self.without: list[str] = []
        self.last: Draft | None = None  # the subject of a relation that follows
        self.waiting: _Waiting | None = None
        self.parent: Draft | None = None  # "a desk with …"
        self.opens = True  # whether a sentence begins here
        self._ahead: list[tuple[WishName, tuple[Draft, ...], Wall | None]] = []
        self._negating = False
        self._each = False

    # ---- punctuation and little words ------------------------------------------------------------------------------

    def comma(self) -> None:
        self._finish()
        self.parent, self._negating = None, False

    def stop(self) -> None:
        self.comma()
        self.opens, self._each = True, False

    def joined(self, word: str) -> None:
        """Handle "with", which relates the following things to the last one, and "and" and "but"."""
        if word == "and":
            if self.waiting and self.waiting.name == "between":
                return
            self._finish()
        else:
            self._finish()
            self._negating = False
            self.parent = self.last if word == "with" else None

    def negate(self) -> None:
        self._finish()
        self._negating, self.parent = True, None

    def each(self) -> None:
        self._each = True

    def drop(self) -> None:
        """Drop the waiting relation, as its object cannot be placed."""
        self.waiting = None

    def in_room(self) -> bool:
        """Whether the room is the object of the waiting relation ("in the room"), which is dropped."""
        waited = self.waiting is not None
        self.waiting = None
        self._negating = False
        return waited

    def _finish(self) -> None:
        """Drop the waiting relation; "between" with one group of things is complete and is kept."""
        waiting, self.waiting = self.waiting, None
        if waiting and waiting.name == "between" and waiting.found:
            self._link(waiting.subject, "between", waiting.found)

    # ---- things ----------------------------------------------------------------------------------------------------

    def thing(self, name: str, head: str, said: Said, plural: bool) -> None:
        """Handle the name of a thing: the object of the waiting relation, a thing mentioned before, or a new one."""
        each, self._each = self._each or said.determiner == "each", False
        opens, self.opens = self.opens, False
        if self._negating:
            self.without.append(name)
            return
        if self.waiting:
            self._object(self._resolved(name, head, said, plural, each))
            return
        if said.determiner == "the" and (before := self.reading.known(name, head)):
            changed(before, said)
            self.last = self.reading.mention(before)
            return
        draft = self.reading.add(Draft(name, said, plural))
        for relation, objects, wall in self._ahead:
            self.reading.link(Link(draft, relation, objects, wall))
        self._ahead = []
        if self.parent is not None and not opens:
            if each:
                draft.each = self.parent
            self._attach(draft, self.parent)
        self.last = draft

    def _resolved(self, name: str, head: str, said: Said, plural: bool, each: bool) -> Draft:
        """The draft of an object, mentioned before or new; "on each table" counts the subject once per table."""
        assert self.waiting is not None
        subject = self.waiting.subject
        known = self.reading.known(name, head, subject) if said.plain or said.determiner == "the" else None
        draft = known or self.reading.add(Draft(name, said, plural or each))
        if each and subject is not None and subject is not draft:
            subject.each = draft
        return self.reading.mention(draft)

    def _object(self, draft: Draft) -> None:
        waiting = self.waiting
        assert waiting is not None
        if waiting.name == "between" and not draft.several and not waiting.found:
            waiting.found = (draft,)
            return
        self.waiting = None
        self._link(waiting.subject, waiting.name, (*waiting.found, draft))

    def pronoun(self, word: str) -> None:
        """Use a pronoun as the object of the waiting relation: "next to it", "between them"."""
        waiting = self.waiting
        if waiting is None:
            return
        if word in ("them", "these", "those") and waiting.name == "between":
            objects = self.reading.pair(waiting.subject)
        else:
            one = self.reading.before(waiting.subject)
            objects = (one,) if one else ()
        self.waiting = None
        if objects and (waiting.name != "between" or len(objects) == 2 or objects[0].several):
            self._link(waiting.subject, waiting.name, objects)

    def _link(self, subject: Draft | None, name: str, objects: tuple[Draft, ...]) -> None:
        """Add a relation under its layout name, with subject and object exchanged for reversed phrases."""
        first = objects[0]
        if subject is None:
            known = "next_to" if name in ("at", "against", "inside") else name
            self._ahead.append((known, objects, None))
            return
        if name.startswith("reversed "):
            self._link(first, name.removeprefix("reversed "), (subject,))
            self.last = subject
            return
        if first.name == "window" and name in _AT_WINDOW:
            self.reading.link(Link(subject, "at_window"))
            return
        self.reading.link(Link(subject, _named(name, subject, first), objects))

    def _attach(self, child: Draft, parent: Draft) -> None:
        """Add the relation that "with" means for two things, if any."""
        small, large = child.kind, parent.kind
        if not small or not large:
            return
        if small.support == "surface" and (large.top or large.name in small.on):
            self.reading.link(Link(child, "on", (parent,)))
        elif small.seats == 1 and large.top and not large.seats:
            self.reading.link(Link(child, "around", (parent,)))
        elif small.support == "floor" and large.support == "floor" and self.parent is parent and not child.placed:
            self.reading.link(Link(child, "next_to", (parent,), hard=False))
            child.placed = False

    # ---- places ----------------------------------------------------------------------------------------------------

    def place(self, texts: Sequence[str], i: int) -> int:
        """Read a relation or a place at position `i`; returns the number of words, or 0."""
        found = match(vocabulary.RELATIONS, texts, i)
        behind = self._structure(texts, i, *found) if found else 0
        if behind:
            return behind
        spot = match(vocabulary.SPOTS, texts, i)
        if spot and (not found or spot[1] >= found[1]):
            self._spot(spot[0])
            return spot[1]
        if not found or not self._relates(texts, i, found[0], found[1]):
            return 0
        self._finish()
        self.waiting = _Waiting(self.last if not self.opens else None, found[0])
        return found[1]

    def _relates(self, texts: Sequence[str], i: int, name: str, taken: int) -> bool:
        """Whether a word is a relation at this position; "in" and "at" are only between things."""
        if name in ("inside", "at") and (self.last is None or self.opens):
            return False
        return name != "from" and i + taken < len(texts) and (self.last is not None or self.opens)

    def _structure(self, texts: Sequence[str], i: int, name: str, taken: int) -> int:
        """Read a place at a part of the room ("against the north wall", "in the left corner"); the number of words."""
        j = i + taken
        while j < len(texts) and texts[j] in _SKIPPED:
            j += 1
        sides = []
        while j < len(texts) and (texts[j] in vocabulary.CORNERS or texts[j] in vocabulary.WALLS):
            sides.append(texts[j])
            j += 1
        part = texts[j] if j < len(texts) else ""
        if part in ("wall", "walls") and name in ("against", "on", "at", "next_to", "inside", "in_front_of"):
            self._at_wall(name, vocabulary.WALLS.get(sides[-1]) if sides else None)
        elif part in ("corner", "corners") and name in ("inside", "at", "against", "on") and sides:
            walls = [w for s in sides for w in vocabulary.CORNERS.get(s, ())]
            for wall in dict.fromkeys(walls):
                self._place("in_corner", cast(Wall, wall))
        else:
            return 0
        self._finish()
        return j + 1 - i

    def _at_wall(self, name: str, wall: str | None) -> None:
        kind = self.last.kind if self.last is not None else None
        if self.last is not None and kind and kind.support != "floor" and not self.opens:
            self.last.support = "wall"
            if wall is None:
                return
        self._place("against_wall", cast("Wall | None", wall))

    def _spot(self, spot: str) -> None:
        self._finish()
        subject = self.last if not self.opens else None
        if spot == "center":
            self._place("in_center", None)
        elif spot == "corner":
            self._place("in_corner", None)
        elif subject is None:
            return
        elif spot == "aligned_with":
            self.reading.link(Link(subject, "aligned_with", (subject,)))
        elif spot == "facing":
            self._face_each_other(subject)
        elif spot == "wall":
            self._at_wall("on", None)
        else:
            subject.support = "floor" if spot == "floor" else "ceiling"

    def _face_each_other(self, subject: Draft) -> None:
        other = subject if subject.several else self.reading.before(subject)
        if other is not None:
            self.reading.link(Link(subject, "facing", (other,)))
            if other is not subject:
                self.reading.link(Link(other, "facing", (subject,)))

    def _place(self, name: WishName, wall: Wall | None) -> None:
        if self.last is None or self.opens:
            self._ahead.append((name, (), wall))
        else:
            self.reading.link(Link(self.last, name, (), wall))


def _named(name: str, subject: Draft, other: Draft) -> WishName:
    """The layout name of a relation between these two things."""
    small, large = subject.kind, other.kind
    if name == "at":
        seated = small and small.seats == 1 and large and large.top
        return "around" if seated else "next_to"
    if name == "against":
        return "next_to"
    if name == "inside" and small and small.support == "surface" and large and large.top:
        return "on"
    return name
