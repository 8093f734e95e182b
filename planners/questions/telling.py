"""Answers that every kind of question makes in the same way: yes or no, one of several things, nothing of that name."""

from __future__ import annotations

from collections.abc import Sequence

from ...gaussians.language.query.query import Query
from ..rooms.label_encoder import NOT, agreement
from .answer import Answer, AnswerType, Evidence, Line
from .survey import Found, Survey, Thing, listed, with_article

GRAPH_SURE = 0.97  # that a label which somebody wrote, or which was confirmed, is right


def evidence(things: Sequence[Thing], lines: Sequence[Line] = ()) -> Evidence:
    """Evidence from things, each once."""
    return Evidence(ids=tuple(dict.fromkeys(t.id for t in things)), lines=tuple(lines))


def yes_no(holds: bool, text: str, things: Sequence[Thing], confidence: float = GRAPH_SURE) -> Answer:
    """A yes or no. `text` is the sentence without "Yes, " or "No, " before it."""
    said = f"{'Yes' if holds else 'No'}, {text}"
    return Answer(answer="yes" if holds else "no", answer_type="yesno", text=_cut(said), confidence=confidence,
                  evidence=evidence(things))  # fmt: skip


def label(thing: Thing, text: str, confidence: float = GRAPH_SURE, *, others: Sequence[Thing] = (),
          said: str = "") -> Answer:  # fmt: skip
    """One thing by its label, or in the words `said`; `others` are what it was compared with."""
    return Answer(answer=said or thing.name, answer_type="label", text=_cut(text), confidence=confidence,
                  evidence=evidence([thing, *others]))  # fmt: skip


def things_listed(things: Sequence[Thing], text: str, confidence: float = GRAPH_SURE) -> Answer:
    """Several things by their labels."""
    return Answer(answer=tuple(t.name for t in things), answer_type="list", text=_cut(text), confidence=confidence,
                  evidence=evidence(things))  # fmt: skip


def number(value: float, text: str, things: Sequence[Thing], confidence: float = GRAPH_SURE, unit: str = "") -> Answer:
    """A number, with a unit where it is a measure."""
    return Answer(answer=float(value), answer_type="number", text=_cut(text), confidence=confidence, unit=unit,
                  evidence=evidence(things))  # fmt: skip


def told_apart(survey: Survey, thing: Thing, others: Sequence[Thing]) -> str:
    """A label for a thing, with what tells it from others of that label: "red chair"; its plain label without any."""
    if all(o.label != thing.label or o.id == thing.id for o in others):
        return thing.name
    return survey.named(thing).removeprefix("the ")


def bare(query: Query) -> str:
    """A query in words without its article: "lamp on the desk"."""
    said = query.describe()
    for article in ("the ", "every ", "any "):
        said = said.removeprefix(article)
    return said


def absent_text(survey: Survey, query: Query, found: Found) -> str:
    """That there is nothing of this name, with the nearest things."""
    if query.last:
        return "It is not clear what “it” refers to; name the thing."
    near = [survey.named(t) for t in found.near]
    if _may_be_there(query, found):
        verb = "is" if len(near) == 1 else "are"
        return f"Nothing here is surely a {bare(query)}; what comes nearest {verb} {listed(near)}."
    told = f" The nearest to that: {listed(near)}." if near else ""
    return f"There is no {bare(query)} here.{told}"


def _may_be_there(query: Query, found: Found) -> bool:
    """Whether all things nearest to a plain name carry that name: it was not found because it is not sure."""
    plain = query.model_copy(update={"text": "", "pick": "one", "count": None}) == Query()
    return plain and bool(found.near) and all(agreement(query.text, [t.label])[0] > NOT for t in found.near)


def absent(survey: Survey, query: Query, found: Found, answer_type: AnswerType) -> Answer:
    """The answer about something that is not there: "no" to a yes-or-no question, 0 to "how many", else none."""
    text, ids = absent_text(survey, query, found), evidence(found.near)
    if answer_type == "yesno" and not query.last and not _may_be_there(query, found):
        return Answer(answer="no", answer_type="yesno", text=f"No. {text}", confidence=0.9, evidence=ids)
    return Answer(answer=None, answer_type=answer_type, text=text, confidence=0.9, source="none", evidence=ids)


def each_counted(things: Sequence[Thing]) -> str:
    """Things by label with their numbers, the article before single ones."""
    return Survey.counted(things) if things else "nothing"


def _cut(text: str) -> str:
    return text if len(text) <= 4000 else text[:3999] + "…"


__all__ = [
    "GRAPH_SURE", "absent", "absent_text", "bare", "each_counted", "evidence", "label", "number", "things_listed",
    "told_apart", "with_article", "yes_no",
]  # fmt: skip
