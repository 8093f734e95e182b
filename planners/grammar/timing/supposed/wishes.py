"""Plain commands of a kind of wish: the thing, the colour, the amounts of an instruction put into words that are read.

All that an instruction names must stand in the command: a number, a colour, a thing or a time that is left over makes
it none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from .....gaussians import color
from .....gaussians import late_re as re
from .....gaussians.language.query.query import Query
from ...tagging.words import bag
from ...vocabulary.nouns import EVERYWHERE, is_known
from ...vocabulary.quantities import NUMBERS
from ..asides import HUES
from ..command import Command, pace
from ..manner import Thing
from ..moments import DURATION, Moment, seconds_of

_NO_THINGS = EVERYWHERE | bag(
    "second seconds time moment start end beginning film clip video shot movie animation way bit speed motion movement "
    "turn turns circle frame place spot direction half rest minute mood eyes eye sec point stop pace work job whole "
    "look view scene thing things same part middle air sky children kids guests audience viewers boss client baby boy girl son daughter camera screen please once opening walk fall roll ride trip go times sequence effect slow fast "
    "light dark red blue green yellow white black purple pink orange brown gray grey silver gold"
)
_ALL = re.compile(
    r"\b(?:everything|all|whatever|anything)(?: (?:that|which))?(?: (?:is|are))? (?:moves?|moving)\b"
    r"(?: (?:in|on) (?:the|this) (?:shot|scene|film|clip|video|picture))?|\beverything\b(?! else)"
)
_BETWEEN = bag("to at on in into onto by of for with from and or but then so as until while when once after before")
_LONGEST_NAME = 5
SURE = 0.85  # probability from which a change without a time is supposed: others read these
_CONJUNCTION = re.compile(
    r"\b(?:when|whenever|while|whilst|until|till|untill|during|as soon|by the time|the moment|the instant|instead|"
    r"except|unless|if)\b"
)
_EVENTS = re.compile(r"\b(?:once|after|before|as)\b (?=(?:the|a|my|it|he|she|they|that|this)\b)")


@dataclass(frozen=True)
class Said:
    """What an instruction says beside its time.

    Attributes:
        text: its words.
        things: the names in it, as they stand.
        moment: its time in numbers.
        event: whether a time is told by what happens.
        thing: reads a name.
    """

    text: str
    things: tuple[str, ...]
    moment: Moment
    event: bool
    thing: Thing

    @property
    def told(self) -> bool:
        """Whether any time is told."""
        return self.event or self.moment.told

    @property
    def whose(self) -> Query:
        """What the first name means."""
        return self.thing(self.things[0]) or Query(last=True)

    @property
    def beside(self) -> str:
        """The words that name no thing."""
        text = self.text
        for name in self.things:
            text = re.sub(rf"(?<!\S){re.escape(name)}(?!\S)", "|", text)
        return text


@dataclass(frozen=True)
class Wish:
    """A command, in words or as it is; its time; the number of things in it, and the words of the instruction that it
    holds otherwise."""

    command: str | Command
    moment: Moment
    things: int = 1
    holds: str = ""


def named(text: str, thing: Thing) -> tuple[str, ...]:
    """The names of things in a text, in their order."""
    text, words, at = _ALL.sub("everything that moves", text), [], 0
    found = list[str]()
    words = text.split()
    while at < len(words):
        for end in range(min(len(words), at + _LONGEST_NAME), at, -1):
            phrase = " ".join(words[at:end])
            if _is_name(words[at:end]) and thing(phrase) is not None:
                found.append(phrase)
                at = end
                break
        else:
            at += 1
    return tuple(dict.fromkeys(found))


def _is_name(words: Sequence[str]) -> bool:
    if list(words) == ["everything", "that", "moves"]:
        return True
    if not all(word.isalpha() or word == "'s" for word in words) or set(words) & _BETWEEN:
        return False
    last = words[-1]
    return last not in _NO_THINGS and last not in NUMBERS and (is_known(last) or (words[0] == "the" and 1 < len(words) < 4))


_PRONOUN = re.compile(r"\b(?:it|he|she|him|her|they|them)\b")
_AS_BEFORE = re.compile(
    r"(?: ,)? (?:and |then |but )*(?:(?:it |make it |let it |turn it |go |goes |back |should |is |to )*)(?:[a-z]+ )?"
    r"(?:again|back|afterwards?|after that|as before|like before|as it was|normal(?: again)?)(?: (?:afterwards?|then))?$"
)
_IDLE = (
    re.compile(r" , (?:and |but )?(?:not|instead of|rather than) (?:at |to |by )?(?:the )?[a-z0-9.]+(?: [a-z]+)?$"),
    re.compile(r" , (?:and |with )?(?:no|not|without) [a-z]+ing\b(?: (?:at|after|in|it|down|up|again) ?[a-z0-9.]*)*$"),
    re.compile(r" , (?:so )?(?:i|we) (?:just )?(?:want|like|love|need|would like|would love) to (?:see|watch|look|have)\b.*$"),
    re.compile(r"(?<= )(?:say|uh|um|er|erm|well|like) ,|(?: ,)? (?:say|uh|um|er|erm) (?=(?:from|at|for|until|between)\b)"),
)
_ONE = re.compile(r"\b(?P<how>(?:the|that|this) (?!(?:first|last|next|other|moving|only) )[a-z]+) one\b")


def with_nouns(text: str) -> str:
    """A text with the noun that "one" stands for: "the middle drawer ... the top one" names the top drawer."""

    def noun(found: re.Match[str]) -> str:
        before = [w for w in text[: found.start()].split() if is_known(w) and w not in _NO_THINGS]
        after = [w for w in text[found.end() :].split() if is_known(w) and w not in _NO_THINGS]
        return f"{found['how']} {(before[-1:] or after[:1] or ['one'])[0]}"

    return _ONE.sub(noun, text)


def said_of(text: str, thing: Thing, moment: Moment, clause: str) -> Said:
    """What words say beside their time, with the clause of that time if there is one: "once the fan stops, hide it"."""
    text = _ALL.sub("everything that moves", text)
    for idle in _IDLE:
        text = " ".join(idle.sub(" ", text).split())
    if clause or moment.told:
        text = _AS_BEFORE.sub("", text)
    things = named(text, thing)
    if not things and _PRONOUN.search(text):
        things = named(clause, thing)[:1]
    return Said(text, things, moment, clause != "", thing)


def wishes(kind: str, said: Said, chance: float) -> Iterator[Wish]:
    """The plain commands of a kind that an instruction may stand for, the likeliest first."""
    made = _KINDS.get(kind)
    timeless = not said.told and not said.moment.always
    if made is None or not said.things or (kind in _STATIC and timeless and (chance < SURE or _ORDERED.match(said.text))):
        return
    if (_PROHIBITED if kind in _STATIC else _OTHER_EDITS).search(said.text):
        return
    for wish in made(said):
        if _is_whole(wish, said):
            yield wish


def _is_whole(wish: Wish, said: Said) -> bool:
    """Whether nothing that the instruction names is left out."""
    left = said.beside
    for held in wish.holds.split("|"):
        if held:
            left = left.replace(held, " ")
    left = _COMPLAINED.sub(" ", left)
    if len(said.things) > wish.things or _CONJUNCTION.search(left) or _EVENTS.search(left):
        return False
    words = left.split()
    if any(w[0].isdigit() or (w in NUMBERS and w != "one") or w in _hues() for w in words):
        return False
    return re.search(DURATION, left) is None


_COMPLAINED = re.compile(rf"\btoo (?:{HUES})\b")


def _hues() -> frozenset[str]:
    return frozenset(name for name in color.names() if " " not in name)


# -- kinds -----------------------------------------------------------------------------------------------------------


def _recolor(said: Said) -> Iterator[Wish]:
    hues = [w for w in said.beside.split() if w in _hues()]
    if hues:
        before = re.search(rf"\b(?P<how>very dark|very light|dark|deep|light|pale|bright|vivid) {hues[0]}\b", said.text)
        hue = f"{before['how']} {hues[0]}" if before is not None else hues[0]
        yield Wish(Command(kind="look", text=f"make {said.things[0]} {hue}"), said.moment, holds=hues[0])


_APPEARS = re.compile(r"\b(?:appears?|shows?|shown|visible|pops? (?:up|in)|comes? in(?:to)?|reveal|reveals?|there only|turns? up)\b")
_NOT = re.compile(r"\b(?:not|no|never|without|invisible|nobody|nothing)\b")


def _hide(said: Said) -> Iterator[Wish]:
    seen = _APPEARS.search(said.text) is not None and _NOT.search(said.text) is None
    yield Wish(f"{'show' if seen else 'hide'} {said.things[0]}", said.moment)


def _remove(said: Said) -> Iterator[Wish]:
    if not said.told:
        yield Wish(Command(kind="look", text=f"remove {said.things[0]}"), said.moment)


_GOAL = re.compile(r"\b(?P<how>to|next to|beside|towards?|by|near|up to|over to|across to|against|alongside)(?: the side of)? $")
_WAYS = {"up": "up", "upwards": "up", "left": "to the left", "right": "to the right", "down": "down"}
_LENGTH = re.compile(r"(?:\d+(?:\.\d+)?|half a|a|one|two|three|fifty|thirty|twenty|ten|forty) ?(?:m|cm|met(?:re|er)s?|centimet(?:re|er)s?)\b")


def _move(said: Said) -> Iterator[Wish]:
    if len(said.things) == 2:
        first, goal = said.things
        if said.text.find(goal) > said.text.find(first):
            yield Wish(f"move {first} to {goal}", said.moment, things=2)
    length = _LENGTH.search(said.text)
    way = next((_WAYS[w] for w in said.beside.split() if w in _WAYS), None)
    if way is not None and length is not None:
        yield Wish(f"move {said.things[0]} {way} by {length[0]}", said.moment, holds=length[0])


_TIMES = {"once": 1, "twice": 2, "two times": 2, "three times": 3, "thrice": 3, "four times": 4, "one time": 1}


def _times(text: str) -> tuple[str, int] | None:
    return next(((words, n) for words, n in _TIMES.items() if re.search(rf"\b{words}\b", text)), None)


def _spin(said: Said) -> Iterator[Wish]:
    times = _times(said.beside)
    full = re.search(r"\b(?:one|a) (?:[a-z]+ ){0,2}(?:turn|circle|spin|rotation|twirl|pirouette|round)\b|\ball the way round\b", said.beside)
    if times is not None:
        yield Wish(f"spin {said.things[0]} {times[0] if times[1] > 1 else 'once'}", said.moment, holds=times[0])
    elif full is not None:
        yield Wish(f"spin {said.things[0]} once", said.moment, holds=full[0])
    else:
        yield Wish(f"spin {said.things[0]}", said.moment)


_A_PART = re.compile(r"\b(?:clos(?:e|es|ing)|shut(?:s|ting)?|back|returns?|again|in again)\b")  # of a movement that has two
_LATER = re.compile(r"\b(?:later|delay|delayed|late|postpone|hold back|waits?|longer|behind)\b")
_EARLIER = re.compile(r"\b(?:earlier|sooner|early|ahead)\b")


def _begin(said: Said) -> Iterator[Wish]:
    if _A_PART.search(said.text):
        return
    thing, moment = said.things[0], said.moment
    later, earlier = _LATER.search(said.text), _EARLIER.search(said.text)
    for span in re.finditer(DURATION, said.text):
        seconds = seconds_of(span[0])
        if seconds is not None and (later is None) != (earlier is None):
            way = "later" if later is not None else "earlier"
            yield Wish(pace(said.whose, "later", seconds=seconds if way == "later" else -seconds), Moment(), holds=span[0])
    if moment.lasting is not None and moment.start is None and moment.stop is None and (later is None) != (earlier is None):
        way = "later" if later is not None else "earlier"
        yield Wish(pace(said.whose, "later", seconds=moment.lasting if way == "later" else -moment.lasting), Moment())
    if said.told and moment.lasting is None:
        if moment.stop is not None and moment.start is None and not said.event:  # "it waits until 2 s"
            moment = replace(moment, start=moment.stop, stop=None)
        yield Wish(pace(said.whose, "begin"), moment)


_FACTORS = (
    (re.compile(r"\bhalf (?:of )?(?:the|its|that) time\b"), 2.0),
    (re.compile(r"\b(?:twice|double) (?:of )?(?:the|its|that) time\b|\btwice as long\b"), 0.5),
    (re.compile(r"\b(?:twice|double[ds]?|two times)\b"), 2.0),
    (re.compile(r"\b(?:three times|triple|thrice)\b"), 3.0),
    (re.compile(r"\bfour times\b"), 4.0),
    (re.compile(r"\b(?:a )?third\b"), 1 / 3),
    (re.compile(r"\b(?:a )?quarter\b"), 0.25),
    (re.compile(r"\bhalf\b|\bhalve\b"), 0.5),
)
_SLOWER = re.compile(
    r"\b(?:too|so|far too|way too|much too) (?:\w+ )?(?:fast|quick|quickly|hasty|rushed|wild)|"
    r"\b(?:less|not so|not as|not that) (?:fast|quick|quickly|hasty|wild|rushed|speedy|speed)|\bcalm\b|"
    r"\bslow(?!ly does)|\bslower\b|\bslowly\b|\bslow motion\b|\bhalf\b|\bgentler?\b|\blazy\b|\bleisurely\b"
)
_FASTER = re.compile(
    r"\b(?:too|so|far too|way too|much too|painfully) (?:\w+ )?(?:slow|slowly|sluggish|lazy)|\bnot (?:so|as|that) slow|"
    r"\bless slow|\bfast(?:er)?\b|\bquick(?:er|ly)?\b|\bhurry\b|\bspeed (?:it |this |that |the .+ )?up\b|\brush\b|"
    r"\bsnappier\b|\bbrisk(?:er)?\b|\bzip\b|\btwice\b|\bdouble\b"
)
_COMPLAINT = re.compile(r"\b(?:too|so|painfully)(?: \w+)? (?:fast|quick|quickly|hasty|wild|slow|slowly|sluggish|lazy)\b")


def _speed(said: Said) -> Iterator[Wish]:
    if _A_PART.search(said.text):
        return
    thing, text = said.things[0], said.beside
    plain = _COMPLAINT.sub(lambda m: "faster" if re.search(r"slow|slug|lazy", m[0]) else "slower", text)
    slower, faster = _SLOWER.search(plain) is not None, _FASTER.search(plain) is not None
    for pattern, factor in _FACTORS:
        if (found := pattern.search(text)) is not None:
            slowly = re.search(r"\bslow", plain) is not None and factor > 1
            yield Wish(pace(said.whose, "speed", factor=round(1 / factor if slowly else factor, 4)), _kept(said), holds=found[0])
            return
    if slower != faster:
        yield Wish(pace(said.whose, "speed", factor=0.5 if slower else 2.0), _kept(said))


def _kept(said: Said) -> Moment:
    """The time without words that only say how slow something is."""
    return replace(said.moment, slowly=False, quickly=False)


def _duration(said: Said) -> Iterator[Wish]:
    if _A_PART.search(said.text):
        return
    thing, moment = said.things[0], said.moment
    if moment.lasting is not None and moment.stop is None:
        yield Wish(pace(said.whose, "begin"), replace(moment, taken=True, slowly=False, quickly=False))
    if moment.lasting is None and moment.start is None and moment.stop is None:
        for span in re.finditer(DURATION, said.text):
            if (seconds := seconds_of(span[0])) is not None:
                yield Wish(pace(said.whose, "begin"), Moment(lasting=seconds, taken=True), holds=span[0])


def _pause(said: Said) -> Iterator[Wish]:
    moment, thing = said.moment, said.things[0]
    if moment.lasting is not None or moment.stop is not None:
        if moment.start is not None or moment.stop is not None or said.event:
            yield Wish(pace(said.whose, "stop"), replace(moment, taken=False, slowly=False))
        return
    for span in re.finditer(DURATION, said.text):
        seconds = seconds_of(span[0])
        if seconds is not None and (said.event or moment.start is not None):
            yield Wish(pace(said.whose, "stop"), replace(moment, lasting=seconds), holds=span[0])


def _halt(said: Said) -> Iterator[Wish]:
    moment = said.moment
    waits = moment.start is None and moment.stop is not None  # it moves afterwards
    if said.told and moment.lasting is None and (moment.stop in (None, "end") or waits):
        yield Wish(pace(said.whose, "stop"), _kept(said))


def _still(said: Said) -> Iterator[Wish]:
    moment = said.moment
    if moment.start is None and moment.stop is None and moment.lasting is None and not said.told:
        stays = re.search(r"\b(?:stay|remain|keep|leave|sit|stand|rest)(?:s|ing)?\b.* (?:on|in|at|by|where|put)\b", said.text) is not None
        yield Wish(pace(said.whose, "stop"), Moment(), things=2 if stays else 1)


def _reverse(said: Said) -> Iterator[Wish]:
    if not said.told:
        if re.search(r"\b(?:way|direction|clockwise|anti|counter)\b", said.text):
            yield Wish(f"let {said.things[0]} turn the other way round", said.moment)
        else:
            yield Wish(pace(said.whose, "reverse"), said.moment)


def _stay(said: Said) -> Iterator[Wish]:
    if not said.told and _RESTS.search(said.text):
        yield from _still(said)
    elif not said.told:
        yield Wish(f"keep {said.things[0]} open", Moment())


_RESTS = re.compile(
    r"\b(?:not|never|no) (?:ever )?(?:to )?(?:fall|move|drop|roll|walk|turn|go|budge|spin)|\bstays? (?:put|where)\b|"
    r"\bsits? still\b"
)
_SHARES = (
    (re.compile(r"\b(?:half ?way|half (?:as|the|that|of)|only half|half open|half)\b"), "halfway", "half the way"),
    (re.compile(r"\b(?:a|one) third\b"), "a third of the way", "a third of the way"),
    (re.compile(r"\b(?:a|one) quarter\b"), "a quarter of the way", "a quarter of the way"),
)
_DEGREES = re.compile(r"(?P<n>\d+|[a-z]+) (?:degrees?|deg|°)")
_OPENS = re.compile(r"\b(?:doors?|drawers?|gates?|lids?|windows?|hatch|flaps?|curtains?|cupboards?)$")


def _amount(said: Said) -> Iterator[Wish]:
    thing = said.things[0]
    opens = _OPENS.search(thing) is not None
    if (found := _DEGREES.search(said.text)) is not None:
        yield Wish(f"open {thing} by {found[0]}", said.moment, holds=found[0])
    elif (found := _LENGTH.search(said.text)) is not None:
        yield Wish(f"open {thing} by {found[0]}" if opens else f"let {thing} only move {found[0]}", said.moment, holds=found[0])
    for pattern, opened, way in _SHARES:
        if (found := pattern.search(said.beside)) is not None:
            yield Wish(f"open {thing} only {opened}" if opens else f"let {thing} go {way}", said.moment, holds=found[0])


def _open(said: Said) -> Iterator[Wish]:
    if _LATER.search(said.text) or _EARLIER.search(said.text):
        yield from _begin(said)
        return
    yield Wish(f"open {said.things[0]}", said.moment)


def _close(said: Said) -> Iterator[Wish]:
    yield Wish(f"close {said.things[0]}", said.moment)


def _order(said: Said) -> Iterator[Wish]:
    text = said.text
    if said.told and said.moment.empty and len(said.things) == 1:
        yield Wish(pace(said.whose, "begin"), said.moment)
    if len(said.things) == 1 and not said.told:
        for word in ("first", "last"):
            if re.search(rf"\b{word}\b", said.beside):
                yield Wish(f"let {said.things[0]} start {word}", Moment(), holds=word)
    if len(said.things) == 2:
        first, second = said.things
        between = text[text.find(first) + len(first) : text.find(second)]
        if re.search(r"\bafter\b", between) and text.find(first) < text.find(second):
            yield Wish(f"let {first} start after {second} has stopped", Moment(), things=2, holds="after")
        if re.search(r"\b(?:before|ahead of)\b", between) and text.find(first) < text.find(second):
            yield Wish(f"let {second} start after {first} has stopped", Moment(), things=2, holds="before")


def _together(said: Said) -> Iterator[Wish]:
    if len(said.things) > 1:
        yield Wish(f"let {' and '.join(said.things)} start at the same time", Moment(), things=len(said.things))
    elif _SEVERAL.search(said.things[0]):
        yield Wish(f"let {said.things[0]} start at the same time", said.moment)


_SEVERAL = re.compile(r"^(?:all|both|everything|these|those|the (?:two|three|four))\b|[^s]s$")


def _repeat(said: Said) -> Iterator[Wish]:
    times = _times(said.beside)
    if times is None or times[0] == "once":
        yield Wish(f"repeat the movement of {said.things[0]}", said.moment, holds="once")
    elif times[1] == 2:
        yield Wish(f"let {said.things[0]} move twice", said.moment, holds=times[0])
    else:
        yield Wish(f"let {said.things[0]} move {times[1]} times", said.moment, holds=times[0])


def _return(said: Said) -> Iterator[Wish]:
    yield Wish(pace(said.whose, "return"), said.moment)


def _longer(said: Said) -> Iterator[Wish]:
    if said.moment.lasting is None and said.moment.start is None:
        yield Wish(pace(said.whose, "go_on"), said.moment)


_STATIC = ("recolor", "hide", "remove", "move")  # which the rest of the grammar reads where no time is told
_ORDERED = re.compile(r"(?:delete|remove|erase|hide|paint|make|move|turn|put|recolou?r)\b")  # which others read
_PROHIBITED = re.compile(r"\b(?:do not|never|must not|should not) (?:delete|remove|move|paint|touch|hide|recolou?r|change)\b")
_OTHER_EDITS = re.compile(r"\b(?:delete|remove|erase|add|insert|duplicate|copy|replace|get rid)\b")
_KINDS: dict[str, Callable[[Said], Iterator[Wish]]] = {
    "recolor": _recolor, "hide": _hide, "remove": _remove, "move": _move, "spin": _spin, "begin": _begin,
    "speed": _speed, "duration": _duration, "pause": _pause, "halt": _halt, "still": _still, "reverse": _reverse,
    "stay": _stay, "amount": _amount, "open": _open, "close": _close, "order": _order, "together": _together,
    "repeat": _repeat, "return": _return, "longer": _longer,
}  # fmt: skip
