"""Restates sentences that ask for a change without a command: "I'd like the desk moved to the left", "the rug can go".

A form is a pattern over the words of a sentence (`wish_patterns.py`). What it yields is tried by the planner and counts
only if the whole of it is understood, so that a pattern may be generous about where a noun phrase ends.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .....gaussians import late_re as re
from ...tagging.lookahead import Lookahead, color_at, is_hue
from ...vocabulary import quantities
from ..chunks import is_thing
from ..speech.participles import at, gerunds
from .states import bare_thing, begins_state, command, is_plain, may_end, states
from .wish_patterns import (
    ASKED,
    BEST_PLACE,
    CLEFT,
    EMPTIED,
    GIVEN,
    HUED,
    INSTEAD,
    KEPT,
    MODAL,
    NEEDS,
    NEW,
    OF_COLOR,
    PLACED,
    UNWANTED,
    WANTED,
    WANTING,
    WHERE,
)  # fmt: skip


def wishes(said: str) -> Iterator[str]:
    """Commands that a sentence may stand for, the likeliest first."""
    cut = (
        _by_doing,
        _would,
        _cleft,
        _emptied,
        _hued,
        _best_place,
        _given,
        _kept,
        _replacing,
        _unwanted,
        _of_color,
        _wanted,
        _needed,
        _asked,
        _wanting,
        _modal,
        _placed,
    )
    for form in cut:
        yield from form(said)


def _by_doing(said: str) -> Iterator[str]:
    """ "make room for a rack by moving the basket to the right"."""
    words = said.split()
    for i, word in enumerate(words[:-1]):
        if word == "by" and i > 1 and (form := at(gerunds(), words, i + 1)) is not None:
            yield " ".join([*form[0], *words[i + 1 + form[1] :]])


_WOULD = re.compile(
    r"^(?:i|we|you)(?: (?:would|will|could|might|should|had|may|am going to|are going to|want to|need to|have to))"
    r"(?: (?:just|rather|also|prefer to|like to|love to|better|best|do well to|do better to|want to|need to|like "
    r"you to|now|"
    r"be tempted to|be inclined to|say|suggest we|suggest you))* (?P<rest>\S.*?)(?:(?: ,)* (?:if (?:i|it) (?:were|"
    r"was) (?:you|me|up to me|"
    r"my choice|my room|mine)|in your (?:place|shoes)|if it were up to me|if you ask me))?$"
)


def _would(said: str) -> Iterator[str]:
    """ "I'd move the palm a bit", "you'd do well to turn the chair around"."""
    found = _WOULD.match(said)
    if found and Lookahead(found["rest"].split()).verb(0) is not None:
        yield found["rest"]


def _emptied(said: str) -> Iterator[str]:
    for pattern in EMPTIED:
        if (found := pattern.match(said)) and is_thing(tuple(found["thing"].split())):
            yield f"delete everything on {found['thing']}"


def _hued(said: str) -> Iterator[str]:
    for pattern in HUED:
        if (found := pattern.match(said)) and is_hue(found["hue"].split()):
            yield f"paint {found['thing']} {found['hue']}"


def _best_place(said: str) -> Iterator[str]:
    if found := WHERE.match(said):
        yield f"move {found['thing']} to {found['place']}"
    if found := BEST_PLACE.match(said):
        yield f"put {found['thing']} {found['state']}"


def _cleft(said: str) -> Iterator[str]:
    """ "the third bookcase is the one I want gone"."""
    for pattern in CLEFT:
        if found := pattern.match(said):
            yield from states(found.group("thing"), found.group("state").split())


def _kept(said: str) -> Iterator[str]:
    """ "I only need to see the car", "the bed and nothing else"."""
    for pattern in KEPT:
        found = pattern.match(said)
        if found and is_thing(tuple(found.group("thing").split())):
            yield f"keep only {found.group('thing')}"


_NUMBERED = re.compile(
    r"(?:two|three|four|five|\d+|so many|that many|another|more|as many|this many|several|quite so many) "
)


def _unwanted(said: str) -> Iterator[str]:
    for pattern in UNWANTED:
        if not (found := pattern.match(said)):
            continue
        each = found.groupdict().get("each")
        thing = f"every {each}" if each else found.group("thing")
        if _NUMBERED.match(thing):
            continue  # "we do not need two palms" leaves one of them
        if is_plain(thing) or thing in ("it", "they"):
            yield f"delete {re.sub('^any ', 'all ', bare_thing(thing)).replace('they', 'them')}"


def _wanted(said: str) -> Iterator[str]:
    for pattern in WANTED:
        if not (found := pattern.match(said)):
            continue
        more, noun = found.groupdict().get("more") or "", found.groupdict().get("noun")
        if noun is None:
            yield f"add {_introduced(found.group('thing'))}{more}"
        elif color_at(found.group("hue").split(), 0):
            yield f"add {found.group('thing')}{found.group('hue')} {noun}{more}"


def _introduced(thing: str) -> str:
    """A new thing with an article: "floor lamp wanted"."""
    return thing if re.match(rf"^(?:{NEW}|\d+)\b", thing) or thing.endswith("s") else f"a {thing}"


def _replacing(said: str) -> Iterator[str]:
    for pattern in INSTEAD:
        if (found := pattern.match(said)) and not _is_amount(found.group("new").split()):
            yield f"replace {found.group('old')} with {found.group('new')}"


def _is_amount(new: Sequence[str]) -> bool:
    """Whether words that look like a new thing are a colour or an amount: "a dark red", "twice as tall"."""
    amount = quantities.read(new)
    stated = amount is not None and amount.kind not in ("NUMBER", "ORDINAL")
    return stated or color_at(new, 1) is not None


def _of_color(said: str) -> Iterator[str]:
    if found := OF_COLOR.match(said):
        yield f"paint {found.group('thing')} {found.group('state')}"


def _needed(said: str) -> Iterator[str]:
    """ "the rug needs removing", "the wall could do with a coat of blue"."""
    found = NEEDS.match(said)
    if not found:
        return
    thing, state = found.group("thing"), found.group("state").split()
    if (form := at(gerunds(), state, 0)) is not None:
        yield command(form[0], thing, state[form[1] :])
    yield from states(thing, state)
    painted = re.match(
        r"^(?:a |some )?(?:new |fresh )?(?:coat|lick|layer|splash|touch) of (?P<hue>.+?)(?: paint)?$", " ".join(state)
    )
    if painted:
        yield f"paint {thing} {painted.group('hue')}"


def _asked(said: str) -> Iterator[str]:
    """ "can the lamp go on the desk"."""
    found = ASKED.match(said)
    if found and not re.match(r"(?:you|i|we|it be possible)\b", found.group("thing")):
        yield from states(found.group("thing"), f"{found.group('verb')} {found.group('state') or ''}".split())


def _wanting(said: str) -> Iterator[str]:
    found = WANTING.match(said)
    if not found:
        return
    rest = found.group("rest")
    if _IN_PLACE_OF.match(rest):
        yield f"put {rest}"
    yield from _split_states(rest.split())
    yield from wishes(rest)


def _modal(said: str) -> Iterator[str]:
    found = MODAL.match(said)
    if found and not found.group("not"):
        yield from states(found.group("thing"), found.group("state").split())


def _placed(said: str) -> Iterator[str]:
    found = PLACED.match(said)
    if found and found.group("thing") not in ("i", "you", "we", "what", "where", "how"):
        state = found.group("state").split()
        yield from states(found.group("thing"), state)
        yield f"put {found.group('thing')} {' '.join(state)}"


# "A stool where the armchair is", said as a wish.
_IN_PLACE_OF = re.compile(
    rf"^{NEW} [^,]*? where (?:the|that|this|my|our) [^,]*? (?:is|are|was|were|stands?|sits?)(?= ,|$| now)"
)
_INDEFINITE = ("a", "an", "another", "some")


def _split_states(rest: Sequence[str]) -> Iterator[str]:
    """The readings of a thing and its state that stand side by side: "the sofa painted blue"."""
    for i in range(1, len(rest)):
        thing = tuple(rest[:i])
        if rest[0] not in _INDEFINITE and may_end(rest[i - 1]) and begins_state(rest, i) and is_thing(thing):
            yield from states(" ".join(thing), rest[i:])


def _given(said: str) -> Iterator[str]:
    """ "give the chair a quarter turn", "give it a nudge to the left"."""
    if not (found := GIVEN.match(said)):
        return
    verb = found.group("verb").removesuffix("s")
    amount = (
        ""
        if found.group("amount") in ("a", "an", "another", "a little", "a gentle", "a good")
        else found.group("amount")
    )
    if found.group("amount") == "a little":
        amount = "a little"
    if verb in ("turn", "spin", "rotation", "twist"):
        stated = re.fullmatch(r"(?:an? |another )?([\d.]+) ?(?:-? ?degrees?|°)", amount)
        turned = f"{stated[1]} degrees" if stated else f"{amount} turn" if amount not in ("", "a little") else amount
        yield " ".join(f"rotate {found.group('thing')} {turned}{found.group('rest')}".split())
        if not re.search(r"\d", amount):  # a number that is not understood is not half a turn
            yield " ".join(f"turn {found.group('thing')} around{found.group('rest')}".split())
        return
    yield " ".join(f"{verb} {found.group('thing')} {amount}{found.group('rest')}".split())
