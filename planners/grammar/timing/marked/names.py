"""Names of things, and colours, in the words of an instruction that no rule has divided."""

from __future__ import annotations

from collections.abc import Sequence

from .....gaussians import late_re as re
from .....gaussians.language.query.query import Query
from .....gaussians.world.words import singular
from ...learned.marks import Span
from ...learned.seen import hues
from ...tagging.words import bag
from ...vocabulary.nouns import EVERYWHERE, is_known, is_opened
from ...vocabulary.quantities import NUMBERS
from ..manner import Thing

MOVING = "everything that moves"
_MOVING = re.compile(
    r"\b(?:everything|all|whatevers?|anything)(?: (?:that|which))?(?: (?:is|are))? (?:moves?|moving)\b"
    r"(?: (?:in|on) (?:the|this) (?:shot|scene|film|clip|video|picture))?|\beverything\b(?! else)"
)
# Times, people, and words that stand behind "the" and name nothing that can be edited.
_NO_THINGS = EVERYWHERE | bag(
    "second seconds sec time times moment minute start beginning end film clip video shot movie animation sequence "
    "way bit speed motion movement turn turns circle frame place spot direction half rest mood eyes eye point stop "
    "pace work job whole look view scene thing things same part middle air sky effect go walk fall roll ride trip "
    "opening once please children kids guests audience viewers boss client baby boy girl son daughter camera screen "
    "drop swing tumble flight animation layer action gravity "
    "slow fast light dark red blue green yellow white black purple pink orange brown gray grey silver gold"
)
_BETWEEN = bag(
    "to at on in into onto by of for with from and or but then so as until till while when once after before"
)
_LONGEST = 5  # words of a name
_UNKNOWN = 3  # words of a name with "the" whose noun is not known
_ONE = re.compile(
    r"\b(?P<how>(?:the|that|this) (?!(?:first|last|next|other|moving|only) )[a-z]+|top|middle|bottom|upper|lower) one\b"
    r"(?! (?:and a (?:half|quarter)|full|whole|half|third|quarter|seconds?|secs?|s|m|cm|met(?:re|er)s?|times?|turns?|"
    r"by)\b)"
)
_OF_DRAWERS = ("top", "middle", "bottom", "upper", "lower")  # of what "one" is then said
_NO_NOUNS = bag("can back top middle bottom upper lower mirror match")
_RANKED = re.compile(  # "from when the first book falls until the last one is down"
    r"\bthe (?:first|last|second|third) (?P<noun>[a-z]+)\b.*\bthe (?:first|last|second|third) (?P<one>one)\b"
)
_RANKED_ALONE = re.compile(  # "until the last has landed"
    r"\bthe (?P<rank>first|last)(?= (?:has|have|is|'s|lands?|falls?|hits?|stops?|drops?|comes?|goes|opens?|starts?|"
    r"sets|begins?|leaves)\b)"
)


def with_moving(text: str) -> str:
    """A text with one name for all that moves: "whatever moves in this shot"."""
    return _MOVING.sub(MOVING, text)


def with_nouns(text: str) -> str:
    """A text with the noun that "one" stands for: "the middle drawer ... the top one" names the top drawer."""

    def noun(found: re.Match[str]) -> str:
        before, after = (
            [word for word in part.split() if is_known(word) and word not in _NO_THINGS and word not in _NO_NOUNS]
            for part in (text[: found.start()], text[found.end() :])
        )
        if found[0].split()[-2] in _OF_DRAWERS and (own := [w for w in (*before, *after) if is_opened(singular(w))]):
            before = own
        unnamed = "drawer" if found[0].split()[-2] in _OF_DRAWERS else "one"
        return f"{found[0].removesuffix(' one')} {singular((before[-1:] or after[:1] or [unnamed])[0])}"

    return _RANKED_ALONE.sub(noun, _ONE.sub(noun, with_ranked_noun(text)))


def with_ranked_noun(text: str) -> str:
    """A text with the noun of a ranked "one": "when the first book falls until the last one lands"."""
    ranked = _RANKED.search(text)
    if ranked is None or not is_known(ranked["noun"]):
        return text
    return f"{text[: ranked.start('one')]}{ranked['noun']}{text[ranked.end('one') :]}"


def named(text: str, thing: Thing) -> tuple[str, ...]:
    """The names of things in a text, in their order, each once."""
    words, found, at = text.split(), list[str](), 0
    while at < len(words):
        for end in range(min(len(words), at + _LONGEST), at, -1):
            phrase = " ".join(words[at:end])
            if _is_name(words[at:end]) and thing(phrase) is not None:
                found.append(phrase)
                at = end
                break
        else:
            at += 1
    return tuple(dict.fromkeys(found))


def _is_name(words: Sequence[str]) -> bool:
    """Whether words may be the name of a thing: a noun that is known at their end, or "the" before a few."""
    last = words[-1]
    if " ".join(words) == MOVING:
        return True
    if not all(word.isalpha() or word == "'s" for word in words) or set(words) & _BETWEEN:
        return False
    if last in _NO_THINGS or last in NUMBERS:
        return False
    return is_known(last) or (words[0] == "the" and 1 < len(words) <= _UNKNOWN)


PARTS = {"leaf": "door", "blade": "fan", "rotor": "fan", "propeller": "fan"}  # what moves as the whole does
_FELLOW = re.compile(r"(?<=[a-z]) (?:guy|dude|fella|fellow|buddy|chap|lad|thingy|dearest)$")  # behind a name
_LIST = re.compile(r" , and | and | , | \+ | & | / ")


def with_colors(thing: Thing, words: Sequence[str], spans: Sequence[Span]) -> Thing:
    """A reader of names that also reads a colour alone, "once blue has landed": of the noun that the marks of an
    instruction name, or else of what moves.

    Args:
        thing: reads other names.
        words: those of the instruction.
        spans: the marks in them.
    """
    marked = (words[start:stop] for tag, start, stop in spans if tag in ("x", "y"))
    named = [word for own in marked for word in own if is_known(word) and word not in _NO_THINGS | hues()]
    noun = singular(named[0]) if named and len(set(map(singular, named))) == 1 else ""
    noun = noun or next((own for own in map(singular, words) if not named and is_opened(own)), "")

    def read(name: str) -> Query | None:
        name = _FELLOW.sub("", name)
        if (part := singular(name.split()[-1]) if name else "") in PARTS:  # "from when the blades stand still"
            name = f"the {PARTS[part]}"
        bare = [word for word in name.split() if word not in ("the", "one", "'s", "that", "this", "those")]
        alone = name in _OF_DRAWERS or (bare[:1] != ["middle"] and name == f"the {bare[0] if bare else ''}")
        if len(bare) == 1 and bare[0] in _OF_DRAWERS and alone and is_opened(noun):  # "middle and bottom drawer"
            return thing(f"the {bare[0]} {noun}")
        if noun and name.endswith(" one") and is_opened(noun) and thing(name) is None:
            return thing(f"{name.removesuffix('one')}{noun}")  # "the lowest one"
        if not bare or not set(bare) <= hues():
            *several, last = (own for own in _LIST.split(name) if own) if name else ("",)
            whole = last.split() or [""]
            own_noun = whole[-1] if is_known(whole[-1]) and whole[-1] not in hues() else ""
            shades = set(whole) - {"the", "one", own_noun}
            if several and shades <= hues() and all(set(own.split()) - {"the", "one"} <= hues() for own in several):
                said = [f"the {own.removeprefix('the ')} {own_noun}".strip() if own_noun else own for own in several]
                first, *others = (thing(own) if own_noun else read(own) for own in (*said, last))
                return None if first is None else first.model_copy(update={"also": tuple(o for o in others if o)})
            return thing(name)
        query = thing(f"the {' '.join(bare)} {noun or 'one'}")
        return query if noun or query is None else query.model_copy(update={"moving": True})

    return read
