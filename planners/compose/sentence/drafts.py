"""Collect the things of a description with their counts and relations while it is read, and turn them into a brief.

Resolves pronouns and phrases such as "the table" to earlier things. `read.py` parses the words.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from ....gaussians.world.kinds import Kind
from ....gaussians.world.relations import WishName
from ....gaussians.world.words import is_plural, singular
from ...layout.problem import Wall
from .. import knowledge
from ..brief import Arrangement, Brief, RefusedError, Relation, RoomSize, Scale, Thing
from .amounts import Side

_BARE_PLURAL = 2  # count of "chairs" where the kind of room has no habit of chairs
_ONE = (
    "headphones",
    "scales",
    "scale",
    "drums",
    "stairs",
    "steps",
    "binoculars",
    "clothes",
)  # plural names of one thing
_MOST = 60  # most of one thing


@dataclass(frozen=True)
class Said:
    """The modifiers before a noun."""

    count: int | None = None
    determiner: Literal["", "a", "the", "each"] = ""
    color: str = ""
    material: str = ""
    scale: Scale | None = None
    sides: dict[Side, float] = field(default_factory=dict)
    styles: tuple[str, ...] = ()
    shape: str = ""
    own: bool = False  # "its own monitor": one for each of what it belongs to
    arrangement: Arrangement | None = None

    @property
    def plain(self) -> bool:
        """Whether no modifier distinguishes the thing from one that was mentioned before."""
        return self.count is None and not (self.color or self.material or self.scale or self.sides)


@dataclass
class Draft:
    """One thing while it is read. Where `each` is a draft, the count is per thing of that draft."""

    name: str
    said: Said
    plural: bool
    support: Literal["floor", "wall", "ceiling"] | None = None
    each: Draft | None = None
    placed: bool = False  # whether it is the subject of a relation
    arrangement: Arrangement | None = None
    called: str = ""  # the noun that was said, where it is not the name
    seated: bool = False  # whether its count is that of the people, where none is stated

    @property
    def kind(self) -> Kind | None:
        return knowledge.thing(self.name)

    @property
    def renamed(self) -> bool:
        """Whether several were said of a thing that its kind has another name for: magazines, of the kind "books"."""
        return self.plural and bool(self.called) and self.called != singular(self.name)

    @property
    def several(self) -> bool:
        return self.plural or (self.said.count or 1) > 1 or self.each is not None


@dataclass(frozen=True)
class Link:
    """A relation between drafts."""

    subject: Draft
    name: WishName
    objects: tuple[Draft, ...] = ()
    wall: Wall | None = None
    hard: bool = True
    distance: float | None = None
    sides: bool = False


class Reading:
    """The things and relations that were read from one description."""

    def __init__(self) -> None:
        self.drafts: list[Draft] = []
        self.recent: list[Draft] = []  # in the order of their last mention
        self.links: list[Link] = []
        self.capped: list[str] = []  # remarks on things of which too many were asked for
        self.suggested: list[Link] = []  # of the links those that "with" suggests: "a desk with a lamp"
        self.topic: Draft | None = None  # what "it" meant last in this sentence

    def add(self, draft: Draft) -> Draft:
        self.drafts.append(draft)
        return self.mention(draft)

    def mention(self, draft: Draft) -> Draft:
        self.recent = [d for d in self.recent if d is not draft] + [draft]
        return draft

    def known(self, name: str, head: str, without: Draft | None = None) -> Draft | None:
        """The draft that "the NAME" refers to: one of that name, or one whose name ends with the head noun."""
        others = [d for d in reversed(self.recent) if d is not without]
        if same := next((d for d in others if d.name == name), None):
            return same
        if " " in name and name.endswith(f" {head}"):  # "the teacher's desk" is not just any desk
            role = kind.role if (kind := knowledge.thing(name)) else ""
            return next((d for d in others if d.name in (head, role)), None) if role != name else None
        return next((d for d in others if d.name.endswith(head)), None)

    def parted(self, draft: Draft, color: str) -> Draft:
        """One of several things that has a colour of its own, taken out of them: "the blue tent" of two tents."""
        if draft.said.color == color:
            return draft
        count = (draft.said.count or _BARE_PLURAL) - 1
        if draft.said.color or count < 1 or draft.each is not None:
            return draft
        draft.said = replace(draft.said, count=count)
        one = replace(draft, said=replace(draft.said, count=1, color=color), plural=False)
        draft.plural = count > 1
        self.drafts.append(one)
        self.links += [replace(x, subject=one) for x in self.links if x.subject is draft and draft not in x.objects]
        return self.mention(one)

    def named_again(self, name: str, said: Said, plural: bool) -> Draft | None:
        """The single thing that a bare noun names again: "bin under the workbench, workbench 2 m wide"."""
        found = next((d for d in self.drafts if d.name == name), None)
        return found if said.plain and not plural and found is not None and not found.several else None

    def before(self, subject: Draft | None, word: str = "it", relation: str = "") -> Draft | None:
        """The draft that "it", "them" or "each" refers to in a relation of `subject`: what "it" meant before in the
        sentence, else the last single thing, the last several ones; with "on it" the last that carries things."""
        others = [d for d in reversed(self.recent) if d is not subject]
        fit = [d for d in others if d.several == (word in ("them", "these", "those", "each"))] or others
        fit = [d for d in fit if not (d.kind and d.kind.opening)] or fit
        if relation in ("on", "reversed on") and word == "it":
            fit = [d for d in fit if d.kind and (d.kind.top or d.kind.is_rug or d.kind.stores)] or fit
        elif relation not in ("inside", "under", "below") and word == "it":
            if self.topic is not None and self.topic in fit:
                return self.topic
            fit = [d for d in fit if d.kind and d.kind.support == "floor" and d.support is None] or fit
        self.topic = fit[0] if fit and word == "it" else self.topic
        return fit[0] if fit else None

    def first(self, subject: Draft, seats: bool = True) -> Draft | None:
        """The first thing on the floor, which what hangs overhead is likely above; without `seats` no seat."""
        found = (d for d in self.drafts if d is not subject and d.kind and d.kind.support == "floor")
        return next((d for d in found if d.kind and (seats or not d.kind.seats)), None)

    def pair(self, subject: Draft | None) -> tuple[Draft, ...]:
        """The drafts that "them" refers to: one draft of several things, or the last two drafts."""
        others = [d for d in reversed(self.recent) if d is not subject]
        others = [d for d in others if d.each not in others]  # of two beds with a lamp each, "them" is the beds
        if many := next((d for d in others[:2] if d.several), None):
            return (many,)
        return tuple(reversed(others[:2]))

    def link(self, link: Link) -> None:
        """Add a relation, unless it is there already."""
        link.subject.placed = True
        if link.objects:  # what is said replaces what "with" suggests
            gone = [x for x in self.suggested if x.subject is link.subject and (
                x.objects != link.objects or x.name in ("on", "next_to"))]  # fmt: skip
            self.links = [x for x in self.links if not any(x is g for g in gone)]
        self.suggested = [x for x in self.suggested if x != link]
        if link not in self.links:
            self.links.append(link)

    def suggest(self, link: Link) -> None:
        """Add a relation that "with" suggests; a stated relation of the same thing replaces it."""
        self.link(link)
        self.suggested.append(link)

    def seat_chairs(self) -> None:
        """Relate chairs without a relation to the last table by a soft "around"."""
        tables = [d for d in self.drafts if d.kind and d.kind.top and d.kind.support == "floor" and _is_table(d.name)]
        for chair in self.drafts:
            if chair.placed or not tables or not chair.kind or chair.kind.seats != 1 or not _is_chair(chair.name):
                continue
            self.link(Link(chair, "around", (tables[-1],), hard=False))

    def remarks(self) -> list[str]:
        """What cannot be provided or shown as described, a sentence each."""
        found = []
        for draft in self.drafts:
            if (draft.said.count or 0) > _MOST:
                found.append(
                    f"{draft.said.count} of “{draft.name}” were asked for; at most {_MOST} of a kind are built"
                )
            if draft.kind is None:
                found.append(f"the usual size of a {draft.name} is unknown; it is a plain box of half a metre")
            if draft.said.shape and draft.said.shape not in draft.name and not (draft.kind and draft.kind.round):
                found.append(f"the shape of the {draft.name} ({draft.said.shape}) is not shown")
        return found

    def counts(self, room: str, seats: int | None = None) -> dict[int, int]:
        """The number of things of each draft, by `id(draft)`; `seats`: people, each of whom gets "each desk"."""
        habits = {h.thing: h.count[1] for h in knowledge.room(room).habits}
        found: dict[int, int] = {}

        def count(draft: Draft, deep: int = 0) -> int:
            own = draft.said.count
            if own is None and draft.seated and seats:
                own = seats
            one = draft.called in _ONE or draft.name in _ONE or f"{draft.name}s" in _ONE
            if own is None and draft.kind and (one or (is_plural(draft.kind.name) and not draft.renamed)):
                own = 1  # string lights are one thing
            if own is None:
                own = max(habits.get(draft.name, 0), _BARE_PLURAL) if draft.plural and not draft.each else 1
            times = count(draft.each, deep + 1) if draft.each is not None and deep < 4 else 1
            if own * times > _MOST and draft.each is not None:
                self.capped.append(f"{own * times} of “{draft.name}” were asked for; at most {_MOST} are built")
            return max(1, min(own * times, _MOST))

        for draft in self.drafts:
            found[id(draft)] = count(draft)
        return found


def _is_chair(name: str) -> bool:
    return name.rsplit(" ", 1)[-1] in ("chair", "stool")


def _is_table(name: str) -> bool:
    return name.rsplit(" ", 1)[-1] in ("table", "desk", "island") and name not in ("side table", "coffee table")


def brief_of(reading: Reading, kind: str, seats: int | None, size: dict[Side, float], **rest: Any) -> Brief:
    """A brief from everything that was read."""
    reading.seat_chairs()
    counts = reading.counts(kind, seats)
    rest["remarks"] = tuple(dict.fromkeys((*rest.get("remarks", ()), *reading.capped)))[:64]
    drafts = _within(reading.drafts, counts)
    ids = _ids(drafts)
    things = tuple(_thing(d, ids[id(d)], counts[id(d)]) for d in drafts)
    relations = tuple(
        Relation(
            subject=ids[id(x.subject)],
            name=x.name,
            objects=tuple(ids[id(o)] for o in x.objects),
            wall=x.wall,
            hard=x.hard,
            distance=x.distance,
            sides=x.sides,
        )
        for x in reading.links
        if all(id(d) in ids for d in (x.subject, *x.objects))
    )
    return Brief(kind=kind, seats=seats, size=_room_size(size), things=things, relations=relations, **rest)


def _within(drafts: Sequence[Draft], counts: dict[int, int]) -> list[Draft]:
    """As many drafts as a brief may hold; reduces `counts` where there are too many things."""
    left, kept = 200, list[Draft]()
    for draft in drafts[:64]:
        if left <= 0:
            break
        counts[id(draft)] = min(counts[id(draft)], left)
        left -= counts[id(draft)]
        kept.append(draft)
    return kept


def _ids(drafts: Iterable[Draft]) -> dict[int, str]:
    """Ids by `id(draft)`: the names, with a number from the second draft of the same name on."""
    used: dict[str, int] = {}
    found = {}
    for draft in drafts:
        used[draft.name] = used.get(draft.name, 0) + 1
        found[id(draft)] = draft.name if used[draft.name] == 1 else f"{draft.name} {used[draft.name]}"
    return found


def _thing(draft: Draft, id: str, count: int) -> Thing:
    said, sides = draft.said, draft.said.sides
    long = sides.get("long", sides.get("any"))
    return Thing(
        id=id,
        name=draft.name,
        count=count,
        color=said.color,
        material=said.material,
        scale=said.scale or "normal",
        width=_side(sides.get("width", long)),
        depth=_side(sides.get("depth", long if "width" in sides else None)),
        height=_side(sides.get("height")),
        support=draft.support,
        arrangement=draft.arrangement or said.arrangement,
        called=draft.called[:60],
    )


def _side(length: float | None) -> float | None:
    """A stated length, rounded to millimetres.

    Raises:
        RefusedError: it is outside 0.005 m to 100 m.
    """
    if length is not None and not 0.005 <= length <= 100:
        raise RefusedError(f"{length:g} m cannot be built; give a size from 0.005 m to 100 m", "impossible")
    return None if length is None else round(length, 3)


def _room_size(sides: dict[Side, float]) -> RoomSize | None:
    if not sides:
        return None
    depth = sides.get("depth", sides.get("long", sides.get("any")))  # "a 1 m closet" is one by one
    width = sides.get("width", sides.get("any"))
    area = sides.get("area")
    return RoomSize(
        width=_side(width), depth=_side(depth), height=_side(sides.get("height")), area=min(area, 1e4) if area else None
    )


def changed(draft: Draft, said: Said) -> None:
    """Add modifiers to a thing that was mentioned before."""
    draft.said = replace(
        draft.said,
        color=said.color or draft.said.color,
        material=said.material or draft.said.material,
        scale=said.scale or draft.said.scale,
        sides={**draft.said.sides, **said.sides},
    )
