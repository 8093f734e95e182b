"""How things look for a while: "when is the plant yellow?", "how often does the lamp blink?", "what changes its
colour?", "is the vase ever hidden?"."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

from .....gaussians.motion.holding import Span, joined
from .....gaussians.motion.motion import Look
from ....grammar.tagging.words import bag
from ...answer import Answer
from ...candidates import is_plural
from ...kind import Asked, Kind
from ...reading.phrase_templates import templates
from ...survey import Survey, listed
from ...timeline.asked import PLACES, at, cap, evidence, nothing, number, spoken, yes_no
from ...timeline.bodies import Body, Timeline
from ...timeline.worn import hiding, looks_of, recoloring

_SOON = 1e-3  # seconds
_SHORTLY = 0.05  # seconds before and after a change
_BLINKS = 2  # times that something is hidden, at least, to blink

_BLINK = "(blink|flash|flicker|wink|blinks|flashes|flickers)"
_BLINKING = "(blinking|flashing|flickering) [on and off]"
_GONE = "(hidden|invisible|gone|away|missing|absent|out of sight|not there|not visible|not to be seen)"
_VANISH = "(disappear|vanish|disappears|vanishes|go away|goes away)"
_BECOME = "(turn|become|go|get|change|switch|turns|becomes|goes|gets|changes|switches) [back] [to|into] [being]"
_EVER = "[ever|at any time|at some point|at some time]"
_WHEN = "(when|(at|from) (what|which) (time|second|point|moment) [on]|what time)"
_LONG = "(how long|for how long|how many seconds|for how many seconds|how much time)"
_ALL = "(the whole time|all the time|throughout|all along|the entire time|from (start|beginning) to end|always)"
_DO, _IS = "(do|does|did|will|would)", "(is|are|was|were)"
_ONE = "(what|which thing|which things|which object|which objects|which one|which piece of furniture)"
_NTH = "[for] the (first|second|third|fourth|fifth|last) time"

_CHANGES = (
    "(it|they) (goes|turns|turned|went|becomes|became|changes|changed|is|was) [to|into] [{c:color}|color|its color]"
)

_WHENS = f"""
    {_WHEN} {_DO} {{x}} [first] {_BECOME} {{c:color}} [again]
    {_WHEN} {{x}} [first] {_BECOME} {{c:color}} [again]
    {_WHEN} {_DO} {{x}} change (its|their) (color|colors) to {{c:color}} [again]
    {_WHEN} {_IS} {{x}} [first] {{c:color}} [again]
    {_WHEN} {{x}} {_IS} {{c:color}} [again]
    {_WHEN} {_IS} {{x}} (painted|colored|recolored) {{c:color}}
    (until|till) (when|what time) {_IS} {{u}} {{c:color}}
    {_WHEN} {_DO} {{u}} (stop being|cease to be) {{c:color}}
    {_WHEN} {_IS} {{u}} no longer {{c:color}}
    {_WHEN} {_IS} {{v}} (back|visible again|there again|to be seen again|back again)
    {_WHEN} {_DO} {{v}} (come back|reappear|show up again|appear again)
    (until|till) (when|what time) {_IS} {{v}} {_GONE}
    {_WHEN} {_DO} {{b}} [start to|begin to] {_BLINK} [{_NTH}]
    {_WHEN} {{b}} (blinks|flashes|flickers) [{_NTH}]
    {_WHEN} {_IS} {{g}} {_GONE} [{_NTH}]
    {_WHEN} {{g}} {_IS} {_GONE} [{_NTH}]
    {_WHEN} {{g}} {_VANISH} [{_NTH}]
    {_WHEN} {_DO} {{g}} {_VANISH} [{_NTH}]
    [{_WHEN} is] [what is] [the] time of {{b}} 's (first|second|third|fourth|fifth|last) (blink|flash|flicker)
    {_WHEN} {_IS} {{b}} 's (first|second|third|fourth|fifth|last) (blink|flash|flicker)
"""
_LONGS = f"""
    {_LONG} {_IS} {{x}} {{c:color}} [for]
    {_LONG} {_DO} {{x}} (stay|remain|keep|look) {{c:color}} [for]
    {_LONG} {{x}} (is|are|stays|stay|remains|remain|keeps) {{c:color}} [for]
    {_LONG} {_IS} {{e}} {_GONE} (each time [it {_BLINK}]|every time [it {_BLINK}]|at a time|per blink)
    {_LONG} {_DO} {{e}} {_BLINK} (each time|every time|at a time)
    {_LONG} (does|is) each (blink|flash|flicker) of {{e}} [last|take]
    {_LONG} {_DO} {{b}} {_BLINK} [for]
    {_LONG} {_IS} {{g}} {_GONE} [for] [in total|altogether]
    {_LONG} {_DO} {{g}} (stay|remain) {_GONE} [for]
    {_LONG} {{g}} (is|are|stays|stay|remains|remain) {_GONE} [for]
"""
_OFTENS = f"""
    how (often|many times) {_DO} {{x}} [turn|become|go] {{c:color}}
    how (often|many times) {_IS} {{x}} {{c:color}}
    how (often|many times) {_DO} {{b}} {_BLINK}
    how (often|many times) {_DO} {{g}} {_VANISH}
    how (often|many times) {_IS} {{g}} {_GONE}
    how (often|many times) {_DO} {{r}} change [its|their] (color|colors|look)
    how many (things|objects) (change|changes) [their|its] (color|colors|look)
    how many (things|objects) {_BLINK}
    how many (things|objects) (turn|become|go) {{c:color}}
"""
_WHETHERS = f"""
    {_DO} {{x}} {_EVER} {_BECOME} {{c:color}} {_EVER}
    {_IS} {{x}} ever {{c:color}}
    {_IS} {{a}} (always) {{c:color}}
    {_DO} {{a}} (stay|remain|keep) {{c:color}} [{_ALL}]
    {_DO} {{b}} {_EVER} {_BLINK} {_EVER}
    {_IS} {{b}} {_EVER} {_BLINKING} {_EVER}
    {_IS} {{g}} ever {_GONE}
    {_DO} {{g}} ever {_VANISH}
    {_DO} {{r}} {_EVER} change [its|their] (color|colors|look) {_EVER} [at all]
"""
_WHATS = f"""
    {_ONE} (change|changes|changed) [its|their] (color|colors|look) [first|last]
    {_ONE} (is|was) [the] (first|last) [one|thing|object] to change [its] (color|look)
    [what is] the (first|last) (thing|object|one) to change [its] (color|look)
    {_ONE} ({_BLINK}|{_VANISH})
    {_ONE} (is|keeps|are|keep) {_BLINKING} [here|there|in (this|the) (scene|room|film|clip|video)]
    {_ONE} (is|are|gets|get) {_GONE} [for a while|at some time|at some point|for a time]
    {_ONE} (turns|becomes|goes|turn|become|go) {{c:color}}
"""
_COLORS = f"""
    (what|which) color {_DO} {{x}} (turn|become|go|get|change) [to|into]
    (what|which) color {{x}} (turns|becomes|goes|gets|changes) [to|into]
    (what|which) color {_IS} {{x}} before {_CHANGES}
    (what|which) color {_IS} {{x}} after {_CHANGES}
    (what|which) color {_DO} {{x}} have (before|after) {_CHANGES}
"""
_DOES = bag("do does did will would")
_FLICKERS = bag("blink blinks blinking flash flashes flashing flicker flickers flickering wink")
_PLACES = PLACES | {"fifth": 4}


Tell = Callable[[Asked, Timeline, Body, str, list[Span]], Answer]


def _of_spans(tell: Tell) -> Callable[[Asked, Survey], Answer | None]:
    """An answer about the spans in which one thing looks so, of which there are some."""

    def answer(asked: Asked, survey: Survey) -> Answer | None:
        line = asked.timeline
        if line is None or (found := _found(asked, survey, line)) is None:
            return None
        body, how, spans = found
        if not spans:
            return nothing(cap(f"{body.name} is never {how}."), "number", [body])
        return tell(asked, line, body, how, spans)

    return answer


@_of_spans
def _when(asked: Asked, line: Timeline, body: Body, how: str, spans: list[Span]) -> Answer:
    begun = [s for s in spans if s[0] > line.start + _SOON]
    again = "again" in asked.words
    if {"u", "v"} & asked.slots.keys():
        ended = [s for s in spans if s[1] < line.stop - _SOON]
        if not ended:
            return nothing(cap(f"{body.name} is {how} to the end: {spoken(spans)}."), "number", [body])
        return number(ended[0][1], "s", cap(f"{body.name} is {how} {spoken(spans)}."), [body], ended[0][1])
    if {"b", "g"} & asked.slots.keys() and (place := next((_PLACES[w] for w in asked.words if w in _PLACES), 0)):
        if place >= len(spans):
            return nothing(cap(f"{body.name} is {how} {_times(spans)}."), "number", [body])
        return number(spans[place][0], "s", cap(f"{body.name} is {how} {spoken(spans)}."), [body], spans[place][0])
    changes = not {"is", "are", "was", "were"} & set(asked.words)
    if changes and not begun:
        return nothing(cap(f"{body.name} is {how} from the start on: {spoken(spans)}."), "number", [body])
    chosen = (begun if again or changes else spans) or spans
    if again and len(spans) < 2:
        return nothing(cap(f"{body.name} is {how} once only: {spoken(spans)}."), "number", [body])
    first = chosen[0] if not again or spans[0][0] <= line.start + _SOON else chosen[1]
    return number(first[0], "s", cap(f"{body.name} is {how} {spoken(spans)}."), [body], first[0])


@_of_spans
def _long(asked: Asked, line: Timeline, body: Body, how: str, spans: list[Span]) -> Answer:
    if "e" in asked.slots:
        seconds = sum(b - a for a, b in spans) / len(spans)
        return number(seconds, "s", f"{at(seconds)}: {body.name} is {how} {spoken(spans)}.", [body], spans[0][0])
    if "b" in asked.slots:
        spans, how = [(spans[0][0], spans[-1][1])], "blinking"
    seconds = sum(b - a for a, b in spans)
    return number(seconds, "s", f"{at(seconds)}: {body.name} is {how} {spoken(spans)}.", [body], spans[0][0])


def _often(asked: Asked, survey: Survey) -> Answer | None:
    line = asked.timeline
    if line is None:
        return None
    if not asked.slots or set(asked.slots) == {"c"}:
        each, done = _each(asked, survey, line)
        told = f": {listed([b.name for b, _ in each])}" if each else ""
        return number(float(len(each)), "", f"{len(each)} {done}{told}.", [b for b, _ in each])
    if "r" in asked.slots:
        body = line.one(asked.slots["r"], survey)
        changes = len(_recolored(line, body))
        text = f"{body.name} changes its look {changes} time{'' if changes == 1 else 's'}."
        return number(float(changes), "", cap(text), [body])
    if (found := _found(asked, survey, line)) is None:
        return None
    body, how, spans = found
    return number(float(len(spans)), "", cap(f"{body.name} is {how} {_times(spans)}."), [body])


def _whether(asked: Asked, survey: Survey) -> Answer | None:
    line = asked.timeline
    if line is None:
        return None
    if "r" in asked.slots:
        body = line.one(asked.slots["r"], survey)
        edges = _recolored(line, body)
        told = f"changes its look at {listed([at(t) for t in edges])}" if edges else "does not change its colour"
        return yes_no(bool(edges), f"{body.name} {told}.", [body])
    if (found := _found(asked, survey, line)) is None:
        return None
    body, how, spans = found
    told = f"{body.name} is {how} {spoken(spans)}." if spans else f"{body.name} is never {how}."
    if "a" in asked.slots:
        whole = bool(spans) and spans[0][0] <= line.start + _SOON and spans[0][1] >= line.stop - _SOON
        return yes_no(whole, told, [body])
    if "c" in asked.slots and asked.words[0] in _DOES:  # it becomes so
        return yes_no(any(s[0] > line.start + _SOON for s in spans), told, [body])
    return yes_no(bool(spans), told, [body])


def _color(asked: Asked, survey: Survey) -> Answer | None:
    """The colour that a thing has before its colour changes, or behind that."""
    line = asked.timeline
    if line is None or is_plural(asked.slots["x"]):
        return None
    body = line.one(asked.slots["x"], survey)
    edges = _recolored(line, body)
    if (color := asked.slots.get("c")) is not None:
        edges = [s[0] for s in _colored(line, body, survey, color) if s[0] > line.start + _SOON]
    if body.thing is None or not edges:
        return nothing(cap(f"{body.name} does not change its colour{'' if color is None else ' so'}."), "label", [body])
    time = edges[0] - _SHORTLY if "before" in asked.words else edges[0] + _SHORTLY
    thing = next((t for t in line.survey_at(time).things if t.id == body.thing.id), None)
    if thing is None or not thing.color:
        return None
    text = f"{body.name} is {thing.color} at {at(time)}; its colour changes at {at(edges[0])}."
    return Answer(
        answer=thing.color, answer_type="label", text=cap(text), confidence=0.9, evidence=evidence([body], time)
    )  # fmt: skip


def _what(asked: Asked, survey: Survey) -> Answer | None:
    line = asked.timeline
    if line is None:
        return None
    found, done = _each(asked, survey, line)
    if not found:
        return nothing(f"Nothing {done}.", "label")
    if (place := next((_PLACES[w] for w in asked.words if w in _PLACES), None)) is not None:
        found = [sorted(found, key=lambda each: each[1][place][0])[place]]
    told = "; ".join(f"{body.name} {done} {spoken(spans)}" for body, spans in found)
    labels = tuple(body.label for body, _ in found)
    return Answer(
        answer=labels[0] if len(labels) == 1 else labels, answer_type="label" if len(labels) == 1 else "list",
        text=cap(f"{told}."), confidence=0.95, evidence=evidence([body for body, _ in found], found[0][1][0][0]),
    )  # fmt: skip


def _each(asked: Asked, survey: Survey, line: Timeline) -> tuple[list[tuple[Body, list[Span]]], str]:
    """The things that look so for a while, with when, and what they do in words."""
    color = asked.slots.get("c")
    hidden = color is None and not {"color", "colors", "look"} & set(asked.words)
    done = "is hidden" if hidden else f"turns {color}" if color else "changes its colour"
    found = list[tuple[Body, list[Span]]]()
    for thing in survey.things:
        if not looks_of(line, line.groups(thing)[0]):
            continue
        body = line.body(thing, survey)
        if hidden:
            spans = _hidden(line, body)
        elif color is not None:
            spans = [s for s in _colored(line, body, survey, color) if s[0] > line.start + _SOON]
        else:
            spans = [(t, t) for t in _recolored(line, body)]
        if len(spans) >= (_BLINKS if _FLICKERS & set(asked.words) else 1):
            found.append((body, spans))
    return found, done


def _times(spans: Sequence[Span]) -> str:
    """How often, and when: "2 times: from 1 s to 2 s and at 3 s"."""
    told = f": {spoken(spans)}" if spans else ""
    return f"{len(spans)} time{'' if len(spans) == 1 else 's'}{told}"


def _found(asked: Asked, survey: Survey, line: Timeline) -> tuple[Body, str, list[Span]] | None:
    """What a question is about, how it looks then, and when it looks so; None if it is about several."""
    slots = asked.slots
    query = next((slots[name] for name in "xuabgve" if name in slots), None)
    if query is None or is_plural(query):
        return None
    body = line.one(query, survey)
    if "c" in slots:
        return body, slots["c"], _colored(line, body, survey, slots["c"])
    spans = _hidden(line, body)
    return body, "hidden", [] if "b" in slots and len(spans) < _BLINKS else spans


def _colored(line: Timeline, body: Body, survey: Survey, color: str) -> list[Span]:
    """The spans in which a thing has a colour."""
    if body.thing is None:
        return []
    edges = [line.start, *_edges(line, looks_of(line, body.group.id)), line.stop]
    found = list[Span]()
    for start, stop in itertools.pairwise(edges):
        there = line.survey_at((start + stop) / 2) if len(edges) > 2 else survey
        thing = next((t for t in there.things if t.id == body.thing.id), None)
        if thing is not None and there.has_color(thing, color):
            found.append((start, stop))
    return joined(found, _SOON)


def _hidden(line: Timeline, body: Body) -> list[Span]:
    """The spans in which a thing is hidden."""
    looks = hiding(line, body.group.id)
    spans = [(max(look.start, line.start), min(look.stop, line.stop)) for look in looks]
    return joined(sorted(span for span in spans if span[0] < span[1]), _SOON)


def _recolored(line: Timeline, body: Body) -> list[float]:
    """The times at which a thing gets other colours."""
    return _edges(line, recoloring(line, body.group.id))


def _edges(line: Timeline, looks: Sequence[Look]) -> list[float]:
    """The times within the film at which looks begin or end, ascending."""
    return sorted({t for look in looks for t in (look.start, look.stop) if line.start < t < line.stop})


WHEN_SEEN = Kind("when_it_looks", templates(_WHENS), _when)
LONG_SEEN = Kind("how_long_it_looks", templates(_LONGS), _long)
OFTEN_SEEN = Kind("how_often_it_looks", templates(_OFTENS), _often)
WHETHER_SEEN = Kind("whether_it_looks", templates(_WHETHERS), _whether)
WHAT_SEEN = Kind("what_looks", templates(_WHATS), _what)
COLOR_SEEN = Kind("what_color_then", templates(_COLORS), _color)
KINDS = (COLOR_SEEN, WHEN_SEEN, LONG_SEEN, OFTEN_SEEN, WHETHER_SEEN, WHAT_SEEN)
