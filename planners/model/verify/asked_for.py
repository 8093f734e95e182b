"""Checks each step of a model's plan against what was said: its target, its kind and its count.

A step is asked for if the instruction names what it changes, or points at it ("it", "everything"), and, in a plan of
several steps, if a word or a value of the step is in the instruction. Of a single step on a named thing no verb is
required: "rug out, please" removes the rug, since nothing else is said of it. Only English is read; for other languages
every step counts as asked for, and `removal_words` still guards removals.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

from ....gaussians.color import EVERYDAY
from ....gaussians.world.finishes import words as finish_words
from ....gaussians.world.words import is_plural
from ....tools.operation import EditOp
from ...grammar.tagging.words import bag
from ...grammar.vocabulary.quantities import NUMBERS
from ...grammar.vocabulary.verbs import VERBS
from ...rooms.label_encoder import words

_WORD = re.compile(r"[^\W\d_]+|\d+(?:[.,]\d+)?|%|°")
_ENGLISH = bag(
    "the a an this that these those my our your to of on in into at by next with and or but please i we you it them is "
    "are can could would should want need like make move put delete remove paint turn add all every under over behind "
    "near"
)
# Words for things of any kind, which need no name.
_GENERAL = bag(
    "other others another rest else everything anything all both each every any thing things stuff object objects "
    "furniture room scene place here some something whatever what where who whose lot decor clutter mess whole entire "
    "machine tool item items anyone"
)
# Beginnings of words that ask for each kind of step.
_KINDS: dict[str, str] = {
    "recolor": "colo colour paint dy tint stain bright dark light pale vivid satur warm cool match hue shade "
    "recolo repaint "
    "dull mut fad varnish coat",
    "move": "mov shift push pull slid plac put set bring brought drag nudg rais lower lift up down left right forward "
    "forwards back backward closer nearer away toward to onto into on under next beside between behind above "
    "corner middle "
    "cent wall hang stand lean sit swap switch exchang trad against apart out off higher inward along over here "
    "there goes "
    "belong at in near by front relocat reposition tidy carry send",
    "rotate": "rotat turn spin spun fac twist flip tilt around round degree quarter half upside pivot swivel angle "
    "clockwise anticlockwise counterclockwise toward point look orient invert",
    "scale": "siz scal big small larg tall short wid narrow deep thick thin high low half halv twice doubl tripl "
    "shrink "
    "shrunk grow grew enlarg percent % times giant tiny huge mini reduc increas stretch expand length long quarter "
    "third "
    "metre meter cm inch feet foot",
    "duplicate": "cop dup clon another more twin second extra again repeat replic x2 double two three four five "
    "six mult",
    "insert": "add put insert plac need want set get give bring new another more with miss includ introduc plant "
    "have has "
    "should would could like fit furnish hang stand install some a an",
    "replace": "replac swap switch exchang substitut trad chang turn instead rather into upgrad convert for become",
    "exchange": "swap switch exchang trad plac interchang chang where",
    "opacity": "hid hidden transparen opac see through fad ghost invisib vanish disappear visib translucen clear",
    "isolate": "only just keep isolat nothing except but alone leav solo everything rest single",
    "arrange": "arrang line row align circle around spread space tidy order group even grid stack neat between "
    "evenly each",
}
# What says that a thing is unwanted, without a verb of removal.
_UNWANTED = re.compile(
    r"\b(?:out|off|away|no|not|never|nothing|none|without|enough|bye|goodbye|farewell|begone|hate|hates|ugly|hideous|eyesore|"
    r"useless|pointless|tired|sick|fed up|history|had it|past it|unneeded|redundant|surplus|scram|adios|rid|"
    r"clutter|gone|"
    r"unnecessary|n't|outta|sell|skip|tip|dump)\b|n't\b"
)
_REMOVALS = ("DELETE", "CLEAR", "HIDE", "ISOLATE", "TAKE", "DROP", "REPLACE", "SWAP", "CROP", "FADE")
_NEUTRAL = ("WANT", "SELECT", "SAME", "KEEP", "MAKE", "ADD", "GIVE", "PUT")


def is_english(text: str) -> bool:
    """Whether an instruction seems to be English: one of its words is among the commonest."""
    said = {w.lower() for w in _WORD.findall(text)}
    return bool(said & _ENGLISH) and text.isascii()


def unwanted(text: str) -> bool:
    """Whether an instruction says without a verb that something is to go, and has no verb that asks for another "
    "thing."""
    said = text.lower().replace("’", "'")
    return bool(_UNWANTED.search(said)) and not any(v in said.split() for v in _other_verbs())


@cache
def _other_verbs() -> frozenset[str]:
    """The verbs of one word that ask for something else than a removal."""
    kinds = (*_REMOVALS, *_NEUTRAL)
    return frozenset(phrase for phrase, (kind, _) in VERBS.items() if " " not in phrase and kind not in kinds)


def speaks_of_any(text: str | None) -> bool:
    """Whether an instruction speaks of things without naming them ("everything", "the rest")."""
    return bool(text) and not _GENERAL.isdisjoint(w.lower() for w in _WORD.findall(text or ""))


def clears(text: str) -> bool:
    """Whether an instruction asks to clear a thing, which means what stands on it."""
    return re.search(r"\b(?:clear|empty|tidy|strip|declutter|clean)", text.lower()) is not None


def names_target(op: EditOp, text: str, previous: str | None) -> bool:
    """Whether the noun of a step's target is in the instruction, or in the one before."""
    query = op.query()
    if query is None or query.last:
        return True
    heard = _stems(f"{text} {previous or ''}")
    return bool(set(words(query.text)[-1:]) & heard)


def unasked_kinds(ops: Sequence[EditOp], text: str, previous: str | None) -> Iterator[EditOp]:
    """The steps of a plan of several for which the instruction has neither a word nor a value."""
    if len(ops) < 2:
        return
    heard = [w.lower() for w in _WORD.findall(f"{text} {previous or ''}")]
    for op in ops:
        starts = _starts().get(op.op)
        if starts is None or _has_value(op, set(heard) | _stems(" ".join(heard))):
            continue
        if not any(w.startswith(s) if len(s) > 2 else w == s for s in starts.split() for w in heard):
            yield op


def _has_value(op: EditOp, heard: set[str]) -> bool:
    """Whether a value of a step is in the instruction: its colour, its new thing, its number."""
    given: list[Any] = [
        getattr(op, name, None) for name in ("color", "asset", "direction", "degrees", "factor", "count")
    ]
    for value in given:
        if isinstance(value, str) and _stems(value) & heard:
            return True
        if isinstance(value, int | float) and f"{value:g}" in heard:
            return True
    return op.op == "recolor" and bool(heard & _color_words())


@cache
def _starts() -> dict[str, str]:
    """`_KINDS` with the names of materials."""
    materials = " ".join(sorted({word for name in finish_words() for word in name.split() if len(word) > 2}))
    return _KINDS | {
        "restyle": f"mater textur pattern made out look finish surface clad panel cover upholst {materials}"
    }


@cache
def _color_words() -> frozenset[str]:
    from ....gaussians.color import names

    return frozenset(w for name in (*names(), *EVERYDAY) for w in name.split()) | {"grey", "gray"}


_SEVERAL = frozenset(
    (*(n for n in NUMBERS if n != "one"), "some", "few", "couple", "pair", "several", "each", "every", "both", "all")
) | {"more", "twice", "times"}


def too_many(ops: Sequence[EditOp], text: str, previous: str | None) -> Iterator[EditOp]:
    """The steps that add several things although the instruction speaks of one."""
    heard = [w.lower() for w in _WORD.findall(f"{text} {previous or ''}")]
    counted = any(w[0].isdigit() or w in _SEVERAL or (len(w) > 3 and is_plural(w)) for w in heard)
    for op in ops:
        if op.op in ("insert", "duplicate") and (getattr(op, "count", 1) or 1) > 1 and not counted:
            yield op


def _stems(text: str) -> set[str]:
    return {s for w in _WORD.findall(text.lower()) for s in (w, *words(w))}
