"""Commands of a kind of wish: the thing, the colour, the amounts of an instruction put into what is read or done.

All that an instruction names must stand in the command: one that leaves a number, a colour, a thing or a time out is
none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import takewhile

from .....gaussians import late_re as re
from .....gaussians.language.query.query import Query
from ...learned.seen import hues
from ...vocabulary.nouns import EVERYWHERE, is_opened
from ...vocabulary.quantities import NUMBERS
from ..asides import HUES
from ..clauses import ALL_OF_IT, AUXILIARIES
from ..command import Command, pace
from ..moments import DURATION, End, Moment, seconds_of
from ..verbs import SENSES, has_form
from ..whens import HELD_BACK
from .choosing import says
from .kinds import is_any_word
from .names import MOVING
from .orders import in_order
from .said import BEFORE_IT, Said

SURE = 0.85  # probability from which a change without a time is supposed, or an unknown verb is left aside
STATIC = ("recolor", "hide", "remove", "move")  # kinds that need no time
_ON_ITS_WAY = (  # kinds that may name where something goes by itself
    "pause",
    "halt",
    "reverse",
    "speed",
    "duration",
    "begin",
    "still",
    "repeat",
    "longer",
)
_GREETING = re.compile(r"^(?:(?:hi|hello|hey|hiya|yo|ok|okay|so|and|well|right|sorry|oh|ah|hm+)(?: there)?(?: ,)? )+")
_THERE_AND_BACK = re.compile(r"\b(?:to|against|at|into) (?:\||(?:the|a) \w+) and\b")
_ORDERED = re.compile(r"(?:delete|remove|erase|hide|paint|make|move|turn|put|recolou?r)\b")  # how they are ordered
_DETERMINED = re.compile(r"(?:the|a|an|that|this|these|those|my|our|all|both|every|everything|it|him|her|them)$")
_PROHIBITED = re.compile(
    r"\b(?:do not|never|must not|should not) (?:delete|remove|move|paint|touch|hide|recolou?r|change)\b"
)
_UNWANTED = re.compile(r"\b(?:nobody|no one|none of us) (?:wants?|needs?|asked|asks|likes?)\b")
_OTHER_EDITS = re.compile(
    r"\b(?:add|insert|duplicate|copy|replace|swap|exchange|trade|forget|never mind|cancel|undo)\b"
)
_LIT = re.compile(r"\b(?:off|out|on)$")
_A_LIGHT = re.compile(r"\b(?:lamps?|lights?|lanterns?|candles?|bulbs?)$")
_EXCEPT = re.compile(r"(?<!\bat )\b(?:everything|all|every|both|things?)\b.*\b(?:but|except|apart from)\b")
_IN_PIECES = re.compile(r"\b(?:apart(?! from)|to pieces|in two)\b")
_REMOVALS = re.compile(r"\b(?:delete|remove|erase|get rid)\b")
_TIMES_LEFT = re.compile(
    r"\b(?:when|whenever|while|whilst|until|till|untill|during|as soon|by the time|the moment|the instant|instead|"
    rf"except|unless|if)\b|\bwhere (?:the|(?:it|he|she|they) (?!is\b|are\b|was\b|were\b|stood\b|used\b|came\b))|"
    r"\b(?:first|second|last|other|next) (?:part|leg|half|bit|stretch|stage)\b|"
    rf"\bat the (?:very )?(?:end|start|beginning)\b|\b(?:once|after|before|as)\b "
    rf"(?=(?:the|a|my|it|he|she|they|that|this)\b)|{DURATION}"
)
_COMPLAINED = re.compile(rf"\btoo (?:{HUES})\b")


@dataclass(frozen=True)
class Wish:
    """A command, in words or as it is.

    Attributes:
        moment: its time in numbers.
        things: how many things stand in it.
        holds: words of the instruction, other than names, that stand in it.
        spent: what the time in numbers tells that is no time of it.
        timeless: whether what happens at its time goes without saying.
        marked: whether all that has a mark stands in it.
    """

    command: str | Command
    moment: Moment
    things: int = 1
    holds: str = ""
    spent: End | None = None
    timeless: bool = False
    marked: bool = False


def wishes(kind: str, said: Said, chance: float) -> Iterator[Wish]:
    """The commands of a kind that an instruction may stand for, the likeliest first.

    Args:
        chance: the probability of the kind.
    """
    made = _KINDS.get(kind)
    if made is None or is_ruled_out(kind, said, chance):
        return
    if says(kind, said.idle) and not says(kind, said.text):
        return  # "the door closes too late"
    if kind not in ("order", "together"):
        said = said.joined().placed()
    if kind in ("recolor", "hide"):
        if kind == "hide" and _is_to_be_seen(said) and _BACK.search(f"{said.text} {said.idle}"):
            return  # "show it for a second, then bring it back" contradicts itself
        said = said.until_then()
    for wish in made(said):
        left = _left(wish, said)
        if _is_whole(kind, chance, wish, said, left) and says_no_more(kind, said, left):
            yield wish


def is_ruled_out(kind: str, said: Said, chance: float) -> bool:
    """Whether an instruction names nothing, or has words by which it is no wish of a kind, or more than one."""
    if not said.things or said.things[0].split(" ")[-1] in EVERYWHERE:
        return True
    first, then = (*_GREETING.sub("", said.text).split(" "), "")[:2]
    if not is_any_word(first) and _DETERMINED.match(then):
        return True  # a verb that is no word may ask for anything
    timeless = not said.told and not said.moment.always
    if kind in STATIC and timeless and (chance < SURE or _ORDERED.match(said.text)):
        return True
    if _LIT.search(said.text) and _A_LIGHT.search(said.things[0]):
        return True  # "turn the lamp off" stops no motion
    if _EXCEPT.search(f"{said.text} {said.idle}") or _IN_PIECES.search(f"{said.text} {said.idle}"):
        return True  # "everything but the fan", "take it apart"
    if (_PROHIBITED if kind in STATIC else _REMOVALS).search(said.text):
        return True
    if _UNWANTED.search(f"{said.idle} {said.text}"):
        return True
    if _OTHER_EDITS.search(said.text) and not (kind == "order" and said.listed):
        return True
    if kind in ("reverse", "return") and _THERE_AND_BACK.search(said.beside):
        return True  # "roll to the wall and come back"
    if kind in ("speed", "duration", "begin") and _A_STRETCH.search(said.text):
        return True  # "faster in the second half"
    return kind in STATIC and MOVING in said.things  # all, or what of it moves


def _is_whole(kind: str, chance: float, wish: Wish, said: Said, left: str) -> bool:
    """Whether nothing that the instruction names is among the words that are `left`, and no time is lost."""
    if _times(said.moment) - _times(wish.moment) - {wish.spent}:
        return False
    goes = kind in _ON_ITS_WAY and chance >= SURE and all(_goes_to(goal, said.text) for goal in said.goals)
    named = len(said.things) - (len(said.goals) if goes else 0)
    if (named > wish.things and not wish.marked) or _TIMES_LEFT.search(left):
        return False
    return not any(w[0].isdigit() or (w in NUMBERS and w != "one") or w in hues() for w in left.split())


def _goes_to(goal: str, text: str) -> bool:
    """Whether a name stands where words tell the place of something: "... then go on to the bed"."""
    way = r"to|at|by|near|on|onto|into|towards?|from|off|over|beside|reach(?:es|ing)?|hits?"
    return re.search(rf"\b(?:{way}) {re.escape(goal)}(?!\S)", text) is not None


def _times(moment: Moment) -> set[End | None]:
    return {moment.start, moment.stop, moment.lasting} - {None}


_LEFT_SO = re.compile(  # "and leave it that way", "keep it hidden before that"
    r"(?:\b(?:and|then) |, )*\b(?:leave|keep|stay|stays) (?:it |him |her |them |\| )?(?:(?:just )?(?:that way|"
    r"like that|like this|so|as is)|(?:hidden|away|out of sight) (?:before|until) (?:that|then)|like [a-z ]+)$"
)
_IF_ONLY = re.compile(  # "I would be grateful if ..."
    r"\b(?:i|we|it) (?:would|should|will) (?:\w+ ){0,3}?(?:grateful|happy|glad|nice|nicer|good|great|lovely|better|"
    r"best|delighted|suit \w+(?: \w+){0,2}?|appreciate it|like it|love it|prefer it|help)(?: \w+)?? if\b|"
    r"^(?:so |well )?it (?:would|will|might|could) (?:feel|look|be) (?:\w+ ){1,4}?if\b|^(?:and |so )?what if\b"
)
_AFTER_THAT = re.compile(r"\b(?:any ?more |ever |again |from then )?(?:after (?:that|this)|on after)\b")


def _stops(wish: Wish) -> bool:
    """Whether something is to stand still: nothing comes after that."""
    return isinstance(wish.command, Command) and all(op.get("change") == "stop" for op in wish.command.ops)


def _left(wish: Wish, said: Said) -> str:
    """The words that do not stand in a command."""
    if wish.marked:
        return said.unmarked
    left, hue = _without(said.beside, BEFORE_IT, _LEFT_SO, _IF_ONLY), wish.holds.split(" ")[-1]
    if wish.holds:
        left = re.sub(rf"(?<!\S){re.escape(wish.holds)}(?!\S)", " ", left, count=1)
    if hue in hues():
        left = re.sub(rf"(?<!\S){hue}(?!\S)", " ", left)  # "red, a good strong red"
    if wish.holds.startswith("half"):
        left = _AS_IT_DOES.sub(" ", left)
    if _stops(wish):
        left = _AFTER_THAT.sub(" ", left)
    return _COMPLAINED.sub(" ", left)


_TELLING = {  # words that say something by themselves, and the kinds of wishes that say it
    r"slow|slower|fast|faster|quick|quicker|twice|double|half|speed": "speed duration spin repeat amount",
    r"slowly|quickly": "speed duration spin repeat amount move",
    r"far(?! (?:too|better|nicer|more|less|from|prettier|cooler))|farther|further|wide|wider": "amount",
    r"earlier|sooner|later": "begin open order",
    r"backwards?|reverse|reversed": "reverse return order",
    r"back": "return reverse close stay still hide order repeat pause",
    r"again": "repeat return close open stay still halt hide recolor reverse pause",
    r"invisible|hides?|hidden|disappears?|vanish|vanishes|gone": "hide remove",
    r"shows?|shown|reveals?|visible": "hide recolor",
    r"shut|shuts|close|closes": "close stay still open begin order together speed",
    r"(?:turn|turned|switch|switched) (?:\| )?off": "halt",
    r"(?:to|into|onto|against|at) (?:the|a) (?:wall|floor|ground|ceiling)": "move reverse order duration",
}
_THEN = re.compile(r"\bthen (?:\w+ ){0,3}(?P<rest>(?:shut|close|open)s?)\b")
_BACK_TO = re.compile(r"\bback(?= (?:to|by|on|in|at|near|against|next to|beside)\b)")
_BY_HOW_MUCH = re.compile(r"\b(?:earlier|sooner|later)\b")
_BACK_IN = re.compile(r"\bback(?: in)?\b")
_NEGATED = ("hide", "remove", "still", "stay", "halt", "pause", "longer")  # kinds that say what is not to be
_SAID_BY = tuple((re.compile(rf"\b(?:{words})\b"), kinds.split()) for words, kinds in _TELLING.items())
_DISLIKES = re.compile(r"\b(?:do|does) not (?:really |much |quite )?(?:like|love|care for|fancy|enjoy)\b")
_AS_IT_DOES = re.compile(
    r"\b(?:\w+ )?as (?:it|he|she|they|now|\|)(?: \w+)? ?(?:does|do|is|was|goes|opens|moves)?(?: now)?\b"
)
_WISHED = re.compile(r" , (?:and |but )?(?:i|we) (?:want|would like|need) (?:it|him|her|them) to\b")
_TWO_ORDERS = re.compile(  # "open it, and once it is open paint it red"
    r"^(?:open|close|shut|push|pull|move|slide|roll|lift|spin|turn|stop|start|freeze|hide|remove|delete) \|.*"
    r"(?:,|\band\b|\bthen\b) ?(?:paint|make|turn|colou?r|hide|show|spin|move|stop|open|close) (?:it|him|her|them|\|)"
)
_MANNER = re.compile(r"\| (?P<verb>[a-z]+) (?:open|shut|closed|apart)\b")


def _without(text: str, *patterns: re.Pattern[str]) -> str:
    """A text without what patterns find."""
    for pattern in patterns:
        text = pattern.sub(" ", text)
    return text


def says_no_more(kind: str, said: Said, left: str) -> bool:
    """Whether no word that is `left` tells of another wish: "one second earlier, and slower"."""
    if kind not in ("recolor", "hide") and "then" in said.idle and hues() & set(said.idle.split()):
        return False  # "stop at 2 s, then roll it red again"
    if (then := _THEN.search(said.idle)) is not None:
        left = f"{left} {then['rest']}"  # "let it stand for a second, then shut it"
    if kind == "move" and len(said.things) > 1:
        left = _BACK_TO.sub(" ", left)
    if kind in ("open", "close") and isinstance(said.moment.start, float):
        left = _BY_HOW_MUCH.sub(" ", left)  # "a bit sooner, at 2 s"
    if kind == "begin":
        left = BEFORE_IT.sub(" ", HELD_BACK.sub(" ", left))
        if is_opened(said.things[0]):
            left = _BACK_IN.sub(" ", left)  # the beginning of its closing
    if kind in ("halt", "stay", "amount"):
        left = _without(left, _NO_MORE, _AS_IT_DOES)
    if any(kind not in kinds and words.search(left) for words, kinds in _SAID_BY):
        return False
    if _WISHED.search(f"{said.text} {said.idle}") or _TWO_ORDERS.search(left):
        return False
    if kind not in _NEGATED and _NOT.search(_without(left, _DISLIKES, _TOO_FAST, _TOO_SLOW, _NO_MORE)):
        waits = _LATER.search(left) is not None or isinstance(said.moment.stop, float)
        return kind == "begin" and waits  # "not at once, it waits", "do not open it till 3 s"
    manner = _MANNER.search(left)
    return manner is None or manner["verb"] in AUXILIARIES or has_form(manner["verb"], tuple(SENSES), "plain", "s")


_POINT_BEFORE = re.compile(r"\b(?:at|from|until|till|before)(?: (?:right|about|around|exactly|the))* $")


def _durations(text: str) -> Iterator[tuple[float, str]]:
    """The durations in a text: seconds, and the words."""
    for span in re.finditer(DURATION, text):
        if (seconds := seconds_of(span[0])) is not None and not _POINT_BEFORE.search(text[: span.start()]):
            yield seconds, span[0]


def _plainly(said: Said) -> Moment:
    """The time without words that only say how slow something is."""
    return replace(said.moment, slowly=False, quickly=False)


# -- looks and places ------------------------------------------------------------------------------------------------

_SHADE = r"very dark|very light|dark|deep|light|pale|bright|vivid"
_APPEARS = re.compile(
    r"\b(?:appears?|shows?|showing|shown|visible|into view|in view|pops? (?:up|in)|comes? in(?:to)?|reveals?|"
    r"there only|turns? up)\b"
)
_NO_MORE = re.compile(r"\b(?:no|not|nothing) (?:more|further|farther|wider)(?: than (?:that|this))?\b")
_NOT = re.compile(r"\b(?:not|no|never|without|invisible|nobody|nothing)\b")
_BACK = re.compile(r"\b(?:back|again)\b")
_TOWARDS = re.compile(
    r"\b(?:to|towards?|next to|beside|by|near|against|alongside|close to)(?: (?:the side of|stand by))? $"
)
_WAYS = {"up": "up", "upwards": "up", "left": "to the left", "right": "to the right", "down": "down"}
_RISES = {"lift": "up", "raise": "up", "rise": "up", "rises": "up", "hoist": "up", "lower": "down", "sink": "down"}
_LENGTH = re.compile(
    r"(?:\d+(?:\.\d+)?|half a|a|one|two|three|fifty|thirty|twenty|ten|forty) ?"
    r"(?:m|cm|met(?:re|er)s?|centimet(?:re|er)s?)\b"
)


_A_COLORED = re.compile(r"(?:an? )(?P<hue>[a-z]+) (?P<noun>[a-z ]+)$")


def _recolor(said: Said) -> Iterator[Wish]:
    words = _COMPLAINED.sub(" ", said.beside).split()
    first = next((at for at, word in enumerate(words) if word in hues()), None)
    if first is None:
        if (found := _A_COLORED.match(said.things[0])) is not None and found["hue"] in hues():
            noun = f"the {found['noun']}"  # "give me a red door"
            yield Wish(Command(kind="look", text=f"make {noun} {found['hue']}"), said.moment, holds=found["hue"])
        return
    hue = " ".join(takewhile(hues().__contains__, words[first:]))  # "navy blue"
    if set(words) & hues() <= set(hue.split()):
        shown = re.search(rf"\b(?:as (?:an? )?)?(?P<hue>(?:(?:{_SHADE}) )?{hue})\b", said.text)
        named = hue if shown is None else shown["hue"]
        holds = hue if shown is None else shown[0]
        yield Wish(Command(kind="look", text=f"make {said.things[0]} {named}"), said.moment, holds=holds)


_ENTERS_LATER = re.compile(r"\bnot\b[^,.]*[,.].*\b(?:appears?|spawns?|pops?|shows?|reveal(?:s|ed)?|comes?|fades?)\b")


def _hide(said: Said) -> Iterator[Wish]:
    if isinstance(said.moment.start, float) and said.moment.stop is None and _ENTERS_LATER.search(said.text):
        yield Wish(f"hide {said.things[0]}", replace(said.moment, start=None, stop=said.moment.start))
        return
    if isinstance(said.moment.stop, float) and not said.event and _COMES_UP.search(said.text):
        yield Wish(f"hide {said.things[0]}", said.moment)  # "gone at first, then let it appear at 2 s"
        return
    things = 1 + (_OUT_OF.search(said.beside.strip(" ,.!")) is not None)
    yield Wish(f"{'show' if _is_to_be_seen(said) else 'hide'} {said.things[0]}", said.moment, things)


_AT_FIRST = re.compile(r"\b(?:at first|to begin with|to start with|initially)\b")
_COMES_UP = re.compile(r"\b(?:appears?|(?:shows?|comes?|pops?|turns?) (?:back|up|in)|back|reveals?|revealed)\b")


def _is_to_be_seen(said: Said) -> bool:
    """Whether something is to be seen at the time that is told, and not to be hidden then."""
    appears = _APPEARS.search(said.text) is not None
    return appears and (_NOT.search(said.text) is None or _AT_FIRST.search(said.text) is not None)


_OFF_A = re.compile(r"\boff \|")  # "half a metre off the table"
_OUT_OF = re.compile(r"\|(?: \w+){0,3} (?:out of|from|off) \|(?= ?[,.!]|$)")


def _remove(said: Said) -> Iterator[Wish]:
    if not said.told:
        things = 1 + (_OUT_OF.search(said.beside.strip(" ,.!")) is not None)
        yield Wish(Command(kind="look", text=f"remove {said.things[0]}"), said.moment, things)


def _move(said: Said) -> Iterator[Wish]:
    if len(said.things) == 2 and "|" in said.beside and _TOWARDS.search(said.beside.split("|")[-2]):
        yield Wish(f"move {said.things[0]} to {said.things[1]}", said.moment, things=2)
    length = _LENGTH.search(said.text)
    words = said.beside.split()
    ways = {_WAYS[word] for word in words if word in _WAYS} or {_RISES[word] for word in words if word in _RISES}
    if ways == {"up"} and length is None and len(said.things) == 1 + (_OFF_A.search(said.beside) is not None):
        yield Wish(f"move {said.things[0]} up", said.moment, len(said.things))
    if len(ways) == 1 and length is not None and f"to {length[0]}" not in said.text:  # "lower it to 30 cm"
        things = 1 + (_OUT_OF.search(said.beside) is not None or _OFF_A.search(said.beside) is not None)
        yield Wish(f"move {said.things[0]} {ways.pop()} by {length[0]}", said.moment, things, length[0])


# -- turns and repeats -----------------------------------------------------------------------------------------------

_TIMES = re.compile(r"\b(?:once|one time|twice|two times|three times|thrice|four times)\b")
_ONCE = ("once", "one time")
_ROUND = re.compile(
    r"\b(?:one|a) (?:[a-z]+ ){0,2}(?:turn|circle|spin|rotation|twirl|pirouette|round)\b|\ball the way round\b|"
    r"\b(?:a )?(?:full )?360(?: degrees?)?\b"
)
_BACKWARDS = re.compile(
    r"\b(?:back|backwards?|revers\w+|in reverse|rewind|rewound|opposite|undo\w*|invert\w*|flip\w*|contrary)\b"
)
_TURNS = re.compile(  # "two full spins", "a quarter turn", "by 180 degrees"
    rf"\b(?P<n>\d+(?:\.\d+)?|half an?|(?:a )?quarter(?: of an?)?|{'|'.join(NUMBERS)}) "
    r"(?:(?:full|whole|complete|quick|slow|single|proper) )*(?:turns?|spins?|rotations?|revolutions?|twirls?|"
    r"rounds?|circles?|pirouettes?)\b|\b(?P<degrees>\d+(?:\.\d+)?) ?(?:degrees?|deg|°)"
)
_RATE = re.compile(
    r"\b(?:once|twice|(?:[a-z]+|\d+(?:\.\d+)?) (?:full |whole |complete )?(?:times|turns?|rounds?|rotations?|"
    r"revolutions?|spins?|twirls?|circles?)) (?:a|per|every|each) (?:(?:[a-z]+|\d+(?:\.\d+)?) )?seconds?\b"
)
_IN_REVERSE = re.compile(r"\b(?:backwards?|in reverse|rewind|rewound)\b")
_OTHER_WAY = re.compile(
    r"\b(?:(?:other|opposite|reverse|wrong|contrary) (?:way|direction|side|sense)|way (?:round|around)|direction|"
    r"clockwise|anti|counter)\b"
)


_STANDS_ON = re.compile(r"\| (?:\w+ ){0,6}(?:on|in|by|near|at|behind|under|beside) \|")  # "it spins on the table"


def _with_its_place(said: Said) -> int:
    """How many names are those of a thing and of what it stands on or beside meanwhile."""
    return 1 if _STANDS_ON.search(said.beside) is None else 2


def _spin(said: Said) -> Iterator[Wish]:
    rate, times, full = (p.search(said.beside) for p in (_RATE, _TIMES, _ROUND))
    how, moment = ("", "") if rate is None else (rate[0], rate[0]), said.moment
    if rate is None and (turns := _TURNS.search(said.beside)) is not None:
        yield Wish(f"spin {said.things[0]} {_turns(turns)}", _to_the_end(moment), _with_its_place(said), turns[0])
        return
    if rate is None and (often := times or full) is not None:
        how = ("once" if often is full or often[0] in _ONCE else often[0], often[0])
        moment = _to_the_end(moment)
    command = f"spin {said.things[0]} {how[0]}" if how[0] or not said.told else f"let {said.things[0]} spin"
    yield Wish(command, moment, _with_its_place(said), how[1])


def _turns(found: re.Match[str]) -> str:
    """How far something turns, in words that the grammar knows."""
    if found["degrees"] is not None:
        return f"by {found['degrees']} degrees"
    if "quarter" in found["n"] or "half" in found["n"]:
        return "a quarter turn" if "quarter" in found["n"] else "half a turn"
    return f"{NUMBERS.get(found['n'], found['n'])} turns"


def _to_the_end(moment: Moment) -> Moment:
    """A time "in the last two seconds", all of which a turn takes."""
    last = isinstance(moment.start, float) and moment.start < 0 and moment.stop is None
    return replace(moment, stop="end") if last or moment.always else moment


_TRAVELS = re.compile(r"\b(?:travel|roll|walk|driv|slid|march|fall)(?:e?s|e|ing|ling)?\b|\bsetting (?:off|out)\b")


def _reverse(said: Said) -> Iterator[Wish]:
    if not _BACKWARDS.search(said.text) and not _OTHER_WAY.search(said.text):
        return  # "roll up the wall"
    travels = _TRAVELS.search(said.text) is not None
    if not said.told and not travels and _OTHER_WAY.search(said.text) and not _IN_REVERSE.search(said.text):
        yield Wish(f"let {said.things[0]} turn the other way round", said.moment)
    elif not said.told:
        whose = ALL_OF_IT if said.things[0] in (MOVING, "everything") else said.whose
        yield Wish(pace(whose, "reverse"), said.moment, things=1 + len(said.goals))


_AGAIN_FOR = re.compile(r"\b(?:over and over|again and again|all the time|keeps?|repeatedly|loops?|non ?stop)\b")


_ANOTHER_TIME = re.compile(r"\b(?:an?|one|the) (?:second|other|more) time\b|\banother time\b")


def _repeat(said: Said) -> Iterator[Wish]:
    another = _ANOTHER_TIME.search(said.beside)
    times = another or _TIMES.search(said.beside)
    if times is None or another is not None or times[0] in _ONCE:
        holds = "" if times is None else times[0]
        if said.told and not _AGAIN_FOR.search(said.text):
            yield Wish(pace(said.whose, "repeat", times=1), said.moment, holds=holds)
        yield Wish(f"repeat the movement of {said.things[0]}", said.moment, holds=holds)
    else:
        yield Wish(f"let {said.things[0]} move {times[0]}", said.moment, holds=times[0])


_ITS_PLACE = re.compile(
    r"\b(?:its|his|her|their|the same|the old) (?:\w+ )?(?:place|spot|home|shelf|position|start)\b|"
    r"\b(?:home|where (?:it|he|she|they) (?:was|were|came|started|stood|began|set off))\b"
)


def _return(said: Said) -> Iterator[Wish]:
    if _ITS_PLACE.search(said.text):
        yield Wish(pace(said.whose, "return"), said.moment, things=1 + len(said.goals))
    if len(said.goals) == 1 and said.told:
        yield Wish(f"move {said.things[0]} to {said.goals[0]}", said.moment, things=2)
    yield Wish(pace(said.whose, "return"), said.moment)


# -- when and how fast -----------------------------------------------------------------------------------------------

_A_PART = re.compile(
    r"\b(?:clos(?:e|es|ing)|shut(?:s|ting)?|(?<!play )(?<!plays )(?<!playing )(?<!played )back|returns?|again)\b"
)  # of a movement that has two
_SHUTS = re.compile(r"\b(?:clos(?:e|es|ing)|shut(?:s|ting)?|(?:go|going|slides?|sliding|moving|comes?|coming) back)\b")
_A_STRETCH = re.compile(r"\b(?:first|second|last|latter|other|final) (?:half|third|quarter|part|stretch|leg|bit)\b")
_LATER = re.compile(r"\b(?:plus|later|delay|delayed|late|postpone|hold back|waits?|longer|behind)\b")
_EARLIER = re.compile(r"\b(?:minus|earlier|sooner|early|ahead|forward)\b")
_TOO_LATE = re.compile(r"\b(?:too|so) (?:\w+ )?(late|early|soon)\b")
_FACTORS = tuple(
    (re.compile(pattern), factor)
    for pattern, factor in (
        (r"\b(?:one|1) and a half times\b", 1.5),
        (r"\b(?:two|2) and a half times\b", 2.5),
        (r"\bhalf (?:of )?(?:the|its|that) time\b", 2.0),
        (r"\b(?:twice|double) (?:of )?(?:the|its|that) time\b|\btwice as long\b", 0.5),
        (r"\b(?:twice|double[ds]?|two times)\b", 2.0),
        (r"\b(?:three times|triple|thrice)\b", 3.0),
        (r"\bfour times\b", 4.0),
        (r"\b(?:a )?third\b", 0.3333),
        (r"\b(?:a )?quarter\b", 0.25),
        (r"\bhalf\b|\bhalve\b", 0.5),
    )
)
_OFTEN = re.compile(r"\b(?:by (?:a )?factor (?:of )?)?(?P<n>\d+(?:\.\d+)?) ?(?P<unit>x|times|%|percent|fold)(?= |$)")
_TOO_FAST = re.compile(
    r"\b(?:too|so|painfully)(?: \w+)? (?:fast|quick|quickly|hasty|rushed|wild)\b|"
    r"\b(?:less|not so|not as|not that) (?:fast|quick|quickly|hasty|wild|rushed|speedy|speed)\b"
)
_TOO_SLOW = re.compile(
    r"\b(?:too|so|painfully)(?: \w+)? (?:slow|slowly|sluggish|lazy)\b|\b(?:less|not so|not as|not that) slow\b"
)
_SLOWER = re.compile(r"\b(?:slow|slower|slowly|half|calm|calmer|gentle|gentler|lazy|leisurely)\b")
_AS_FAST = re.compile(r" (?:as |its |the |present |current )*(?:fast|quick|rapid|speed|pace|rate)")
_HASTE = re.compile(r"\b(?:faster|quicker|hurry|rush)\b")
_FASTER = re.compile(r"\b(?:fast|faster|quick|quicker|quickly|hurry|speed .*up|rush|snappier|brisk|brisker|zip)\b")


_SAME_SPEED = re.compile(r"\bsame (?:speed|pace|tempo|rate)\b")
_MOVED_ON = re.compile(r"\b(?:shift|delay|postpone|move|later|earlier|sooner)\b")
_BE_AT = re.compile(r"\b(?:be|is|been) (?:\w+ ){0,2}?(?:at|by|in|on|there|home|done|finished|through)\b")
_TAKES = re.compile(
    r"\b(?:takes?|taking|lasts?|needs?|stretch(?:ed)?|spread|drag(?:ged)?|spends?|within|over|to|whole|full|in) "
    rf"(?:just |only |about |a |the )*{DURATION}"
)


def _is_of_a_part(said: Said) -> bool:
    """Whether only one of the movements of something is meant, and it is no door or drawer that tells which."""
    return _A_PART.search(said.text) is not None and not is_opened(said.things[0])


def _begin(said: Said) -> Iterator[Wish]:
    if _is_of_a_part(said):
        return
    moment, sign = said.moment, _sign(said.text)
    by = any(words.startswith("by ") for words in moment.said)
    if by and sign is None and _MOVED_ON.search(said.text):
        return  # "shift it by 1 s" tells not which way
    if sign is not None:
        if by and isinstance(moment.stop, float) and moment.start is None:  # "delay it by one second"
            yield Wish(pace(said.whose, "later", seconds=sign * moment.stop), Moment(), spent=moment.stop)
        for seconds, words in _durations(said.text):
            yield Wish(pace(said.whose, "later", seconds=sign * seconds), Moment(), holds=words)
        if moment.lasting is not None and moment.start is None and moment.stop is None:
            yield Wish(pace(said.whose, "later", seconds=sign * moment.lasting), Moment(), spent=moment.lasting)
    if _A_PART.search(HELD_BACK.sub(" ", said.text)):  # "close it at 2 s" begins no other movement
        if is_opened(said.things[0]) and _SHUTS.search(said.text) and isinstance(moment.start, float):
            yield Wish(f"close {said.things[0]}", moment)
        return
    if moment.lasting is not None and moment.taken and isinstance(moment.start, float) and moment.stop is None:
        yield Wish(pace(said.whose, "begin"), _plainly(said))  # "start it at 2 s and finish in half a second"
    if said.told and moment.lasting is None:
        if moment.stop is not None and moment.start is None and not said.event:  # "it waits until 2 s"
            moment = replace(moment, start=moment.stop, stop=None)
        yield Wish(pace(said.whose, "begin"), moment)


def _sign(text: str) -> float | None:
    """1 if something is to be later, -1 if earlier; None if neither is said, or both."""
    if (late := _TOO_LATE.search(text)) is not None:
        return -1.0 if late[1] == "late" else 1.0
    held = HELD_BACK.search(text) is not None
    later, earlier = held or _LATER.search(text) is not None, _EARLIER.search(text) is not None
    return None if later == earlier else 1.0 if later else -1.0


def _speed(said: Said) -> Iterator[Wish]:
    if _is_of_a_part(said) or _A_STRETCH.search(said.text) or _SAME_SPEED.search(said.text):
        return
    if _RATE.search(said.beside):
        yield from _spin(said)
        return
    plain = _TOO_SLOW.sub("faster", _TOO_FAST.sub("slower", said.beside))
    share = (often := _OFTEN.search(said.beside)) is not None and often["unit"] in ("%", "percent")
    if often is not None and not (share and "slow" in plain):
        factor = float(often["n"]) / 100 if share else float(often["n"])
        if "slow" in plain and factor > 1:
            factor = round(1 / factor, 4)
        if factor > 0 and (factor > 1 or not _HASTE.search(plain)):
            yield Wish(pace(said.whose, "speed", factor=factor), _plainly(said), holds=often[0])
        return
    if any(_durations(said.text)):  # "it is too slow, half a second is enough"
        yield from _duration(said)
        return
    slower, faster = _SLOWER.search(plain) is not None, _FASTER.search(plain) is not None
    for pattern, factor in _FACTORS:
        if (found := pattern.search(said.beside)) is not None:
            if factor < 1 and re.search(rf"\bby {re.escape(found[0])}", said.beside):
                factor = 1 + factor if faster else 1 - factor
            elif factor < 1 and _HASTE.search(plain):
                return  # "faster in the second half"
            elif factor > 1 and "slow" in plain and not _AS_FAST.match(said.beside[found.end() :]):
                factor = 1 / factor  # "three times slower"
            factor = round(factor, 4)
            yield Wish(pace(said.whose, "speed", factor=factor), _plainly(said), holds=found[0])
            return
    if slower != faster:
        yield Wish(pace(said.whose, "speed", factor=0.5 if slower else 2.0), _plainly(said))


def _duration(said: Said) -> Iterator[Wish]:
    moment = said.moment
    if _is_of_a_part(said):
        return
    if (
        isinstance(moment.start, float)
        and moment.stop is None
        and moment.lasting is None
        and _BE_AT.search(said.beside)
    ):
        moment = replace(moment, start=None, stop=moment.start)  # "it has to be at the bed at 2 s"
        said = replace(said, moment=moment)
    done = isinstance(moment.stop, float) and moment.start is None and moment.lasting is None
    if done and _MOVED_ON.search(said.text) is None:
        yield Wish(pace(said.whose, "begin"), _plainly(said), things=1 + len(said.goals))
    if isinstance(moment.stop, float) and isinstance(moment.start, float):
        yield Wish(pace(said.whose, "begin"), _plainly(said), things=1 + len(said.goals))
    if moment.stop is not None or (moment.lasting is not None and not moment.taken):
        return
    if moment.lasting is not None:
        if not any(words.startswith("by ") for words in moment.said):  # that is a time, and no duration
            yield Wish(pace(said.whose, "begin"), replace(_plainly(said), taken=True), 1 + len(said.goals))
    elif moment.start is None and _MOVED_ON.search(said.text) is None:
        told = [
            (seconds, words)
            for seconds, words in _durations(said.text)
            if f"for {words}" not in said.text and not re.search(rf"\bby (?:plus |minus |another )?{words}", said.text)
        ]
        for seconds, words in told if len(told) == 1 or _TAKES.search(said.text) else ():
            yield Wish(pace(said.whose, "begin"), Moment(lasting=seconds, taken=True), 1 + len(said.goals), words)


# -- rests -----------------------------------------------------------------------------------------------------------

_KEPT = re.compile(r"\b(?:stay|remain|keep|leave|not|never)\b")
_RESTS = re.compile(
    r"\b(?:not|never|no) (?:ever )?(?:(?:let|have|want) (?:[a-z]+ ){1,3}?)?"
    r"(?:to )?(?:fall|move|drop|roll|walk|turn|go|budge|spin)|\bstays? (?:put|where)\b|"
    r"\bsits? still\b"
)


_HALFWAY = {"state": "halfway", "part": "from"}
_HALF_DONE = re.compile(r"\b(?:half ?way|half (?:of )?(?:the|its|his|her) (?:way|fall|drop|walk|swing)|midway)\b")


_MIDDLE_OF = re.compile(r"\b(?:in|at|on|over) the (?:very )?(?:middle|centre|center) of \|")


def _in_the_middle(said: Said) -> Command | None:
    """The command to stand still where something is in the middle of a goal; None if that is not said."""
    query = said.thing(said.goals[0]) if len(said.goals) == 1 and _MIDDLE_OF.search(said.beside) else None
    if query is None or said.event:
        return None
    return replace(pace(said.whose, "stop"), during={"state": "closest", "anchors": (query,), "part": "from"})


def _pause(said: Said) -> Iterator[Wish]:
    moment, rest = said.moment, pace(said.whose, "stop")
    if (there := _in_the_middle(said)) is not None and moment.lasting is not None and moment.start is None:
        yield Wish(there, replace(moment, taken=False), things=2)
    half = _HALF_DONE.search(said.beside)
    if half is not None and moment.lasting is not None and moment.start is None and not said.event:
        rest = replace(rest, during=_HALFWAY)
        yield Wish(rest, replace(moment, taken=False), things=1 + len(said.goals), holds=half[0])
        return
    if moment.lasting is not None or moment.stop is not None:
        if moment.start is not None or moment.stop is not None or said.event:
            yield Wish(rest, replace(moment, taken=False, slowly=False), _with_its_place(said))
    elif said.event or moment.start is not None:
        for seconds, words in _durations(said.text):
            yield Wish(rest, replace(moment, lasting=seconds), holds=words)


def _halt(said: Said) -> Iterator[Wish]:
    moment = said.moment
    if (there := _in_the_middle(said)) is not None and not said.told:
        yield Wish(there, Moment(), things=2)
    waits = moment.start is None and moment.stop is not None  # it moves afterwards
    if said.told and moment.lasting is None and (moment.stop in (None, "end") or waits):
        yield Wish(pace(said.whose, "stop"), _plainly(said))
    elif not said.told and (half := _HALF_DONE.search(said.beside)) is not None:
        yield Wish(replace(pace(said.whose, "stop"), during=_HALFWAY), Moment(), holds=half[0])


_KEPT_ONLY = re.compile(r"(?:please |just )*(?:keep|leave|put|have) \|(?: please)?")  # it, and not its motion


def _still(said: Said) -> Iterator[Wish]:
    if not said.told and not _KEPT_ONLY.fullmatch(said.beside):
        yield Wish(pace(said.whose, "stop"), Moment(), things=1 + len(said.goals))


_OPEN = re.compile(r"\b(?:open|out|ajar)\b")


def _stay(said: Said) -> Iterator[Wish]:
    moment = said.moment
    stands = is_opened(said.things[0]) and _OPEN.search(said.text) is not None
    if _RESTS.search(said.text) and not said.event and not stands:
        yield from _still(said)
    elif moment.lasting is None and moment.stop in (None, "end") and moment.start in (None, "end"):
        if moment.start == "end" and not _KEPT.search(said.text):
            return  # "it should be open at the end"
        yield Wish(f"keep {said.things[0]} open", Moment(), spent="end", timeless=True)


def _longer(said: Said) -> Iterator[Wish]:
    if said.moment.lasting is None and said.moment.start is None:
        yield Wish(pace(said.whose, "go_on"), said.moment)


# -- how far ---------------------------------------------------------------------------------------------------------

_DEGREES = re.compile(r"(?:\d+|[a-z]+) (?:degrees?|deg|°)")
_SHARES = tuple(
    (re.compile(pattern), opened, way)
    for pattern, opened, way in (
        (r"\bhalf ?way|\bhalf (?:as|the|that|of|open)|\bhalf\b(?! an? )", "halfway", "half the way"),
        (r"\b(?:a|one) third\b", "a third of the way", "a third of the way"),
        (r"\b(?:a|one) quarter\b", "a quarter of the way", "a quarter of the way"),
    )
)


def _amount(said: Said) -> Iterator[Wish]:
    thing = said.things[0]
    opens = is_opened(thing)
    if (found := _DEGREES.search(said.text)) is not None:
        yield Wish(f"open {thing} by {found[0]}", said.moment, holds=found[0])
    elif (found := _LENGTH.search(said.text)) is not None:
        text = f"open {thing} by {found[0]}" if opens else f"let {thing} only move {found[0]}"
        yield Wish(text, said.moment, holds=found[0])
    for pattern, opened, way in _SHARES:
        if (found := pattern.search(said.beside)) is not None:
            text = f"open {thing} only {opened}" if opens else f"let {thing} go {way}"
            yield Wish(text, said.moment, holds=found[0])


def _opening(said: Said, verb: str) -> Iterator[Wish]:
    if verb == "open" and isinstance(said.moment.start, float) and _TOO_LATE.search(said.idle):
        yield from _begin(said)
        return
    if verb == "close" and (sign := _sign(said.text)) is not None:
        for seconds, words in _durations(said.text):
            yield Wish(pace(said.whose, "later", seconds=sign * seconds), Moment(), holds=words)
    if _TOO_LATE.search(said.text):
        return  # by how much is not told
    if verb == "open" and (_LATER.search(said.text) or _EARLIER.search(said.text)):
        yield from _begin(said)
    elif said.moment.start != "end":
        how_far = _DEGREES.search(said.text) or _LENGTH.search(said.text)
        if how_far is not None and verb == "open":
            yield Wish(f"open {said.things[0]} by {how_far[0]}", said.moment, holds=how_far[0])
        yield Wish(f"{verb} {said.things[0]}", said.moment)


# -- one after the other ---------------------------------------------------------------------------------------------

_ENDS = re.compile(r"\b(?:freez\w+|stop\w*|halt\w*|still|paus\w+|rest\w*|end\w*|finish\w*)\b")
_SPEEDS = re.compile(r"\b(?:slow|quick|fast|rapid)")
_SEVERAL = re.compile(r"^(?:all|both|everything|these|those|the (?:two|three|four))\b|[^s]s$")


def _order(said: Said) -> Iterator[Wish]:
    if said.listed and not said.told:
        yield Wish(in_order(said.listed), Moment(), marked=True)
    colors = [word for word in said.beside.split() if word in hues()]
    if len(said.things) == 1 and len(colors) > 1 and len(set(colors)) == len(colors) and not said.told:
        listed = ", ".join(colors)
        holds = said.beside[said.beside.index(colors[0]) : said.beside.rindex(colors[-1]) + len(colors[-1])]
        yield Wish(f"let {said.things[0]} move in the order {listed}", Moment(), holds=holds)
        return
    if len(said.things) == 1:
        if said.told and said.moment.empty:
            yield Wish(pace(said.whose, "begin"), said.moment)
        for place in ("first", "last") if not said.told else ():
            if re.search(rf"\b{place}\b(?! (?:year|month|week|night|summer|winter|one to)\b)", said.beside):
                yield Wish(f"let {said.things[0]} start {place}", Moment(), holds=place)
    elif len(said.things) == 2:
        one, other = said.things
        between = said.beside.split("|")[1] if "|" in said.beside else ""
        for word, (later, sooner) in {"after": (one, other), "before": (other, one)}.items():
            if word in between.split() and (first := said.thing(sooner)) is not None:
                begun = pace(said.thing(later) or Query(last=True), "begin")
                stopped = {"state": "moving", "of": first, "part": "after"}
                yield Wish(replace(begun, during=stopped), Moment(), things=2, holds=word)


def _the(name: str) -> str:
    """A name with its article."""
    return name if name.split(" ")[0] in ("the", "all", "both", "my", "our", "every") else f"the {name}"


def _together(said: Said) -> Iterator[Wish]:
    if _ENDS.search(said.text) or any(map(_SPEEDS.search, said.moment.said)):
        return  # "freeze everything at 2.5", "the door quickly and the drawer slowly"
    if len(said.things) > 1 or _SEVERAL.search(said.things[0]):
        who = " and ".join(said.things)
        yield Wish(f"let {who} start at the same time", said.moment, things=len(said.things))


_KINDS: dict[str, Callable[[Said], Iterator[Wish]]] = {
    "recolor": _recolor, "hide": _hide, "remove": _remove, "move": _move, "spin": _spin, "begin": _begin,
    "speed": _speed, "duration": _duration, "pause": _pause, "halt": _halt, "still": _still, "reverse": _reverse,
    "stay": _stay, "amount": _amount, "open": partial(_opening, verb="open"), "close": partial(_opening, verb="close"),
    "order": _order, "together": _together, "repeat": _repeat, "return": _return, "longer": _longer,
}  # fmt: skip
