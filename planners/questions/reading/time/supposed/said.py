"""What a question says by its marks: what it is about, its time, its unit, and the words beside them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from ......gaussians import late_re as re
from ......gaussians.world import kinds as kinds_of_things
from ......gaussians.world.words import singular
from .....grammar.learned.marks import Span, held_by
from .....grammar.tagging.words import bag
from ...noun_phrase import is_color_word
from ..frames import UNIT
from .phrases import PRONOUNS

_DETERMINED = re.compile(r"^(?:the|a|an|this|that|these|those|my|our|your|his|her|its|their|all|both|any|every)\b")

_COUNTED = re.compile(r"\d")  # "like 90 degrees" is no unit
_EACH = re.compile(r"(?:per|a|each|every) (?:second|minute)$")  # so many turns
_IN_UNIT = re.compile(rf"\b(?:{UNIT}|rpm|revs? (?:a|per) minute)\b")


@dataclass(frozen=True)
class Said:
    """What a question says.

    Attributes:
        x, y: what it is about, and the other thing; "" if none is named.
        places: each other thing, where there are several.
        time: the words of its time, "" if there are none.
        unit: that of its answer, "" if none is said.
        times: the words of each of its times.
        off: words that ask for nothing.
        rest: all other words.
        names: words of the names of the things of the scene.
        first: its first word that asks for something.
        barred: `rest` with a bar for each mark.
        asked: whether it is asked which thing does something: "which toy", and not "the toy".
    """

    x: str
    y: str
    time: str
    unit: str
    rest: str
    times: tuple[str, ...] = ()
    off: str = ""
    places: tuple[str, ...] = ()
    names: Collection[str] = ()
    first: str = ""
    barred: str = ""
    asked: bool = False


def said_of(words: tuple[str, ...], spans: Collection[Span], names: Collection[str]) -> Said | None:
    """The words of a question by their marks; None if two things stand where one can, or a time would be lost."""
    found: dict[str, list[str]] = {tag: [] for tag in ("x", "y", "t", "u", "off")}
    before = ("", *words)  # the word before each
    spans = [(tag, a - (tag == "t" and before[a] in _CONJUNCTIONS), b) for tag, a, b in spans]
    spans = [span for span in spans if span[0] != "u" or not _COUNTED.search(" ".join(words[span[1] : span[2]]))]
    inside = held_by(spans)
    for tag, start, stop in spans:
        found[tag].append(" ".join(words[start:stop]).strip(" ,.?"))
    rest = " ".join(word for at, word in enumerate(words) if at not in inside)
    starts = {start for _, start, _ in spans}
    barred = " ".join(
        "|" if at in starts else word for at, word in enumerate(words) if at not in inside or at in starts
    )
    idle = held_by(spans, "off")
    first = next((word for at, word in enumerate(words) if at not in idle and word.isalpha()), "")
    events = [name for name in found["x"] if _AN_EVENT.match(name)]
    found["x"] = [name for name in found["x"] if name not in events and not _ONES.match(name)]
    if not found["x"] and (own := _THAT_ONE.search(" ".join(found["off"]))) is not None:
        found["x"] = [own[0]]  # "oh, the green one! when does it let go?"
    rest = _TAG.sub(" ", " ".join((rest, *events)))
    if not found["x"]:  # "one of the toys was in a sulk, which was it?"
        plain = (word for aside in found["off"] for word in aside.split())
        named = [f"the {word}" for word in plain if singular(word) in names]
        several = [name for name in named if name.endswith("s")]
        found["x"] = several[:1] or (named if len(set(named)) == 1 and "it" in rest.split() else [])
    noun = next((singular(w) for w in words if w.endswith("s") and singular(w) in names), "")
    things = {
        tag: tuple(dict.fromkeys(_named(_ONE.sub(noun or "one", name), names) for name in found[tag]))
        for tag in ("x", "y")
    }
    known = tuple(name for name in things["x"] if _is_known(name, names))
    things["x"] = known or things["x"]  # "my clockwork apprentice, the robot"
    if not found["t"] and (past := _NOW_THAT.match(" ".join(found["off"]))) is not None:
        found["t"], found["off"] = [f"once {past['time']}"], []
    if not found["t"] and len(found["off"]) == 1 and (blinked := _BLINKED.search(found["off"][0])) is not None:
        found["t"], found["off"] = [blinked["time"] or blinked["t"]], []  # "I blinked at 1.4 s, which one fell?"
    asides = (words[start:stop] for tag, start, stop in spans if tag == "off" and not _is_apart(words, start, stop))
    if len(found["t"]) > 2 or any(_TIMED.search(ASKS_WHEN.sub("", " ".join(aside))) for aside in asides):
        return None
    wanted = re.sub(r"metre", "meter", " ".join(found["u"]))
    unit = None if _EACH.match(wanted) else _IN_UNIT.search(wanted)
    return Said(
        x=_joined(things["x"]), y=_joined(things["y"][:1]), time=" ".join(found["t"]), unit=unit[0] if unit else "",
        rest=f" {rest} ", times=tuple(found["t"]), off=" ".join(found["off"]), places=things["y"],
        names=names, first=first, barred=f" {_TAG.sub(' ', barred)} ",
        asked=any(tag == "x" and before[start] in ("which", "what") for tag, start, _ in spans),
    )  # fmt: skip


ASKS_WHEN = re.compile(r"^when ,")  # "when, to the best of your knowledge, ..."
_TAG = re.compile(  # "it opens, doesn't it?", "yes or no"
    r" ,? ?(?:or )?(?:is|are|was|does|do|did|has|have|will|would|could|can) "
    r"(?:not (?:it|he|she|they)|(?:it|he|she|they)"
    r"(?: not)?)(?: \?)?$|,? ?\b(?:yes ?(?:or|/) ?no|y ?/ ?n|true or (?:false|not)|right or wrong)\b|"
    r", true \?$|,? or (?:not|no|nothing|nah)?(?: at all)? ?\?$|"
    r", (?:is (?:not )?(?:it|that)(?: not)? so|(?:or )?not so) \?$|"
    r",? or (?:it|he|she) (?:did|does|do) not(?: [a-z]+){0,3} \?$|, or (?:has|is|does|was) (?:it|he|she) "
    r"(?:[a-z]+ ){1,3}\?$"
)


def _is_apart(words: tuple[str, ...], start: int, stop: int) -> bool:
    """Whether words are a sentence of their own in front of the question, or behind it."""
    ends = set(words[stop - 1 : stop + 1]) if start == 0 else set()
    begins = set(words[start - 1 : start + 1]) if start and stop >= len(words) - 1 else set()
    return not ends.isdisjoint(_STOPS) or not begins.isdisjoint(_STOPS)


_STOPS = (".", "!", "?", ":", ";")
_AN_EVENT = re.compile(
    r"^(?:the |its |his |her |this |that )?(?:turn|turning|roll|rolling|fall|falling|opening|closing|walk|spin|"
    r"movement|motion|rotation|drop)"
    r"(?: manoeuvre| maneuver| movement| motion| phase| part)?$"
)
_TIMED = re.compile(
    r"\b(?:when|while|until|till|once|after|before|during|now that)\b(?!.*\b(?:i|we|you|me|us)\b)|\d|\bseconds?\b"
)
_ONES = re.compile(r"^(?:the |that |this |which )?ones?$")
_BLINKED = re.compile(
    r"^(?:if |when )?(?:i|we) [a-z ]+? (?P<time>at \d+(?:\.\d+)?(?: ?s(?:ec(?:ond)?s?)?)?)"
    r"(?: (?:to|for) [a-z ]+)?(?: ,)?$|^if (?P<t>t = \d+(?:\.\d+)?)(?: ,)?$"
)
_NOW_THAT = re.compile(r"^(?:and )?(?:now|seeing|given) that (?P<time>.+)$")
_ONE = re.compile(r"\bone$")
_THAT_ONE = re.compile(r"\bthe (?:red|green|blue|yellow|white|black|brown|grey|gray|orange|purple|pink) one\b")
_CONJUNCTIONS = ("til", "till", "until", "before", "once")


def _named(said: str, names: Collection[str]) -> str:
    """A name with an article, without adjectives of which no thing of the scene has one in its name."""
    said = re.sub(r"^(?:the )?final (?=\w)", "the last ", said)
    if (whole := re.match(r"^(?:everything|anything|something)(?= [a-z]+ly$)", said)) is not None:
        return whole[0]  # "everything tidily"
    if (stands := _ON_A_SIDE.match(said)) is not None:
        said = f"the {stands['side']} {stands['thing']}"
    if (two := _TWO_OF_A_KIND.match(said)) is not None and singular(two["noun"]) in names:
        said = f"the {two['one']} {singular(two['noun'])} and the {two['other']} {singular(two['noun'])}"
    if (whose := _WHOSE.match(said)) is not None and singular(whose["noun"]) in names:
        said = f"the {whose['noun']}"
    said = _PART_OF.sub("the ", said)
    words = said.split()
    if words and is_color_word(words[-1]) and words[-1] not in names:
        return f"the {words[-1]} one"  # "red, green, blue: which order?"
    if not _is_known(said, names) and (color := next(filter(is_color_word, words), None)) is not None:
        return f"the {color} one"  # "our small green wanderer"
    if words and singular(words[-1]) in names:
        said = " ".join(w for w in words if w in names or singular(w) in names or w in _TELLING or is_color_word(w))
    said = re.sub(
        r" 's$", "", re.sub(r"^(?:this|that|these|those|a|an|my|our|your|his|her|their|its) (?=\w)", "the ", said)
    )
    return said if _DETERMINED.match(said) or said in PRONOUNS else f"the {said}"


_PART_OF = re.compile(r"^(?:the )?(?:[a-z]+ )?(?:edge|rim|border|fringe) of (?:the )?(?=[a-z])")

_TWO_OF_A_KIND = re.compile(r"^(?:both |the )*(?P<one>[a-z]+) and (?:the )?(?P<other>[a-z]+) (?P<noun>[a-z]+s)$")
_WHOSE = re.compile(r"^(?:the |this )?[a-z]+ 's (?P<noun>[a-z]+s)$")  # "the dresser 's drawers"
_ON_A_SIDE = re.compile(r"^(?:the |that |this )?(?P<thing>\w+(?: \w+)?) (?:on|to) the (?P<side>left|right)$")
_TELLING = bag(
    "on in at under beside behind below above from near by to next of "
    "the a an this that these those all both every each any two three top bottom middle upper lower first "
    "second third last left right other moving and of"
)


def _is_known(said: str, names: Collection[str]) -> bool:
    """Whether words name a thing of the scene, or one of which is known what it is."""
    words = [singular(word) for word in said.split() if not is_color_word(word)]
    return not words or said in PRONOUNS or any(w in names or kinds_of_things.find(w) is not None for w in words)


def _joined(names: tuple[str, ...]) -> str:
    """Several names as one; without pronouns where a name stands beside."""
    nouns = tuple(name for name in names if name not in PRONOUNS) or names
    return " and ".join(nouns)
