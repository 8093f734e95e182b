"""Sentences that ask for a style: "a rustic look", "make the kitchen industrial", "japandi vibe for the whole thing".

They become sentences about a new colour: "paint everything #style~rustic" (see `vocabulary.materials`).
"""

from __future__ import annotations

from functools import cache

from .....gaussians import late_re as re
from .....gaussians.world import styles
from ...vocabulary.materials import STYLE, mark
from ..chunks import is_thing

_ROOMS = (
    "room|living room|sitting room|bedroom|bed room|kitchen|bathroom|office|home office|study|dining room|hallway|hall|"
    "nursery|lounge|cafe|coffee shop|bar|shop|loft|studio|attic|basement|garage|restaurant|library|classroom|salon|"
    "place|space|flat|house|apartment|scene|interior|thing|home|decor|floor and walls|furniture and walls|lot"
)
_ROOM = rf"(?:(?:the|this|my|our|that) )?(?:(?:whole|entire|complete|full) )*(?:{_ROOMS})"
_ALL = rf"(?:{_ROOM}|everything|it all|all of it|it|this|all)"
_LOOK = (
    "look|style|vibe|vibes|feel|feeling|theme|makeover|touch|flair|atmosphere|mood|aesthetic|character|design|decor|"
    "treatment|interior|direction|look and feel|spin|twist|ambiance|ambience|inspired look"
)
_DO = (
    "make|turn|render|do|redo|style|restyle|decorate|redecorate|furnish|i want|i would like|i would love|have|get|let|"
    "transform|convert|change|refurbish|renovate|remodel|design|redesign|dress|set|we want|want"
)
_LINK = (
    r"(?:(?:look|looking|to look|feel|to feel|be|to be|have|to have|get|go|into|in|to|with|more|very|really|all|a bit|"
    r"a little|like|as if it is|properly|completely|totally|become|something|it is) )*(?:(?:a|an|the|some) )?"
)
_POLITE = (
    r"(?P<polite>(?:(?:please|now|then|also|next|finally|and|ok|okay|can you|could you|would you|can we|could we|"
    r"just|go ahead and|let us|maybe) )*)"
)
_TAIL = r"(?: (?:,|please|too|as well|instead|now|thanks|go|overall|throughout|everywhere|style|again))*"
# Names of styles that say the light or the size more often than a style: they are one only beside "style" or "look".
_VAGUE = frozenset(
    ["warm", "dark", "open", "simple", "clean", "bare", "sparse", "moody", "gloomy", "dramatic", "fun", "cheerful",
     "comfortable", "comfy", "relaxing", "inviting", "welcoming", "minimal", "urban", "country", "beach", "classic",
     "fancy", "formal", "grand", "lively", "colorful", "colourful", "vibrant", "intimate", "snug", "traditional",
     "stylish", "trendy", "uncluttered", "party", "holiday", "leafy", "jungle", "lodge", "cottage"]
)  # fmt: skip


@cache
def _forms() -> tuple[re.Pattern[str], ...]:
    every = sorted(styles.names(), key=lambda n: (-len(n), n))
    spelt = [re.escape(n).replace(r"\ ", "[ -]+(?:- )?") for n in every]
    style = rf"(?P<style>{'|'.join(spelt)})"
    sure = [re.escape(n).replace(r"\ ", "[ -]+(?:- )?") for n in every if n not in _VAGUE]
    plain = rf"(?P<style>{'|'.join(sure)})"
    thing = rf"(?P<thing>{_ALL}|(?:the|my|our|this|that|both|all|these|those) [^,;]+?)"
    forms = (
        rf"(?:{_DO}) {thing} {_LINK}{style} (?:{_LOOK})",
        rf"(?:{_DO}) (?P<thing>{_ALL}) {_LINK}{plain}(?: {_ROOM})?",
        rf"(?:give|add|bring|lend) (?:to )?{thing} (?:(?:a|an|the|some|more of a|more) )?{style} (?:{_LOOK})",
        rf"(?:give|add|bring) (?:me |us )?(?:(?:a|an|the|some) )?{style} (?:{_LOOK}) (?:to|for|in|on) {thing}",
        rf"(?:(?:{_DO}|go for|go with|try|give me|show me|apply|use|let us go for|how about|what about) )?"
        rf"(?:(?:a|an|the|some) )?{style} (?:{_LOOK})(?: (?:for|in|throughout|on|across|to|over) {thing})?",
        rf"{plain} (?P<thing>{_ROOM})",
        rf"(?P<thing>{_ALL}) (?:in|goes|should be|should look|should feel) (?:(?:a|an|the|more) )*{plain}"
        rf"(?: (?:{_LOOK}))?",
        rf"(?:go|make it|we want it|i want it) (?:all |more |full |fully )*{plain}",
    )
    return tuple(re.compile(rf"^{_POLITE}{form}{_TAIL}$") for form in forms)


@cache
def _cue() -> re.Pattern[str]:
    words = sorted({name.split()[-1] for name in styles.names()} | {name.split()[0] for name in styles.names()})
    return re.compile(rf"\b(?:{'|'.join(map(re.escape, words))})\b")


def names_style(said: str) -> bool:
    """Whether a word of a sentence may name a style."""
    return _cue().search(said) is not None


def styled(said: str) -> str | None:
    """A sentence that asks for a style in other words; None if it asks for none."""
    if not names_style(said):
        return None
    for form in _forms():
        found = form.match(said)
        if found is None:
            continue
        thing = found.groupdict().get("thing") or "everything"
        whole = re.fullmatch(_ALL, thing) is not None
        if not whole and not is_thing(tuple(thing.split())):
            continue
        style = styles.named(re.sub(r"[ -]+", " ", found["style"]))
        if style:
            return f"{found['polite']}paint {'everything' if whole else thing} {mark(STYLE, style)}"
    return None
