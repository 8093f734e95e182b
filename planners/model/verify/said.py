"""What an English instruction says in so many words: verbs, colours, directions, relations, amounts, and things.

The words are those that the grammar tags, which it does also where it understands no whole sentence. Each check asks
whether a step of a model's plan agrees with them: a word that says the opposite or another value speaks against a step,
and a verb for something else does where nothing speaks for it. Words that are not there speak against nothing.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

from ....gaussians.errors import UserError
from ....gaussians.language.query.query import Query
from ....gaussians.world.finishes import said as finish_said
from ....gaussians.world.lengths import in_metres
from ....tools.operation import EditOp
from ...grammar.restating.chunks import Chunk, as_words, chunks, is_thing
from ...grammar.tagging.tagger import clauses
from ...grammar.tagging.tags import Tag, sentences
from ...grammar.tagging.words import bag, clean, split
from ...grammar.vocabulary.verbs import VERBS
from ...impossible import metres
from ...plan import Planner
from ...rooms.label_encoder import words
from .second_reading import Given, alike

# Verbs and other tags of the grammar that ask for each operation. Tags that ask for none ("make", "want") are not here.
_ASKS: dict[str, str] = {
    "delete": "DELETE CLEAR TAKE DROP CROP AWAY GOES GONE ISOLATE KEEP REPLACE SUBSTITUTE SWAP",
    "recolor": "PAINT TINT ADJUST HUE COLORS LIGHT TOWARDHUE COLORLIKE APPLY SAME SWAP COLORWORD FADE ASHADE FROMHUE",
    "move": "MOVE CENTERING RAISE PUT TAKE DIR NEAR TOWARD CENTER SWAP GOES DROP PLACES ONIT AROUND APART TURN",
    "rotate": "ROTATE TURN TURNROUND FACE FACING FACEAWAY FLIP TILT ANGLE CLOCK UPSIDE TAKE",
    "scale": "SCALE GROW MULTIPLY STRETCH GROWN TALLER TIMES PERCENT FRACTION SIZEWORD HEIGHT AS RAISE",
    "duplicate": "COPY COPIES ADD MORE OTHER NUMBER TIMES MULTIPLY LIKEIT ASONE ORDINAL",
    "insert": "ADD PUT WANT GIVE MORE MAKE MISSING APPLY TAKE SUBSTITUTE REPLACE SWAP MOVE",
    "replace": "REPLACE SWAP SUBSTITUTE TURN CHANGE INTO WANT PUT ADD TAKE",
    "exchange": "SWAP PLACES CHANGE PUT MOVE",
    "opacity": "HIDE FADE OPAQUE CLEARLY OPACITYWORD PERCENT",
    "isolate": "ISOLATE KEEP CROP DELETE CLEAR HIDE BUT EVERYTHING OTHERS SELECT",
    "arrange": "MOVE PUT CENTERING APART DIR NEAR LENGTH TURN ROTATE AROUND SWAP PLACES",
    "select": "",
}
_DECISIVE = frozenset({tag for tags in _ASKS.values() for tag in tags.split()})
# Tags that ask for nothing by themselves beside a verb that does: "remove the one on the left", "hide the bigger one".
_WITH_VERB = bag(
    "DIR NEAR TOWARD CENTER SIZEWORD AS MORE LESS NUMBER OTHER BUT EVERYTHING OTHERS MAKE WANT GIVE LIGHT HEIGHT SAME "
    "COLORWORD AWAY PERCENT INTO AROUND FRACTION HUE GROWN TIMES ONIT GOES"
)
_VERBS = bag(
    "DELETE CLEAR DROP SELECT ISOLATE CROP HIDE FADE PAINT TINT ADJUST MOVE CENTERING RAISE PUT ADD COPY REPLACE SWAP "
    "SUBSTITUTE ROTATE TURNROUND FACE FLIP TILT SCALE GROW MULTIPLY STRETCH MERGE SPLIT COPIES"
)
# Tags that ask for something without any verb: what no step carries out is not what a plan of one step is for.
_ALONE = bag(
    "HUE LIGHT GROWN TIMES FRACTION OPAQUE CLEARLY OPACITYWORD ANGLE CLOCK COPIES COLORLIKE DIR CENTER FACING "
    "UPSIDE AWAY"
)
# Words without which nothing is put there; "on", "next to" and "against" may also be meant by "to" or "with".
_WORDS_OF_PLACES: dict[str, str] = {
    "under": r"under\w*|beneath|below|bottom", "above": "above|over|overhead|up|higher", "behind": "behind|back|rear",
    "in_front_of": "front|before|ahead|facing", "left_of": "left", "right_of": "right", "corner": "corners?",
    "inside": "in|into|inside|within", "between": "between|middle|amid|among", "opposite": "opposite|across|facing",
    "center": r"cent\w*|middle", "diagonally_opposite": r"diagonal\w*|corner|across",
}  # fmt: skip
_OPPOSITES = (
    ({"left"}, {"right"}), ({"up"}, {"down"}), ({"forward"}, {"backward"}), ({"left_of"}, {"right_of"}),
    ({"on", "above"}, {"under", "below"}), ({"in_front_of"}, {"behind"}),
)  # fmt: skip
_PLAIN = {"left": "left", "right": "right", "up": "up", "down": "down", "behind": "behind", "under": "under",
          "underneath": "under", "beneath": "under", "on": "on", "onto": "on", "front": "in_front_of", "atop": "on",
          "above": "above", "below": "under", "lower": "down", "raise": "up", "higher": "up", "top": "on"}  # fmt: skip
_SIDES = {"left_of": "left", "right_of": "right"}
_POINTING = re.compile(
    r"\b(?:everything|anything|everyone|rest|others?|ones?|any|some|things?|stuff|whatever|what|where|who\w*|something|"
    r"not)\b|n't\b"
)
_SAYS_HOW = bag("on onto in into inside next beside against by upon atop")  # how a thing stands where it goes to
_EXCEPTING = frozenset({"but", "except", "apart from", "bar", "besides", "keep", "leave"})
_LIKENING = bag("colour color shade tone hue like match matches matching")
_DETERMINERS = bag("the a an my our your his her their this that these those every all both each any some")
_PRONOUNS = bag("it its them they their this that these those")
_CLOSE = 0.03  # relative difference of a number from the one that is said
_LONGEST = 5  # chunks of a noun phrase
_SPANS = 60  # most phrases that are looked up in the scene for one instruction


@dataclass(frozen=True)
class Phrase:
    """A noun phrase.

    Attributes:
        placed: whether it stands behind a preposition ("on the table").
        noun: its noun with what makes it a compound.
        readings: queries that it may mean, with the most of what describes it first; empty if it cannot be read.
    """

    placed: bool
    noun: str
    readings: tuple[Query, ...]


class Said:
    """The words of an instruction; `previous` is the one before, for what is not said again."""

    def __init__(self, text: str, previous: str | None = None) -> None:
        self._own = tuple(_sentences(text))
        self._sentences = self._own + tuple(_sentences(previous or ""))
        self._words = [w for texts in self._sentences for w in texts]

    @cached_property
    def _tags(self) -> tuple[Tag, ...]:
        return tuple(t for texts in self._sentences for t in _tagged(texts))

    def values(self, *types: str) -> list[Any]:
        """The values of the tags of some classes, in order."""
        return [t.value for t in self._tags if t.type in types]

    def amounts(self, *types: str) -> list[Any]:
        """The same without the instruction before, whose amounts are not those of "a bit more"."""
        return [t.value for texts in self._own for t in _tagged(texts) if t.type in types]

    @cached_property
    def asked(self) -> frozenset[str]:
        """The classes of tags that ask for something; also of participles, as in "I want it moved"."""
        return (frozenset(t.type for t in self._tags) | {c for w in self._words for c in _participle(w)}) & _DECISIVE

    @property
    def asks_to_remove(self) -> bool:
        """Whether a word of the grammar asks to take something away."""
        return not self.asked.isdisjoint({"DELETE", "CLEAR", "AWAY", "GONE", "GOES"})

    @cached_property
    def given(self) -> Given:
        """Which values it gives."""
        amounts = self.amounts("LENGTH", "ANGLE", "PERCENT", "TIMES", "FRACTION", "NUMBER", "MULTIPLY")
        return Given(bool(amounts), bool(self.amounts("LENGTH")), _SAYS_HOW.isdisjoint(self._words))

    @cached_property
    def left_out(self) -> frozenset[str]:
        """Colours of what is excepted: "all but the red one", "keep the white one"."""
        found, excepted = set[str](), False
        for tag in (t for texts in self._own for t in _tagged(texts)):
            if tag.type in ("BUT", "KEEP") or tag.text in _EXCEPTING:
                excepted = True
            elif tag.type in ("AND", "COMMA") or tag.type in _VERBS:
                excepted = False
            elif excepted and tag.type == "COLOR" and isinstance(tag.value, str):
                found.add(tag.value)
        return frozenset(found)

    # -- steps ------------------------------------------------------------------------------------------------------

    def against(self, op: EditOp, single: bool) -> Iterator[str]:
        """Why the words speak against a step.

        Args:
            single: whether it is the only step of its plan; then a verb that the grammar does not know may ask for it.
        """
        if self._own and not self._asks_for(op, single):
            yield f"nothing asks to {op.op} {op.subject()}"
        checks = (
            self._color,
            self._material,
            self._direction,
            self._relation,
            self._turn,
            self._length,
            self._factor,
            self._count,
        )
        for check in checks:
            if (why := check(op)) is not None:
                yield why

    def _asks_for(self, op: EditOp, single: bool) -> bool:
        wanted = frozenset(_ASKS.get(op.op, "").split())
        if op.op not in _ASKS or not wanted or (op.op in ("insert", "replace") and self._names(op)):
            return True
        if getattr(op, "place", None) is not None and not self.asked & _VERBS:
            wanted |= {"PREP", "BETWEEN"}  # "the iron goes on the shelf"
        verbs = self.asked & _VERBS
        loose = {VERBS[w][0] for w in self._words if w in VERBS}  # "let the picture fade"
        given = wanted & (frozenset(t.type for t in self._tags) | self.asked | loose)
        if verbs and not given & verbs and given <= _WITH_VERB - self._own_evidence(op):
            return False  # a verb asks for something else, and what is there does not ask by itself
        return bool(given) or (single and not verbs and self.asked.isdisjoint(_ALONE))

    def _own_evidence(self, op: EditOp) -> frozenset[str]:
        """Tags that ask for this very step beside any verb, since its value is theirs."""
        found = set[str]()
        color = getattr(op, "color", None)
        if color and any(alike(str(color), str(hue)) for hue in self.values("HUE") if hue):
            found.add("HUE")
        if getattr(op, "direction", None) in self.values("DIR"):
            found.add("DIR")
        place = getattr(op, "place", None)
        if place is not None:
            found |= {"NEAR", "CENTER", "TOWARD", "AROUND", "DIR", "GOES", "ONIT"}
        if getattr(op, "toward", None) is not None:
            found.add("TOWARD")
        if op.op == "scale":
            found |= {"GROWN", "TIMES", "FRACTION", "PERCENT", "HEIGHT"}
        return frozenset(found)

    def _names(self, op: EditOp) -> bool:
        """Whether the new thing of a step is named."""
        head = words(str(getattr(op, "asset", "")))[-1:]
        return bool(head) and head[0] in {n for w in self._words for n in words(w)}

    @property
    def turns_either_way(self) -> bool:
        """Whether it does not say which way something turns."""
        ways = re.search(r"\b(?:left|right|anti\w*|counter\w*|minus)\b", " ".join(self._words))
        return ways is None and not self.values("CLOCK")

    @property
    def likens(self) -> bool:
        """Whether it gives something the colour of another thing."""
        return bool(self.values("COLORLIKE"))

    # -- values -----------------------------------------------------------------------------------------------------

    def _color(self, op: EditOp) -> str | None:
        color = getattr(op, "color", None)
        if color is None or getattr(op, "adjust", None) not in (None, "toward"):
            return None
        hues = [str(v) for v in self.values("HUE", "TOWARDHUE") if isinstance(v, str)]
        every = hues + [str(v) for v in self.values("COLOR") if isinstance(v, str)]
        if any(alike(color, c) for c in (hues or every)):
            return None
        if not hues and (self.values("COLORLIKE", "SAME", "COLORWORD") or not _LIKENING.isdisjoint(self._words)):
            return None  # the colour of another thing, which the scene or the model knows ("the colour of the sky")
        if every:
            return f"the colour {color} is not the one that is said"
        return f"no colour is said for the {op.subject()}" if op.op != "recolor" else None

    def _material(self, op: EditOp) -> str | None:
        """A material has one of its words in the instruction."""
        material = getattr(op, "material", None)
        if material is None:
            return None
        runs = (self._words[i : i + n] for n in (1, 2, 3) for i in range(len(self._words)))
        named = {found.finish for run in runs if (found := finish_said(" ".join(run))) is not None}
        return None if material in named or not named else f"the material {material} is not the one that is said"

    def _sides(self) -> set[str]:
        tags = {str(v) for v in self.values("DIR", "RAISE", "PREP", "NEAR", "SIDE", "SPOT") if isinstance(v, str)}
        plain = {_PLAIN[w] for w in self._words if w in _PLAIN}
        return {s for side in tags | plain for s in (side, _SIDES.get(side, side))}

    def _contradicted(self, side: str) -> bool:
        """Whether the opposite of a direction or relation is said, and neither it nor another word for it."""
        said = self._sides()
        for one, other in _OPPOSITES:
            for mine, its in ((one, other), (other, one)):
                if side in mine and said & (its | {_SIDES.get(s, s) for s in its}):
                    return not said & (mine | {_SIDES.get(s, s) for s in mine})
        return False

    def _direction(self, op: EditOp) -> str | None:
        way = getattr(op, "direction", None)
        said = {v for v in self.values("DIR", "RAISE") if v in ("left", "right", "up", "down", "forward", "backward")}
        if way is None or way in said:
            return None
        return f"it goes {way}, not as it is said" if said or self._contradicted(way) else None

    def _relation(self, op: EditOp) -> str | None:
        place = getattr(op, "place", None)
        if place is None:
            return None
        needed = _WORDS_OF_PLACES.get(place.relation)
        unsaid = needed is not None and re.search(rf"\b(?:{needed})\b", " ".join(self._words)) is None
        if unsaid:
            return f"nothing says {place.relation.replace('_', ' ')}"
        if not self._contradicted(place.relation):
            return None
        return f"it goes {place.relation.replace('_', ' ')} something, the words say the opposite"

    def _turn(self, op: EditOp) -> str | None:
        degrees = getattr(op, "degrees", None)
        if op.op != "rotate" or degrees is None or getattr(op, "toward", None) is not None:
            return None
        senses = {math.copysign(1, v) for v in self.values("CLOCK") if isinstance(v, int | float) and v}
        if senses and abs(degrees) % 180 and math.copysign(1, degrees) not in senses:
            return "it turns the other way round"
        angles = [abs(float(v)) for v in self.amounts("ANGLE") if isinstance(v, int | float)]
        angles += [180.0] * len(self.amounts("TURNROUND", "UPSIDE", *(() if angles else ("AROUND",))))
        if angles and not any(_close(abs(degrees), a) for a in angles):
            return f"{abs(degrees):g} degrees are not said"
        return None

    def _length(self, op: EditOp) -> str | None:
        given = metres(op)
        said = [_metres(v) for v in self.amounts("LENGTH")]
        units = {v[1] for v in self.values("LENGTH") if isinstance(v, tuple) and len(v) == 2}
        said += [_metres((n, unit)) for n in self.amounts("NUMBER") for unit in units]  # "and another 10"
        lengths = [v for v in said if v is not None]
        if given is None or not lengths or any(_close(given, v) for v in lengths):
            return None
        return f"{given:g} m are not said"

    def _factor(self, op: EditOp) -> str | None:
        factor = getattr(op, "factor", None)
        if factor is None or op.op != "scale":
            return None
        amounts = [float(v) for v in self.amounts("TIMES", "FRACTION", "MULTIPLY") if isinstance(v, int | float) and v]
        shares = [float(v) for v in self.amounts("PERCENT") if isinstance(v, int | float)]
        senses = {bool(v[1]) for v in self.values("GROW", "GROWN") if isinstance(v, tuple) and len(v) == 2}
        if senses and (factor > 1) not in senses and factor != 1:
            return "it grows where it is to shrink" if factor > 1 else "it shrinks where it is to grow"
        grows, shrinks = True in senses, False in senses
        candidates = [
            c for v in amounts for c in (v, *((1 / v, 1 - v) if shrinks else ()), *((1 + v,) if grows else ()))
        ]
        candidates += [1 - v for v in self.values("FRACTION") if isinstance(v, float) and self.values("FROM")]
        candidates += [c for v in shares for c in (v, 1 + v, 1 - v)]
        if candidates and not any(_close(factor, c) for c in candidates):
            return f"the factor {factor:g} is not said"
        return None

    def _count(self, op: EditOp) -> str | None:
        count = getattr(op, "count", None) or 1
        if op.op not in ("insert", "duplicate") or count == 1:
            return None
        numbers = [int(v) for v in self.amounts("NUMBER", "COUNTED", "TIMES") if isinstance(v, int | float)]
        if not numbers and "another" in self._words:
            return "one more is asked for"
        if not numbers or any(count in (n, n - 1, n * m) for n in numbers for m in numbers):
            return None
        return f"{count} are not said"

    # -- things -----------------------------------------------------------------------------------------------------

    @property
    def refers(self) -> bool:
        """Whether a pronoun stands for a thing."""
        return not _PRONOUNS.isdisjoint(w for texts in self._own for w in texts)

    @property
    def points(self) -> bool:
        """Whether it speaks of things without naming them, or by what they are not."""
        return _POINTING.search(" ".join(self._words)) is not None

    def phrases(self, reader: Planner) -> tuple[Phrase, ...]:
        """The noun phrases."""
        return tuple(p for texts in self._sentences for p in _phrases(texts, reader))


def _phrases(texts: tuple[str, ...], reader: Planner) -> Iterator[Phrase]:
    """The noun phrases of a sentence."""
    parts = chunks(texts)
    for i, part in enumerate(parts[:_SPANS]):
        start = part.start
        if part.kind == "place":  # without its preposition
            until = part.head + 1 if part.head >= 0 else part.end
            starts = [k for k in range(part.start, until) if texts[k] in _DETERMINERS][-1:]
            starts += range(part.start, part.end)
            start = next((k for k in starts if is_thing(texts[k : part.end])), part.end)
        if part.kind not in ("thing", "place") or start == part.end:
            continue
        spans = [texts[start:end] for end in _ends(parts, i)]
        read = (_read(reader, " ".join(span)) for span in spans if span == spans[-1] or is_thing(span))
        found = _fullest(query for query in read if query is not None)
        noun = found[-1].text if found else " ".join(texts[part.head : part.end]) if part.head >= 0 else ""
        if noun:
            yield Phrase(part.kind == "place", noun, found)


def _fullest(readings: Iterable[Query]) -> tuple[Query, ...]:
    """Readings of one phrase, the longest first, up to the first that leaves something out: "the mugs but not the red
    one" is not "the mugs"."""
    found: list[Query] = []
    for query in readings:
        found.append(query)
        if query.exclude or query.not_colors:
            break
    return tuple(found)


def _ends(parts: Sequence[Chunk], i: int) -> list[int]:
    """Where a phrase that begins with a chunk may end, the longest first."""
    ends = [parts[i].end]
    for other in parts[i + 1 :]:
        if other.kind == "verb" or len(ends) > _LONGEST:
            break
        ends.append(other.end)
    return ends[::-1]


@cache
def _participle(word: str) -> frozenset[str]:
    """The class of the verb of which a word is the past participle, if it is a regular one."""
    if not word.endswith("ed"):
        return frozenset()
    found = (VERBS.get(stem) for stem in (word[:-1], word[:-2], word[:-3]))
    return frozenset(entry[0] for entry in found if entry is not None)


def _sentences(text: str) -> Iterator[tuple[str, ...]]:
    """The words of each sentence; what stands before a colon is one."""
    try:
        said = split(clean(text.replace(":", ".")))
    except UserError:  # too long for the grammar
        return
    for part, _ in sentences(said):
        yield tuple(w.text for w in part)


def _tagged(texts: Sequence[str]) -> list[Tag]:
    return [t for clause in clauses(as_words(texts)) for t in clause.tags if t.words] if texts else []


def _read(reader: Planner, phrase: str) -> Query | None:
    """A noun phrase as a query; None if it cannot be read."""
    try:
        ops = reader.plan(f"select {phrase}").ops
    except UserError:
        return None
    return ops[0].query() if len(ops) == 1 and ops[0].op == "select" else None


def _metres(value: Any) -> float | None:
    try:
        number, unit = value
        return in_metres(float(number), unit)
    except (TypeError, ValueError, KeyError):
        return None


def _close(one: float, other: float) -> bool:
    return math.isclose(one, other, rel_tol=_CLOSE, abs_tol=1e-9)
