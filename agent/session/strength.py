"""Words that ask for more or less of the edit that was made last: "more", "a bit less", "twice as much", "too strong".

They change the strength of that edit and carry it out again from where it started, so that "less" is possible and
"a bit more, a bit less" ends where it began. Nothing here looks at a scene.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from .answers import plain

if TYPE_CHECKING:
    from ...planners.plan import EditPlan

_BIT = r"a (?:(?:little|tiny|wee|small) )?(?:bit|touch|tad|little|smidge|hair)"
_LITTLE = rf"(?:(?:just |only )?(?:{_BIT}|slightly|somewhat|marginally))"
_MUCH = r"(?:(?:very )?much|a lot|lots|far|way|considerably|a great deal|loads)"
_MORE = r"(?:more(?: of (?:it|that))?|stronger|more strongly|more intense|more intensely|harder|heavier|further)"
_LESS = (
    r"(?:less(?: of (?:it|that))?|weaker|less strong|less strongly|less intense|softer|gentler|subtler|milder|"
    r"lighter touch)"
)
_OF = r"(?: (?:as much|that|as strong|as strongly|the strength|the amount|it|of it|of that))?"
_IT_IS = r"(?:(?:that|it)(?:'?s| is| was) )?"
_BY = r"(?:far |way |much |a bit |a little |slightly )?"
_FORMS: tuple[tuple[str, float], ...] = (
    (rf"(?:even |and |still )?{_LITTLE} {_MORE}", 1.5),
    (rf"(?:even |and |still )?{_LITTLE} {_LESS}", 0.75),
    (rf"(?:even )?{_MUCH} {_MORE}", 3.0),
    (rf"(?:even )?{_MUCH} {_LESS}", 0.25),
    (rf"(?:even |and |still |some |yet )?{_MORE}(?: still)?", 2.0),
    (rf"(?:even |and |still |yet )?{_LESS}(?: still)?", 0.5),
    (rf"(?:twice|double|2x|two times){_OF}", 2.0),
    (rf"(?:three times|triple|thrice|3x){_OF}", 3.0),
    (rf"(?:only |just )?half{_OF}", 0.5),
    (r"halve (?:it|that|the strength|the amount)", 0.5),
    (rf"{_IT_IS}{_BY}too (?:much|strong|intense|heavy)", 0.5),
    (rf"{_IT_IS}{_BY}too (?:weak|little|subtle)", 2.0),
    (rf"{_IT_IS}not (?:quite |nearly )?(?:enough|strong enough)", 2.0),
    (rf"{_IT_IS}not (?:quite )?so (?:much|strong|strongly)", 0.5),
)
_BEFORE = r"(?:(?:please|now|ok|okay|hmm|no|yes|well|make it|make that|do it|do that|go|try|give me|and|but)[ ,]+)*"
_AFTER = r"(?:[ ,]+(?:please|then|now|thanks|than that))*"
_READ = tuple((re.compile(_BEFORE + form + _AFTER), times) for form, times in _FORMS)


def times_asked(text: str) -> float | None:
    """How many times as strong the last edit is asked to be; None if the text says something else.

    >>> times_asked("a bit less, please")
    0.75
    """
    said = plain(text)
    return next((times for form, times in _READ if form.fullmatch(said)), None)


def stronger_plan(plan: EditPlan, times: float) -> EditPlan | None:
    """The plan with each of its operations that has a strength `times` as strong; None if none has one, or each is as
    strong as it can be."""
    ops = [op.stronger(times) for op in plan.ops]
    if not any(op is not None for op in ops):
        return None
    changed = tuple(new or old for new, old in zip(ops, plan.ops, strict=True))
    said = f"{plan.instruction!r} again from its start, {_told(times)} as strong"
    return plan.model_copy(update={"ops": changed, "planner": "said", "reason": said, "usage": None, "seconds": 0.0})


def _told(times: float) -> str:
    return {0.25: "a quarter", 0.5: "half", 0.75: "three quarters", 2.0: "twice"}.get(times, f"{times:g} times")
