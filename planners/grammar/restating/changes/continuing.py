"""Restates what continues the command before: "a bit more", "another 10 cm", "and the blue one purple", "try navy".

What is said of the change before ("too far", "wrong way") is left out; an amount without a way goes the way of before.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .....gaussians import late_re as re
from ...tagging.lookahead import Lookahead, color_at, is_hue
from ...vocabulary import quantities
from ..chunks import is_thing
from ..order.elision import JOINTS
from ..wishes.judgements import is_judged

_DO_TOO = re.compile(r"^(?:and |now |then |also )*(?:do|same for|ditto(?: for)?|likewise|so does|so should|so for) "
                     r"(?P<thing>\S.*?)"
                     r"(?: (?:too|as well|also|next|now|the same))*$")  # fmt: skip
_MORE = re.compile(r"^(?:and |now |just |no |then |but )*(?P<degree>(?:even |bit |tad |touch |a little |a bit |a "
                   r"tad |slightly |"
                   r"much |a lot |a touch |"
                   r"a little bit |some |quite a bit )*)(?:more|further|farther|again|once more|one more time)"
                   r"(?: please| still| again| of the same| in (?:that|the same) direction| (?:that|the same) "
                   r"way)*$")  # fmt: skip


_TOO = re.compile(r"^(?:and |then |oh |also )*(?:the )?(?P<thing>\S.*?) (?:too|as well|also|likewise)$")
_NICER = re.compile(r"^(?:in )?(?P<hue>\S.*?) (?:would|might|could) (?:be|look|suit|work|go|fit|feel)(?: it| "
                    r"them)? (?:much |far |way |a lot |so "
                    r"much )?(?:better|nicer|best|good|nice|great|well|lovely|perfect|prettier)(?: there| on "
                    r"it)?$")  # fmt: skip


def following(said: Sequence[str]) -> Iterator[str]:
    """Readings as the continuation of the command before: "a bit more", "do the wardrobe as well", "on the rug"."""
    text = " ".join(said)
    if found := _DO_TOO.match(text):
        yield f"do the same to {found.group('thing')}"
    if (found := _TOO.match(text)) and is_thing(tuple(found.group("thing").split())):
        yield f"do the same to {found.group('thing')}"
    if found := _MORE.match(text):
        degree = found.group("degree").strip().removesuffix("even").strip()
        degree = f"a {degree}" if degree in ("bit", "tad", "touch") else degree
        yield f"{degree} more".strip()
    if found := _NICER.match(text):
        yield f"make it {found.group('hue')}"
    if Lookahead(said).preposition_at(0):
        yield f"put it {text}"


_AGAIN = re.compile(
    r"^(?:and |now |then |just |, )*(?:the )?(?:same again|again|once more|one more time|once again|keep going|go "
    r"on|carry on|"
    r"continue|repeat(?: that| it)?|do (?:it|that|the same) (?:again|once more)|another (?:go|one like that)|more "
    r"of the same|"
    r"same thing again|a second time|twice more|further still)(?: please)?$"
)
_AMOUNT_MORE = re.compile(
    r"^(?:and |now |then |just |by |maybe |say |make (?:it|that) |go |a bit more ,? ?|, |another |a further |an "
    r"extra |an additional )*"
    r"(?P<amount>\S.*?)(?: (?:more|further|again|extra|on top|in addition|please|too|as well|still|then|or so))*$"
)
_TRIED = re.compile(
    r"^(?:(?:or|and|but|no|nope|maybe|perhaps|then|now|rather|better|hmm|well|ok|okay|actually|so|,) )*"
    r"(?:(?:let us |we could |you could |i would |could you |can you |can we )?(?:just )?(?:try|go|use|make it|make "
    r"them|change it|"
    r"switch it|turn it|do it|have it|paint it|prefer|say|think|like|stick|settle|how about|what about|it should be|"
    r"i mean|i meant)"
    r"(?: back)?(?: with| for| to| in| into| on)* )?(?:in )?(?P<hue>\S.*?)"
    r"(?: (?:again|instead|then|please|rather|now|after all|though|this time|would be (?:better|nicer)|is better|"
    r"was better))*$"
)
_SAFER = re.compile(
    r"^(?:no |wait |actually |not there |not that one |rather |or |maybe |, )*(?P<place>\S.*?)(?: (?:would|might|"
    r"will|could) (?:be|look|work|feel) "
    r"(?:a bit |a little |much |far |even )?(?:\w+er|best|good|great|fine|ideal|perfect)| instead| rather| please)*$"
)
_ONE_MORE = re.compile(
    r"^(?:and |plus |, )*(?P<n>one|another|a|two|three|four|five|\d+)(?: more)?(?: one| ones)? (?:of|like|just like|"
    r"the same as) "
    r"(?:those|these|them|that|it|this|that one|this one)(?: please)?$"
)
_MOST_AMOUNT = 8  # words


def continued(said: Sequence[str]) -> Iterator[str]:
    """Readings of a sentence behind a command without what it says of the change before: "too far, 10 cm back"."""
    words = _without_judgement(said)
    if not words:
        return
    if len(words) < len(said):
        yield " ".join(words)
    yield from _amounts(words)
    text = " ".join(words)
    if _AGAIN.match(text):
        yield "more"
    if (found := _SAFER.match(text)) and Lookahead(words).preposition_at(0):
        yield f"put it {found['place']}"
    if (found := _TRIED.match(text)) and is_hue(found["hue"].removeprefix("a ").removeprefix("the ").split()):
        yield f"make it {found['hue']}"
    if found := _ONE_MORE.match(text):
        yield "copy it" if found["n"] in ("one", "another", "a", "1") else f"copy it {found['n']} times"
    yield from _renamed(words)


def _without_judgement(said: Sequence[str]) -> list[str]:
    """The words without parts in front that only judge: "too far, 10 cm to the right"."""
    words = list(said)
    while True:
        while words and words[0] in JOINTS:
            words = words[1:]
        end = next((i for i, w in enumerate(words) if w in (",", ";", ":")), None)
        if end is None or not is_judged(words[:end]):
            return words
        words = words[end + 1 :]


def _amounts(words: Sequence[str]) -> Iterator[str]:
    """ "another 10 cm", "keep going, half a metre more": as far as said in the way of before."""
    parts = " ".join(words).split(" , ")
    if len(parts) > 1 and (_AGAIN.match(parts[0]) or _MORE.match(parts[0])):
        words = parts[-1].split()
    if len(words) > _MOST_AMOUNT or not (found := _AMOUNT_MORE.match(" ".join(words))):
        return
    said = found["amount"].split()
    amount = quantities.read(said)
    if amount is not None and amount.taken == len(said) and amount.kind != "ORDINAL":
        yield f"{' '.join(said)} more"


def _renamed(words: Sequence[str]) -> Iterator[str]:
    """ "the blue one purple", "fridge black": a thing and what becomes of it."""
    while words and words[0] in ("and", "then", "now", "but", "also", "plus", "so"):
        words = words[1:]
    for taken in (1, 2, 3):
        thing = words[: len(words) - taken]
        hue = color_at(words, len(words) - taken) if len(words) > taken else None
        if hue is None or hue[1] != taken:
            continue
        if thing[-1] in ("one", "ones") or is_thing(tuple(thing)):
            named = thing if thing[0] in _NAMING else ["the", *thing]
            yield f"paint {' '.join(named)} {' '.join(words[len(words) - taken :])}"
            return


_NAMING = (
    "the",
    "that",
    "this",
    "those",
    "these",
    "my",
    "our",
    "both",
    "all",
    "every",
    "each",
    "it",
    "them",
    "any",
    "either",
)
