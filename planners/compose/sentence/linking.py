"""Attach relations to things: "next to it", "a counter with a pastry display", "one on each side of it".

Depends on the order of things and places in a sentence only; `read.py` recognises the names.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, cast

from ....gaussians.world.relations import WishName
from ...grammar.tagging.lookahead import match
from ...layout.problem import Wall
from ..brief import Arrangement
from . import vocabulary
from .drafts import Draft, Link, Reading, Said, changed
from .relating import PREPOSITIONS, layout_name, sides_at

_SKIPPED = frozenset({
    "the", "a", "an", "one", "each", "every", "all", "both", "opposite", "that", "my", "its", "two", "other", "end",
    "long", "short", "same", "near", "main", "whole", "entire", "upper", "lower", "top", "bottom", "adjacent", "four",
    "three", "longer", "shorter", "side", "opposing", "facing", "remaining", "white", "brick", "stone", "wooden", "of",
})  # fmt: skip
_SOME = {"two": 2, "both": 2, "opposite": 2, "three": 3}
_EVERY = frozenset({"each", "every", "all", "four"})
_ROOM_SIDES: dict[str, Wall] = {"behind": "north", "in_front_of": "south", "left_of": "west", "right_of": "east"}
_AT_WINDOW = frozenset({"next_to", "under", "below", "at", "in_front_of", "against", "inside"})


_TWO, _CORNERS, _FULL = 2, 4, 4
_TIMES_AS_LONG = 2.5  # as a thing on a rug, say: how much longer things listed before it may be to stand there too
_ENDS = (",", ".", ";", "and", "!", "?", "\n")
_NEAREST = frozenset({"next_to", "in_front_of", "behind", "left_of", "right_of", "against"})
_TO_OWNER = frozenset({
    "in_front_of", "behind", "on", "under", "below", "next_to", "around", "above", "left_of", "right_of", "between",
    "facing",
})  # fmt: skip
_NOBODY = Draft("", Said(), False)  # the subject of a relation until its thing is read
_VAGUE = frozenset({"inside", "at", "from", "across"})  # "in summer": no place of a thing
_PRONOUN_COUNTS = ("one", "two", "three", "four", "five", "six", "half")


@dataclass
class _Waiting:
    """A relation whose object has not been read yet; None as subject stands for the next thing."""

    subject: Draft | None
    name: str
    distance: float | None = None
    found: tuple[Draft, ...] = ()
    sides: bool = False
    owner: Draft | None = None  # what has the subject in a list behind "with"
    peers: tuple[Draft, ...] = ()  # things before the subject in its list: "a lamp and a clock on the desk"


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
        self.lost: list[str] = []  # sentences about places that were not understood
        self.listed = False  # whether a list of what each has goes on behind a comma
        self.asked = ""  # the word before the place that is read
        self.distance: float | None = None  # metres that belong to the relation that follows
        self._ahead: list[Link] = []  # relations of the next thing; their subjects are not read yet
        self._negating = False
        self._each = False
        self._each_of: Draft | None = None  # "each desk …": what follows is one for each of it
        self._own = False  # "its own chair, monitor and lamp": the list goes on behind commas
        self._ahead_support: Literal["wall", "ceiling", "floor"] | None = None
        self._ahead_each: Draft | None = None  # "around each of them": of what the next thing is there once for each
        self._fronted: list[Link] = []  # relations of the last thing that stood before it, which the next ones share
        self._sharing: list[Draft] = []  # things that share them unless they have a place of their own
        self._list: list[Draft] = []  # things that are listed since the last place or end of a clause
        self._and = False  # whether the last separator is "and"
        self._owner: Draft | None = None  # of a list behind "with", what has the things in it

    # ---- punctuation and little words ------------------------------------------------------------------------------

    def comma(self, goes_on: bool = False) -> None:
        """Handle a comma; `goes_on`: a list goes on behind it up to an "and"."""
        self._finish()
        self.distance, self._negating, self.fresh, self._and = None, False, None, False
        self.listed = goes_on and self.parent is not None and self.parent is self._each_of
        if not self._own and not self.listed:
            self.parent = None

    def front(self) -> None:
        """Let a place that follows be that of the next thing: "…, on it two candles"."""
        self._share_front()
        self._finish()
        self._list, self._own, self._owner = [], False, None
        self.opens, self.parent, self.fresh = True, None, None

    def _share_front(self) -> None:
        """Give the things that were listed behind "on it a till" their place, unless they have one."""
        links, drafts = self._fronted, self._sharing
        self._fronted, self._sharing = [], []
        for draft in drafts:
            if draft.placed or draft.support:
                continue
            for link in links:
                if _may_share(draft, link):
                    self.reading.link(replace(link, subject=draft, hard=link.hard and link.name in ("on", "inside")))

    def stop(self) -> None:
        self._own = False
        self.comma()
        self._share_front()
        self._list, self._owner = [], None
        self.opens, self._each, self._each_of = True, False, None
        self.reading.topic = None

    def joined(self, word: str) -> None:
        """Handle "with", which relates the following things to the last one, and "and" and "but"."""
        self.fresh = None
        if word == "and":
            if self.waiting and self.waiting.name == "between":
                return
            self._finish()
            self._and = True
        else:
            self._finish()
            self._negating = False
            self._list = []
            self.parent = self._owner = self.last if word == "with" else None
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
        waiting, self.waiting = self.waiting, None
        if waiting is not None:
            self._lose(waiting)

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
        elif waiting is not None:
            self._lose(waiting)

    def _lose(self, waiting: _Waiting) -> None:
        """Note a place that is not understood, as the thing that it names was not."""
        if waiting.subject is not None and waiting.subject.name and waiting.name not in _VAGUE:
            words = waiting.name.removeprefix("reversed ").replace("_", " ")
            said = f"what the {waiting.subject.name} is {words} was not understood"
            self.lost.append(said)

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
        again = self.reading.named_again(name, said, plural) if not said.determiner else None
        if again or (said.determiner in ("the", "each") and (again := self.reading.known(name, head))):
            before = again
            changed(before, said)
            self.last = self.reading.mention(before)
            self._each_of = before if each else self._each_of
            self._take_ahead(before)
            self._list = [before]
            return
        draft = self.reading.add(Draft(name, said, plural or each, seated=each, called=called))
        on = all(x.name in ("on", "inside") for x in self._fronted)
        if not self._take_ahead(draft) and self._fronted and (on or self._and):
            self._sharing.append(draft)
        self._list.append(draft)
        parent = self.parent
        if parent is not None and self._own and not said.own and (said.determiner or said.count or plural):
            parent, self.parent, self._own = None, None, False  # the list of "its own …" has ended
        if parent is not None and not opens:
            if parent is self._each_of or said.own or (parent.each is not None and said.determiner == "a"):
                draft.each = parent
            self._own = self._own or said.own
            self._attach(draft, parent)
        if each:
            self._each_of = draft
        self.last = draft

    def _take_ahead(self, draft: Draft) -> bool:
        """Give a thing the places that stood before it; whether there were any."""
        links, support, owner = self._ahead, self._ahead_support, self._ahead_each
        self._ahead, self._ahead_support, self._ahead_each = [], None, None
        if owner is not None and owner is not draft:
            draft.each = owner
        draft.support = support or draft.support
        own = [replace(x, subject=draft) for x in links if draft not in x.objects]
        for link in own:
            if (
                link.sides
                and (link.objects or link.name == "in_corner")
                and (draft.said.count or 1) == 1
                and not draft.plural
            ):
                draft.said = replace(draft.said, count=_TWO if link.objects else _CORNERS)
            self.reading.link(replace(link, name=layout_name(link.name, draft, link.objects[0], link.sides))
                              if link.objects else link)  # fmt: skip
        if own:
            self._fronted, self._sharing = own, []
        return bool(own)

    def _resolved(self, name: str, head: str, said: Said, plural: bool, each: bool) -> Draft:
        """The draft of an object, mentioned before or new; "on each table" counts the subject once per table."""
        assert self.waiting is not None
        subject = self.waiting.subject
        if said.own and subject is not None:  # "each facing its own mirror"
            return self.reading.mention(self.reading.add(Draft(name, said, False, each=subject)))
        known = self.reading.known(name, head, subject) if said.plain or said.determiner == "the" else None
        if known is not None and said.color and known.several and not plural:
            known = self.reading.parted(known, said.color)
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
        if waiting.owner is not None and _belongs_to_owner(waiting, draft):
            waiting.subject, waiting.peers = waiting.owner, ()
        if waiting.subject is None:
            self.reading.topic = draft
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
            owner = self.parent or waiting.owner  # "a desk with a lamp on it"
            owner = owner if owner is not waiting.subject else None
            if word == "each" and owner is not None and not owner.several:
                owner = None
            one = owner or self.reading.before(waiting.subject, word, waiting.name)
            objects = (one,) if one else ()
        self.waiting = None
        one = waiting.subject
        owned = word == "it" and bool(objects) and objects[0].each is not None
        if owned and one is not None and one.said.determiner == "a" and one.each is None:
            one.each = objects[0]
        if word == "each" and objects:
            for draft in (waiting.subject, *waiting.peers):
                if draft is not None and draft is not objects[0]:
                    draft.each = objects[0]
            self._ahead_each = objects[0] if waiting.subject is None else self._ahead_each
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
        if name == "across":  # "two sofas facing each other across a table": it is between them
            if subject.several:
                self.reading.link(Link(first, "between", (subject,)))
            else:
                self.reading.link(Link(subject, "facing", (first,)))
            return
        if name.startswith("reversed "):
            if name == "reversed on" and first.plural and first.said.count is None:
                first.said = replace(first.said, count=_FULL if not subject.several else _TWO)
                first.each = subject if subject.several else first.each
            self._link(first, name.removeprefix("reversed "), (subject,), said)
            self.last = subject
            return
        if first.name == "window" and name in _AT_WINDOW:
            self.reading.link(Link(subject, "at_window", distance=distance))
            if name in ("under", "below"):
                self.reading.link(Link(subject, "under", (first,)))
            return
        link = Link(subject, layout_name(name, subject, first, sides), objects, distance=distance, sides=sides)
        self.reading.link(link)
        for peer in said.peers if said is not None else ():
            if not peer.placed and peer not in objects and _may_share(peer, link):
                kin = peer.kind is not None and subject.kind is not None and peer.kind.support == subject.kind.support
                name = layout_name(link.name, peer, first, sides)
                self.reading.link(replace(link, subject=peer, name=name, hard=kin or name in ("on", "inside")))

    def _attach(self, child: Draft, parent: Draft) -> None:
        """Add the relation that "with" means for two things, if any."""
        small, large = child.kind, parent.kind
        if not small or not large:
            return
        carries = large.support == "floor" and not large.seats and large.role != "bed" and not large.opening
        if small.support == "surface" and (large.top or large.name in small.on or carries):
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
        large = self.last is not None and self.last.kind is not None and self.last.kind.support != "surface"
        if self.fresh is not None and found[0] in ("on", "inside") and _is_small(self.fresh) and large:
            self.last = self.fresh  # "chairs facing a television on a stand": the television is on it
        self.fresh, self.carried = None, found[0] in ("on", "inside", "under")
        self._finish()
        distance, self.distance = self.distance, None
        subject = self.last if not self.opens else None
        owner = self._owner if subject is not None and subject in self._list else None
        self.waiting = _Waiting(subject, found[0], distance, owner=owner, peers=self._peers(subject))
        return found[1]

    def _peers(self, subject: Draft | None) -> tuple[Draft, ...]:
        """The things before a subject that its place is said of too: "a lamp and a clock on the desk"."""
        listed, self._list = self._list, []
        if subject is None or not self._and or not listed or listed[-1] is not subject:
            return ()
        return tuple(d for d in listed[:-1] if not d.placed)

    def _sides(self, texts: Sequence[str], i: int) -> int:
        """Read "on either side of", "down each side", "one on the left and one on the right of"; the number of words.

        A thing that is named once stands at both sides: "a lamp on either side" is two lamps.
        """
        taken = sides_at(texts, i)
        if taken and self.opens and texts[i] != "of":
            return self._sides_ahead(texts, i, taken)
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

    def _sides_ahead(self, texts: Sequence[str], i: int, taken: int) -> int:
        """Read "at either end of the table" before its thing; the number of words."""
        self._finish()
        self.waiting = _Waiting(None, "next_to", sides=True)
        if texts[i + taken - 1] != "of":
            one, self.waiting = self.reading.before(None), None
            if one is not None:
                self._link(None, "next_to", (one,), _Waiting(None, "next_to", sides=True))
        return taken

    def _to_owner(self, name: str) -> bool:
        """Relate the last thing to what it belongs to: "a counter and two stools in front"."""
        draft = self.last
        if draft is None or self.opens or name not in _TO_OWNER:
            return False
        owner = self.parent if self.parent is not None and self.parent is not draft else None
        if owner is not None and _is_small(draft) and name in _NEAREST and not draft.several:
            draft, owner = owner, None  # "a tripod with a camera in front": that is where the tripod is
        owner = owner or self.reading.before(draft, relation=name)
        if owner is None:
            return False
        self._finish()
        if name == "above":
            owner = self.reading.first(draft, seats=False) or owner
            self.reading.link(Link(draft, "above", (owner,), hard=False))
        elif name == "between":
            pair = (owner,) if owner.several else self.reading.pair(draft)
            if len(pair) == _TWO or (pair and pair[0].several):
                self.reading.link(Link(draft, "between", pair))
        else:
            distance, self.distance = self.distance, None
            self._link(draft, name, (owner,), _Waiting(draft, name, distance))
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
        every = bool(_EVERY & set(texts[i + taken : j]))
        some = next((n for w in texts[i + taken : j] if (n := _SOME.get(w))), 0)
        sides = []
        while j < len(texts) and (texts[j] in vocabulary.CORNERS or texts[j] in vocabulary.WALLS):
            sides.append(texts[j])
            j += 1
        part = texts[j] if j < len(texts) else ""
        if part in ("wall", "walls") and name in ("against", "on", "at", "next_to", "inside", "in_front_of"):
            self._at_wall(name, vocabulary.WALLS.get(sides[-1]) if sides else None)
        elif part in ("corner", "corners") and name in ("inside", "at", "against", "on"):
            walls = [w for s in sides for w in vocabulary.CORNERS.get(s, ())]
            if every or (part == "corners" and not walls):
                if some and self.last is not None and not self.opens and not self.last.said.count:
                    self.counted(some)
                self._spot("corners")
            else:
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
        elif spot == "corners":
            self._place("in_corner", None, sides=True)
            if subject is not None and (subject.said.count or 1) == 1 and self.last is subject:
                self.counted(_CORNERS)
        elif subject is None:
            if spot.startswith("part "):
                self._ahead.append(Link(_NOBODY, "against_wall", (), cast(Wall, spot.removeprefix("part ")), False))
            elif spot in ("wall", "ceiling", "floor"):
                self._ahead_support = cast(Literal["wall", "ceiling", "floor"], spot)
            elif spot.startswith("rel ") and (one := self.reading.before(None)) is not None:
                self._link(None, spot.removeprefix("rel "), (one,))
        elif spot == "aligned_with":
            self.reading.link(Link(subject, "aligned_with", (subject,)))
            if subject.several and subject.arrangement is None and subject.said.arrangement is None:
                subject.arrangement = Arrangement(form="row")
        elif spot == "facing":
            self._face_each_other(subject)
        elif spot == "beside":
            self._side_by_side(subject)
        elif spot == "wall":
            self._at_wall("on", None)
        elif spot.startswith("rel "):
            self._to_owner(spot.removeprefix("rel "))
        elif spot in ("one side", "other side"):
            if (table := self._table_of(subject)) is not None:
                self.reading.link(Link(subject, "around", (table,)))
            else:
                wall: Wall = "west" if spot == "one side" else "east"
                self.reading.link(Link(subject, "against_wall", (), wall, False))
        elif spot.startswith("part "):
            self.reading.link(Link(subject, "against_wall", (), cast(Wall, spot.removeprefix("part ")), False))
        elif spot == "walls":
            self.reading.link(Link(subject, "against_wall", sides=True))
        elif spot == "floor":
            subject.support, subject.placed = "floor", True
        else:
            subject.support, subject.placed = "ceiling", True
            owner = self.parent if self.parent is not subject else None
            if (owner := owner or self.reading.first(subject)) is not None:
                self.reading.link(Link(subject, "above", (owner,), hard=False))

    def _table_of(self, subject: Draft) -> Draft | None:
        """The table that a seat "on one side" is at."""
        other = self.reading.before(subject)
        seat = subject.kind is not None and subject.kind.seats == 1
        return other if seat and other is not None and other.kind and other.kind.top and not other.kind.seats else None

    def more_at(self, count: int) -> None:
        """Handle "and three along each side" behind chairs at a table: that many more of the last thing."""
        if self.last is not None:
            self.counted((self.last.said.count or 1) + count)

    def _side_by_side(self, subject: Draft) -> None:
        if subject.several:
            self.reading.link(Link(subject, "aligned_with", (subject,)))
            self.reading.link(Link(subject, "next_to", (subject,)))
            if subject.arrangement is None and subject.said.arrangement is None:
                subject.arrangement = Arrangement(form="row")
        elif (other := self.reading.before(subject)) is not None:
            self.reading.link(Link(subject, "next_to", (other,)))
            self.reading.link(Link(subject, "aligned_with", (other,), hard=False))

    def _face_each_other(self, subject: Draft) -> None:
        other = subject if subject.several else self.reading.before(subject)
        if other is not None:
            self.reading.link(Link(subject, "facing", (other,)))
            if other is not subject:
                self.reading.link(Link(other, "facing", (subject,)))

    def _place(self, name: WishName, wall: Wall | None, sides: bool = False) -> None:
        if self.last is None or self.opens:
            self._ahead.append(Link(_NOBODY, name, (), wall, sides=sides))
            return
        distance, self.distance = self.distance, None
        self.reading.link(Link(self.last, name, (), wall, distance=distance, sides=sides))
        for peer in self._peers(self.last):
            if name == "against_wall" and peer.kind and self.last.kind and peer.kind.support == self.last.kind.support:
                self.reading.link(Link(peer, name, (), wall))


def _is_small(draft: Draft) -> bool:
    return draft.kind is None or draft.kind.support == "surface"


def _share_ground(draft: Draft, subject: Draft) -> bool:
    """Whether what a floor thing stands on carries a large one before it too: sofas and the table among them on a rug,
    but not the bed that was listed before a ball."""
    if draft.kind is None or subject.kind is None or subject.kind.support == "surface":
        return False
    return max(draft.kind.usual_size) <= _TIMES_AS_LONG * max(subject.kind.usual_size)


def _may_share(draft: Draft, link: Link) -> bool:
    """Whether a thing in a list shares the place of another one of it, where only that one's is stated."""
    kind = draft.kind
    if draft in link.objects or draft is link.subject:
        return False
    small = _is_small(draft)
    if kind is not None and kind.seats == 1 and link.name in ("under", "below"):
        return False  # chairs are at the table that is there
    if link.name in ("on", "inside"):
        first = link.objects[0].kind
        return small or _share_ground(draft, link.subject) or (first is not None and first.name == "stage")
    if link.name in ("in_center", "in_corner", "next_to", "between", "around", "aligned_with"):
        return False
    return not small or link.name in ("under", "below")


def _belongs_to_owner(waiting: _Waiting, other: Draft) -> bool:
    """Whether a place behind "a desk with a lamp" is that of the desk: "by the window"."""
    small, owner = waiting.subject, waiting.owner
    if small is None or owner is None or other is owner or owner.placed or small.several:
        return False
    return _is_small(small) and bool(owner.kind) and waiting.name in (
        "next_to", "facing", "left_of", "right_of", "in_front_of", "behind", "against", "between", "at",
    )  # fmt: skip
