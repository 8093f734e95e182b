"""What an instruction says stays as it is: "half as fast, still starting at 1 s", "... and the other two fall as now".

The words are cut out, the rest is read as any instruction, and what they say is held against what was read: where it is
so anyway nothing changes, where the plan can be made so it is, and what contradicts itself is refused.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import nullcontext, suppress
from dataclasses import dataclass

from ....gaussians import late_re as re
from ....tools.when import When
from ...plan import Movement
from ..parsing import Refusal
from ..tagging.words import bag
from ..vocabulary.nouns import is_known
from ..vocabulary.quantities import NUMBERS
from .command import Fields
from .ending import MovementOf, between
from .marked.kinds import marked
from .wording import in_words

TAG = "keep"  # the mark of words that say that something stays as it is
_LEAST = 2  # words beside them that can ask for anything
_NEAR = 0.05  # seconds by which times of a plan may differ from those that are to stay
_SAME = re.compile(  # words by which something stays as it is
    r"\b(?:same|still|un(?:changed|touched|altered|affected|modified)|identical|constant|otherwise|alone|present|"
    r"usual|(?:is|was|stays) (?:ok|okay|good|right)|"
    r"normal|hitherto|(?:is|are|was|were|be) fine|no change|nothing (?:else|about)|as (?:is|now|it|they|he|she|"
    r"before|"
    r"specified|planned|ever|in the|at present|usual|today|fast|long|quick|slow)|like (?:now|before|it|they|always)|"
    r"always|(?:it|they|he|she) always|final|"
    r"when (?:it|they|he|she) \w+|no (?:later|earlier|sooner) than|"
    r"(?:it|they|he|she) (?:does|do|has|have) now|(?:keep|stay|remain|retain|leav)\w*|"
    r"kept|left|without \w+ing|"
    r"not (?:(?:to|being|is|are|be) )*(?:chang|alter|touch|affect|mov|modif|retim|delay)\w*)\b"
)
_A_COMMAND = re.compile(  # "keep the sofa and remove everything else", "leave the hole open"
    r"\b(?:holes?|fill\w*|infill|rest)\b|\b(?:but|yet) (?:\w+ )?(?:twice|double|half|faster|slower|later|earlier)\b|"
    r"^(?:(?:and|but|just|only) )*(?:keep|leave|hold) (?:the|a|my|our|that|this) "
    r"(?!.*\b(?:as|same|still|unchanged|untouched|alone|otherwise|identical|like|usual|now)\b)"
)
_SUBJECTS = {  # what stays, and the words for it
    "start": r"(?:step|head|mov|push)\w* off|start\w*|begin\w*|onset|setting off|"
    r"sets? off|depart\w*|embark\w*|leav(?:es|ing)|"
    r"kick\w*|set(?:ting)? out|"
    r"letting go|take ?off|(?:tips?|takes?|goes|go|heads?) off|comes? out|falls?|drops?|opens?|timings?|times|"
    r"schedule|moment|cue|entrance|slots?",
    "stop": r"reach\w*|"
    r"ends?|until|till|out ?point|ending|stops?|stopping|finish\w*|switch(?:es)? off|cut(?:s|ting)? out|"
    r"arriv\w*|"
    r"(?<!set )(?<!sets )(?<!tips )(?<!takes )(?<!goes )(?<!kicks )(?<!setting )"
    r"(?<!stepping )(?<!heading )(?<!moving )off|done|"
    r"timings?|times|schedule|slots?",
    "speed": r"speeds?|pace|rate|tempo|velocity|rpm|fast|quick|slow|takes?|taking|duration|long|length|last|lasting|"
    r"cycle time|turns? a second",
}
_SAID = {name: re.compile(rf"\b(?:{words})\b") for name, words in _SUBJECTS.items()}
_AS_EVER = re.compile(  # "then back on duty till 4 like always"
    r"\b(?:stop\w*|end\w*|finish\w*|until|till|off)\b.*\d.*\b(?:like|as) "
    r"(?:always|ever|now|before|usual|it (?:does|did))\b|"
    r"\b(?:stop\w*|end\w*|finish\w*|off)\b.*\bwhen (?:it|he|she) (?:always |usually )?"
    r"(?:stop|end|finish|did|does|used)\w*|"
    r"\bno (?:later|earlier|sooner) than (?:now|before|at present|(?:it|he|she) (?:does|did))\b"
)
_IS_FINE = re.compile(
    r"^(?:the |its )?(?:stop|stopping|end|ending|start|beginning)(?: time)? (?:is|was|stays) "
    r"(?:ok|okay|fine|good|right)$"
)
_ARRIVES = re.compile(r"\b(?:reach\w*|arriv\w*|there|appointment|home|until|till|stops?|ends?|finish\w*|off|over)\b")
_OTHERWISE = re.compile(r"\b(?:not|no|instead|than|never|without|rather|too)\b")
_STILL = re.compile(  # "..., but it should still stop at four seconds", "? It should still be off at 4 s"
    r" (?:[,.?;!] )?(?:and |but )*(?:(?:it|he|she|they) )?(?:(?:should|must|has to|is to|needs to|to) )*"
    r"still (?:has to )?"
    r"(?:to )?(?:be (?:off|over|done|there)|(?:stop|start|begin|end|finish|kick|set|leav|arriv|cut|switch|tak)[a-z]*)"
    r"\b[^.;]*\.?$"
)
_AS_TOLD = 0.3  # seconds by which what is said to stay may differ from how it is now
_NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?=$| (?!x\b|times|rpm|turns?|rounds?|rev|cm|m\b|deg|%))")
_ITS_OWN = ("start", "stop")
_OTHERS = re.compile(r"\b(?:others?|rest)\b")
_TO_A_PLACE = re.compile(r"\b(?:reach\w*|to|at|by|into|onto|against) (?:the|its|his|her|my) [a-z]+\b")
_NO_OTHERS = bag("can start beginning fall drop stop end speed turn time second roll walk swing opening motion")


@dataclass(frozen=True)
class Kept:
    """What stays as it is of the movement that an instruction is about.

    Attributes:
        facts: "start", "stop", "speed".
        start, stop: seconds that are said with it.
        said: the words.
        supposed: whether only the seconds tell that: they are those of how it is now.
    """

    facts: frozenset[str]
    start: float | None = None
    stop: float | None = None
    said: str = ""
    supposed: bool = False


def without_kept(cleaned: str) -> tuple[str, tuple[Kept, ...]]:
    """An instruction without the words that say that something stays as it is, and what they say.

    >>> without_kept("make the door open half as fast , still starting at 1 s")[0]
    'make the door open half as fast'
    """
    words = in_words(cleaned).split(" ")
    marks = ((tag, a, b, " ".join(words[a:b]).strip(" ,.;:")) for tag, a, b in marked(words))
    tagged = [own for own in marks if own[0] in (TAG, "not") or (own[0] == "off" and _IS_FINE.match(own[3]))]
    if _SAME.search(" ".join(words)) is None:
        return cleaned, tuple(_supposed(said for _, _, _, said in tagged))
    told = ((a, b, said) for tag, a, b, said in tagged if tag != "not" or _AS_EVER.search(said))
    spans = [(a, b) for a, b, said in told if _SAME.search(said) and not _A_COMMAND.search(said)]
    if not spans and (found := _STILL.search(said := " ".join(words))) is not None:
        spans = [(said[: found.start()].count(" ") + 1, len(words))]
    cut = {at for a, b in spans for at in range(a, b)}
    rest = " ".join(word for at, word in enumerate(words) if at not in cut).strip(" ,;:")
    supposed = tuple(_supposed(said for _, a, b, said in tagged if (a, b) not in spans))
    if not spans or len(re.findall(r"[a-z]+", rest)) < _LEAST:
        return cleaned, supposed
    kept = (kept_by(" ".join(words[a:b]).strip(" ,.;:")) for a, b in spans)
    return rest, (*(own if own.facts else next(_supposed((own.said,)), own) for own in kept), *supposed)


def _supposed(said: Iterable[str]) -> Iterator[Kept]:
    """What words that only may tell it say of an end that stays: "and afterwards it goes on until four"."""
    for words in said:
        numbers = [float(NUMBERS.get(word, word)) for word in words.split() if _A_NUMBER.fullmatch(word)]
        if len(numbers) == 1 and _ARRIVES.search(words) and not _OTHERWISE.search(words):
            yield Kept(frozenset({"stop"}), stop=numbers[0], said=words, supposed=True)


_A_NUMBER = re.compile(rf"\d+(?:\.\d+)?|{'|'.join(word for word in NUMBERS if word not in ('a', 'an', 'one', 'half'))}")


def kept_by(said: str) -> Kept:
    """What words say that stays. Of what other things do nothing is told: no operation changes that."""
    others = _TO_A_PLACE.sub(" ", said).split()
    if _OTHERS.search(said) or any(is_known(word) and word not in _NO_OTHERS for word in others):
        return Kept(frozenset(), said=said)
    facts = frozenset(name for name, words in _SAID.items() if words.search(said))
    numbers = [float(found) for found in _NUMBER.findall(said)]
    if len(numbers) == len(_ITS_OWN) and "speed" not in facts:
        return Kept(facts | set(_ITS_OWN), numbers[0], numbers[1], said)
    own = [name for name in _ITS_OWN if name in facts]
    value = {own[0]: numbers[0]} if len(own) == len(numbers) == 1 and "speed" not in facts else {}
    return Kept(facts, value.get("start"), value.get("stop"), said)


def held(ops: Sequence[Fields], kept: Sequence[Kept], movement: MovementOf) -> tuple[Fields, ...]:
    """Operations with which everything stays that is to stay.

    Args:
        movement: how things move in the scene before.

    Raises:
        Refusal: they change just what is to stay.
    """
    for own in kept:
        with suppress(Refusal) if own.supposed else nullcontext():
            ops = tuple(made for op in ops for made in _held(op, own, movement))
    return tuple(ops)


def _held(op: Fields, kept: Kept, movement: MovementOf) -> tuple[Fields, ...]:
    change = op.get("change") if op["op"] == "pace" else None
    if change is None or not kept.facts:
        return (op,)
    moves = movement(op["target"])
    if kept.supposed and (moves is None or kept.stop is None or abs(kept.stop - moves.stop) > _AS_TOLD):
        return (op,)
    start = kept.start if kept.start is not None or moves is None else moves.start
    stop = kept.stop if kept.stop is not None or moves is None else moves.stop
    made: Fields | None = op
    if change == "speed":
        made = _faster(op, kept, moves, stop)
    elif change in ("begin", "later"):
        made = _begun(op, kept, start, stop)
        if made is not None and moves is not None and moves.turns and made is not op and _begins_only(op):
            return op, _stopped(op, moves.stop)  # as fast as now
    elif change == "stop" and "stop" in kept.facts:
        if not _ends(op):
            made = None  # it stops early
        elif moves is not None and moves.turns and stop is not None:  # it runs no longer for its rest
            return op, _stopped(op, stop)
    if made is None:
        reason = "it asks to change what it says is to stay as it is; leave one of the two out"
        raise Refusal(reason, kept.said, verdict="impossible")
    return (made,)


def _begins_only(op: Fields) -> bool:
    """Whether a movement only gets another beginning, and no other duration."""
    when = op.get("when") or When()
    return when.lasting is None and when.stop is None


def _stopped(op: Fields, stop: float) -> Fields:
    """What lets the target of an operation rest from then on."""
    return {"op": "pace", "target": op["target"], "change": "stop", "when": When(start=round(stop, 4))}


def _faster(op: Fields, kept: Kept, moves: Movement | None, stop: float | None) -> Fields | None:
    """Another speed, with the end that is to stay; None if the speed is to stay, or a beginning that is another one."""
    if "speed" in kept.facts:
        return None
    if moves is not None and kept.start is not None and abs(kept.start - moves.start) > _AS_TOLD:
        return None  # "it still departs at 1.7 s", and departs at 0.5 s now
    if kept.facts >= set(_ITS_OWN):
        return op if moves is not None and moves.turns else None
    if "stop" not in kept.facts or moves is None or moves.turns or stop is None:
        return op
    if op.get("when") is not None:
        return None
    lasting = (moves.stop - moves.start) / op["factor"]
    return between(op, round(stop - lasting, 4), stop) if stop > lasting else None


def _begun(op: Fields, kept: Kept, start: float | None, stop: float | None) -> Fields | None:
    """Another beginning or duration, with what is to stay; None if that is what is asked to change."""
    when = op.get("when") or When()
    if when.during is not None or when.until is not None:
        return op
    begins = when.start if isinstance(when.start, float | int) else None
    if op["change"] == "later":
        if "start" in kept.facts:
            return None
        if "stop" not in kept.facts or start is None or stop is None:
            return op
        begins = round(start + op["seconds"], 4)
        return between(op, begins, stop) if 0 <= begins < stop and "speed" not in kept.facts else None
    if "speed" in kept.facts and (when.lasting is not None or when.stop is not None):
        return None
    if "start" in kept.facts and begins is None and kept.start is not None:
        return {**op, "when": when.model_copy(update={"start": kept.start})}
    if "start" in kept.facts and begins is not None and start is not None and abs(begins - start) > _NEAR:
        return None
    if "stop" not in kept.facts or stop is None or when.stop is not None:
        return op
    if when.lasting is None:
        return between(op, begins, stop) if begins is not None and begins < stop else None
    if "start" in kept.facts or begins is not None or stop < when.lasting:
        return None
    return between(op, round(stop - when.lasting, 4), stop)


def _ends(op: Fields) -> bool:
    """Whether a rest has an end."""
    when = op.get("when")
    return when is not None and (when.stop is not None or when.lasting is not None or when.until is not None)
