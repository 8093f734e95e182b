"""Attach relations to things: "next to it", "a counter with a pastry display", "one on each side of it".

Depends on the order of things and places in a sentence only; `read.py` recognises the names.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import cast

from ....gaussians.world.relations import WishName
from ...grammar.tagging.lookahead import match
from ...layout.problem import Wall
from ..brief import Arrangement
from . import vocabulary
from .drafts import Draft, Link, Reading, Said, changed
from .relating import PREPOSITIONS, layout_name, sides_at

_SKIPPED = frozenset({"the", "a", "an", "one", "each", "every", "all", "both", "opposite", "that", "my", "its", "two"})
_ROOM_SIDES: dict[str, Wall] = {"behind": "north", "in_front_of": "south", "left_of": "west", "right_of": "east"}
_AT_WINDOW = frozenset({"next_to", "under", "below", "at", "in_front_of", "against", "inside"})


_TWO = 2
_ENDS = (",", ".", ";", "and", "!", "?", "\n")
_NEAREST = frozenset({"next_to", "in_front_of", "behind", "left_of", "right_of", "against"})
_TO_OWNER = frozenset(
    {"in_front_of", "behind", "on", "under", "below", "next_to", "around", "above", "left_of", "right_of"}
)
_NOBODY = Draft("", Said(), False)  # the subject of a relation until its thing is read
_PRONOUN_COUNTS = ("one", "two", "three", "four", "five", "six", "half")


@dataclass
class _Waiting:
    """A relation whose object has not been read yet; None as subject stands for the next thing."""

    subject: Draft | None
    name: str
    found: tuple[Draft, ...] = ()
    distance: float | None = None
    sides: bool = False


class Linker:
    """The things and relations read so far, and the relation that the next thing completes."""

    def __init__(self) -> None:
        self.reading = Reading()
        self.without: list[str] = []
        self.last: Draft | None = None  # the subject of a relation that follows
        self.waiting: _Waiting | None = None
        self.parent: Draft | None = None  # "a desk with …"
        self.opens = True  # whether a sentence begins here
        self.fresh: Draft | None = None  # a thing just introduced as an object: "a stool in the centre" is about it
        self.carried = False  # whether the last relation was that of a thing on, in or under the fresh one
        self.asked = ""  # the word before the place that is read
        self.distance: float | None = None  # metres that belong to the relation that follows
        self._ahead: list[Link] = []  # relations of the next thing; their subjects are not read yet
        self._negating = False
        self._each = False
        self._each_of: Draft | None = None  # "each desk …": what follows is one for each of it
        self._own = False  # "its own chair, monitor and lamp": the list goes on behind commas

    # ---- punctuation and little words ------------------------------------------------------------------------------

    def comma(self) -> None:
        self._finish()
        self.distance, self._negating, self.fresh = None, False, None
        if not self._own:
            self.parent = None

    def stop(self) -> None:
        self._own = False
        self.comma()
        self.opens, self._each, self._each_of = True, False, None

    def joined(self, word: str) -> None:
        """Handle "with", which relates the following things to the last one, and "and" and "but"."""
        self.fresh = None
        if word == "and":
            if self.waiting and self.waiting.name == "between":
                return
            self._finish()
        else:
            self._finish()
            self._negating = False
            self.parent = self.last if word == "with" else None
            if self.parent is not None and self._each:
                self._each_of = self.parent
            self._each = False

    def negate(self) -> None:
        self._finish()
        self._negating, self.parent = True, None

    def each(self) -> None:
        self._each = True

    def each_behind(self) -> None:
        """Handle "a chair each": the last thing is there once for each of the thing that it belongs to."""
        owner = self.parent or self.reading.before(self.last)
        if self.last is not None and owner is not None and owner is not self.last:
            self.last.each = owner

    def counted(self, count: int) -> None:
        """Handle a number behind its noun: "armchair x2", "buckets of tulips, say six"."""
        if self.last is not None:
            self.last.said = replace(self.last.said, count=count)

    def arrange(self, arrangement: Arrangement, count: int | None = None) -> None:
        """Handle "in two rows of three" behind a noun."""
        if self.last is not None:
            self.last.arrangement = arrangement
            if arrangement.form == "row":
                self.reading.link(Link(self.last, "aligned_with", (self.last,)))
            if count and self.last.said.count is None:
                self.counted(count)

    def apart(self, metres: float) -> None:
        """Handle "a metre apart" behind a noun."""
        if self.last is not None:
            form = self.last.arrangement or self.last.said.arrangement or Arrangement(form="row")
            self.last.arrangement = form.model_copy(update={"gap": metres})

    def from_there(self, metres: float) -> None:
        """Handle a distance behind a relation: "facing it from 2 metres away"."""
        links = self.reading.links
        if links and links[-1].subject is self.last:
            links[-1] = replace(links[-1], distance=metres)

    def elsewhere(self) -> None:
        """Let what follows be about no thing: a dance floor has a place, but is no thing."""
        self._finish()
        self.last, self.opens = Draft("", Said(), False), False

    def drop(self) -> None:
        """Drop the waiting relation, as its object cannot be placed."""
        self.waiting = None

    def in_room(self) -> bool:
        """Whether the room is the object of the waiting relation: "in the room", "at the back of the shop"."""
        waiting, self.waiting = self.waiting, None
        self._negating = False
        if waiting is not None and waiting.subject is not None and waiting.name in _ROOM_SIDES:
            self.reading.link(Link(waiting.subject, "against_wall", (), _ROOM_SIDES[waiting.name], False))
        return waiting is not None

    def _finish(self) -> None:
        """Drop the waiting relation; "between" with one group of things is complete and is kept."""
        waiting, self.waiting = self.waiting, None
        if waiting and waiting.name == "between" and waiting.found:
            self._link(waiting.subject, "between", waiting.found)

    # ---- things ----------------------------------------------------------------------------------------------------

    def thing(self, name: str, head: str, said: Said, plural: bool, called: str = "") -> None:
        """Handle the name of a thing: the object of the waiting relation, a thing mentioned before, or a new one."""
        each, self._each = said.determiner == "each", False
        opens, self.opens = self.opens, False
        if self._negating:
            self.without.append(name)
            return
        if self.waiting:
            known = len(self.reading.drafts)
            found = self._resolved(name, head, said, plural, each)
            found.called = found.called or called
            self.fresh = found if len(self.reading.drafts) > known else None
            self._object(found)
            return
        if said.determiner in ("the", "each") and (before := self.reading.known(name, head)):
            changed(before, said)
            self.last = self.reading.mention(before)
            self._each_of = before if each else self._each_of
            return
        draft = self.reading.add(Draft(name, said, plural or each, seated=each, called=called))
        for ahead in self._ahead:
            self.reading.link(replace(ahead, subject=draft))
        self._ahead = []
        parent = self.parent
        if parent is not None and self._own and not said.own and (said.determiner or said.count or plural):
            parent, self.parent, self._own = None, None, False  # the list of "its own …" has ended
        if parent is not None and not opens:
            if parent is self._each_of or said.own:
                draft.each = parent
            self._own = self._own or said.own
            self._attach(draft, parent)
        if each:
            self._each_of = draft
        self.last = draft

    def _resolved(self, name: str, head: str, said: Said, plural: bool, each: bool) -> Draft:
        """The draft of an object, mentioned before or new; "on each table" counts the subject once per table."""
        assert self.waiting is not None
        subject = self.waiting.subject
        if said.own and subject is not None:  # "each facing its own mirror"
            return self.reading.mention(self.reading.add(Draft(name, said, False, each=subject)))
        known = self.reading.known(name, head, subject) if said.plain or said.determiner == "the" else None
        if known is None and subject is not None and said.determiner == "the" and subject.name == name:
            return subject  # it cannot be under itself: what is was not understood
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
        if draft is not waiting.subject:
            self._link(waiting.subject, waiting.name, (*waiting.found, draft), waiting)

    def pronoun(self, word: str) -> None:
        """Use a pronoun as the object of the waiting relation: "next to it", "between them"."""
        waiting = self.waiting
        if waiting is None:
            return
        if word in ("them", "these", "those") and waiting.name == "between":
            objects = self.reading.pair(waiting.subject)
        else:
            owner = self.parent if self.parent is not waiting.subject else None  # "a desk with a lamp on it"
            one = owner or self.reading.before(waiting.subject, word)
            objects = (one,) if one else ()
        self.waiting = None
        if objects and (waiting.name != "between" or len(objects) == 2 or objects[0].several):
            self._link(waiting.subject, waiting.name, objects, waiting)

    def _link(self, subject: Draft | None, name: str, objects: tuple[Draft, ...], said: _Waiting | None = None) -> None:
        """Add a relation under its layout name, with subject and object exchanged for reversed phrases."""
        first = objects[0]
        distance, sides = (said.distance, said.sides) if said is not None else (None, False)
        if subject is None:
            known = "next_to" if name in ("at", "against", "inside") else name
            self._ahead.append(Link(first, known, objects, distance=distance, sides=sides))
            return
        if name.startswith("reversed "):
            self._link(first, name.removeprefix("reversed "), (subject,), said)
            self.last = subject
            return
        if first.name == "window" and name in _AT_WINDOW:
            self.reading.link(Link(subject, "at_window", distance=distance))
            return
        self.reading.link(
            Link(subject, layout_name(name, subject, first, sides), objects, distance=distance, sides=sides)
        )

    def _attach(self, child: Draft, parent: Draft) -> None:
        """Add the relation that "with" means for two things, if any."""
        small, large = child.kind, parent.kind
        if not small or not large:
            return
        if small.support == "surface" and (large.top or large.name in small.on):
            self.reading.suggest(Link(child, "on", (parent,)))
        elif small.seats == 1 and large.top and not large.seats:
            self.reading.suggest(Link(child, "around", (parent,)))
        elif small.support == "floor" and large.support == "floor" and self.parent is parent and not child.placed:
            self.reading.suggest(Link(child, "next_to", (parent,), hard=False))
            child.placed = False

    # ---- places ----------------------------------------------------------------------------------------------------

    def place(self, texts: Sequence[str], i: int) -> int:
        """Read a relation or a place at position `i`; returns the number of words, or 0."""
        found = match(vocabulary.RELATIONS, texts, i)
        if sides := self._sides(texts, i):
            return sides
        behind = self._structure(texts, i, *found) if found else 0
        if behind:
            return behind
        spot = match(vocabulary.SPOTS, texts, i)
        if spot and self.fresh is not None and spot[0] in ("center", "corner", "wall"):
            self.last, self.fresh = self.fresh, None
        if (
            found
            and (i + found[1] >= len(texts) or texts[i + found[1]] in _ENDS)
            and found[0] != "on"
            and self._to_owner(found[0])
        ):
            return found[1]
        if spot and (not found or spot[1] >= found[1]):
            self._spot(spot[0])
            return spot[1]
        if not found or not self._relates(texts, i, found[0], found[1]):
            return 0
        if self.fresh is not None and found[0] in _NEAREST and self.carried:
            self.last = self.fresh  # "a candle on a stool next to the bed": the stool is next to it
        self.fresh, self.carried = None, found[0] in ("on", "inside", "under")
        self._finish()
        distance, self.distance = self.distance, None
        self.waiting = _Waiting(self.last if not self.opens else None, found[0], distance=distance)
        return found[1]

    def _sides(self, texts: Sequence[str], i: int) -> int:
        """Read "on either side of", "down each side", "one on the left and one on the right of"; the number of words.

        A thing that is named once stands at both sides: "a lamp on either side" is two lamps.
        """
        taken = sides_at(texts, i)
        if not taken or self.last is None or self.opens:
            return 0
        draft, word = self.last, texts[i + 1] if texts[i] in PREPOSITIONS else texts[i]
        stated = draft.said.count or (_TWO if draft.plural else 1)
        pronoun = self.asked in _PRONOUN_COUNTS
        if not pronoun and (stated == 1 or (word in ("each", "every") and draft.said.count)):
            self.counted(_TWO * stated)
        self._finish()
        if taken == 1:
            self.waiting = _Waiting(draft, "next_to", sides=True)
        elif texts[i + taken - 1] == "of" and "aisle" in texts[i + taken : i + taken + 3]:
            self.arrange(Arrangement(form="grid", columns=_TWO))
        elif texts[i + taken - 1] == "of":
            self.waiting = _Waiting(draft, "next_to", sides=True)
        elif owner := (self.parent if self.parent is not draft else None) or self.reading.before(draft):
            self._link(draft, "next_to", (owner,), _Waiting(draft, "next_to", sides=True))
        return taken

    def _to_owner(self, name: str) -> bool:
        """Relate the last thing to what it belongs to: "a counter and two stools in front"."""
        draft = self.last
        if draft is None or self.opens or name not in _TO_OWNER:
            return False
        owner = self.parent if self.parent is not None and self.parent is not draft else self.reading.before(draft)
        if owner is None:
            return False
        self._finish()
        if name == "above":
            owner = self.reading.first(draft, seats=False) or owner
            self.reading.link(Link(draft, "above", (owner,), hard=False))
        else:
            self._link(draft, name, (owner,))
        return True

    def away(self, texts: Sequence[str], i: int) -> int:
        """Read what a distance is from, at position `i`: a part of the room, or the next thing; the number of words
        of a part of the room."""
        self._finish()
        behind = self._structure(texts, i, "against", 0)
        if not behind:
            distance, self.distance = self.distance, None
            self.waiting = _Waiting(self.last if not self.opens else None, "far_from", distance=distance)
        return behind

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
        elif part in ("corner", "corners") and name in ("inside", "at", "against", "on"):
            walls = [w for s in sides for w in vocabulary.CORNERS.get(s, ())]
            for wall in dict.fromkeys(walls) or (None,):
                self._place("in_corner", cast("Wall | None", wall))
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
            if subject.several and subject.arrangement is None and subject.said.arrangement is None:
                subject.arrangement = Arrangement(form="row")
        elif spot == "facing":
            self._face_each_other(subject)
        elif spot == "wall":
            self._at_wall("on", None)
        elif spot.startswith("rel "):
            self._to_owner(spot.removeprefix("rel "))
        elif spot.startswith("part "):
            self.reading.link(Link(subject, "against_wall", (), cast(Wall, spot.removeprefix("part ")), False))
        elif spot == "walls":
            self.reading.link(Link(subject, "against_wall", sides=True))
        elif spot == "floor":
            subject.support = "floor"
        else:
            subject.support = "ceiling"
            owner = self.parent if self.parent is not subject else None
            if (owner := owner or self.reading.first(subject)) is not None:
                self.reading.link(Link(subject, "above", (owner,), hard=False))

    def _face_each_other(self, subject: Draft) -> None:
        other = subject if subject.several else self.reading.before(subject)
        if other is not None:
            self.reading.link(Link(subject, "facing", (other,)))
            if other is not subject:
                self.reading.link(Link(other, "facing", (subject,)))

    def _place(self, name: WishName, wall: Wall | None) -> None:
        if self.last is None or self.opens:
            self._ahead.append(Link(_NOBODY, name, (), wall))
        else:
            distance, self.distance = self.distance, None
            self.reading.link(Link(self.last, name, (), wall, distance=distance))
