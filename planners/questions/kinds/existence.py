"""Whether there is such a thing: "is there a lamp on the desk?", "is there no clock?", "got a fireplace?"."""

from __future__ import annotations

from ....gaussians.language.query.query import Query
from ..answer import Answer
from ..kind import Asked, Kind
from ..reading.phrase_templates import templates
from ..resolving import all_of
from ..survey import Survey, Thing, be, listed
from ..telling import GRAPH_SURE, absent_text, bare, evidence, yes_no

_NAMED = 4  # things up to which each is told apart
_PLACE = "(the room|this room|it|this place|this scene|the scene|this|the house|there)"
_WHO = "(we|you|i|they|one|somebody|someone|people|he|she|the owner|the owners)"
_SEE = (
    "(have|see|find|spot|notice|make out|identify|detect|locate|discover|get|own|keep|recognize|find me|encounter|"
    "have got|come across|count on finding)"
)
_PHRASES = f"""
    {{x:some}}
    (is|are|was|were) there (no|not any|not a|not an) {{none}}
    [whether] there (is|are) (no|not any|not a|not an) {{none}}
    (is|are|does) {_PLACE} (lacking|missing|without|lack|miss|lack of) {{lacks}}
    (is|are) there not {{x}}
    (is|are|was|were|would|will|might|could) there [be] [also] {{x}}
    [whether] there (is|are|might be|would be) [also] {{x}}
    (does|do|has|did|have) {_PLACE} [not] [also] (have|contain|include|got|possess|hold|feature|come with|offer|hide) \
        {{x}}
    [whether] {_PLACE} (has|have|contains|includes|features|holds|offers|has got) {{x}}
    (do|can|could|would|did|does|will) {_WHO} [not] [also] {_SEE} {{x}}
    [whether] {_WHO} [can|could|would] [also] (have|has|see|find|spot|sees|have got|has got) {{x}}
    have {_WHO} [not] [also] (got|seen|found|spotted) {{x}}
    [see] (got|any|spot|see|seen|spotted|contains|has) {{x}}
    no {{none}}
    does (anyone|anybody|somebody|someone) (see|spot|notice) {{x}}
    BE {{x}} (here|in here|in the room|present|around|anywhere|in view|visible|part of the room|among the things|there|
    to be (found|seen)|(somewhere|anywhere) to be (found|seen)|in it) [in the room|in here|here]
    BE {{x}} [hanging|standing|lying|placed|located] in the room
    (can|could) {{x}} be (seen|found|spotted) [here|in here|in the room|anywhere]
    (does|do) {{x}} exist [here|in here|in the room]
    is the room (equipped|furnished|fitted) with {{x}}
    (does|do) {{x}} (appear|show up) [here|in here|in the room|anywhere]
    is one of the things [here|in the room] {{x}}
    where there (is|are) {{x}}
    (is|are|was|were) {{lacks}} [already|still|now] (gone|missing|hidden|invisible|absent|out of sight)
""".replace("|\n    to be", "|to be")


def answer(asked: Asked, survey: Survey) -> Answer:
    """Yes with what there is, or no with the nearest. "Is there no clock?" has "yes" where there is one, as people say.

    "Does the room lack a clock?" has "yes" where there is none.
    """
    name = next(iter(asked.slots))
    lacks = name == "lacks"
    query: Query = asked.slots[name]
    together = query.also and "or" not in asked.words
    parts = (query.model_copy(update={"also": ()}), *query.also) if together else (query,)
    found = [_there(survey, part) for part in parts]
    if (lacking := next((f for f in found if not f[1]), None)) is not None:
        missing, _, told = lacking
        near = evidence(survey.find(missing).near)
        none = yes_no(lacks, told, [], GRAPH_SURE - 0.02)
        return none.model_copy(update={"evidence": near})
    things = [t for _, each, _ in found for t in each]
    return yes_no(not lacks, _told(survey, query, things), things)


def _there(survey: Survey, query: Query) -> tuple[Query, tuple[Thing, ...], str]:
    """What a description finds, and that it finds nothing."""
    things, found = all_of(survey, query)
    if query.count is not None and things and len(things) != query.count:
        verb = be(things)
        return query, (), f"there {verb} {survey.counted(things)}."
    if things:
        return query, things, ""
    if query.also:
        names = " or ".join(bare(q) for q in (query.model_copy(update={"also": ()}), *query.also))
        return query, (), f"there is no {names} here."
    told = absent_text(survey, found.about or query, found)
    return query, (), told[0].lower() + told[1:]


def _told(survey: Survey, query: Query, things: list[Thing]) -> str:
    verb = be(things)
    named = [survey.named(t) for t in things]
    plain = {f"the {t.label}" for t in things}
    where = f": {listed(named)}" if len(things) <= _NAMED and not plain.issuperset(named) else ""
    return f"there {verb} {survey.counted(things)}{where}."


KIND = Kind("existence", templates(_PHRASES), answer)
