"""Commands about motion in any order of their words: "a spin for the vase", "less speed on the fan, please".

The words are divided into one thing, a verb, what stands beside a verb (`manner`), and words that say nothing by
themselves. Every word belongs to one of them. This is the last resort, behind clauses.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from ..tagging.words import bag
from . import manner as manners
from .clauses import ALL_OF_IT, Clause, owner
from .manner import MOTION, Manner, Thing
from .moments import DURATION, Moment
from .verbs import Verb, verbs_at

_EMPTY = bag(
    "a an the to of for with on please i we you it want wants need needs would like wish prefer should must shall can "
    "could may might will has have had is are be being get gets there let lets make makes give gives put do does "
    "take takes "
    "set just so then that there this its now also and , my our us me see some bit"
)
_LIGHT = bag("a an the some one its")  # before a verb that is used as a noun
_NOT = bag("not never no without")
_TELLING = bag("more further even again already straight directly away from any")  # idle elsewhere, not here
_ENDING = bag("to of for with on at by into as in and ,")  # which do not end a command
_NOUNS = {  # nouns that are no verbs, by the verb that they stand for
    "break": "stop", "halt": "stop", "standstill": "stop", "stillness": "stop", "rest": "stop", "wait": "stop",
    "rotation": "spin", "rotations": "spin", "whirl": "spin", "pirouette": "spin", "delay": "delay", "deceleration":
    "slower", "acceleration": "faster", "reversal": "reverse", "opening": "open", "closing": "close", "start": "start",
}  # fmt: skip
_LASTS = re.compile(rf"{DURATION}")
_MOST_WORDS = 16
_MOST_WAYS = 24
_NOTHING = Manner()


@dataclass(frozen=True)
class _Found:
    """What was found so far: a thing with its words, a verb, what is beside it, whether it is negated, and
    whether the verb is used as a noun or stands before the thing."""

    whose: tuple[Query, str] | None = None
    np: str = ""
    verb: Verb | None = None
    manner: Manner = _NOTHING
    negated: bool = False
    noun: bool = False
    led: bool = False


def readings(said: str, thing: Thing) -> Iterator[tuple[Clause, Manner]]:
    """Each way of dividing words, as a clause that tells what something is to do, and what is beside its verb."""
    words = said.split()
    if not 1 < len(words) <= _MOST_WORDS or words[-1] in _ENDING or "instead" in words:
        return
    count = 0
    for found in _divided(words, 0, _Found(), thing):
        if found.whose is None or (found.verb is None and found.manner == _NOTHING):
            continue
        target, aspect = found.whose
        tail = ("there",) if found.verb is None else ()
        form = found.verb
        if form is not None and form.form != "plain" and not found.noun:
            form = replace(form, form="ing" if form.form == "ing" else "s")
        ordered = found.led and not found.noun
        clause = Clause(target, aspect, form, tail, found.np, ordered, negated=found.negated, aux=("should",))
        yield clause, found.manner
        count += 1
        if count >= _MOST_WAYS:
            return


def _divided(words: Sequence[str], at: int, so_far: _Found, thing: Thing) -> Iterator[_Found]:
    if at == len(words):
        yield so_far
        return
    if so_far.whose is None:
        for end in range(min(len(words), at + 7), at, -1):
            np = " ".join(words[at:end])
            whose = owner(np, thing)
            if whose is not None and (whose[0] == ALL_OF_IT or not whose[0].last):
                yield from _divided(words, end, replace(so_far, whose=whose, np=np), thing)
    elif words[at] in ("it", "him", "her", "itself", "them", "they", "he", "she"):
        yield from _divided(words, at + 1, so_far, thing)
    if so_far.verb is None:
        for verb in _verbs(words, at):
            noun = at > 0 and words[at - 1] in _LIGHT
            yield from _divided(
                words, at + verb.taken, replace(so_far, verb=verb, noun=noun, led=so_far.whose is None), thing
            )
    rest = " ".join(words[at:])
    for fields, left in manners.starts(rest, thing):
        clash = any(getattr(so_far.manner, k) not in (None, "", False) and getattr(so_far.manner, k) != v
                    for k, v in fields.items() if k not in ("compare", "degree", "by"))  # fmt: skip
        if not clash and (fields or words[at] not in _TELLING):
            after = len(words) - len(left.split())
            yield from _divided(words, after, replace(so_far, manner=replace(so_far.manner, **fields)), thing)
    if words[at] in _NOT and not so_far.negated:
        yield from _divided(words, at + 1, replace(so_far, negated=True), thing)
    into = words[at] in ("in", "into", "during") and so_far.whose is None
    if into and any(
        (w := owner(" ".join(words[at + 1 : e]), thing)) and w[1] == "event" for e in range(at + 2, at + 7)
    ):
        yield from _divided(words, at + 1, so_far, thing)  # "a break in the robot 's walk"
    holds = words[at] == "for" and _LASTS.match(" ".join(words[at + 1 :]))  # that long, and not that it takes so long
    led = so_far.verb is not None and not so_far.noun and words[at - 1] == so_far.verb.said
    particle = words[at] == "on" and led  # "turn on" is no turning
    if words[at] in _EMPTY and not holds and not particle:
        yield from _divided(words, at + 1, so_far, thing)


def _verbs(words: Sequence[str], at: int) -> Iterator[Verb]:
    yield from verbs_at(words, at)
    if words[at] in _NOUNS and at > 0:
        yield Verb(_NOUNS[words[at]], "plain", 1, words[at])


def with_time(clause: Clause, manner: Manner, moment: Moment) -> Iterator[tuple[Clause, Manner, Moment]]:
    """The parts of a command; seconds beside the verb are how long it lasts, if nothing else says so."""
    yield clause, manner, moment
    if manner.lasting is not None and moment.lasting is None and moment.stop is None:
        taken = clause.sense in MOTION or manner.doing in MOTION or clause.aspect == "event"
        rest = replace(manner, lasting=None)
        yield clause, rest, replace(moment, lasting=manner.lasting, taken=taken, said=(*moment.said, "for"))
