"""How things look for a while: "when is the plant yellow?", "how often does the lamp blink?", "what changes its
colour?", "is the vase ever hidden?"."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from .....gaussians.language.field.group_index import index_groups
from .....gaussians.motion.holding import Span, joined
from .....gaussians.motion.motion import Look
from ...answer import Answer
from ...candidates import is_plural
from ...kind import Asked, Kind
from ...reading.phrase_templates import templates
from ...survey import Survey, listed
from ...timeline.asked import at, cap, evidence, nothing, number, spoken, yes_no
from ...timeline.bodies import Body, Timeline

_MOST = 0.5  # of a thing's Gaussians: when more than these look otherwise, it does
_SOON = 1e-3  # seconds

_BLINK = "(blink|flash|flicker|wink|blinks|flashes|flickers)"
_GONE = "(hidden|invisible|gone|away|out of sight|not there|not visible|not to be seen)"
_BECOME = "(turn|become|go|get|change to|change into|turn to|turn into|change ITS to|switch to)"
_EVER = "[ever|at any time|at some point|at some time]"
_WHEN = "(when|at what time|at which time|at what second|at which second|what time)"
_LONG = "(how long|for how long|how many seconds|for how many seconds|how much time)"
_ALL = (
    "(the whole time|all the time|throughout|all along|the entire time|from start to end|from beginning to end|always)"
)

_WHENS = f"""
    {_WHEN} (do|does|did|will|would) {{x}} [first] (turn|become|go|get|change|switch) [to|into] {{c:color}} [again]
    {_WHEN} (do|does|did|will) {{x}} change (its|their) (color|colors) to {{c:color}} [again]
    {_WHEN} (is|are|was|were) {{x}} [first] {{c:color}} [again]
    {_WHEN} (is|are|was|were) {{x}} (painted|colored|recolored) {{c:color}}
    (until|till) (when|what time) (is|are|was|were) {{u}} {{c:color}}
    {_WHEN} (do|does|did|will) {{u}} (stop being|cease to be) {{c:color}}
    {_WHEN} (is|are|was|were) {{u}} no longer {{c:color}}
    {_WHEN} (do|does|did|will) {{b}} [start to|begin to] {_BLINK}
    {_WHEN} (is|are|was|were) {{g}} {_GONE}
"""
_LONGS = f"""
    {_LONG} (is|are|was|were) {{x}} {{c:color}}
    {_LONG} (do|does|did|will) {{x}} (stay|remain|keep|look) {{c:color}}
    {_LONG} (do|does|did|will) {{b}} {_BLINK}
    {_LONG} (is|are|was|were) {{g}} {_GONE}
    {_LONG} (do|does|did|will) {{g}} (stay|remain) {_GONE}
"""
_OFTENS = f"""
    how (often|many times) (do|does|did|will) {{x}} [turn|become|go] {{c:color}}
    how (often|many times) (is|are|was|were) {{x}} {{c:color}}
    how (often|many times) (do|does|did|will) {{b}} {_BLINK}
    how (often|many times) (do|does|did|will) {{g}} (disappear|vanish)
    how (often|many times) (is|are|was|were) {{g}} {_GONE}
    how (often|many times) (do|does|did|will) {{r}} change [its|their] (color|colors|look)
"""
_WHETHERS = f"""
    (do|does|did|will) {{x}} {_EVER} (turn|become|go|get|change to|turn to) {{c:color}} {_EVER}
    (is|are|was|were) {{x}} ever {{c:color}}
    (is|are|was|were) {{a}} (always) {{c:color}}
    (do|does|did|will) {{a}} (stay|remain|keep) {{c:color}} [{_ALL}]
    (do|does|did|will) {{b}} {_EVER} {_BLINK} {_EVER}
    (is|are|was|were) {{b}} {_EVER} (blinking|flashing|flickering) {_EVER}
    (is|are|was|were) {{g}} ever {_GONE}
    (do|does|did|will) {{r}} {_EVER} change [its|their] (color|colors|look) {_EVER}
"""
_WHATS = f"""
    (what|which thing|which things|which object|which objects) (change|changes|changed) [its|their] (color|colors|look)
    (what|which thing|which things|which object|which objects) ({_BLINK}|disappears|vanishes|disappear|vanish)
    (what|which thing|which things|which object|which objects) (is|are|gets|get) {_GONE} [for a while|at some time|\
        at some point|for a time]
    (what|which thing|which things|which object|which objects) (turns|becomes|goes|turn|become|go) {{c:color}}
"""


def _when(asked: Asked, survey: Survey) -> Answer | None:
    line = asked.timeline
    if line is None or (found := _found(asked, survey, line)) is None:
        return None
    body, how, spans = found
    if not spans:
        return nothing(cap(f"{body.name} is never {how}."), "number", [body])
    begun = [s for s in spans if s[0] > line.start + _SOON]
    again = "again" in asked.words
    if "u" in asked.slots:
        ended = [s for s in spans if s[1] < line.stop - _SOON]
        if not ended:
            return nothing(cap(f"{body.name} is {how} to the end: {spoken(spans)}."), "number", [body])
        return number(ended[0][1], "s", cap(f"{body.name} is {how} {spoken(spans)}."), [body], ended[0][1])
    changes = "is" not in asked.words and "are" not in asked.words
    chosen = (begun if again or changes else spans) or spans
    if again and len(spans) < 2:
        return nothing(cap(f"{body.name} is {how} once only: {spoken(spans)}."), "number", [body])
    first = chosen[0] if not again or spans[0][0] <= line.start + _SOON else chosen[1]
    return number(first[0], "s", cap(f"{body.name} is {how} {spoken(spans)}."), [body], first[0])


def _long(asked: Asked, survey: Survey) -> Answer | None:
    line = asked.timeline
    if line is None or (found := _found(asked, survey, line)) is None:
        return None
    body, how, spans = found
    if not spans:
        return nothing(cap(f"{body.name} is never {how}."), "number", [body])
    if "b" in asked.slots:
        spans, how = [(spans[0][0], spans[-1][1])], "blinking"
    seconds = sum(b - a for a, b in spans)
    return number(seconds, "s", f"{at(seconds)}: {body.name} is {how} {spoken(spans)}.", [body], spans[0][0])


def _often(asked: Asked, survey: Survey) -> Answer | None:
    line = asked.timeline
    if line is None:
        return None
    if "r" in asked.slots:
        body = line.one(asked.slots["r"], survey)
        changes = sum(line.start < t < line.stop for t in _edges(_looks(line, body, colors=True)))
        text = f"{body.name} changes its look {changes} time{'' if changes == 1 else 's'}."
        return number(float(changes), "", cap(text), [body])
    if (found := _found(asked, survey, line)) is None:
        return None
    body, how, spans = found
    times = f"{len(spans)} time{'' if len(spans) == 1 else 's'}"
    told = f": {spoken(spans)}" if spans else ""
    return number(float(len(spans)), "", cap(f"{body.name} is {how} {times}{told}."), [body])


def _whether(asked: Asked, survey: Survey) -> Answer | None:
    line = asked.timeline
    if line is None:
        return None
    if "r" in asked.slots:
        body = line.one(asked.slots["r"], survey)
        edges = [t for t in _edges(_looks(line, body, colors=True)) if line.start < t < line.stop]
        told = f"changes its look at {listed([at(t) for t in edges])}" if edges else "does not change its colour"
        return yes_no(bool(edges), f"{body.name} {told}.", [body])
    if (found := _found(asked, survey, line)) is None:
        return None
    body, how, spans = found
    told = f"{body.name} is {how} {spoken(spans)}." if spans else f"{body.name} is never {how}."
    if "a" in asked.slots:
        whole = bool(spans) and spans[0][0] <= line.start + _SOON and spans[0][1] >= line.stop - _SOON
        return yes_no(whole, told, [body])
    if "c" in asked.slots and "ever" not in asked.words:
        return yes_no(any(s[0] > line.start + _SOON for s in spans), told, [body])
    return yes_no(bool(spans), told, [body])


def _what(asked: Asked, survey: Survey) -> Answer | None:
    line = asked.timeline
    if line is None:
        return None
    color = asked.slots.get("c")
    hidden = color is None and not {"color", "colors", "look"} & set(asked.words)
    looks = line.scene.motion.looks if line.scene.motion is not None else ()
    found = list[tuple[Body, list[Span]]]()
    for thing in survey.things:
        body = line.body(thing, survey)
        if not any(_worn(line, body, look) for look in looks):
            continue
        if hidden:
            spans = _hidden(line, body)
        elif color is not None:
            spans = [s for s in _colored(line, body, survey, color) if s[0] > line.start + _SOON]
        else:
            edges = _edges(_looks(line, body, colors=True))
            spans = [(t, t) for t in edges if line.start < t < line.stop]
        if spans:
            found.append((body, spans))
    done = "is hidden" if hidden else f"turns {color}" if color else "changes its colour"
    if not found:
        return nothing(f"Nothing {done}.", "label")
    told = "; ".join(f"{body.name} {done} {spoken(spans)}" for body, spans in found)
    names = tuple(body.label for body, _ in found)
    bodies = [body for body, _ in found]
    return Answer(
        answer=names[0] if len(names) == 1 else names, answer_type="label" if len(names) == 1 else "list",
        text=cap(f"{told}."), confidence=0.95, evidence=evidence(bodies, found[0][1][0][0]),
    )  # fmt: skip


def _found(asked: Asked, survey: Survey, line: Timeline) -> tuple[Body, str, list[Span]] | None:
    """What a question is about, how it looks then, and when it looks so; None if it is about several."""
    slots = asked.slots
    query = next((slots[name] for name in "xuabg" if name in slots), None)
    if query is None or is_plural(query):
        return None
    body = line.one(query, survey)
    if "c" in slots:
        return body, slots["c"], _colored(line, body, survey, slots["c"])
    return body, "hidden", _hidden(line, body)


def _colored(line: Timeline, body: Body, survey: Survey, color: str) -> list[Span]:
    """The spans in which a thing has a colour."""
    if body.thing is None:
        return []
    edges = sorted({line.start, line.stop, *(t for t in _edges(_looks(line, body)) if line.start < t < line.stop)})
    found = list[Span]()
    for start, stop in itertools.pairwise(edges):
        there = line.survey_at((start + stop) / 2) if len(edges) > 2 else survey
        thing = next((t for t in there.things if t.id == body.thing.id), None)
        if thing is not None and there.has_color(thing, color):
            found.append((start, stop))
    return joined(found, _SOON)


def _hidden(line: Timeline, body: Body) -> list[Span]:
    """The spans in which a thing is hidden."""
    spans = [
        (max(look.start, line.start), min(look.stop, line.stop))
        for look in _looks(line, body)
        if look.opacities is not None and float((look.opacities == 0).float().mean()) > _MOST
    ]
    return joined(sorted(spans), _SOON)


def _looks(line: Timeline, body: Body, colors: bool = False) -> list[Look]:
    """The looks that most of a thing has at some time; of colours only, or all."""
    motion = line.scene.motion
    assert motion is not None
    return [look for look in motion.looks if (look.sh is not None or not colors) and _worn(line, body, look)]


def _worn(line: Timeline, body: Body, look: Look) -> bool:
    """Whether most of a thing has a look."""
    assert line.scene.language is not None
    ids = index_groups(line.scene.cloud).ids_of(line.scene.language.leaves(body.group.id)).cpu().numpy()
    return len(ids) > 0 and bool(np.isin(ids, look.ids).mean() > _MOST)


def _edges(looks: Sequence[Look]) -> list[float]:
    """The times at which looks begin or end, ascending."""
    return sorted({t for look in looks for t in (look.start, look.stop)})


WHEN_SEEN = Kind("when_it_looks", templates(_WHENS), _when)
LONG_SEEN = Kind("how_long_it_looks", templates(_LONGS), _long)
OFTEN_SEEN = Kind("how_often_it_looks", templates(_OFTENS), _often)
WHETHER_SEEN = Kind("whether_it_looks", templates(_WHETHERS), _whether)
WHAT_SEEN = Kind("what_looks", templates(_WHATS), _what)
KINDS = (WHEN_SEEN, LONG_SEEN, OFTEN_SEEN, WHETHER_SEEN, WHAT_SEEN)
