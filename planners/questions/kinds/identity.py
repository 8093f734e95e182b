"""What a numbered thing is: "what is object 7?", "describe number 3"."""

from __future__ import annotations

from ..answer import Answer
from ..kind import Asked, Kind
from ..measuring import told_size
from ..reading.noun_phrase import BY_ID
from ..reading.phrase_templates import templates
from ..resolving import meant
from ..survey import Survey, with_article
from ..telling import label

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


def answer(asked: Asked, survey: Survey) -> Answer | None:
    """The label of the thing with this number."""
    if not asked.slots["x"].text.startswith(f"{BY_ID} "):
        return None
    (thing,) = meant(survey, asked.slots["x"]).things
    if not thing.label:
        return None
    color = f"{thing.color} " if thing.color else ""
    text = f"Number {thing.id} is {with_article(color + thing.name)}, {told_size(survey, thing)}."
    return label(thing, text, 0.85 if survey.measured else 0.98)


KIND = Kind("what it is", templates(_PHRASES), answer)
