"""Plain questions of a kind: the things, the time and the unit of a question that no frame reads, put into one.

    "hey um, trolley get rolling at what second?"  ──►  "when does the trolley start to move"

A question is put plainly only if none of its words tells more: a negation, a number, a comparison, a rank, a thing.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

from ......gaussians import late_re as re
from ......gaussians.world.spelling import best_slip
from ......gaussians.world.words import singular
from .....grammar.tagging.spelling import is_word
from .....grammar.tagging.words import bag, clean, split
from .....grammar.vocabulary.quantities import NUMBERS
from ...noun_phrase import is_color_word
from ..everyday import everyday
from ..frames import UNIT
from ..loosely import HARD
from .kinds import kinds_of, marked, vocabulary

LEAST = 0.38  # probability of a kind that is tried: .8 of these are told right, .9 from .5 on
_LONGEST = 40  # words
_DETERMINED = re.compile(r"^(?:the|a|an|this|that|these|those|my|our|your|his|her|its|their|all|both|any|every)\b")
_PLURAL = re.compile(r"^(?:all |both )?(?:of )?(?:the |these |those |my |our )?")
_IN_UNIT = re.compile(rf"\b(?:{UNIT}|rpm|revs? (?:a|per) minute)\b")
_HARD = (HARD - {"one"}) | bag("after before further until while backwards backward reverse")


@dataclass(frozen=True)
class Said:
    """What a question says.

    Attributes:
        x, y: what it is about, and the other thing; "" if none is named.
        time: the words of its time, "" if there are none.
        unit: that of its answer, "" if none is said.
        rest: all other words.
    """

    x: str
    y: str
    time: str
    unit: str
    rest: str


@lru_cache(maxsize=1024)
def supposed(text: str, names: frozenset[str]) -> tuple[str, ...]:
    """Plain questions that a text most likely means, with its time; none if that is not likely enough.

    Args:
        names: words of the names of the things of the scene.
    """
    if not text.strip() or len(text.split()) > _LONGEST:
        return ()
    told = tuple(word.text for word in split(clean(text)))
    told = tuple(_spelled(word, names) for word in told)
    kind, chance = _likeliest(" ".join(told))
    if chance < LEAST or kind not in _PLAIN:
        return ()
    said = _said(told, marked(told), names)
    if said is None or _says_more(kind, said, names):
        return ()
    time = everyday(_ROUGHLY.sub("", said.time)) if said.time else ""
    return tuple(dict.fromkeys(" ".join(f"{plain} {time}".split()) for plain in _PLAIN[kind](said)))


_ROUGHLY = re.compile(r"\b(?:like|around|about|roughly|approximately|exactly|just|maybe|say) (?=\d)")


def _spelled(word: str, names: frozenset[str]) -> str:
    """A word, or the word that it is with a slip."""
    if len(word) < 5 or not word.isalpha() or word in names or singular(word) in names or is_word(word):
        return word
    return word if word in vocabulary() else best_slip(word, vocabulary()) or word


def _likeliest(said: str) -> tuple[str, float]:
    """The likeliest kind with its probability; an average and a greatest speed are told apart by their words."""
    found = dict(kinds_of(said))
    kind = max(found, key=found.__getitem__)
    if kind in ("fast", "fast_most"):
        return ("fast_most" if _GREATEST.search(said) else "fast"), found["fast"] + found["fast_most"]
    return kind, found[kind]


_GREATEST = re.compile(r"\b(?:top|max|maximum|maximal|peak|highest|greatest|fastest|most|record)\b")


def _said(words: tuple[str, ...], spans: Collection[tuple[str, int, int]], names: Collection[str]) -> Said | None:
    """The words of a question by their marks; None if two things stand where one can, or a time would be lost."""
    found: dict[str, list[str]] = {tag: [] for tag in ("x", "y", "t", "u", "off")}
    inside = set[int]()
    for tag, start, stop in spans:
        found[tag].append(" ".join(words[start:stop]).strip(" ,.?"))
        inside |= set(range(start, stop))
    rest = " ".join(word for at, word in enumerate(words) if at not in inside)
    things = {tag: tuple(dict.fromkeys(_named(name, names) for name in found[tag])) for tag in ("x", "y")}
    if len(things["y"]) > 1 or len(found["t"]) > 2 or any(_TIMED.search(aside) for aside in found["off"]):
        return None
    unit = _IN_UNIT.search(" ".join(found["u"]))
    return Said(
        x=_joined(things["x"]), y=_joined(things["y"]), time=" ".join(found["t"]), unit=unit[0] if unit else "",
        rest=f" {rest} ",
    )  # fmt: skip


_TIMED = re.compile(
    rf"\b(?:when|while|until|till|once|after|before|during)\b(?!.*\b(?:i|we|you|me|us)\b)|\d|\bseconds?\b|"
    rf"\b(?:{'|'.join(w for w in NUMBERS if w != 'one')})\b"
)


def _named(said: str, names: Collection[str]) -> str:
    """A name with an article, without adjectives of which no thing of the scene has one in its name."""
    words = said.split()
    if words and singular(words[-1]) in names:
        said = " ".join(w for w in words if w in names or singular(w) in names or w in _TELLING or is_color_word(w))
    said = re.sub(
        r" 's$", "", re.sub(r"^(?:this|that|these|those|a|an|my|our|your|his|her|their|its) (?=\w)", "the ", said)
    )
    return said if _DETERMINED.match(said) or said in _PRONOUNS else f"the {said}"


_TELLING = bag(
    "the a an this that these those all both every each any two three top bottom middle upper lower first "
    "second third last left right other moving and of"
)
_PRONOUNS = ("it", "he", "she", "they", "anything", "something", "everything", "things", "what", "which")


def _joined(names: tuple[str, ...]) -> str:
    """Several names as one; without pronouns where a name stands beside."""
    nouns = tuple(name for name in names if name not in _PRONOUNS) or names
    return " and ".join(nouns)


def _says_more(kind: str, said: Said, names: Collection[str]) -> bool:
    """Whether words without a mark say more than the kind of question does."""
    rest = said.rest.split()
    if not kind.startswith("if_") and rest and rest[0] in _AUXILIARIES:
        return True  # "is the ball at its top speed then?" wants no number
    if kind.startswith("if_") and _ASKS.intersection(rest):
        return True  # "which way does it turn" wants no yes or no
    if kind in _NEGATED or (rest and rest[0] in _AUXILIARIES):
        rest = [word for word in rest if word not in ("not", "no", "never", "nothing")]  # "did it not move?"
    if "and" in rest or "or" in rest:
        return True  # two deeds, or things to choose from
    allowed = _ALLOWED.get(kind, frozenset())
    if any(word in _HARD and word not in allowed for word in rest):
        return True
    if any((word in NUMBERS and word != "one") or word[0].isdigit() or is_color_word(word) for word in rest):
        return True
    return any(singular(word) in names for word in rest if word not in _VERBS)


_ASKS = bag("which what how when where who whose")
_AUXILIARIES = bag("is are was were does do did has have had")
_NEGATED = bag("if_still what_still")
_VERBS = bag("fall falls light turn turns open close drop step steps start stop move swing spin fan walk roll slide")
_ORDERS = bag("first last second third than before after earlier later sooner next other")
_ALLOWED: Mapping[str, frozenset[str]] = {
    "first": _ORDERS, "last": _ORDERS | {"final"}, "order": _ORDERS, "if_before": _ORDERS, "if_after": _ORDERS,
    "if_together": bag("same both each other"), "if_returns": bag("back again"), "when_closes": bag("back again"),
    "when_shut": bag("back again"), "if_closes": bag("back again"), "if_shut": bag("again back"),
    "long_closes": bag("back again"), "where_ends": bag("last final"),
    "fastest": bag("most than faster every each other"),
    "when_closest": bag("most least"), "when_starts": bag("first"), "when_stops": bag("last final again"),
    "when_reaches": bag("first"), "when_falls": bag("first"), "where_starts": bag("first initial"),
    "turns": bag("every each"), "often": bag("every each"), "fast_most": bag("most"), "gap": _ORDERS | {"between"},
    "long_still": bag("before first only"), "long_reach": bag("before until"), "if_to_end": bag("until"),
    "what_still": bag("only else other"), "what_moves": bag("else other"), "how_many": bag("every each other"),
}  # fmt: skip

# -- one plain question for each kind ----------------------------------------------------------------------------------

_DEEDS = tuple(
    (re.compile(rf"\b(?:{words})\b"), deed)
    for words, deed in (
        (r"land(?:s|ed|ing)?|hits? (?:the )?(?:floor|ground)|touch(?:es|ed)? down", "land"),
        (r"f[ae]ll(?:s|en|ing)?|drop(?:s|ped|ping)?|tumbl\w+|c[oa]mes? (?:down|off)|plung\w+|plummet\w*|down", "fall"),
        (r"stop(?:s|ped|ping)?|finish\w*|halt\w*|rest|standstill|end(?:s|ed)?|done|still", "stop"),
        (r"clos(?:e|es|ed|ing)|shut(?:s|ting)?", "close"),
        (r"open(?:s|ed|ing)?", "open"),
        (r"turn(?:s|ed|ing)?", "turn"),
    )
)  # fmt: skip
_OFTEN = (
    (re.compile(r"\bsteps?\b|\bpaces?\b"), "how many steps does {x} take"),
    (re.compile(r"\bhops?\b|\bbounc\w+|\bbobs?\b|\bjumps?\b"), "how often does {x} bob"),
)


def _deed(rest: str, moving: str) -> str:
    """The verb of what things do."""
    return next((deed for words, deed in _DEEDS if words.search(rest)), moving)


def _s(verb: str) -> str:
    return re.sub(r"(?<=[^s])$", "s", verb.split(" ")[0]) + verb[len(verb.split(" ")[0]) :]


def _one_of(x: str) -> str:
    """Of several things the noun for one: "the books" is "book"."""
    bare = _PLURAL.sub("", x)
    words = bare.split()
    return " ".join((*words[:-1], singular(words[-1]))) if words else "thing"


Plain = Callable[[Said], Iterator[str]]


def _about(text: str, unit: bool = False) -> Plain:
    """A plain question with the things in it; none if it needs one that is not named."""

    def made(said: Said) -> Iterator[str]:
        if ("{y}" in text and not said.y) or ("{x}" in text and not said.x):
            return
        asked = text.format(x=said.x, y=said.y)
        yield f"{asked} in {said.unit}" if unit and said.unit else asked

    return made


def _either(*ways: Plain) -> Plain:
    """The first of the ways that gives a question."""

    def made(said: Said) -> Iterator[str]:
        for way in ways:
            found = tuple(way(said))
            if found:
                yield from found
                return

    return made


def _moves(said: Said) -> Iterator[str]:
    yield f"does {said.x or 'anything'} move"


def _ordered(said: Said, rank: str) -> Iterator[str]:
    deed = _deed(said.rest, "move")
    noun = "thing" if not said.x or " and " in said.x or said.x in _PRONOUNS else _one_of(said.x)
    yield f"which {noun} {_s(deed)} {rank}"


def _in_order(said: Said) -> Iterator[str]:
    deed = _deed(said.rest, "move")
    yield f"in what order do {said.x if said.x and said.x not in _PRONOUNS else 'things'} {deed}"


def _counted(said: Said) -> Iterator[str]:
    deed = _deed(said.rest, "move")
    noun = _PLURAL.sub("", said.x) if said.x and said.x not in _PRONOUNS else "things"
    yield f"how many {noun} {deed}"


def _compared(said: Said, word: str) -> Iterator[str]:
    if said.x and said.y:
        deed = _deed(said.rest, "start to move")
        deed = "stop moving" if deed == "stop" else deed
        yield f"does {said.x} {deed} {word} {said.y}"


def _often(said: Said) -> Iterator[str]:
    if said.x:
        own = next((text for words, text in _OFTEN if words.search(said.rest)), "")
        deed = _deed(said.rest, "")
        if own or deed:
            yield (own or f"how often does {{x}} {deed}").format(x=said.x)


def _turns(said: Said) -> Iterator[str]:
    if said.x:
        degrees = "degree" in f"{said.unit} {said.rest}" or "angle" in said.rest
        yield f"how many degrees does {said.x} turn" if degrees else f"how many turns does {said.x} make"


def _fast(said: Said) -> Iterator[str]:
    if said.x:
        yield f"how fast does {said.x} move in {said.unit}" if said.unit else f"what is the average speed of {said.x}"


def _which(said: Said) -> Iterator[str]:
    if said.x:
        yield (
            f"which {_one_of(said.x)} is the fastest" if " and " not in said.x else f"which of {said.x} is the fastest"
        )


def _over(said: Said) -> Iterator[str]:
    if said.x and said.y:
        passes = re.search(r"\b(?:past|pass|passes|passed|by)\b", said.rest) is not None
        yield f"does {said.x} {'pass' if passes else 'cross'} {said.y}"


def _gap(said: Said) -> Iterator[str]:
    deed = {"fall": "falling", "land": "landing", "stop": "stopping", "open": "opening", "close": "closing"}.get(
        _deed(said.rest, ""), "starting"
    )
    if said.x and said.y:
        yield f"how much time is there between {said.x} {deed} and {said.y} {deed}"


_PLAIN: Mapping[str, Plain] = {
    "when_starts": _about("when does {x} start to move"),
    "when_stops": _about("when does {x} stop moving"),
    "when_opens": _about("when does {x} start to open"),
    "when_open": _about("when is {x} fully open"),
    "when_closes": _about("when does {x} start to close"),
    "when_shut": _about("when is {x} closed"),
    "when_falls": _about("when does {x} fall"),
    "when_lands": _either(_about("when does {x} reach {y}"), _about("when does {x} land")),
    "when_turns": _about("when does {x} turn"),
    "when_reaches": _about("when does {x} reach {y}"),
    "when_leaves": _either(_about("when does {x} leave {y}"), _about("when does {x} start to move")),
    "when_closest": _about("when is {x} closest to {y}"),
    "long_moves": _about("how long does {x} move"),
    "long_opens": _about("how long does {x} take to open"),
    "long_closes": _about("how long does {x} take to close"),
    "long_open": _about("how long does {x} stay open"),
    "long_still": _about("how long does {x} stand still"),
    "long_on": _about("how long is {x} on {y}"),
    "long_falls": _about("how long does {x} fall"),
    "long_reach": _about("how long does {x} take to reach {y}"),
    "gap": _gap,
    "film_long": lambda said: iter(("how long is the film",)),
    "far": _about("how far does {x} move", unit=True),
    "far_opens": _about("how far does {x} open", unit=True),
    "far_turns": _about("by how many degrees does {x} turn"),
    "fast": _fast,
    "fast_most": _about("what is the maximum speed of {x}", unit=True),
    "turns": _turns,
    "often": _often,
    "where_ends": _about("where does {x} stop"),
    "where_starts": _about("where does {x} start"),
    "where_at": lambda said: iter((f"where is {said.x}",) if said.x and said.time else ()),
    "way": _about("which way does {x} move"),
    "turn_way": _about("which way does {x} turn"),
    "if_moves": _moves,
    "if_still": _about("does {x} stand still"),
    "if_opens": _about("does {x} open"),
    "if_closes": _about("does {x} close"),
    "if_open": _about("is {x} open"),
    "if_shut": _about("is {x} closed"),
    "if_falls": _about("does {x} fall"),
    "if_reaches": _about("does {x} touch {y}"),
    "if_on": _about("is {x} on {y}"),
    "if_crosses": _over,
    "if_returns": _about("does {x} come back"),
    "if_to_end": _about("does {x} move until the end"),
    "if_stops": _about("does {x} stop"),
    "if_turns": _about("does {x} turn"),
    "if_before": lambda said: _compared(said, "before"),
    "if_after": lambda said: _compared(said, "after"),
    "if_together": lambda said: _compared(said, "at the same time as"),
    "what_moves": lambda said: iter(("what moves",)),
    "what_still": lambda said: iter(("what does not move",)),
    "how_many": _counted,
    "first": lambda said: _ordered(said, "first"),
    "last": lambda said: _ordered(said, "last"),
    "order": _in_order,
    "fastest": _which,
    "happens": lambda said: iter(("what happens",)),
    "does": _about("what does {x} do"),
    "near": _about("what is {x} next to"),
    "on_way": _about("what does {x} touch"),
}
