"""Read a description in words into a brief, in one pass from left to right, without a language model.

A description names a kind of room and things, with modifiers before each noun and relations after it. Unknown words are
listed in the brief, and a text that describes no room is refused. `linking` makes the relations between things.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ....gaussians.errors import UserError
from ....gaussians.world import everyday
from ....gaussians.world.finishes import described
from ....gaussians.world.words import is_plural, singular
from ...grammar.tagging.lookahead import NOUN_COLORS, color_at, match, may_be_noun
from ...grammar.tagging.words import clean
from ...grammar.vocabulary import lexicon, nouns, quantities
from ...grammar.vocabulary.unsafe import unsafe_words
from .. import knowledge
from ..brief import Brief, RefusedError
from . import amounts, vocabulary
from .amounts import Side
from .clauses import Clauses
from .drafts import Said, brief_of
from .lights import feature_mood, lights
from .linking import Linker
from .numbers_and_rows import standing, times
from .relating import sides_at
from .surfaces import extracted
from .tokenize import refuse_others, words_of

_MARKS = frozenset(".;!?\n:")
_OWNING = ("has", "have", "gets", "get")
_SAID_OF = ("be", "is", "are", "in", "painted", "all", "colored", "coloured")
_IRRELEVANT = ("selling", "sells", "serving", "serves", "like")  # what stands behind them is not in the room itself
_PLANTED = (["pot"], ["tree"], ["bush"], ["plant"], ["hedge"], ["trees"], ["pots"], ["bushes"], ["plants"], ["bouquet"])
_AFTER_PLACE = (["with"], ["w"], [":"], [","], ["."], ["interior"], ["where"], ["-"], ["for"], ["has"], ["containing"])
_LIKE_PLACES = ("house", "tent")  # shapes of things that one can be in
_AFTER_ROUND = (["a"], ["an"], ["it"], ["the"], ["them"], ["each"], ["every"], ["this"], ["that"], ["both"])
_MOST_MORE = 20  # of "and three along each side"
_OPENERS = frozenset(
    {"a", "an", "the", "its", "their", "his", "her", "my", "our", "your", "own", "another", "with", "and"}
)
_LISTED = frozenset({",", ";", ":", "-", "."})
_ENDS = frozenset({",", "and", "with", "that", "which", "or", "but", "to", "for", "as", "is", "are", "has", "have"})


def read(text: str) -> Brief:
    """The brief that a description in words asks for.

    Raises:
        UserError: the text is too long to be a description.
        RefusedError: the text describes no room: a question, an edit, chat, or unknown words.
    """
    cleaned = clean(text)
    if phrase := unsafe_words(cleaned):
        raise RefusedError("this is no description of a room", "unsafe", (phrase[:60],))
    if any(c in cleaned for c in "{}<>[]\\"):
        raise RefusedError("this is code or data, not a description in words", "not_understood")
    texts, slips = words_of(cleaned)
    refuse_others(texts)
    texts, light = lights(texts)
    texts, features = extracted(texts)
    reader = _Reader(texts)
    reader.features += [*light, *features]
    reader.remarks += slips
    reader.run()
    return reader.brief()


class _Reader(Clauses):
    """The state of one reading."""

    def __init__(self, texts: Sequence[str]) -> None:
        super().__init__(texts)
        self.linker = Linker()
        self.kind = ""
        self.styles: list[str] = []
        self.size: dict[Side, float] = {}
        self.scale = "normal"
        self.seats: int | None = None
        self.habits = True
        self.features: list[str] = []
        self.remarks: list[str] = []
        self.unknown: list[str] = []
        self.about_room = True  # whether a size that comes next is that of the room
        self.unshown: tuple[str, ...] = ()  # adjectives of the next noun that boxes do not show
        self.room_word = ""  # the word for the place that is described
        self.skipped: set[int] = set()  # positions of words that made nothing
        self.noun_end = -1  # position behind the last name of a thing
        self.room_end = 0  # position behind the last name of a room
        self.modifiers: list[str] = []  # unknown words before a noun, kept in its name

    def run(self) -> None:
        self.straighten()
        i = 0
        steps = (self._mark, self._formation, self._size, self._negation, self._only, self._long_name, self._feature,
                 self._more, self._place, self._people, self._count, self._color, self._name, self._attribute,
                 self._filler)  # fmt: skip
        while i < len(self.texts):
            step, taken = next(((s, n) for s in steps if (n := s(i))), (None, 0))
            known = len(self.linker.reading.drafts) + len(self.linker.without)
            taken = taken or self._unknown(i)
            if step is None and known == len(self.linker.reading.drafts) + len(self.linker.without):
                self.skipped |= set(range(i, i + taken))
            i += taken
        self._settle_count()
        self.linker.stop()

    def brief(self) -> Brief:
        """What was read.

        Raises:
            RefusedError: it names neither a room nor a thing.
        """
        reading = self.linker.reading
        self._settle_count()
        if not self.kind and not any(d.kind for d in reading.drafts):
            told = f": “{' '.join(self.unknown[:5])}” was not understood" if self.unknown else ""
            raise RefusedError(
                f"this describes no room{told}; name a kind of room or what is in it",
                "not_understood" if self.unknown else "not_an_edit",
                tuple(self.unknown[:64]),
            )  # fmt: skip
        self.remarks += [*reading.remarks(), *self.linker.lost, *self.unread()]
        for name in dict.fromkeys(self.styles):
            if (unshown := knowledge.styles()[name].unshown) and feature_mood(unshown) is None:
                self.remarks.append(f"{name} also means {unshown}, which boxes do not show")
        rest: dict[str, Any] = {
            "styles": tuple(dict.fromkeys(self.styles))[:8],
            "scale": self.scale,
            "without": tuple(dict.fromkeys(self.linker.without))[:32],
            "habits": self.habits,
            "features": tuple(dict.fromkeys(self.features))[:16],
            "remarks": tuple(r[:300] for r in dict.fromkeys(self.remarks))[:64],
            "unknown": tuple(w[:60] for w in dict.fromkeys(self.unknown))[:64],
        }
        try:
            return brief_of(reading, self.kind or "room", self.seats, self.size, **rest)
        except ValueError as error:
            raise UserError(f"this cannot be built as described: {error}") from error

    # ---- readers of what may stand at position `i`; each returns the number of words that it read, or 0 ------------

    def _mark(self, i: int) -> int:
        text = self.texts[i]
        if text == ",":
            self.linker.comma(self.goes_on(i, self.linker.listed))
        elif text in _MARKS:
            self.linker.stop()
        elif text in ("but", "with", "w") or (text == "and" and self.said == Said()):
            self.linker.joined("with" if text == "w" else text)
            self.said = replace(self.said, determiner="")
        elif text in _OWNING and self.linker.last is not None and not self.linker.opens:
            self.linker.joined("with")
        else:
            return 0
        self.modifiers = []
        if text in _MARKS or text == ",":
            self._settle_count()
            self.about_room = self.about_room or text in _MARKS
            self.said = Said()
        return 1

    def _settle_count(self) -> None:
        """Give a number without a noun to the things before it: "tulips, say six"."""
        last = self.linker.last
        bare = self.said.count is not None and self.said == Said(count=self.said.count)
        if bare and self.said.count and last is not None and last.plural and not (last.said.count or last.each):
            self.linker.counted(self.said.count)

    def _size(self, i: int) -> int:
        found = amounts.read(self.texts[i:])
        if not found:
            return 0
        behind = self.texts[i + found.taken : i + found.taken + 1]
        last = self.linker.last
        if last is not None and set(found.sides) == {"any"} and (taken := self._distance(i + found.taken, found)):
            return found.taken + taken
        if behind and (behind[0] == "of" or behind[0] not in {",", *_MARKS, "where", *vocabulary.FILLER}):
            self.said = replace(self.said, sides={**self.said.sides, **found.sides})
        elif self.about_room or last is None or (not self.size and self._begins_size(i, found)):
            self.size.update(found.sides)
        else:
            last.said = replace(last.said, sides={**last.said.sides, **found.sides})
        return found.taken

    def _begins_size(self, i: int, found: amounts.Extents) -> bool:
        """Whether a size at position `i` is that of the room: behind a mark and of two sides or an area, or behind the
        end of a sentence."""
        before = self.before(i)
        return before in (";", ".", ":") or (
            before == "," and (len(found.sides) > 1 or set(found.sides) <= {"area", "any"})
        )

    def _distance(self, i: int, found: amounts.Extents) -> int:
        """Read what follows a length that is a distance: "2 m from the bench", "1 m apart", "50 cm in front of"."""
        metres, rest = found.sides["any"], tuple(self.texts[i : i + 3])
        linker = self.linker
        if rest[:1] == ("apart",):
            linker.apart(metres)
            return 1
        away = 2 if rest[:2] == ("away", "from") else 1 if rest[:1] in (("from",), ("off",)) else 0
        if away:
            linker.distance = metres
            return away + linker.away(self.texts, i + away)
        if rest[:1] == ("away",):
            linker.from_there(metres)
            return 1
        relation = match(vocabulary.RELATIONS, self.texts, i) or match(vocabulary.SPOTS, self.texts, i)
        if relation and relation[0].removeprefix("rel ") in ("in_front_of", "behind", "left_of", "right_of", "above"):
            linker.distance = metres
            return linker.place(self.texts, i)
        return 0

    def _formation(self, i: int) -> int:
        """Read how things stand together: "in two rows of three" behind a noun, "three rows of four" before it."""
        found = standing(self.texts, i)
        if found is None:
            return 0
        if not found.behind:
            self.said = replace(self.said, count=found.count, arrangement=found.arrangement)
            return found.taken
        self._settle_count()
        self.linker.arrange(found.arrangement, found.count)
        self.said = Said()
        return found.taken

    def _negation(self, i: int) -> int:
        found = match(vocabulary.NEGATIONS, self.texts, i)
        if found and self.texts[i] == "not" and self.texts[i + 1 : i + 2] in (["too"], ["very"], ["so"]):
            return 0
        if found and tuple(self.texts[i : i + 2]) != ("no", "."):
            self.linker.negate()
            return found[1]
        return 0

    def _only(self, i: int) -> int:
        found = match(vocabulary.ONLY, self.texts, i)
        if found:
            self.habits = False
        return found[1] if found else 0

    def _feature(self, i: int) -> int:
        if match(vocabulary.BIG_WINDOWS, [singular(t) for t in self.texts], i):
            return 0
        if found := match(vocabulary.FEATURES, self.texts, i):
            self.features.append(found[0])
            self.said = Said()
            self.linker.elsewhere()
            if found[0] not in ("high ceiling", "low ceiling", "dance floor", "brick wall"):
                self.remarks.append(f"{found[0]}: kept in the brief, but not drawn")
            return found[1]
        looks = self.said.color or self.said.material
        told = looks or (self.said.styles and self.said.styles[-1]) or (self.before(i) == "light" and "light")
        if self.texts[i] in vocabulary.STRUCTURE and not self.linker.waiting and told:
            self.features.append(f"{told} {self.texts[i]}")
            if described(told) is None:
                self.remarks.append(f"{told} {self.texts[i]}: kept in the brief, but no material that is known")
            self.said = Said()
            return 1
        return 0

    def _place(self, i: int) -> int:
        if self.texts[i] in ("round", "down", "off") and self.texts[i + 1 : i + 2] not in _AFTER_ROUND:
            return 0
        self._per(i)
        self.linker.asked = self.before(i)
        if not self.linker.opens and self.comes_first(i):
            self.linker.front()
        taken = self.linker.place(self.texts, i)
        if taken:
            self._settle_count()
            self.modifiers = []
            self.said = Said()
        return taken

    def _more(self, i: int) -> int:
        """Read "and three along each side" behind chairs that are at the ends of a table."""
        number = quantities.read(self.texts[i:]) if self.before(i) in ("and", ",") else None
        last = self.linker.last
        if number is None or number.kind != "NUMBER" or last is None or not last.placed or number.value > _MOST_MORE:
            return 0
        at = i + number.taken
        taken = sides_at(self.texts, at) if at < len(self.texts) else 0
        spot = match(vocabulary.SPOTS, self.texts, at)
        if taken and self.texts[at + taken - 1] != "of":
            if number.value > 1 or (last.said.count or 1) == 1:  # of four benches, "one on each side" is one of them
                self.linker.more_at(2 * int(number.value))
        elif last.several and ((spot and spot[0] in ("one side", "other side")) or self.one_of(at + 1)):
            taken = spot[1] if spot else 1 + self.one_of(at + 1)
            self.linker.more_at(int(number.value))
        else:
            return 0
        return number.taken + taken

    def _per(self, i: int) -> None:
        """Read "four chairs to a table" and "two stools per desk" as "at each"."""
        texts = self.texts
        if texts[i] == "per":
            texts[i : i + 1] = ["at", "each"]
        elif texts[i] == "to" and texts[i + 1 : i + 2] in (["a"], ["each"], ["every"]) and self.name_at(i + 2):
            texts[i : i + 2] = ["at", "each"]

    def _people(self, i: int) -> int:
        """How many people are to be seated: "for six people", "seats four", "six-seater", "for eight"."""
        opener = self.texts[i] in ("for", "seats", "seating", "seat", "sleeps", "seated", "of")
        at = i + 1 + (self.texts[i + 1 : i + 2] == ["for"]) if opener else i
        number = quantities.read(self.texts[at:]) if at < len(self.texts) else None
        if not number or number.kind != "NUMBER" or not 1 <= number.value <= 100:
            return 0
        end = at + number.taken
        behind = self.texts[end] if end < len(self.texts) else ","
        person = behind in vocabulary.PEOPLE
        ends = self.texts[i] != "of" and (behind in (",", "and", "with", "in") or behind in _MARKS)
        if not person and behind not in ("seater", "seat") and not (opener and ends):
            return 0
        last = self.linker.last
        tables = last.said.count or 1 if last is not None and opener and last.kind and last.kind.top else 1
        self.seats = min(int(number.value) * tables, 100)
        return end - i + (person or behind in ("seater", "seat"))

    def _count(self, i: int) -> int:
        if taken := self._colors(i):
            return taken
        if self.texts[i] == "both":
            self.said = replace(self.said, determiner="the")
            return 1
        if found := match(vocabulary.COUNTS, self.texts, i):
            behind = self.texts[i + found[1] : i + found[1] + 1]
            one = "set" in self.texts[i : i + found[1]] and bool(behind) and behind[0] in vocabulary.PAIRS
            name = self.name_at(i + found[1])
            one = one or (self.texts[i : i + 2] == ["a", "bunch"] and name is not None and is_plural(name[0]))
            self.said = replace(self.said, count=1 if one else found[0])
            return found[1]
        if found := times(self.texts, i):
            return self._times(i, *found)
        if self.linker.waiting and (taken := self.one_of(i)):
            self.linker.pronoun("each" if self.texts[i] == "each" else "them")
            return taken
        number = quantities.read(self.texts[i:])
        if (
            number
            and number.kind == "NUMBER"
            and self.texts[i + number.taken : i + number.taken + 2] == ["pairs", "of"]
        ):
            self.said = replace(self.said, count=2 * int(number.value))
            return number.taken + 2
        if number and number.kind == "NUMBER" and number.value == int(number.value) and 1 <= number.value <= 10**6:
            self.said = replace(self.said, count=int(number.value))
            return number.taken
        return 0

    def _times(self, i: int, count: int, taken: int) -> int:
        """Give "x2" to the noun behind it, or to the one before it."""
        if self.noun_follows(i + taken) and not self.stood_before(i):
            self.said = replace(self.said, count=count)
        else:
            self.linker.counted(count)
        return taken

    def _colors(self, i: int) -> int:
        """Read "one green and one orange" behind two things: each has a colour of its own."""
        colors, j = [], i
        while self.texts[j : j + 1] == ["one"] or self.texts[j : j + 2] == ["the", "other"]:
            at = j + (1 if self.texts[j] == "one" else 2)
            found = color_at(self.texts, at) if at < len(self.texts) else None
            if not found:
                break
            colors.append(_plain(found[0]))
            j = at + found[1]
            if self.texts[j : j + 2] == [",", "and"]:
                j += 2
            elif self.texts[j : j + 1] in ([","], ["and"]):
                j += 1
        last = self.linker.last
        if len(colors) < 2 or last is None or (last.said.count or 2) < len(colors) or not last.several:
            return 0
        for color in colors[1:]:
            self.linker.reading.parted(last, color)
        last.said = replace(last.said, color=colors[0])
        self.linker.last = last
        return j - i - (self.texts[j - 1] in (",", "and"))

    def _color(self, i: int) -> int:
        found = color_at(self.texts, i)
        if not found or self.texts[i + found[1] : i + found[1] + 1] in _PLANTED:
            return 0
        last = self.linker.last
        if last is not None and self.before(i) in _SAID_OF and not self.noun_follows(i + found[1]):
            last.said = replace(last.said, color=_plain(found[0]))
            return found[1]
        end = i + found[1]
        ends = (
            end == len(self.texts) or self.texts[end] in _MARKS or self.texts[end] in (",", "and", "with", "in", "on")
        )
        if last is not None and ends and self.noun_end == i and self.said == Said() and not last.said.color:
            last.said = replace(last.said, color=_plain(found[0]))  # "tool chest red"
            return found[1]
        name = knowledge.lookup(knowledge.thing_words(), self.texts, i)
        plain = self._is_colored(i)
        if name and not plain and (name[1] > found[1] or not self.noun_follows(i + found[1])):
            return 0
        if self.texts[i] in vocabulary.MATERIALS and found[1] == 1:
            return 0
        self.said = replace(self.said, color=_plain(found[0]))
        return found[1]

    def _is_colored(self, i: int) -> bool:
        """Whether a name that begins with a colour is that of a thing in this colour: "a red carpet"."""
        color = color_at(self.texts, i)
        name = knowledge.lookup(knowledge.thing_words(), self.texts, i) if color else None
        if not color or not name or name[0] in knowledge.things() or self.texts[i] in NOUN_COLORS:
            return False
        return (rest := self.name_at(i + color[1])) is not None and rest[1] == name[1] - color[1]

    def _long_name(self, i: int) -> int:
        return 0 if self._is_colored(i) else self._name(i, 2)

    def _name(self, i: int, shortest: int = 1) -> int:
        """A thing, a room or a style: the longest name at position `i`, of at least `shortest` words."""
        self.has_place = bool(self.kind or self.linker.reading.drafts)
        tables = (knowledge.thing_words(), knowledge.room_words(), knowledge.style_words())
        hits = [(knowledge.lookup(t, self.texts, i), what) for t, what in zip(tables, range(3), strict=True)]
        if self.texts[i] == "light" and self.texts[i + 1 : i + 2] and self.texts[i + 1] in vocabulary.STRUCTURE:
            return 0
        best = max(((h[1], -what, h[0]) for h, what in hits if h), default=None)
        if not best or best[0] < shortest:
            return 0
        taken, what, name = best
        if what == 0:
            return self._noun(i, name, taken)
        if what == -1 and self._is_place(i + taken, 1, " ".join(self.texts[i + taken : i + taken + 1])):
            self.room_word = self.texts[i + taken]  # of "a poolside deck" the first word says what it is
            self._room(name, " ".join(self.texts[i : i + taken + 1]))
            return taken + 1
        elif what == -1 and not is_plural(self.texts[i]) and self.name_at(i + taken):
            self.modifiers += self.texts[i : i + taken]  # a "studio monitor" is no studio
        elif what == -1:
            if i and i == self.room_end:
                self.kind = ""  # of "a cafe terrace" the last word says what it is
            self.room_end = i + taken
            self._room(name, " ".join(self.texts[i : i + taken]))
        else:
            self.styles.append(name) if not self.linker.reading.drafts else None
            self.said = replace(self.said, styles=(*self.said.styles, self.texts[i]))
        return taken

    def _noun(self, i: int, name: str, taken: int) -> int:
        """Read a noun phrase from its first name of a thing: nouns before the head ("stone lantern") are part of the
        name, and what follows "of" ("crates of oranges") belongs to it too."""
        texts = self.texts
        if self.is_verb(i, taken):
            return 0
        if (
            taken == 1
            and texts[i] in vocabulary.MATERIALS
            and texts[i + 1 : i + 2]
            and texts[i + 1] in vocabulary.STRUCTURE
        ):
            self.said = replace(self.said, material=texts[i])
            return 1 + self._feature(i + 1)
        if self.names_room(i, taken):
            return taken  # "a vegetable garden" holds no vegetable, a "bus station cafe" no bus
        before: list[str] = []
        while not is_plural(texts[i + taken - 1]) and (more := self.compound_at(i + taken)):
            end, (name, taken) = more
            before += texts[i:end]
            i = end
        if self._is_place(i, taken, word := texts[i + taken - 1]):
            self.habits = False  # what is usual there is unknown
            self._room("room", word)
            self.modifiers = []
            return taken + len(before)
        lead, self.modifiers = [*self.modifiers, *before], []
        said = " ".join(texts[i : i + taken])
        end, content = self.content(i + taken)
        if content:
            head = singular(texts[i + taken - 1])
            whole = knowledge.thing(f"{content} {head}")
            measured = head in vocabulary.MEASURES
            if content.endswith(f" {head}"):
                name = content  # a "rack of dumbbells"
            elif whole is not None and whole.name in knowledge.things():
                name = whole.name
            elif measured:
                name = content if head in ("pair", "set", "group", "row", "line") else f"{head} of {content}"
        if lead and (known := self.sort(lead, singular(said) if " of " not in said else said)):
            name = known
        if self.before(i - len(before)) in _IRRELEVANT:
            return end - i + len(before)
        self._thing(name[:60], said, i)
        self.noun_end = end
        return end - i + len(before)

    def _thing(self, name: str, word: str, i: int) -> None:
        said = self.said
        self.remarks += [f"“{u}” of the {name} is not shown" for u in self.unshown]
        self.unshown = ()
        if said.styles and self.kind and self.linker.reading.drafts:
            self.remarks.append(f"“{said.styles[-1]}” of the {name} is not shown")
        head = singular(word.rsplit(" ", 1)[-1])
        self.linker.thing(name, head, said, is_plural(word), singular(word) if singular(word) != name else "")
        self.said, self.about_room = Said(), False

    def _room(self, name: str, word: str) -> None:
        said = self.said
        another = self.kind not in ("", "room", name) or (self.kind and word != self.room_word)
        if another and said.determiner != "the" and everyday.find(word):
            self._thing(singular(word), word, 0)  # a greenhouse in a garden, a kitchenette in a studio flat
            return
        if self.kind and name == "kitchen" and self.linker.reading.drafts:
            self._thing("kitchen counter", word, 0)
            return
        if self.kind and any(d.name == singular(word) for d in self.linker.reading.drafts):
            self._thing(singular(word), word, 0)
            return
        self.room_word = self.room_word or word
        if said.material and described(said.material) is not None:  # "a concrete loft"
            self.features += [f"{said.material} {part}" for part in ("floor", "walls")]
        self.said = Said()
        if self.linker.in_room():
            if name != "room" and not self.kind:
                self.kind = name
            self.size.update(said.sides)
            self.scale = said.scale or self.scale
            self.about_room = True
            return
        if not self.kind or self.kind == "room":
            self.kind = name
        elif name not in ("room", self.kind):
            self.remarks.append(f"only one room is built: the {self.kind}, not the {name}")
        self.size.update(said.sides)
        self.scale = said.scale or self.scale
        self.about_room = True

    def _attribute(self, i: int) -> int:
        text = self.texts[i]
        if text in vocabulary.SIZES:
            self.said = replace(self.said, scale=vocabulary.SIZES[text])
        elif text in vocabulary.MATERIALS:
            self.said = replace(self.said, material=text)
        elif text in vocabulary.SHAPES:
            self.said = replace(self.said, shape=text)
        elif text in ("each", "every"):
            of = 2 if self.texts[i + 1 : i + 3] in (["of", "them"], ["of", "these"]) else 0
            one = self.texts[i + 1 : i + 2] == ["one"]
            ends = i + 1 == len(self.texts) or self.texts[i + 1] in (",", "and", *_MARKS)
            if self.linker.waiting and (of or one or ends or not self.noun_follows(i + 1)):
                self.linker.pronoun("each")
                return 1 + of + one
            if ends:
                self.linker.each_behind()
                return 1
            self.said = replace(self.said, determiner="each")
            self.linker.each()
        elif text == "own" and self.before(i) in ("its", "their", "his", "her"):
            self.said = replace(self.said, own=True)
        elif text in ("the", "this", "that", "those", "these"):
            self.said = replace(self.said, determiner="the")
        elif text in ("a", "an"):
            self.said = replace(self.said, determiner="a")
        elif text in vocabulary.PRONOUNS and self.linker.waiting:
            self.linker.pronoun(text)
        else:
            return 0
        return 1

    def _filler(self, i: int) -> int:
        text = self.texts[i]
        if text in vocabulary.ABSTRACT or text in vocabulary.PEOPLE:
            self.linker.drop()
            self.said = Said()
            return 1
        return int(text in vocabulary.FILLER or match(lexicon.FILLER, self.texts, i) is not None or text in "-&/'\"()")

    def _unknown(self, i: int) -> int:
        """An unknown word: the head of a noun phrase is a thing without a usual size; words before a name are kept in
        the name. All are listed as unknown, except everyday nouns."""
        word = self.texts[i]
        behind = self.noun_follows(i + 1)
        if singular(word) in vocabulary.MEASURES and self.texts[i + 1 : i + 2] == ["of"]:
            return self._measured(i)
        if word in vocabulary.PLACES and self._is_place(i, 1, word):
            return self._entitled(i)
        if word in ("head", "corner", "centre", "center") and self.name_at(i + 1):
            self.modifiers.append(word)  # a "head table", a "corner sofa"
            return 1
        if word in vocabulary.PARTS or singular(word) in vocabulary.PARTS:
            if not behind and not self.linker.waiting and self._relation_at(i + 1) and self._is_listed(i):
                self.linker.elsewhere()  # "a ring in the centre": what is there is no thing, but nothing else is
            elif not behind:
                self.linker.drop()
            return 1
        if behind and word.endswith(vocabulary.ADJECTIVE_ENDINGS) and not nouns.is_known(word):
            self.unshown = (*self.unshown, word)
            return 1
        known = nouns.is_known(word) and may_be_noun(word) and not word.endswith(vocabulary.NOT_THINGS)
        if behind:
            self.modifiers.append(word)
        elif (known or self._is_head(i)) and not self._is_title(i):
            lead, self.modifiers = self.modifiers, []
            self._thing(" ".join([*lead, singular(word)])[:60], word, i)
        else:
            self.linker.drop()
        if not known or behind:
            self.unknown.append(word)
        if not self.kind and not self.linker.reading.drafts and self.texts[i + 1 : i + 2] in _AFTER_PLACE:
            return self._entitled(i)
        return 1

    def _entitled(self, i: int) -> int:
        """Take a word for the place that is described, of which nothing is known: "the vestry: …"."""
        place = " ".join([*self.modifiers, self.texts[i]])
        self.kind, self.habits, self.modifiers, self.room_word = "room", False, [], self.texts[i]
        self.remarks.append(f"“{place}” is taken for the place itself")
        self.linker.elsewhere()
        return 1

    def _measured(self, i: int) -> int:
        """Read "a stack of": what follows is several things, of "a roll of cloth" one."""
        end, content = self.content(i + 2 - 1)
        measure, known = singular(self.texts[i]), content and knowledge.thing(content) is not None
        several = measure not in ("roll", "sheet", "block", "piece", "length", "bolt", "slab") and known
        if several or not content:
            self.said = replace(self.said, determiner="", count=self.said.count)
            return 2
        self._thing(f"{measure} of {content}"[:60], self.texts[i], i)
        return end - i

    def unread(self) -> list[str]:
        """A sentence for each name of a thing among the words that is not in what was read."""
        drafts = self.linker.reading.drafts
        read = {w for d in drafts for n in (d.name, d.called) for w in singulars(n)}
        read |= {w for n in (*self.linker.without, self.room_word) for w in singulars(n)}
        lost, i = [], 0
        while i < len(self.texts):
            found = self.name_at(i)
            if found and i in self.skipped and not (singulars(found[0]) & read):
                said = " ".join(self.texts[i : i + found[1]])
                if not singulars(said) & read:
                    lost.append(f"“{said}” is said, and is not in the room")
            i += found[1] if found else 1
        return lost

    def _is_title(self, i: int) -> bool:
        """Whether a text begins with an unknown word for the place that it describes: "the vestry: a long table"."""
        first = not self.kind and not self.linker.reading.drafts
        after = self.texts[i + 1 : i + 2]
        return first and (after in ([":"], ["-"], ["."], ["with"], ["w"]) or self.is_heading(i + 1))

    def _is_listed(self, i: int) -> bool:
        """Whether a noun phrase of one word begins at position `i`."""
        return i == 0 or self.before(i) in _LISTED or self.before(i) in _OPENERS

    def _relation_at(self, i: int) -> bool:
        table = (vocabulary.RELATIONS, vocabulary.SPOTS)
        return any(match(t, self.texts, i) for t in table) and self.texts[i] != "of"

    def _is_place(self, i: int, taken: int, word: str) -> bool:
        """Whether the first noun phrase names the place that is described: "a nail bar with", "a caravan: …"."""
        first = not self.kind and not self.linker.reading.drafts and not is_plural(word)
        after = self.texts[i + taken : i + taken + 10]
        rooms = knowledge.room_words()
        within = after[:1] in (["in"], ["at"]) and any(
            knowledge.lookup(rooms, self.texts, i + taken + k) for k in (1, 2)
        )
        ends = within or after[:1] in _AFTER_PLACE or (":" in after and "," not in after[: after.index(":")])
        place = word in vocabulary.PLACES or everyday.shape(" ".join(self.texts[i : i + taken])) in _LIKE_PLACES
        return (
            first and place and ends and (after[:1] != [","] or word in vocabulary.PLACES or self.is_heading(i + taken))
        )

    def _is_head(self, i: int) -> bool:
        """Whether an unknown word is the head of a noun phrase by its place: after a determiner, a number or an
        adjective, and before the end of the phrase."""
        word, after = self.texts[i], self.texts[i + 1] if i + 1 < len(self.texts) else "."
        opened = (
            self.before(i) in _OPENERS
            or (self.before(i) in _LISTED and self._relation_at(i + 1))
            or self.said != Said()
            or bool(self.modifiers)
        )
        ends = after in _ENDS or bool(match(vocabulary.RELATIONS, self.texts, i + 1)) or after in _MARKS
        return opened and ends and may_be_noun(word) and not word.endswith(vocabulary.NOT_THINGS) and len(word) > 2


def _plain(color: str) -> str:
    """A colour as things have it."""
    return color.replace("grey", "gray")[:40]


def singulars(name: str) -> set[str]:
    """The words of a name, in the singular."""
    return {singular(w) for w in name.split()}
