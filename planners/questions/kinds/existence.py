"""Whether there is such a thing: "is there a lamp on the desk?"."""

from __future__ import annotations

from ..answer import Answer, Evidence
from ..kind import Asked, Kind
from ..reading.phrase_templates import templates
from ..survey import Survey, listed

_PHRASES = """
    (is|are|was|were) there {x} [here|in here|in this room|in the room|in this scene|anywhere]
    [whether] there (is|are) {x} [here|in here|in this room|in the room|anywhere]
    (does|do|has|have) (the room|this room|it|this place|this scene) (have|contain|include|got) {x}
    (do|can|could) (we|you|i|they) (have|see|find|spot) {x} [here|in here|in this room|in the room|anywhere]
    [have] (we|you|i) got {x} [here|in here|in this room|in the room]
"""


def answer(asked: Asked, survey: Survey) -> Answer:
    """Yes with what there is, or no with the nearest."""
    query = asked.slots["x"]
    things = survey.all_of(query)
    said = query.describe().removeprefix("the ").removeprefix("every ").removeprefix("any ")
    if things:
        text = f"Yes, there {'is' if len(things) == 1 else 'are'} {survey.counted(things)}."
        return Answer(answer="yes", answer_type="yesno", text=text, evidence=Evidence(ids=tuple(t.id for t in things)))
    near = survey.find(query).near
    told = f" The nearest to that: {listed([survey.named(t) for t in near])}." if near else ""
    ids = tuple(t.id for t in near)
    return Answer(answer="no", answer_type="yesno", text=f"No, there is no {said}.{told}", evidence=Evidence(ids=ids))


KIND = Kind("existence", templates(_PHRASES), answer)
