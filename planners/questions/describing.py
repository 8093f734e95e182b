"""A description of a scene from measured facts: one paragraph, and a line for each thing.

Nothing is told that is not in a survey: sizes, colours, what stands on what, facing and places by boxes; the kind of
room by what it holds. Things without a sure name are told as such.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from ...gaussians.world import kinds, relations
from ...gaussians.world.relation_geometry import HOLDS
from ...gaussians.world.words import plural, singular
from ..rooms.node import NodeId
from .floor.ends import place_words
from .placing import place_of, sides
from .relating import related, supporter
from .room_kind import RoomGuess, room_kinds
from .survey import Survey, Thing, listed, with_article

SURE_ROOM, MAYBE_ROOM = 0.6, 0.45  # probabilities from which a kind of room is told, and told with "perhaps"
_MAIN = 14  # things on the floor that the paragraph tells
_NEAR_SEAT = 0.6  # metres between a table and the chairs at it
_NUMBERS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve")


@dataclass(frozen=True)
class ThingCaption:
    """One thing in words.

    Attributes:
        id: in the scene graph.
        name: "" if nobody could tell.
        color: "" if unknown.
        size: width, depth and height, metres.
        place: where it is, in the viewer's frame: "at the back wall, next to the bed".
        holds: ids of what stands on it or in it.
        text: all of it as one line.
    """

    id: NodeId
    name: str
    color: str
    size: tuple[float, float, float]
    place: str
    holds: tuple[NodeId, ...]
    text: str


@dataclass(frozen=True)
class Description:
    """A scene in words.

    Attributes:
        text: one paragraph.
        room_kind: the kind of room it seems to be, "" if that is not clear.
        things: a caption for each thing, in the order of the graph.
    """

    text: str
    room_kind: str
    things: tuple[ThingCaption, ...]

    def to_json(self) -> dict[str, Any]:
        """As plain JSON data; sizes in metres to the millimetre."""
        return {
            "text": self.text,
            "room_kind": self.room_kind,
            "things": [
                {
                    "id": t.id,
                    "name": t.name,
                    "color": t.color,
                    "size": [round(s, 3) for s in t.size],
                    "place": t.place,
                    "holds": list(t.holds),
                    "text": t.text,
                }
                for t in self.things
            ],
        }


def describe(survey: Survey) -> Description:
    """The scene in words; names that are hardly right are not told."""
    survey = survey.with_sure_names()
    guesses = room_kinds(survey)
    best = guesses[0] if guesses and guesses[0].probability >= MAYBE_ROOM else None
    parts = [
        _room(survey, best),
        *_furniture(survey),
        *_walls(survey),
        *_colors(survey),
        _floor(survey),
        *_unnamed(survey),
    ]
    captions = tuple(caption(t, survey) for t in survey.things)
    return Description(" ".join(p for p in parts if p), best.name if best else "", captions)


def caption(thing: Thing, survey: Survey) -> ThingCaption:
    """One thing in words: "gray bed, 1.76 m wide, 2.10 m deep and 0.95 m high, at the left wall; on it: 2 cushions"."""
    assert thing.node is not None
    node = thing.node
    place = ", ".join(w for w in place_of(thing, survey) if w)
    held = [t for t in survey.things if t.node is not None and t.node.support == thing.id]
    what = " ".join(w for w in (thing.color, thing.name) if w)
    width, depth, height = node.size
    text = f"{what}: {_metres(width)} wide, {_metres(depth)} deep and {_metres(height)} high, {place}"
    if held:
        text += f"; on it: {listed(_counted(held))}"
    return ThingCaption(node.id, thing.label, thing.color, node.size, place, tuple(t.id for t in held), f"{text}.")


def _metres(side: float) -> str:
    return f"{side:.2f} m" if side >= 0.995 else f"{100 * side:.0f} cm"


# -- the paragraph -----------------------------------------------------------------------------------------------------


def _room(survey: Survey, guess: RoomGuess | None) -> str:
    width, depth, height = sides(survey)
    if guess is None:
        what = "This room"
    else:
        kind = with_article(guess.name)
        what = (
            f"This is {kind if guess.probability >= SURE_ROOM else f'perhaps {kind}'}, going by what stands in it; it"
        )
    return f"{what} is {width:.1f} m wide, {depth:.1f} m deep and {height:.1f} m high ({width * depth:.0f} m2)." + (
        "" if survey.scaled else " Its scale is not known: one unit of the scene is read as a metre."
    )


def _furniture(survey: Survey) -> Iterator[str]:
    """Groups of things that belong together, then the other main things by where they are, and what is on them."""
    standing = sorted(
        (
            t
            for t in survey.things
            if t.label and t.node is not None and supporter(t, survey) == "floor" and not _opening(t)
        ),
        key=lambda t: -_importance(t),
    )
    rugs = [t for t in standing if t.node is not None and t.node.is_stepped_on]
    main = [t for t in standing if t not in rugs]
    told: set[int] = set()
    for group in (_facing, _around_tables, _beside_beds):
        for sentence, things in group(main, survey, told):
            told.update(t.row for t in things)
            yield sentence
    rest = [t for t in main if t.row not in told]
    shown = rest[: max(_MAIN - len(told), 4)]
    yield from _by_place(shown, survey)
    if left := [t for t in rest if t not in shown]:
        yield f"There {'is' if len(left) == 1 else 'are'} also {listed(_counted(left))}."
    if rugs:
        yield _rugs(rugs, survey)
    yield from _on_things(survey, told)


def _importance(thing: Thing) -> float:
    """Larger things first; seats, beds and tables before storage of the same size."""
    assert thing.node is not None
    kind = kinds.of(thing.label)
    width, depth, height = thing.node.size
    used = kind is not None and (
        kind.seats > 0 or kind.role in ("bed", "desk", "dining table", "piano", "stove", "bathtub")
    )
    return (width * depth + 0.2 * width * depth * height) * (2.0 if used else 1.0)


def _facing(main: Sequence[Thing], survey: Survey, told: set[int]) -> Iterator[tuple[str, list[Thing]]]:
    """Sofas and armchairs that face a television, with the table between."""
    screens = [
        t
        for t in survey.things
        if (k := kinds.of(t.label)) is not None and k.role in ("television", "projector screen")
    ]
    seats = [t for t in main if (k := kinds.of(t.label)) is not None and k.role in ("sofa", "armchair")]
    for screen in screens[:1]:
        looking = [s for s in seats if s.row not in told and survey.has_front(s) and _faces(s, screen, survey)]
        if not looking:
            continue
        low = [t for t in related("between", (looking[0], screen), survey)
               if (k := kinds.of(t.label)) is not None and k.role in ("coffee table", "table", "ottoman")]  # fmt: skip
        on = supporter(screen, survey)
        stand = [on] if isinstance(on, Thing) and on.label else []
        where = f" on {_a(stand[0])}" if stand else ""
        verb = "faces" if len(looking) == 1 else "face"
        text = f"{listed(_counted(looking))} {verb} {_a(screen)}{where}"
        if low:
            text += f", with {listed(_counted(low[:1]))} between"
        yield _sentence(text), [*looking, *low[:1], *stand, screen]


def _faces(seat: Thing, screen: Thing, survey: Survey) -> bool:
    return relations.score("facing", seat.group, [screen.group], survey.stand) >= HOLDS


def _around_tables(main: Sequence[Thing], survey: Survey, told: set[int]) -> Iterator[tuple[str, list[Thing]]]:
    """Tables and desks with the chairs at them."""
    for table in main:
        kind = kinds.of(table.label)
        if kind is None or table.row in told or not ("table" in kind.name.split() or kind.role in ("desk", "piano")):
            continue
        chairs = [
            t for t in main
            if t.row not in told and t.row != table.row and (k := kinds.of(t.label)) is not None and k.seats == 1
            and k.role not in ("armchair",) and survey.gap(t, table) <= _NEAR_SEAT
        ]  # fmt: skip
        if not chairs:
            continue
        told.update(t.row for t in (table, *chairs))
        verb = "stands" if len(chairs) == 1 else "stand"
        how = "around" if len(chairs) > 2 else "at"
        place = place_of(table, survey)[0]
        yield _sentence(f"{listed(_counted(chairs))} {verb} {how} {_a(table)} {place}"), [table, *chairs]


def _beside_beds(main: Sequence[Thing], survey: Survey, told: set[int]) -> Iterator[tuple[str, list[Thing]]]:
    """Beds with the nightstands next to them."""
    for bed in main:
        kind = kinds.of(bed.label)
        if kind is None or bed.row in told or "bed" not in (kind.name, kind.role):
            continue
        near = [t for t in related("next_to", (bed,), survey) if t.row not in told
                and (k := kinds.of(t.label)) is not None and k.role == "nightstand"][:2]  # fmt: skip
        beside = ""
        if near:
            same = len(near) == 2 and near[0].label == near[1].label and near[0].color == near[1].color
            beside = f", {_a(near[0])} on either side" if same else f", {listed(_counted(near))} next to it"
        yield _sentence(f"{_a(bed)} stands {place_of(bed, survey)[0]}{beside}"), [bed, *near]


def _by_place(things: Sequence[Thing], survey: Survey) -> Iterator[str]:
    """Things by where they are: "At the back wall are a white wardrobe and a white dresser."."""
    places: dict[str, list[Thing]] = {}
    for thing in things:
        places.setdefault(place_of(thing, survey)[0], []).append(thing)
    clauses = [
        f"{place} {'are' if len(found) > 1 else 'is'} {listed(_counted(found))}" for place, found in places.items()
    ]
    for start in range(0, len(clauses), 3):
        yield _sentence("; ".join(clauses[start : start + 3]))


def _rugs(rugs: Sequence[Thing], survey: Survey) -> str:
    places = [place_of(r, survey)[0] for r in rugs]
    if len(rugs) == 1:
        return _sentence(f"{_a(rugs[0])} lies {places[0]}")
    return _sentence(f"{listed(_counted(rugs))} lie on the floor")


def _on_things(survey: Survey, told: set[int]) -> Iterator[str]:
    """What stands on what: "On the desk are a laptop and a table lamp."."""
    clauses = []
    for thing in sorted(survey.things, key=lambda t: -_importance(t) if t.node is not None else 0.0):
        held = [t for t in survey.things if t.node is not None and t.node.support == thing.id and t.label]
        held = [t for t in held if t.row not in told]
        if not held or not thing.label or (thing.node is not None and thing.node.is_stepped_on):
            continue
        clauses.append(f"on {survey.named(thing)} {'is' if len(held) == 1 else 'are'} {listed(_counted(held))}")
    for start in range(0, len(clauses), 3):
        yield _sentence("; ".join(clauses[start : start + 3]))


def _walls(survey: Survey) -> Iterator[str]:
    """Doors, windows, and what hangs on walls and from the ceiling."""
    openings = [t for t in survey.things if _opening(t)]
    if openings:
        places: dict[str, list[Thing]] = {}
        for t in openings:
            places.setdefault(place_of(t, survey)[0].removeprefix("on "), []).append(t)
        said = [f"{listed(_counted(found, colors=False))} in {place}" for place, found in places.items()]
        yield _sentence(f"There {'is' if len(openings) == 1 else 'are'} {listed(said)}")
    hung = [t for t in survey.things if t.label and t.node is not None and t.node.support == "wall" and not _opening(t)]
    if len(hung) == 1:
        yield _sentence(f"{_a(hung[0])} hangs {place_of(hung[0], survey)[0]}")
    elif hung:
        yield _sentence(f"on the walls hang {listed(_counted(hung))}")
    above = [t for t in survey.things if t.label and t.node is not None and t.node.support == "ceiling"]
    if above:
        yield _sentence(f"{listed(_counted(above))} {'hangs' if len(above) == 1 else 'hang'} from the ceiling")


def _colors(survey: Survey) -> Iterator[str]:
    """The two colours that most of the larger things have."""
    large = [t for t in survey.things if t.color and t.node is not None and not _opening(t)]
    areas: dict[str, float] = {}
    for t in large:
        assert t.node is not None
        width, depth, height = t.node.size
        areas[t.color] = areas.get(t.color, 0.0) + max(width * depth, width * height, depth * height)
    order = sorted(areas, key=lambda c: (-areas[c], c))
    if len(large) >= 4 and len(order) >= 2:
        yield f"The main colors are {order[0]} and {order[1]}."


def _floor(survey: Survey) -> str:
    floor = survey.floor
    x, y, _ = floor.most_open()
    share = 100 * floor.free / max(floor.area, 1e-9)
    return f"{share:.0f} % of the floor ({floor.free:.0f} m2) is free, most of it {place_words(x, y, survey)}."


def _unnamed(survey: Survey) -> Iterator[str]:
    """How many things have no sure name."""
    unnamed = [t for t in survey.things if not t.label and t.node is not None]
    if not unnamed:
        return
    largest = max(unnamed, key=lambda t: _importance(t))
    assert largest.node is not None
    width, depth, height = largest.node.size
    color = f"{largest.color}, " if largest.color else ""
    total = len(survey.things)
    which = (
        f"{_number(len(unnamed))} of the {total} things have"
        if len(unnamed) < total
        else f"none of the {total} things has"
    )
    sure = "no sure name" if len(unnamed) < total else "a sure name"
    several = f"{which} {sure}; the largest of them is"
    single = "one thing has no sure name; it is"
    yield _sentence(
        f"{several if len(unnamed) > 1 else single} {color}{width:.1f} m wide, {depth:.1f} m deep and "
        f"{height:.1f} m high"
    )


def _opening(thing: Thing) -> bool:
    return kinds.is_opening(thing.label)


# -- words -------------------------------------------------------------------------------------------------------------


def _a(thing: Thing) -> str:
    return _one(thing.color, thing.name)


def _one(color: str, name: str) -> str:
    """One thing with its article, names in the plural without: "a red cushion", "green books"."""
    said = " ".join(w for w in (color, name) if w)
    return said if singular(name) != name else with_article(said)


def _counted(things: Iterable[Thing], colors: bool = True) -> list[str]:
    """Things by colour and label with their numbers: "two brown nightstands", "a white lamp"."""
    names: dict[tuple[str, str], int] = {}
    for t in things:
        key = (t.color if colors else "", t.name)
        names[key] = names.get(key, 0) + 1
    return [_several(color, name, n) for (color, name), n in names.items()]


def _several(color: str, name: str, n: int) -> str:
    if n == 1:
        return _one(color, name)
    return " ".join(w for w in (_number(n), color, plural(name)) if w)


def _number(n: int) -> str:
    return _NUMBERS[n] if n < len(_NUMBERS) else str(n)


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."
