"""Lists and tables of things: "what things are there?", "name all red things", "make a table of the chairs"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ....gaussians.language.query.query import Query
from ..answer import Answer
from ..kind import Asked, Kind
from ..measuring import sides
from ..reading import families
from ..reading.noun_phrase import is_anything
from ..reading.noun_phrase import thing as noun_phrase
from ..reading.phrase_templates import templates
from ..resolving import all_of
from ..survey import NotResolved, Survey, Thing, be, listed
from ..telling import GRAPH_SURE, absent_text, evidence

_ALL = (
    "[all|all of|every|everything that is|each of|each|me|the names of|of all|a list of|an overview of|the following]"
)
_HERE = (
    "[here|in here|in the room|there|around here|that there is|that there are|that you can see|"
    "that you see|that we have|in view|present|visible]"
)
_SEE = "(see|find|spot|have|identify|notice|make out|recognize|detect|got)"
_WHO = "(you|we|i|they|one)"
_ROOM = "(the room|this room|it|this place|the scene|this scene|this)"
_WITH = "(with|including|and|along with|showing|giving|of|by|together with)"
_ATTRIBUTES = "[their|the|its|all|all their] {cols:columns} [each|of each|for each]"
_PHRASES = f"""
    (make|give|show|draw|create|build|produce|print|write|list|provide|generate) [me|us|up] (a|the) table (of|with|\
        for|listing|showing) {_ALL} {{x}} {_HERE} {_WITH} {_ATTRIBUTES}
    (make|give|show|draw|create|build|produce|print|write|list|provide|generate) [me|us|up] (a|the) table (of|with|\
        for|listing|showing) {_ATTRIBUTES} of {_ALL} {{x}} {_HERE}
    (make|give|show|draw|create|build|produce|print|write|list|provide|generate) [me|us|up] (a|the) table (of|with|\
        for|listing|showing) {_ALL} {{table}} {_HERE}
    (tabulate|a table of|table of) {_ALL} {{x}} {_HERE} {_WITH} {_ATTRIBUTES}
    (tabulate|a table of|table of) {_ATTRIBUTES} of {_ALL} {{x}} {_HERE}
    (tabulate|a table of|table of) {_ALL} {{table}} {_HERE}
    (put|show|list) {_ALL} {{table}} {_HERE} (in a table|as a table|in tabular form|in table form)
    (list|name|give|show|enumerate|tell) [me|us] {_ALL} {{x}} {_HERE} {_WITH} {_ATTRIBUTES}
    (list|name|give|show|enumerate|tell) [me|us] [the] {{cols:columns}} of {_ALL} {{x}} {_HERE}
    what are the {{several:columns}} of {_ALL} {{x}} {_HERE}
    [full|complete|an|a] (inventory|list) [of {_ALL} {{x}}] {_HERE}
    (what|which) [different|kinds of|kind of|sort of|sorts of|types of|type of|other] {{x}} (can|could) be (found|\
        seen|spotted) {_HERE}
    what (can|could) be (found|seen|spotted) {_HERE}
    (list|name|enumerate|itemize|inventory|catalog|catalogue|mention|recite|show|find|tell|give|identify) [out|up|off|\
        for me|me|us] {_ALL} {{x}} \
        {_HERE}
    (give|show|tell|write|provide|make) [me|us] (a list|an inventory|a catalog|the names|an enumeration|the list|an \
        overview) of {_ALL} {{x}} {_HERE}
    (list|name|give|show|tell) [me|us] (what|all that|everything that|everything|all) (is|there is|you see|you can \
        see|can be seen|we have) {_HERE}
    (list|name|enumerate|show|describe|inventory) [me] [all] [the] (contents|inventory|everything) (of|in) [the] \
        (room|scene|place)
    (list|name|enumerate|inventory) (the room|everything|all|it all)
    (what|which) [different|kinds of|kind of|sort of|sorts of|types of|type of|other] {{x}} (is|are) [there|here|in \
        here|in the room|present|visible|available|around|standing around|to be seen|to be found|in it|found|shown] \
        [to be seen|in the room|here]
    (what|which) [different|kinds of|kind of|sort of|sorts of|types of|type of|other] {{x}} (do|does|can|could|did|\
        has|have) ({_WHO}|{_ROOM}) [{_SEE}|contain|hold|include] {_HERE}
    (what|which) [different|kinds of|kind of|sort of|sorts of|types of|type of|other] {{x}} {_WHO} (have|see) {_HERE}
    (what|which) [else|all|different] (is|are|else is) (here|there|in here|in the room|in it|around|around here|\
        visible|present|to be seen|there in the room|all in here|all in the room|there to see|there to be seen|\
        located in the room|contained in the room|found in the room|in the scene)
    what (do|can|could) {_WHO} {_SEE} {_HERE}
    what (does|do|did) {_ROOM} (contain|have|hold|include|consist of|have in it|feature|offer)
    what (things|objects|items) make up the room
    what is the room (furnished|equipped|filled) with
    what all is {_HERE}
    {_ROOM} contains what
    what are {_ALL} {{things}} {_HERE}
    (where|what|on what|which things) (can|could|may) {_WHO} (sit|take a seat|have a seat|be seated) [down] \
      [on] {_HERE}
    (where|what) (can|could) people sit [down] [on] {_HERE}
    (what|which things) (gives|give|provides|emits|makes|produces|lights|light) [up] (light|the room|it) {_HERE}
    where does [the] light come from {_HERE}
    (what|where) (can|could|do|should) {_WHO} (put|store|keep) [my|our|the] (things|stuff|clothes|books|my things) \
        [in|away|on] {_HERE}
    (what|which) (type|kind|sort|types|kinds|sorts) of {{noun:noun}} (is|are|stands|hangs|lies) [there] {{place:place}}
    what (are|is) in there
    (what|which) {_ALL} {{x}} there (is|are)
"""


def answer(asked: Asked, survey: Survey) -> Answer | None:
    """The things, by label, and as a table where one is asked for."""
    slots = asked.slots
    query: Query = slots.get("x") or slots.get("table") or slots.get("things") or Query(pick="all")
    if "things" in slots and not is_anything(query):
        return None
    if not slots and (family := _family(asked)):
        query = Query(text=family, pick="all")
    if "noun" in slots:
        placed = noun_phrase((*slots["noun"], *slots["place"]))
        if placed is None:
            return None
        query = placed.model_copy(update={"pick": "all"})
    if query.last or query.pick not in ("one", "any", "all"):
        return None
    if query.pick == "one" and "table" not in slots and not {"list", "name", "all"} & set(asked.words):
        query = query.model_copy(update={"pick": "all"})
    things, found = all_of(survey, query)
    things = tuple(t for t in things if t.node is not None)[: query.count]
    if not things and {"cols", "several"} & slots.keys():
        raise NotResolved(query, found)
    if not things:
        return Answer(answer=(), answer_type="list", text=absent_text(survey, found.about or query, found),
                      confidence=0.93, evidence=evidence(found.near))  # fmt: skip
    columns: Sequence[str] = slots.get("cols") or slots.get("several") or ()
    if "table" in slots:
        columns = ("color", "width", "depth", "height", "x", "y", "z")
    verb = be(things)
    text = f"There {verb} {survey.counted(things)}."
    if columns:
        text = listed([_row_told(survey, t, columns) for t in things[:40]]) + "."
    return Answer(answer=tuple(t.name for t in things), answer_type="list", text=_up(text)[:4000],
                  confidence=0.9 if survey.measured else GRAPH_SURE, evidence=evidence(things),
                  table=tuple(_row(survey, t, columns) for t in things) if columns else ())  # fmt: skip


def _family(asked: Asked) -> str:
    """The family that a question without a noun asks for: "where can I sit?"."""
    words = set(asked.words)
    if words & {"sit", "seat", "seated"}:
        return families.SEAT
    if words & {"light", "lights"}:
        return families.LIGHT
    return families.STORAGE if words & {"store", "put", "keep"} else ""


def _row(survey: Survey, thing: Thing, columns: Sequence[str]) -> dict[str, Any]:
    """One row of the table: id and name, then the columns, lengths in metres."""
    width, depth, height = sides(survey, thing)
    x, y, z = thing.group.box.center
    on = thing.node.support if thing.node else ""
    values: dict[str, Any] = {"color": thing.color, "width": width, "depth": depth, "height": height, "x": x, "y": y,
                              "z": z, "on": on}  # fmt: skip
    row: dict[str, Any] = {"id": thing.id, "thing": thing.name}
    return row | {c: round(values[c], 3) if isinstance(values[c], float) else values[c] for c in columns}


def _row_told(survey: Survey, thing: Thing, columns: Sequence[str]) -> str:
    row = _row(survey, thing, columns)
    told = []
    if "color" in columns and thing.color:
        told.append(thing.color)
    if "width" in columns or "height" in columns:
        told.append(" × ".join(f"{row[c]:.2f}" for c in ("width", "depth", "height") if c in row) + " m")
    if "x" in columns:
        told.append(f"at ({row['x']:.2f}, {row['y']:.2f}, {row['z']:.2f})")
    return f"{survey.named(thing)} {', '.join(told)}"


def _up(text: str) -> str:
    return text[:1].upper() + text[1:]


KIND = Kind("list", templates(_PHRASES), answer)
