"""Brings commands for a material into the plain forms that `covering` reads: parts, owners, what is replaced, stories.

"glass top for the desk" becomes "the top of the desk in glass", "change the table's material to glass" "change the
table to glass", "the cabinet was wood, I want steel" "the cabinet in steel".
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache

from .....gaussians import late_re as re
from .....gaussians.world import kinds, styles
from .....gaussians.world.finishes import said as finish_said
from ...tagging.words import bag
from ..chunks import is_thing
from ..speech.frames import is_reported, unframed

PARTS = bag(
    "top tops leg legs frame frames seat seats backrest headboard footboard handle handles drawer drawers front fronts "
    "door doors arm arms armrest armrests edge edges base feet foot shade panel panels rim lid shelf shelves tabletop "
    "worktop countertop surround back cover covers trim border knobs knob"
)
_DET = r"(?:the|that|this|my|our|both|all|all the|every|each|its)"
_LOOKS = r"(?:material|finish|surface|fabric|texture|look|upholstery|covering|cladding|cover|coating|appearance|style)"
_OWNED = re.compile(rf"\b({_DET} (?:[a-z]+ ){{1,3}}?)'s {_LOOKS}\b")
_OF = re.compile(rf"\bthe {_LOOKS} of (?={_DET} )(?!.* (?:on|onto|to|over|for) (?:the|that|this|my|our) )")
_STYLED = re.compile(r",? ?\bin the style of [^,]+(?= ,|$)")
_INSTEAD = re.compile(
    r"(?:^| ,| )(?: )?(?:instead of|rather than|in place of|in lieu of) (?P<old>[^,]+?)(?= ,| on | for | over | i |"
    r" we |$)"
)
_NICER = re.compile(
    r" (?:would|might|could|will) (?:look|be|feel) (?:so |much |far |way |a lot |really |even )*"
    r"(?:better|nicer|good|great|lovely|nice|best|cool|amazing|fantastic|prettier|perfect|fine) (?:in|as|with|made "
    r"of|of) "
)
_LIKENED = re.compile(r" , (?:just |a bit |kind of |sort of )*like (?:(?:a|an|the|some) )?[a-z]+(?: [a-z]+)?$")
_SHOWN = re.compile(
    r"^(?:.*\b)?what (?:(?:would|might|could|does|will) )?(?P<thing>(?:the|that|this|my|our) [a-z ]+?) "
    r"(?:(?:would|might|could|will) )?looks? like (?:in|with|made of|made from|as|if it (?:was|were|is)(?: "
    r"made)?(?: of| in)?) "
    r"(?P<rest>.+)$"
)
_FRONTED = re.compile(
    r"^(?:as for|for|on|with|regarding|about) (?P<thing>(?:the|that|this|my|our) [a-z]+(?: [a-z]+)?) (?:, )?"
    r"(?P<rest>(?:i|we|let|how|what|can|could|go|maybe|please|use|try|give)\b.+)$"
)
_SUITS = re.compile(
    r"^(?P<surface>[a-z ]+?) (?:would |might |could |will )?(?:really |definitely |much )*(?:suits?|fits?|flatters?|"
    r"(?:looks?|works?|goes|go) (?:better|good|great|nice|nicer|well|best|lovely) (?:on|for|with)) "
    r"(?P<thing>(?:the|that|this|my|our) [a-z]+(?: [a-z]+)??)(?: (?:better|best|well|more|nicely))?$"
)
_PRONOUN = re.compile(
    r"^(?:(?:make|do|have|see|turn|redo|cover|paint|finish|get|want|like|it|that|them|there|this|is|be|to|as|could|can|should|"
    r"must|into|i am thinking|thinking|in) )+|(?: (?:there|here|on it|on them|for it|over it|all over))+$"
)
_CHANGING = re.compile(
    r"^(?:(?:please|can you|could you|let us) )*(?:change|swap(?: out)?|redo|replace|update|renew|switch(?: out)?|"
    r"refresh|redecorate|"
    r"do up|renovate|lose|get rid of|i hate|i dislike|i am (?:tired|sick|bored) (?:of|with)|i do not like) "
    r"(?=(?:the|that|this|my|our) )"
)
_NOT = re.compile(r" ,? ?(?:and |but )?not (?:the |a |some |in )?(?P<old>[a-z]+(?: [a-z]+)?)(?= ,|$)")
_TOLD = bag("is was were used has had looks seems feels needs wants got became are")
_FIXED = bag("floor floors wall walls ceiling ground worktop countertop backsplash counter flooring")


def plainer(said: str) -> str:
    """The sentence without its frame, with owners, looks and what is replaced in plain form."""
    said = unframed(said)
    said = _OWNED.sub(lambda m: m[1].strip(), said)
    said = _OF.sub("", said)
    said = _NICER.sub(" in ", said)
    said = _STYLED.sub(" ,", said).replace(" , ,", " ,").strip(" ,")
    said = _LIKENED.sub("", said)
    denied = _NOT.search(said)
    if denied is not None and _is_surface(denied["old"].split()):
        said = f"{said[: denied.start()]}{said[denied.end() :]}".replace(" , for ", " for ").strip(" ,")
    found = _INSTEAD.search(said)
    if found is not None and _is_surface(found["old"].split()):
        said = f"{said[: found.start()]}{said[found.end() :]}".strip(" ,")
    return " ".join(said.split())


def retold(said: str) -> Iterator[str]:
    """Other sentences for one that tells how a thing is and then asks for a surface, or names a part behind it."""
    yield from _turned(said)
    first, comma, rest = said.partition(" , ")
    if comma and not is_reported(first) and (thing := subject(first.split()) or _changed(first)) is not None:
        wanted = _PRONOUN.sub("", plainer(rest)).strip()
        yield f"{thing} in {wanted}" if not wanted.startswith(("in ", "of ", "made ")) else f"{thing} {wanted}"
    if (found := _part_at(said.split())) is not None:
        yield found


def _turned(said: str) -> Iterator[str]:
    """Sentences that name the material first, or the thing in front of the wish, in plain order."""
    if (found := _SHOWN.match(said)) or (found := _FRONTED.match(said)):
        wanted = _PRONOUN.sub("", plainer(found["rest"])).strip()
        yield f"{found['thing']} in {wanted}"
    if found := _SUITS.match(said):
        yield f"{found['surface']} on {found['thing']}"


def _changed(first: str) -> str | None:
    """The thing of a clause that only names it, or says that it is to change: "swap out the floor", "the walls"."""
    thing = _CHANGING.sub("", first)
    named = thing.split()[0] in ("the", "that", "this", "my", "our", "all", "both") or thing != first
    return thing if named and is_thing(tuple(thing.split())) else None


def subject(words: Sequence[str]) -> str | None:
    """The thing that a statement is about, None for other words."""
    for end in range(2, min(len(words), 6)):
        if words[end] in _TOLD and words[0] in ("the", "that", "this", "my", "our") and is_thing(tuple(words[:end])):
            return " ".join(words[:end])
    return None


def _part_at(words: Sequence[str]) -> str | None:
    """ "glass top for the desk", "a brass frame on the mirror": the part of the thing in the material."""
    for at in range(1, len(words) - 2):
        article = words[at + 2] in ("the", "that", "this", "my", "our")
        if words[at] in PARTS and words[at + 1] in ("for", "on", "of", "to") and article and _is_surface(words[:at]):
            plain = " ".join(w for w in words[:at] if w not in ("a", "an", "the", "give", "put", "some"))
            return f"the {words[at]} of {' '.join(words[at + 2 :])} in {plain}"
    return None


def _is_surface(words: Sequence[str]) -> bool:
    """Whether words name a material, with an article or a word more at most."""
    plain = [w for w in words if w not in ("the", "a", "an", "that", "this", "some", "plain", "old", "current", "put")]
    return any(finish_said(" ".join(plain[i:])) is not None for i in range(min(len(plain), 3)))


@cache
def style_words() -> frozenset[str]:
    """Adjectives that name a style and change nothing beside a material: "an industrial look, raw metal"."""
    return frozenset(name for name in styles.names() if " " not in name and finish_said(name) is None) - {
        "clean",
        "open",
    }


def is_soft(thing: str) -> bool:
    """Whether a thing is of cloth, so that "gold" and "silver" are its colour: a sofa, a rug, a curtain."""
    kind = kinds.find(thing.removeprefix("the ").removeprefix("my "))
    last = thing.split()[-1] if thing else ""
    soft = bag(
        "sofa couch armchair cushion cushions pillow pillows rug carpet curtain curtains bed duvet blanket throw "
        "pouf ottoman towel"
    )
    return last in soft or (kind is not None and (kind.is_rug or kind.role == "bed"))


def is_fixed(thing: str) -> bool:
    """Whether a thing is a surface of the room."""
    return bool(thing) and thing.split()[-1] in _FIXED
