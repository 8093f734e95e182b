"""Whether something happens: "does the plant move?", "is the door open at 2 s?", "does it ever touch the sofa?"."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from .....gaussians.motion.holding import Span, common
from ...answer import Answer
from ...candidates import is_plural
from ...reading.noun_phrase import is_anything
from ...reading.time.deeds import STATES, Deed
from ...survey import listed
from ...timeline.asked import PLACES, Told, Untold, at, cap, during, kind, spoken, verb, within, yes_no
from ...timeline.bodies import Body
from ...timeline.happening import is_near, spans_of
from .lamps import is_lit, state_asked
from .when import moment

_SOME_TIME = re.compile(r"\b(?:finally|eventually|ultimately|afterwards?|at last|in the end)\b")
_ROUND = 0.15  # seconds: what starts so soon after the start of the scene starts with it


_GONE = re.compile(r"^(?:is|are|was|were|does|do) .*\bgone\b")


def _whether(told: Told) -> Answer | None:
    what, when = told.frame.what, told.frame.when
    deed = what.deed
    if deed is None:
        return None
    if what.subject is None or (deed.kind == "move" and _GONE.search(told.asked.said)):
        return None  # "is the vase gone": the scene at that time tells it
    if told.frame.other is not None and told.frame.asks == "yesno":
        return _before(told)
    if deed.kind in ("still", "move") and (state := state_asked(told)):
        return is_lit(told, state)
    if (
        deed.kind == "related"
        and deed.way != "stay"
        and (when is None or when.kind in ("at", "in", "start", "end", "middle"))
    ):
        return None  # the scene at that time tells it
    if deed.kind == "move" and deed.phase and what.at:
        return _there(told)
    window = told.window()
    if when is not None and when.kind == "end" and deed.kind not in STATES and _SOME_TIME.search(told.asked.said):
        window = None  # "does it finally close": at some time
    bodies = told.bodies()
    if told.frame.rank == "together":
        return _together(told, bodies, window)
    if told.frame.rank in PLACES:
        return _is_ranked(told, window)
    if when is not None and when.conj == "by" and deed.kind in STATES and window is not None:
        window = (window[1], window[1])
    if not bodies and (what.subject is None or not what.subject.last):
        return yes_no(deed.kind == "still", f"nothing {'moves' if deed.kind == 'still' else verb(told)}.", [])
    always = when.kind == "always" if when is not None else deed.way == "stay"
    each = [(b, _holds(told, b, window, always)) for b in bodies]
    plural = what.subject is not None and is_plural(what.subject) and what.subject.pick == "all"
    plural = plural or (deed.kind == "still" and what.subject is not None and is_anything(what.subject))
    holds = all(ok for _, (ok, _) in each) if plural else any(ok for _, (ok, _) in each)
    if what.subject is not None and what.subject.count is not None and what.subject.count > 1:
        holds = sum(ok for _, (ok, _) in each) >= what.subject.count  # "do two books fall"
    single = what.subject is not None and bool(what.subject.text) and what.subject.pick == "one"
    if single and len({ok for _, (ok, _) in each}) > 1:
        raise Untold(f"That holds of {listed([b.name for b, (ok, _) in each if ok])} only. Say which one is meant.")
    holds = holds != what.denied
    time = window[0] if window is not None else next((s[0][0] for _, (ok, s) in each if ok and s), None)
    return yes_no(holds, _sentence(told, each, window), [b for b, _ in each], time, told.others())


def _together(told: Told, bodies: Sequence[Body], window: Span | None) -> Answer:
    """Whether several do it at the same time."""
    each = [(b, within(told.spans(b), window)) for b in bodies]
    pairs = [(common(x, y), a, b) for i, (a, x) in enumerate(each) for b, y in each[i + 1 :]]
    both = next(((shared, a, b) for shared, a, b in pairs if shared), None)
    said = "; ".join(f"{b.name} {verb(told)} {spoken(s)}" for b, s in each if s)
    return yes_no(both is not None, f"{said or 'nothing does that'}.", bodies, both[0][0][0] if both else None)


def _is_ranked(told: Told, window: Span | None) -> Answer:
    """ "Is the blue book the last to fall?"."""
    deed, body = told.frame.what.deed, told.one()
    assert deed is not None
    found = sorted(
        (moment(deed, s[0]), b.name, b)
        for b in told.timeline.movers(told.survey)
        if (s := within(told.spans(b) if told.spans(b) else [], window))
    )
    place = PLACES[told.frame.rank]
    if not found or place >= len(found):
        raise Untold(f"Only {listed([name for _, name, _ in found])} {verb(told)}.")
    text = "; ".join(f"{name} {verb(told)} at {at(time)}" for time, name, _ in found)
    return yes_no(found[place][2] == body, f"{text}.", [body], found[place][0])


def _holds(told: Told, body: Body, window: Span | None, always: bool) -> tuple[bool, list[Span]]:
    """Whether a body does it in a window, and the spans in which it does at all."""
    deed, line, when = told.frame.what.deed, told.timeline, told.frame.when
    assert deed is not None
    if not body.moving and (deed.kind in ("open", "close") or deed.verb == "opened"):
        return False, []
    found = told.spans(body)
    if told.frame.rank == "again":
        later = [s for s in found if s[0] > line.start + 1e-3]
        found = later if deed.kind in STATES else found[1:] if _repeats(deed) else found
    if deed.stops:
        found = [(b, b) for _, b in found if b < line.stop - 1e-3]
    elif deed.starts:
        found = [(a, a) for a, _ in found]
    if always:
        return sum(b - a for a, b in found) >= line.stop - line.start - _ROUND, found
    if window is None:
        if deed.kind == "still" and not (when is not None and when.kind == "ever"):
            return not body.moving, found
        return bool(found), found
    if deed.at_once and deed.phase not in ("quarter", "half", "full"):
        a, b = window if when is None or when.kind != "end" else (line.start, line.stop)  # "has it stopped by the end"
        return any(a - _ROUND <= s[0] <= b + (_ROUND if a == b else 0) for s in found), found
    if deed.phase in ("quarter", "half"):
        return any(abs(s[0] - t) < _ROUND for s in found for t in window), found
    inside = within(found, window)
    if deed.kind in ("still", "is_open", "is_closed") and window[0] < window[1]:
        return sum(b - a for a, b in inside) >= (window[1] - window[0]) - _ROUND, found
    if window[0] < window[1]:
        least = min(_ROUND, 0.1 * (window[1] - window[0]))
        inside = [s for s in inside if s[1] - s[0] > least or s[0] == s[1]]
    return bool(inside), found


def _repeats(deed: Deed) -> bool:
    """Whether doing it again is to do it twice; closing again is only to be closed as before."""
    return not deed.stops and deed.kind not in ("close", "return", "fall")


def _sentence(told: Told, each: list[tuple[Body, tuple[bool, list[Span]]]], window: Span | None) -> str:
    said = []
    for body, (_, spans) in each[:8]:
        if spans and len(each) < 4:
            said.append(f"{body.name} {verb(told)} {spoken(spans)}")
        elif not body.moving:
            said.append(f"{body.name} does not move")
        else:
            said.append(f"{body.name} moves {spoken(body.moving)}")
    asked = f" (asked of {during(window)})" if window is not None else ""
    return f"{'; '.join(said)}{asked}."


def _there(told: Told) -> Answer | None:
    """ "Does it stop at the wall?": whether it is at the other thing when it stops or starts."""
    what, body, others = told.frame.what, told.one(), told.others()
    found = told.spans(body)
    if (
        not found
        or what.deed is None
        or what.at not in ("at", "near", "next to", "beside", "by", "against", "from", "close to", "on")
    ):
        return None
    time = moment(what.deed, found[-1 if what.deed.stops else 0])
    if what.at == "on":
        lying = spans_of(Deed("related", relation="on"), body, others, told.timeline, told.survey) or []
        near = any(a <= time <= b for a, b in lying)
    else:
        near = is_near(body, others, told.timeline, time)
    return yes_no(near != what.denied, f"{body.name} {verb(told)} at {at(time)}.", [body], time, others)


def _either(told: Told) -> Answer | None:
    """ "Is the door open or closed at 2 s?"."""
    first, second = told.frame.options
    if told.frame.options == ("before", "after"):
        given = _whether(told)
        said = first if given is not None and given.answer == "yes" else second
        text = "" if given is None else given.text.partition(", ")[2]
        return (
            None
            if given is None
            else given.model_copy(update={"answer": said, "answer_type": "label", "text": f"{cap(said)}: {text}"})
        )
    given = _whether(told)
    if given is None or given.answer is None:
        return given
    if second != "not":
        if told.frame.other is None:
            return None
        other = _whether(replace(told, frame=replace(told.frame, what=told.frame.other, other=None)))
        if other is None or other.answer == given.answer:
            raise Untold(f"It is not one of the two: {given.text.partition(', ')[2]}")
    said = first if given.answer == "yes" else f"not {first}" if second == "not" else second
    text = given.text.partition(", ")[2]
    return given.model_copy(update={"answer": said, "answer_type": "label", "text": cap(f"{said}: {text}")})


def _before(told: Told) -> Answer | None:
    """ "Does the red book fall before the green one?"."""
    first, second = told.frame.what, told.frame.other
    assert second is not None
    times, bodies = [], []
    for what in (first, second):
        body = told.one(what)
        found = told.spans(body, what)
        if not found or what.deed is None:
            raise Untold(cap(f"{body.name} never {verb(told, what)}."))
        times.append(moment(what.deed, found[0]))
        bodies.append(body)
    holds = times[0] < times[1] if told.frame.rank == "before" else times[0] > times[1]
    said = [f"{b.name} {verb(told, w)} at {at(t)}" for b, w, t in zip(bodies, (first, second), times, strict=True)]
    return yes_no(holds, f"{said[0]} and {said[1]}.", bodies, times[0])


EITHER = kind("which_state", "either", _either)
WHETHER = kind("whether_it_happens", "yesno", _whether)
