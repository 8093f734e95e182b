"""Restates a thing and the state that it is to have as commands: "the sofa" and "in blue" as "make the sofa blue"."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .....gaussians import late_re as re
from ...tagging.lookahead import Lookahead, color_at
from ...tagging.words import bag
from ...vocabulary import quantities
from ..chunks import is_thing
from ..speech.participles import at, participles

_STATE_WORDS = bag(
    "to in on onto into under next near against beside behind between above below at by over inside "
    "facing turned gone out away off a an as half twice slightly further closer nearer right left up down "
    "back forward darker lighter be were was is should was on-the standing sitting hanging a-bit more "
    "less in-front"
)


# What a thing may be made to do: "have the chair face the fridge".
_DOING = bag(
    "face stand sit lean lie hang look point vanish disappear go swap match turn rotate move shrink grow rest spin "
    "tilt "
    "slide shift come"
)


def begins_state(rest: Sequence[str], i: int) -> bool:
    """Whether a state may begin at `i`."""
    word = rest[i]
    state = word in _STATE_WORDS or word.endswith("er") or word[0].isdigit() or color_at(rest, i) is not None
    state = state or (i > 1 and word in _DOING)
    return state or at(participles(), rest, i) is not None


def may_end(word: str) -> bool:
    return word not in ("the", "a", "an", "of", "in", "on", "to", "and", "that", "which", "is", ",", "with", "all")


_MOVES = re.compile(
    r"^(?:(?:be|get|come|go|move|moved|moving) )?(?P<way>(?:(?:about |around |roughly )?(?:a |an |\d|half|two|"
    r"three|four|"
    r"five|six|ten|twenty|thirty|forty|fifty).*? )?"
    r"(?:(?:a bit|a little|slightly|much|a touch|a tad|a lot|some) )?(?:further |farther |more )?(?:to the |to my |"
    r"over |"
    r"towards? |closer|nearer|further|farther|left|right|back|forward|up|down|away).*)$"
)
_TO_FACE = re.compile(
    r"^(?:(?:to )?(?:be |get )?(?:turned (?:round |around )?)?(?:so (?:that )?(?:it|they) )?)?(?:to )?"
    r"(?:face|faces|facing|look at|looking at|point at|pointing at|look towards?|point towards?|pointing towards?|"
    r"looking towards?) "
    r"(?P<goal>\S.*)$"
)
_TALLER = re.compile(
    r"^(?:be |hang |sit |stand |go |come )*(?P<far>(?:about |around )?(?:a|an|half|\d|\w+ty|ten|five|two|three|"
    r"four|six|one)"
    r".*) (?P<way>higher|lower|higher up|lower down)$"
)


_LEFT = bag("kept stored left located placed positioned parked housed tucked stowed situated standing sitting put hung")


def _in_degrees(said: str) -> str:
    """A turn with its unit: "90 clockwise"."""
    return re.sub(r"^(?:by )?(\d+) (?=(?:anti|counter)? ?clockwise)", r"\1 degrees ", said)


# Words before a state that add nothing to it, and the verbs that "to" may stand before.
_EMPTY = bag("to be also just now all both really being been were was is are get gets should then")
_BECOMING = bag(
    "be go face stand move turn come become look get sit hang have disappear vanish leave shrink grow lie match swap"
)


def states(thing: str, state: Sequence[str]) -> Iterator[str]:
    """Commands that give a thing a state: "moved to the left", "in blue", "on the shelf", "half the size"."""
    words = list(state)
    thing = re.sub(
        r"^(?:any|anything)(?= \S)", lambda m: "every" if m.group() == "any" else "everything", bare_thing(thing)
    )
    if not is_thing(tuple(thing.split())):
        return
    while len(words) > 1 and words[0] in _EMPTY:
        if words[0] == "to" and words[1] not in _BECOMING:
            break
        words = words[1:]
    said = " ".join(words)
    if said in ("empty", "clear", "bare", "cleared", "emptied"):
        yield f"delete everything on {thing}"
        return
    from .wish_patterns import GONE

    if re.match(rf"^(?:{GONE}|go|go away|disappear|vanish|leave)$", said):
        yield f"delete {bare_thing(thing)}"
        return
    if words[0] in _LEFT and Lookahead(words).preposition_at(1):
        yield f"put {thing} {' '.join(words[1:])}"
    if (form := at(participles(), words, 0)) is not None:
        yield command(form[0], thing, words[form[1] :])
        if words[0] in ("taken", "made", "turned", "brought") and len(words) > 1:
            yield f"make {thing} {' '.join(words[1:])}"
    amount = quantities.read(words)
    if (
        said.startswith("at ")
        and (share := quantities.read(words[1:])) is not None
        and share.kind in ("FRACTION", "PERCENT")
    ):
        yield f"scale {thing} to {' '.join(words[1 : 1 + share.taken])}"
    if (
        "clockwise" in said
        or (amount is not None and amount.kind == "ANGLE")
        or re.search(r"\b(?:degrees?|deg|°)(?: |$)", said)
    ):
        yield f"rotate {thing} {_in_degrees(said)}"
    if facing := _TO_FACE.match(said):
        yield f"turn {thing} to face {facing.group('goal')}"
    if taller := _TALLER.match(said):
        yield f"{'raise' if taller.group('way').startswith('higher') else 'lower'} {thing} {taller.group('far')}"
    if words[0] in ("to", "into") and color_at(words, 1) is not None:
        yield f"make {thing} {' '.join(words[1:])}"
    if words[0] == "double":
        yield f"make {thing} twice {' '.join(words[1:])}"
    if words[0] == "in" and color_at(words, 1 + (words[1:2] in (["a"], ["an"]))) is not None:
        yield f"make {thing} {' '.join(words[1:])}"
    if words[0] == "match" and len(words) > 1:
        yield f"paint {thing} the same colour as {' '.join(words[1:])}"
    if words[0] in ("become", "turn", "look", "go", "come", "stay", "painted") and len(words) > 1:
        yield f"make {thing} {' '.join(words[1:])}"
    if words[0] in (
        "move",
        "turn",
        "rotate",
        "spin",
        "shrink",
        "grow",
        "swap",
        "trade",
        "exchange",
        "switch",
        "slide",
        "shift",
        "tilt",
        "flip",
        "match",
    ):
        yield f"{words[0]} {thing} {' '.join(words[1:])}"
    if words[0] in (
        "go",
        "lean",
        "leaning",
        "stand",
        "sit",
        "hang",
        "lie",
        "live",
        "come",
        "standing",
        "sitting",
        "hanging",
        "rest",
        "belong",
    ):
        yield f"put {thing} {' '.join(words[1:])}"
        yield f"move {thing} {' '.join(words[1:])}"
    if words[0] == "have" and (
        holding := re.match(
            r"^have (?P<new>.+?) (?P<where>on|in|next to|beside|under|above|behind|by) (?:it|them|top)$", said
        )
    ):
        yield f"add {holding.group('new')} {holding.group('where')} {thing}"
    yield f"make {thing} {said}"
    if _MOVES.match(said):
        yield f"move {thing} {said}"
    yield f"put {thing} {said}"
    yield f"move {thing} {said}"


def command(command: Sequence[str], thing: str, rest: Sequence[str]) -> str:
    return " ".join([*command, bare_thing(thing), *rest])


_HERE = re.compile(
    r"(?: (?:in here|in there|over there|over here|there|here|in this room|in the room|in this place))+$"
)


def bare_thing(thing: str) -> str:
    """A thing without the words that only stress it: "the whole rug thing there" stays, "that old rug of yours" too."""
    return _HERE.sub("", thing)


def is_plain(thing: str) -> bool:
    """Whether words may be the whole of a thing that is unwanted: no state is wished for it."""
    if re.search(r"\b(?:too|also|as well|either) \S| , (?:and )?(?:it|them|get|put|make)\b", thing):
        return False
    return not re.search(r"\b(?:to be|to go|to have|to look)\b", thing) and is_thing(tuple(bare_thing(thing).split()))
