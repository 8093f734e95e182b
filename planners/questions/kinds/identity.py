"""What a thing is that is told by its number, its looks or a click: "what is object 7?", "what is the black thing?",
"what is this?"."""

from __future__ import annotations

from ..answer import Answer
from ..kind import Asked, Kind
from ..measuring import told_size
from ..reading.noun_phrase import BY_ID, is_unnamed
from ..reading.phrase_templates import templates
from ..resolving import meant
from ..survey import Survey, with_article
from ..telling import GRAPH_SURE, label, things_listed

_PHRASES = """
    what (is|are|was|kind of thing is|sort of thing is|type of thing is|object is|thing is) {x} [called]
    what is the (name|label|identity|kind) of {x}
    what is {x} 's (name|label)
    (describe|identify|explain|name) {x}
    what does {x} (show|mean|refer to|stand for)
    what (thing|object|kind of object|sort of object) (has|carries) {x}
    {x} is what
    which (thing|object) is {x}
"""
_ACCOUNT = frozenset({"describe", "explain"})  # of "it" more is told than its name (describe.py)


def answer(asked: Asked, survey: Survey) -> Answer | None:
    """The label of the thing with this number, of "it", or of what is described without its name: "the black thing"."""
    query = asked.slots["x"]
    numbered = query.text.startswith(f"{BY_ID} ")
    pointed = query.last and not _ACCOUNT & set(asked.words)
    described = pointed or (is_unnamed(query) and (query.colors or query.size) and not query.groups)
    if not numbered and not described:
        return None
    phrase = meant(survey, query)
    things = [t for t in phrase.things if t.label]
    if len(things) > 1 and not phrase.plural:
        raise phrase.differ()
    if not things:
        return None
    if len(things) > 1:
        return things_listed(things, f"That is {survey.counted(things)}.")
    (thing,) = things
    color = f"{thing.color} " if thing.color else ""
    subject = f"Number {thing.id}" if numbered else "That"
    text = f"{subject} is {with_article(color + thing.name)}, {told_size(survey, thing)}."
    return label(thing, text, 0.85 if survey.measured else GRAPH_SURE)


KIND = Kind("what it is", templates(_PHRASES), answer)
