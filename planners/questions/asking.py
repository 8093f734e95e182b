"""Answers a question from geometry: words to a filled template, and that to an answer.

text ──reading──► Asked ──kinds──► Answer     (source "none" if no kind of question reads it)

`route` also says whether somebody who sees pictures of the scene may answer what geometry could not.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ...gaussians import late_re as re
from ...gaussians.language.query.nested import with_queries
from ...gaussians.language.query.query import Query
from ...gaussians.world import kinds as world
from ...gaussians.world.words import singular
from ..grammar.tagging.words import bag
from ..grammar.timing.spoken import with_endings
from ..rooms.node import NodeId
from . import kinds
from .answer import Answer, AnswerType
from .kind import Asked, Kind, Undecided
from .reading.holes import READERS
from .reading.phrase_templates import Words
from .reading.restating import restated
from .reading.situation import Situation, read_situation
from .reading.time import several
from .reading.time.comparing import comparisons
from .reading.time.everyday import everyday
from .reading.time.frames import UNIT, plain
from .reading.time.happenings import thing
from .reading.time.loosely import loosely
from .reading.time.situated import situated
from .reading.time.sorting import sorted_events
from .reading.time.supposed.forms import Form, chance_of
from .reading.time.supposed.guards import SURE
from .reading.time.supposed.likely import goes_first
from .reading.time.supposed.plainly import LEAST, supposed
from .reading.words import plain_words
from .survey import NotResolved, Survey, Thing
from .telling import absent, absent_text, evidence
from .timeline import static
from .timeline.asked import STATIC, Untold, at, is_of_motion, nothing, spoken
from .timeline.bodies import Timeline
from .timeline.comparing import compared

NOT_READ = "this question is not understood"
_TRIED = 8  # candidates of an ambiguous phrase for which a question is answered one by one
_ONE_TIME = 0.2  # seconds: what happens so soon after another happens with it
_NEAR = 0.05  # relative difference up to which the answers for all candidates are one answer
_YES_NO = bag(
    "is are was were am does do did has have had can could will would should shall may might must whether there got any"
)
_OPEN = bag("what which where who whose whom how why when list name count describe show give")


@dataclass(frozen=True)
class Reading:
    """What geometry made of a question.

    Attributes:
        answer: the answer; its source is "none" where geometry has none.
        kind: name of the kind of question, "" if it was not read.
        sight: whether somebody who sees pictures of the scene may answer it instead; false of what was answered, and
            of what no picture shows ("who owns it?").
        restated: the plainer question that was answered instead, "" if the question was read as it stands.
    """

    answer: Answer
    kind: str = ""
    sight: bool = False
    restated: str = ""


@dataclass(frozen=True)
class _Attempt:
    """A filled template whose question could not be answered as it stands."""

    kind: Kind
    asked: Asked
    error: NotResolved


def answer(text: str, survey: Survey, timeline: Timeline | None = None) -> Answer:
    """The answer to a question as far as geometry gives one.

    A question that no kind reads has the answer None, the source "none" and `NOT_READ` in its text. A phrase that is
    absent or ambiguous is told with the nearest things or the candidates.

    Raises:
        UserError: the text is too long.
    """
    return route(text, survey, timeline).answer


def route(text: str, survey: Survey, timeline: Timeline | None = None) -> Reading:
    """The answer to a question as far as geometry gives one, and who may answer it otherwise.

    Args:
        timeline: what moves in the scene; None: it is static.

    Raises:
        UserError: the text is too long.
    """
    text = with_endings(_DECIMAL.sub(".", text))
    if timeline is None:
        found = _static(text, survey)
        told = found.kind == "" or (found.kind == "undecidable" and not found.sight)
        if told and found.answer.answer is None and is_of_motion(plain_words(text)):
            still = Answer(answer=None, answer_type="text", text=STATIC, confidence=0.9, source="none")
            return Reading(still, "motion")
        return found
    return _timed(situated(text), survey, timeline)


_DECIMAL = re.compile(r"(?<=\d),(?=\d{1,2}(?![\d,]))")  # "4,2 s", as much of the world writes it


def _timed(text: str, survey: Survey, timeline: Timeline) -> Reading:
    """The answer to a question about a scene with time: of its motion, else of the scene at a moment.

    Where its words tell a kind of question surely, and that has another answer, it is the answer.
    """
    said = everyday(" ".join(plain_words(text)))
    words, names = static.without_relative(tuple(said.split()), survey, timeline), _names(survey)
    found = _as_said(text, words, names, survey, timeline)
    if found is not None and found.answer.answer is not None:
        if (_OF_A_SORT.search(said) is not None and not found.restated) or found.kind in kinds.OF_LOOKS:
            return found  # "which wall is it at" wants a wall; how a thing looks is asked in few ways
        first = goes_first(text)
        strictly = not first and found.answer.answer != ()
        surer = _read_as(supposed(text, names, LEAST if first else SURE, strictly), survey, timeline)
        form = None if surer is not None or _offers(said, found) else _form(found)
        if form is not None and chance_of(text, form) < _HARDLY:
            likely = _read_as(supposed(text, names, _LIKELY), survey, timeline)
            surer = None if likely is None or _form(likely) == form else likely
        return found if surer is None or _agree(found.answer, surer.answer) else surer
    misread = found is None or found.answer.text.startswith(_MISREAD)
    for questions in _guesses(text, words, names, misread):
        if (guess := _read_as(questions, survey, timeline)) is not None:
            return guess
    if found is not None:
        return found
    none = Answer(answer=None, answer_type=expected_type(words), text=NOT_READ, confidence=0.0, source="none")
    return Reading(none, sight=True)


_OF_A_SORT = re.compile(r"\b(?:which|what) (?:wall|corner|side of)\b")


def _offers(said: str, told: Reading) -> bool:
    """Whether a question offers its answers: with "or", or for yes or no."""
    first = said.split(" ")[0]
    return " or " in said or (told.answer.answer_type == "yesno" and first in _YES_NO)


def _form(told: Reading) -> Form | None:
    """The form of an answer."""
    if told.answer.answer_type == "yesno":
        return "yesno"
    if told.answer.answer_type in ("number", "metres"):
        seconds: Form = "moment" if told.kind == "when" else "duration"
        return seconds if told.answer.unit == "s" else "number"
    return "name" if told.answer.answer_type in ("label", "list") else None


_HARDLY = 0.25  # probability of the form of an answer below which another reading is looked for
_LIKELY = 0.3  # that of a kind that is one, then


def _agree(one: Answer, other: Answer) -> bool:
    """Whether two answers are one: "rug", and "on the rug"."""
    a, b = one.answer, other.answer
    return (isinstance(a, str) and isinstance(b, str) and (a in b or b in a)) or _same([one, other]) is not None


def _as_said(text: str, words: Words, names: frozenset[str], survey: Survey, timeline: Timeline) -> Reading | None:
    """The answer to a question as it is put, or the first reason why there is none; None if nothing reads it."""
    for sentence in several.question_alone(text):
        if (told := _timed(sentence, survey, timeline)).answer.answer is not None:
            return told
    if (chosen := _chosen(words, survey, timeline)) is not None:
        return chosen
    if (in_order := _sorted(text, names, survey, timeline)) is not None:
        return in_order
    asked = Asked(text, words=words, timeline=timeline)
    other = _WHAT_IS_THERE.match(asked.said) or _BY_WHOM.match(asked.said)
    moved = None if other else _of_motion(asked, survey)
    if moved is not None and moved.answer.answer is not None:
        return moved
    for made in (_shared, _compared, _of_two):
        if (made_of := made(words, survey, timeline)) is not None:
            return made_of
    still = _of_moments(asked, survey, timeline)
    if still is not None and still.answer.answer is not None:
        return moved if still.restated and still.answer.answer == () else still
    return moved or still


_BY_WHOM = re.compile(  # "who turns off the fan", which no motion shows
    r"^who (?:\w+ )?(?:turn|switch|shut|power|cut|pull|push|open|close|move|stop|start|knock|throw|threw|kick)\w*"
    r"(?: (?:off|on|down|up|out|over|open|shut))? (?:the|this|that|my|those|these)\b"
)
_WHAT_IS_THERE = re.compile(
    r"^(?:what|which(?: \w+){1,3}?)(?: (?:is|are|stands?|sits?|hangs?|lies?))?(?: standing| located| there)? "
    rf"{static.IN_PLACE.pattern}(?: of the \w+)?$"
)


def _guesses(text: str, words: Words, names: frozenset[str], misread: bool) -> Iterator[Sequence[str]]:
    """Plainer questions that a question may mean, the surest first; fewer if it was read and only has no answer."""
    surely = supposed(text, names, SURE)
    yield surely
    if misread:
        said = plain(words)
        yield [guess for guess in loosely(said, names) if not _asks_for_named(guess, said)]
        if (likely := supposed(text, names)) != surely:
            yield likely


def _asks_for_named(question: str, said: str) -> bool:
    """Whether a question asks which ball it is, of words that name the ball."""
    found = re.match(r"which (\w+) ", question)
    return found is not None and _tells_of(found[1], said)


def _tells_of(noun: str, said: str) -> bool:
    """Whether words are about the thing with a noun: "the red ball"."""
    return re.search(rf"\bthe (?:\w+ )?{re.escape(noun)}\b", said) is not None


# How reasons begin where words may have been taken for what they are not: a name, a time.
_MISREAD = (
    "There is no ",
    "“",
    "It is not understood",
    "That does not happen here",
    "Geometry does not tell the state",
)


_NO_NUMBER = bag("is are was were does do did has have had will can list which who")  # first words
_ASKED_FOR = re.compile(
    r"\b(?:how|what)\b|^(?:list|which|who)\b.*\b(?:when|time|second|moment|distance|speed|number|angle)\b"
)
# What is no question for yes or no, though it may hold a statement: "it stops at last , when would that be".
_UNIT_AT_END = re.compile(rf"\b(?:in|measured in) (?:{UNIT}|rpm)(?: , .*)?$")
_WANTS_MORE = re.compile(
    r"^(?:sort|order|rank|list|name|count|describe|give|find|show|state|put|draw|pinpoint|determine|calculate|estimate|"
    r"measure|add|sum|compare|explain)\b|"
    r", (?:and |so |then )?(?:at (?:what|which) \w+|by how|when|how|where|what|which) "
    r"(?:\w+ )*?(?:is|was|are|does|do|did|would|will|might|could|should)\b(?!.* , (?:is|does|do|did|was|has) )"
)


def _of_motion(asked: Asked, survey: Survey) -> Reading | None:
    """The answer to a question about what moves, or the first reason why there is none; None if it is no such one."""
    refused: Reading | None = None
    no_number = (asked.words or ("",))[0] in _NO_NUMBER and not _ASKED_FOR.search(asked.said)
    wants_more = _WANTS_MORE.search(asked.said) is not None
    in_unit = _UNIT_AT_END.search(asked.said) is not None
    for kind in kinds.OF_MOTION:
        for slots in (found for template in kind.templates for found in template.match(asked.words, READERS)):
            try:
                given = kind.answer(replace(asked, slots=slots), survey)
            except NotResolved as error:
                refused = refused or Reading(_unnamed(error, survey), kind.name)
                continue
            if isinstance(given, Answer) and (
                (isinstance(given.answer, float) and no_number)
                or (in_unit and isinstance(given.answer, str | tuple))
                or (given.answer_type == "yesno" and wants_more)
            ):
                continue
            if kind.name == "which_moves" and isinstance(given, Answer) and _is_named(given.answer, asked.said):
                continue
            if isinstance(given, Answer) and given.answer is None:
                refused = refused or Reading(given, kind.name)
            elif given is not None:
                return _reading(kind, given if survey.scaled else _in_units(given))
    return refused


def _is_named(answer: object, said: str) -> bool:
    """Whether the one thing that a question is answered with is the one that it names: "on what is the ball rolling?"
    does not ask for the ball."""
    chosen = re.search(r"\bor\b", said) is not None
    return isinstance(answer, str) and not chosen and _tells_of(answer.split()[-1], said)


def _of_moments(asked: Asked, survey: Survey, timeline: Timeline) -> Reading | None:
    """The answer that the scene at a moment gives, or the first reason why it gives none; None if it is not asked."""
    refused: Reading | None = None
    try:
        for moment in static.moments(asked.words, survey, timeline, asked):
            found = _at_moment(moment, asked.text, survey, timeline)
            if found.answer.answer is not None:
                return found
            refused = refused or (found if found.kind else None)
    except NotResolved as error:
        refused = refused or Reading(_unnamed(error, survey), "moment")
    except Untold as error:
        refused = refused or Reading(nothing(str(error)), "moment")
    return refused


def _chosen(words: Words, survey: Survey, timeline: Timeline) -> Reading | None:
    """The answer to a question that offers names, from among these; None if it offers none."""
    if (found := several.choice(" ".join(words))) is None:
        return None
    told = _timed(found[0], survey, timeline)
    if told.answer.answer is None or told.answer.answer_type not in ("label", "list"):
        return None
    offered = dict[NodeId, str]()
    for name in found[1]:
        if (query := thing(name)) is None or (meant := survey.find(query)).verdict == "absent":
            return None
        for met in meant.things:
            bare = re.sub(r"^(?:the|a|an|my) ", "", name)
            if offered.get(met.id) is None or set(bare.split()) <= set(met.label.split()):
                offered[met.id] = bare  # of two names of one thing its own
    ids = [i for i in told.answer.evidence.ids if i in offered]
    if not ids:
        return Reading(nothing(f"None of them: {told.answer.text}"[:4000]), told.kind)
    names = tuple(offered[i] for i in ids)
    shown = told.answer.evidence.model_copy(update={"ids": tuple(ids)})
    only = {"answer": names[0], "answer_type": "label"} if len(names) == 1 else {"answer": names, "answer_type": "list"}
    text = f"{', '.join(names).capitalize()}. {told.answer.text}"[:4000]
    return replace(told, answer=told.answer.model_copy(update={**only, "text": text, "evidence": shown}))


def _sorted(text: str, names: frozenset[str], survey: Survey, timeline: Timeline) -> Reading | None:
    """Events in their order, of each of which it is asked when it happens; None if the text wants none sorted."""
    told = list[tuple[float, str, Reading]]()
    for event, question in sorted_events(text, names):
        found = _timed(question, survey, timeline)
        if not isinstance(found.answer.answer, float) or found.answer.unit != "s":
            return None
        told.append((found.answer.answer, event, found))
    if not told:
        return None
    told.sort(key=lambda own: own[0])
    first = told[0][2]
    ids = tuple(dict.fromkeys(i for _, _, found in told for i in found.answer.evidence.ids))
    changed = {
        "answer": tuple(event for _, event, _ in told),
        "answer_type": "list",
        "unit": "",
        "text": "; ".join(f"{at(time)}: {event}" for time, event, _ in told)[:4000],
        "evidence": first.answer.evidence.model_copy(update={"ids": ids}),
    }
    return replace(first, answer=first.answer.model_copy(update=changed), restated="")


def _of_two(words: Words, survey: Survey, timeline: Timeline) -> Reading | None:
    """The answer to a question that is two, each of which is asked by itself; None if it is no such question."""
    said = plain(words)
    if (either := several.either(said)) is not None:
        first, second = (_timed(one, survey, timeline) for one in either)
        if first.answer.answer_type == second.answer.answer_type == "yesno" and None not in (
            first.answer.answer, second.answer.answer,
        ):  # fmt: skip
            return second if first.answer.answer == "no" else first
    if (both := several.both(said)) is not None:
        first, second = (_timed(one, survey, timeline) for one in both)
        a, b = first.answer.answer, second.answer.answer
        if isinstance(a, float) and isinstance(b, float) and abs(a - b) < _ONE_TIME:
            return first if a > b else second
    return None


def _shared(words: Words, survey: Survey, timeline: Timeline) -> Reading | None:
    """The share of the scene's time that something takes; None if the words ask for none."""
    if (found := several.share(" ".join(words))) is None:
        return None
    told = _timed(found[0], survey, timeline)
    lasts = timeline.stop - timeline.start
    if not isinstance(told.answer.answer, float) or told.answer.unit != "s" or lasts <= 0:
        return None
    part, percent = told.answer.answer / lasts, found[1]
    value = {"answer": 100 * part if percent else part, "unit": "%" if percent else ""}
    text = f"{100 * part:.0f} % of {at(lasts)}. {told.answer.text}"[:4000]
    return replace(told, answer=told.answer.model_copy(update={**value, "text": text}))


def _compared(words: Words, survey: Survey, timeline: Timeline) -> Reading | None:
    """The answer to a comparison, each of whose numbers is asked for by itself; None if the words are none."""
    for comparison in comparisons(plain(words)):
        if (given := compared(comparison, lambda said: _timed(said, survey, timeline).answer)) is not None:
            return Reading(given, "comparison")
    return None


def _unnamed(error: NotResolved, survey: Survey) -> Answer:
    """That a phrase is absent, or means several things: no answer, for what is not there does nothing."""
    if error.found.verdict == "ambiguous":
        named = "; ".join(survey.named(t) for t in error.found.things[:_TRIED])
        return nothing(f"“{error.query.describe()}” may be {named}. Say which one.")
    return nothing(absent_text(survey, error.query, error.found))


_IMAGINED = ("would it fit", "where would it fit", "space for an activity")  # asked of things that are not there
_IMAGINE = re.compile(r"\b(?:fit|fits|space|room for|would|could|can|might)\b")


def _at_moment(moment: static.AtMoment, text: str, survey: Survey, timeline: Timeline) -> Reading:
    """The answer of the static scene at a moment; of several moments the one that holds at all of them, or at any."""
    first: Reading | None = None
    for time in moment.times:
        there = survey if time == timeline.start else timeline.survey_at(time)
        found = _static(moment.words, there)
        answer = found.answer
        named = answer.text.startswith("There is no ") and _OF_ONE.match(moment.words) is not None
        if answer.answer is None or (answer.answer == "no" and (named or answer.text.startswith("No. There is no "))):
            return replace(found, answer=nothing(answer.text.removeprefix("No. ")))  # what is not there is not asked of
        if _LASTS.match(moment.words):  # no length of a thing
            return replace(found, answer=nothing(NOT_READ), kind="")
        if answer.answer == 0.0 and (gone := _uncounted(moment.words, there)) is not None:
            return replace(found, answer=nothing(gone))
        if answer.answer == () and (under := _UNDER.match(moment.words)) is not None:  # on which it is
            return _timed(f"what is {under['x']} on at {moment.times[0]} s", survey, timeline)
        if found.restated.startswith("how long"):
            return replace(found, answer=nothing(NOT_READ), kind="")  # of a thing, or for how long
        if found.restated and _is_lost(moment.words, found.restated):
            return Reading(
                Answer(answer=None, answer_type=answer.answer_type, text=NOT_READ, confidence=0.0, source="none")
            )
        if moment.said and found.kind in _IMAGINED and not _IMAGINE.search(moment.words):
            return replace(found, answer=nothing(f"Nothing here tells what happens then: {moment.words}."))
        evidence = answer.evidence.model_copy(update={"time": time})
        said = f"At {at(time)}: {answer.text}" if moment.said else _present(answer, survey, timeline)
        found = replace(found, answer=answer.model_copy(update={"text": said[:4000], "evidence": evidence}))
        first = first or found
        if len(moment.times) > 1 and answer.answer_type != "yesno":
            return replace(found, answer=nothing(f"That may change; say at which time. {said}"[:4000]))
        if len(moment.times) > 1 and (answer.answer == "no") == moment.every:
            return found
    assert first is not None
    return first


_OF_ONE = re.compile(r"(?:is|are|was|does|do|did|has|will) (?:the|this|that|my|our) ")
_LASTS = re.compile(
    r"how long (?:is|are|was|does|do) .+ (?:standing|sitting|lying|resting|staying|waiting|stand|stay|on|at|in|by|"
    r"near|next to|under)\b"
)
_UNDER = re.compile(r"^(?:what|which \w+) is (?:right |directly )?(?:under|underneath|beneath|below) (?P<x>.+)$")
_COUNTED = re.compile(r"^(?:how many|count|(?:what is )?the number of) (?P<x>(?:\w+ )*?\w+s)(?= |$)")
_LOST = bag(
    "second seconds sec secs time moment long fast quick quickly slow slowly speed before after while during until "
    "rpm times "
    "often first last never ever again not faster slower longer farther later earlier far turn turns round rounds "
    "floor wall "
    "ceiling final initial frame clip once when then else"
)


def _names(survey: Survey) -> frozenset[str]:
    """Words of the names of the things of a scene."""
    own = frozenset(singular(w) for t in survey.things for w in t.label.split())
    return own | {"wall", "floor", "ceiling", "door"}


def _read_as(questions: Sequence[str], survey: Survey, timeline: Timeline) -> Reading | None:
    """The answer to plainer questions that a question may mean; None if those that have one differ in it."""
    told: list[tuple[str, Reading]] = []
    for plainer in questions:
        words = static.without_relative(tuple(plainer.split()), survey, timeline)
        asked = Asked(plainer, words=words, timeline=timeline)
        found = _chosen(plain_words(plainer), survey, timeline) or _of_motion(asked, survey)
        if found is None or found.answer.answer is None:
            found = _of_moments(asked, survey, timeline)
        if found is not None and found.answer.answer not in (
            None,
            (),
        ):  # "nothing does" may be another question's answer
            told.append((plainer, found))
    if not told or _same([f.answer for _, f in told]) is None:
        return None
    plainer, found = told[0]
    sure = round(found.answer.confidence * _RESTATED, 4)
    text = f"{found.answer.text} (Read as: {plainer}?)"[:4000]
    return replace(found, answer=found.answer.model_copy(update={"confidence": sure, "text": text}), restated=plainer)


def _is_lost(said: str, plainer: str) -> bool:
    """Whether words that a plainer question leaves out tell a time or a number, or name a thing or a part of one."""
    left_out = set(said.split()) - set(plainer.split())
    parts = {m[1] for m in re.finditer(r"'s (?:\w+ )?(\w+)", said)}
    if _LOST & left_out or parts & left_out or any(w[0].isdigit() for w in left_out):
        return True
    return any(world.find(singular(w)) is not None for w in left_out if len(w) > 2)


def _uncounted(words: str, survey: Survey) -> str | None:
    """Why none of what is not in the scene at all can be counted; None if it is there."""
    said = _COUNTED.match(words)
    if said is None or (query := thing(f"the {said['x']}")) is None:
        return None
    found = survey.find(query.model_copy(update={"pick": "all"}))
    return absent_text(survey, query, found) if found.verdict == "absent" else None


def _present(answer: Answer, survey: Survey, timeline: Timeline) -> str:
    """The text of an answer about the present, which says so where it is about something that moves."""
    told = [
        f"{b.name} moves {spoken(b.moving)}"
        for b in timeline.movers(survey)
        if (b.thing is not None and b.thing.id in answer.evidence.ids) or b.name in answer.text.lower()
    ]
    return f"{answer.text} (This is at {at(timeline.now)}; {'; '.join(told)}.)" if told else answer.text


def _static(text: str, survey: Survey) -> Reading:
    """The answer to a question about a scene as it stands."""
    words = plain_words(text)
    situation, rest = read_situation(words)
    readings = [(situation, rest)] if situation is None else [(situation, rest), (None, words)]
    if (told := _without_purpose(words)) is not None:
        readings.append((None, told))
    if _ASIDE.search(text):
        readings.append((None, plain_words(_ASIDE.sub(" ", text))))
    failed: _Attempt | None = None
    for where, said in readings:  # words that seem to say where a person is may belong to the question itself
        for kind, asked in _filled(text, where, said):
            try:
                given = kind.answer(asked, survey)
            except NotResolved as error:
                failed = failed or _Attempt(kind, asked, error)
                continue
            if given is not None:
                return _reading(kind, given if survey.scaled else _in_units(given))
        if failed is not None:
            break
    if failed is not None:  # a name that is absent may hold words that are none of it: "that wooden looking bench"
        plainer = _restated(text, words, survey) if failed.error.found.verdict == "absent" else None
        return plainer if plainer is not None and plainer.answer.answer is not None else _unresolved(failed, survey)
    if (reading := _restated(text, words, survey)) is not None:
        return reading
    none = Answer(answer=None, answer_type=expected_type(rest), text=NOT_READ, confidence=0.0, source="none")
    return Reading(none, sight=True)


_ASIDE = re.compile(r"\([^()]*\)")  # "how many seats are there (sofa plus chairs)?"
_RESTATED = 0.85  # probability that a question means what it was restated as


def _restated(text: str, words: Words, survey: Survey) -> Reading | None:
    """The answer to the likeliest plainer question that the words may mean; None if there is none."""
    for plainer in restated(words, tuple(t.label for t in survey.things if t.label)):
        situation, said = read_situation(plain_words(plainer))
        for kind, asked in _filled(text, situation, said):
            try:
                given = kind.answer(asked, survey)
            except NotResolved as error:
                if plainer.startswith("is there anything"):
                    continue  # "his slipper" is no thing of the scene, and the question is about something else
                return _unresolved(_Attempt(kind, asked, error), survey)
            if isinstance(given, Answer):
                said_so = f"{given.text} (Read as: {plainer}?)"[:4000]
                sure = round(given.confidence * _RESTATED, 4)
                told = given.model_copy(update={"confidence": sure, "text": said_so})
                reading = _reading(kind, told if survey.scaled else _in_units(told))
                return replace(reading, restated=plainer)
            if given is not None:
                return _reading(kind, given)
    return None


_PURPOSE = re.compile(
    r"^(?:(?:i|we) (?:am|are|was|were) )?(?:just )?(?:thinking (?:of|about)|planning (?:to|on)|considering|"
    r"hoping to|looking to) [^,]+ , (?=(?:what|how|is|are|can|could|would|will|where|which|does|do)\b)"
)


def _without_purpose(words: Words) -> Words | None:
    """The question behind a clause that only says what it is asked for: "thinking of painting the floor, ...".

    None if there is no such clause, or the question refers to something in it.
    """
    said = " ".join(words)
    found = _PURPOSE.match(said)
    rest = tuple(said[found.end() :].split()) if found else ()
    return rest if rest and not {"it", "that", "them", "there", "this"} & set(rest) else None


def _filled(text: str, situation: Situation | None, words: Words) -> Iterator[tuple[Kind, Asked]]:
    """Every template that the words fill, in the order of the kinds."""
    held = frozenset(words)
    for kind in kinds.KINDS:
        for template in kind.templates:
            if template.may_match(held):
                for slots in template.match(words, READERS):
                    yield kind, Asked(text, slots, situation, words)


def expected_type(words: Sequence[str]) -> AnswerType:
    """The type of answer that a question asks for, by its first words; "text" if they leave it open."""
    first = next((w for w in words if w != ","), "")
    if first in _YES_NO or (first and first not in _OPEN and {"is", "are"} & set(words)):
        return "text" if "or" in words and "whether" not in words else "yesno"
    return "number" if words[:2] == ("how", "many") or first == "count" else "text"


_UNSCALED = 0.4  # probability that a length is right where one unit of the scene is taken for a metre


def _in_units(given: Answer | Undecided) -> Answer | Undecided:
    """An answer about a scene of unknown scale: lengths are told as uncertain."""
    if not isinstance(given, Answer) or given.answer is None or given.unit in ("", "%", "deg"):
        return given
    text = f"{given.text} The scale of the scene is not known: one unit of it is read as a metre."
    return given.model_copy(update={"confidence": min(given.confidence, _UNSCALED), "text": text[:4000]})


def _reading(kind: Kind, given: Answer | Undecided) -> Reading:
    if isinstance(given, Answer):
        return Reading(given, kind.name, sight=False)
    none = Answer(
        answer=None, answer_type=given.answer_type, text=given.text, confidence=given.confidence, source="none",
        evidence=evidence(given.things),
    )  # fmt: skip
    return Reading(none, kind.name, given.sight)


# -- phrases that are absent or ambiguous ----------------------------------------------------------------------------


def _unresolved(failed: _Attempt, survey: Survey) -> Reading:
    """The answer where a phrase is absent or ambiguous."""
    error, kind = failed.error, failed.kind
    kind_of_answer = expected_type(failed.asked.words)
    if error.found.verdict != "ambiguous":
        unnamed = any(not t.label for t in survey.things)
        return Reading(absent(survey, error.query, error.found, kind_of_answer), kind.name, sight=unnamed)
    given = [(t, _for_one(failed, t, survey)) for t in error.found.things[:_TRIED]]
    answers = [a for _, a in given if a is not None and a.answer is not None]
    if len(answers) == len(error.found.things) and (one := _same(answers)) is not None:
        return Reading(one, kind.name)
    return Reading(_several(error, given, survey, kind_of_answer), kind.name)


def _for_one(failed: _Attempt, thing: Thing, survey: Survey) -> Answer | None:
    """The answer if an ambiguous phrase means this thing; None if there is none."""
    meant = Query(groups=(thing.row,))
    phrase = failed.error.query
    slots = {
        name: with_queries(value, lambda query: meant if query == phrase else query)
        for name, value in failed.asked.slots.items()
    }
    if slots == dict(failed.asked.slots):
        return None
    asked = Asked(failed.asked.text, slots, failed.asked.situation, failed.asked.words)
    try:
        given = failed.kind.answer(asked, survey)
    except NotResolved:
        return None
    return given if isinstance(given, Answer) else None


def _same(answers: Sequence[Answer]) -> Answer | None:
    """The one answer that all candidates give, with the evidence of all; None if they differ."""
    first = answers[0]
    for other in answers[1:]:
        a, b = first.answer, other.answer
        if isinstance(a, float) and isinstance(b, float):
            if abs(a - b) > _NEAR * max(abs(a), abs(b)):
                return None
        elif a != b:
            return None
    ids = tuple(dict.fromkeys(i for a in answers for i in a.evidence.ids))
    sure = min(a.confidence for a in answers)
    return first.model_copy(update={
        "confidence": sure, "evidence": first.evidence.model_copy(update={"ids": ids}),
    })  # fmt: skip


def _several(
    error: NotResolved, given: Sequence[tuple[Thing, Answer | None]], survey: Survey, answer_type: AnswerType
) -> Answer:
    """That a phrase means several things, with the answer for each of them."""
    told = [f"{survey.named(t)}{_value(a)}" for t, a in given]
    more = len(error.found.things) - len(given)
    tail = f"; and {more} more" if more > 0 else ""
    text = f"“{error.query.describe()}” may be {'; '.join(told)}{tail}. Say which one."
    return Answer(answer=None, answer_type=answer_type, text=text[:4000], confidence=0.8, source="none",
                  evidence=evidence(error.found.things))  # fmt: skip


def _value(given: Answer | None) -> str:
    """An answer in brackets, "" if there is none."""
    if given is None or given.answer is None:
        return ""
    value: Mapping[str, Any] = given.to_json()
    said = value["answer"]
    said = ", ".join(said) if isinstance(said, list) else said
    unit = f" {given.unit}" if given.unit and isinstance(said, int | float) else ""  # texts hold their units
    return f" ({said}{unit})"
