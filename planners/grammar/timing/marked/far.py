"""How far something goes or opens: in amounts, as a share of its way, or so much more or less than now."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from .....gaussians import late_re as re
from ...vocabulary.nouns import is_opened
from ...vocabulary.quantities import NUMBERS
from ..moments import Moment
from .amounts import Amount, amount
from .slots import Slots
from .steps import opened
from .wanted import Wanted, now, paced, plainly, whose_of

HALFWAY = {"state": "halfway", "part": "from"}
_HALF_OF_IT = 0.5
_HALF = re.compile(
    r"\b(?:half ?way|midway|half|mid(?: |-)?(?:point|fall|swing|height|drop|flight|air|way|roll|walk|turn|slide)|"
    r"middle of (?:the |its |his )?way|half(?: of)? (?:the|its|his|her|that|this)(?: \w+)? "
    r"(?:way|fall|drop|walk|swing))\b"
)
_FURTHER = r"(?:more|further|farther|wider|longer|extra|additional|another|deeper|higher)"
_SHORTER = r"(?:less|shorter|fewer|short|narrower|lower)"
_ADJECTIVE = r"(?! \w+(?:ful|ing|ic|al|ive|ous|ant|ent|able|ly)\b)"  # "more careful" is no distance
_CHANGES = {1: re.compile(rf"\b{_FURTHER}\b{_ADJECTIVE}"), -1: re.compile(rf"\b{_SHORTER}\b{_ADJECTIVE}")}
_AT_MOST = re.compile(
    r"\b(?:no|not|never|neither|nothing|without)(?: an?| one| any| a hair| go(?:ing)?| it| come)* "
    rf"(?:{_FURTHER}|{_SHORTER})\b(?: than)?|\b{_FURTHER} than (?=\d|an?\b|(?:{'|'.join(NUMBERS)})\b)|"
    rf"\b(?:any|needs? not(?: \w+)?) {_FURTHER}\b"
)
_LESS = re.compile(r"\b(?:less|lower|reduc\w+|cut|drop|decreas\w+|shorten\w*|shorter|trim\w*)\b")
_TO = r"\b(?:to|at|only|just)(?: \w+){0,1} "


def far_along(slots: Slots) -> dict[str, Any] | None:
    """The time from when something has gone as far as is told, as fields: "at 40 degrees", "a third of the way down";
    None if that is not told."""
    if (angle := slots.one("deg")) is not None:
        return {**HALFWAY, "degrees": angle.value}
    if (length := slots.one("m")) is not None:
        return {**HALFWAY, "distance": {"value": length.value}}
    share = slots.one("times", "%")
    part = None if share is None else share.value / 100 if share.unit == "%" else share.value
    if part is not None and 0 < part < 1:
        return {**HALFWAY, "share": round(part, 4)} if part != _HALF_OF_IT else dict(HALFWAY)
    if slots.tell(_HALF):
        slots.used |= {own.said for own in slots.amounts}
        return dict(HALFWAY)
    return None


def goes_as_far(slots: Slots) -> Iterator[Wanted]:
    """The commands of a wish that something goes, opens or turns as far as is told."""
    slots.pass_goals()
    _leave_out_how_far_it_goes(slots)
    if not is_opened(slots.noun):
        yield from _turns(slots)
    if (how := how_far(slots)) is None:
        return
    slots.used |= {own.said for own in slots.amounts if own.unit in ("times", "%")}  # "half as far, 15 cm"
    if is_opened(slots.noun):
        if isinstance(how, float):
            yield opened(whose_of(slots), plainly(slots.moment), slots.happening, share=how)
        else:
            yield now(slots, f"open {slots.whom} {how}")
    elif isinstance(how, float):
        yield paced(slots, "part", share=how)
    elif how.startswith("by") and how.endswith(" m"):
        yield now(slots, f"let {slots.whom} only move {how.removeprefix('by ')}")
    elif how == "halfway":
        yield now(slots, f"let {slots.whom} go half the way")


def _leave_out_how_far_it_goes(slots: Slots) -> None:
    """Leaves out of several amounts those that tell how far something goes now: "it goes 30 cm, reduce that to 10"."""
    moves = slots.movement(slots.queries[0])
    if moves is None or len(slots.amounts) < 2:
        return
    here = {"deg": moves.degrees, "m": moves.metres, "turns": moves.degrees / 360}
    said = [own for own in slots.amounts if own.unit in here and abs(own.value - here[own.unit]) < _AS_NOW]
    if len(said) < len(slots.amounts):
        slots.amounts = tuple(own for own in slots.amounts if own not in said)
        slots.known |= {own.said for own in said}


_AS_NOW = 0.01  # metres, degrees and turns by which what is told may differ from how it is


def _turns(slots: Slots) -> Iterator[Wanted]:
    """Another turn of what turns on its way."""
    moves = slots.movement(slots.queries[0])
    on_its_turn = slots.happening is not None and slots.happening.during.state == "turning"
    if moves is not None and moves.turns and moves.rate > 0 and (turns := slots.one("turns")) is not None:
        stop = round(moves.start + turns.value / moves.rate, 4)  # "three turns are all I want of it"
        slots.repeated.add(turns.said)
        later = stop > moves.stop
        yield paced(slots, "go_on" if later else "stop", Moment(stop=stop) if later else Moment(start=stop))
        return
    if moves is None or moves.turns or (slots.told and not on_its_turn):
        return
    own = next((own for own in slots.amounts if own.unit in ("deg", "", "turns", "times")), None)
    if own is None or (own.unit == "times" and _TURN.search(slots.whole) is None):
        return
    sign = _sign(slots, own, moves.degrees)
    if own.unit == "times":
        angle = moves.degrees * (1 + sign * own.value) if sign else 0.0
    else:
        angle = own.value * (360 if own.unit == "turns" else 1) * (sign or 1) + (moves.degrees if sign else 0.0)
    if angle > 0:
        slots.used.add(own.said)
        slots.repeated.add(own.said)
        yield replace(paced(slots, "turn", Moment(), degrees=round(angle, 4)), happening=None)
        slots.used.discard(own.said)


_TURN = re.compile(r"\b(?:turn\w*|round|around|pivot\w*|rotat\w+|twist\w*|swivel\w*)\b")


def how_far(slots: Slots) -> str | float | None:
    """How far something opens or goes, in words, or as a share of how far it does now; None if that is not told, or if
    nothing tells how far it goes now."""
    slides = slots.noun.startswith("drawer")
    own = slots.one("") or slots.one("deg") or slots.one("m")
    moves = slots.movement(slots.queries[0])
    if own is not None:
        unit = own.unit or ("cm" if slides else "deg")
        value = own.value / 100 if unit == "cm" else own.value
        here = 0.0 if moves is None else moves.degrees if unit == "deg" else moves.metres
        sign = _sign(slots, Amount(value, own.unit, own.said), here)
        if sign:
            if not here or (value := here + sign * value) <= 0:
                return None
            slots.repeated.add(own.said)
            if not is_opened(slots.noun):
                return round(value / here, 4) if value < here else None
        return f"by {value:g} degrees" if unit == "deg" else f"by {value:g} m"
    share = slots.one("times", "%")
    if share is None:
        return "halfway" if slots.tell(_HALF) else None
    part = share.value / 100 if share.unit == "%" else share.value
    sign = _sign(slots, share, 0.0)
    whole = slots.whole
    if sign or (share.unit == "%" and _LESS.search(whole) and not re.search(_TO + re.escape(share.said), whole)):
        slots.repeated.add(share.said)
        part = 1 + (sign or -1) * part
    if part <= 0:
        return None
    now_wide = moves if moves is not None and is_opened(slots.noun) else None
    if now_wide is not None and part != 1 and (part < 1 or _AS_FAR.search(whole)):
        slots.repeated.add(share.said)
        return f"by {now_wide.metres * part:g} m" if slides else f"by {now_wide.degrees * part:g} degrees"
    if part == _HALF_OF_IT:
        return "halfway"
    if part < 1:
        return round(part, 4)
    slots.used.discard(share.said)  # "twice as quick"
    return None


_AS_FAR = re.compile(rf"\b(?:far|wide|distance|{_FURTHER}|deep|out)\b")


def _sign(slots: Slots, own: Amount, here: float) -> int:
    """1 if something is to go further by an amount than now, -1 if less far by that, 0 if the amount is how far it is
    to go: "5 cm further", and "further, 45 cm".

    Args:
        here: how far it goes now; 0 if that is not known.
    """
    instead = any(tag == "not" and amount(" ".join(slots.words[a:b])) is not None for tag, a, b in slots.spans)
    words = _AT_MOST.sub(" ", slots.whole)
    beside = re.search(rf"(?:\S+ )?{re.escape(own.said)}(?: \S+)?", words)
    for sign, change in _CHANGES.items():
        if beside is not None and change.search(beside[0]):
            return sign
        if change.search(slots.said) and change.search(words) and not instead:
            told = own.unit in ("times", "%") or (here and (own.value - here) * sign < 0)
            return sign if told and not _UP_TO.search(words) else 0
    return 0


_UP_TO = re.compile(
    r"\b(?:to|until|up to|reach\w*) (?:\w+ ){0,2}(?:\d|one|two|three|four|five|six|seven|eight|nine|ten|half)"
)
