"""Answers a question from geometry: words to a filled template, and that to an answer.

text ──reading──► Asked ──kinds──► Answer     (source "none" if no kind of question reads it)
"""

from __future__ import annotations

from ...gaussians.language.query.query import Query
from . import kinds
from .answer import Answer, Evidence
from .kind import Asked
from .reading.holes import READERS
from .reading.situation import read_situation
from .reading.words import plain_words
from .survey import NotResolved, Survey, listed

NOT_READ = "this question is not understood"


def answer(text: str, survey: Survey) -> Answer:
    """The answer to a question as far as geometry gives one.

    A question that no kind reads has the answer None, the source "none" and `NOT_READ` in its text. A phrase that is
    absent or ambiguous is told with the nearest things or the candidates.

    Raises:
        UserError: the text is too long.
    """
    situation, words = read_situation(plain_words(text))
    unresolved: NotResolved | None = None
    for kind in kinds.KINDS:
        for template in kind.templates:
            for slots in template.match(words, READERS):
                try:
                    given = kind.answer(Asked(text, slots, situation), survey)
                except NotResolved as error:
                    unresolved = unresolved or error
                    continue
                if given is not None:
                    return given
    if unresolved is not None:
        return _not_resolved(unresolved, survey)
    return Answer(answer=None, answer_type="text", text=NOT_READ, confidence=0.0, source="none")


def _not_resolved(error: NotResolved, survey: Survey) -> Answer:
    """The answer where a phrase is absent or ambiguous."""
    said = error.query.describe()
    if error.found.verdict == "ambiguous":
        names = [survey.named(t) for t in error.found.things]
        text = f"“{said}” may be {listed(names)}; say which one."
        ids = tuple(t.id for t in error.found.things)
        return Answer(answer=None, answer_type="text", text=text, evidence=Evidence(ids=ids))
    near = [survey.named(t) for t in error.found.near]
    told = f" The nearest to that: {listed(near)}." if near else ""
    ids = tuple(t.id for t in error.found.near)
    return Answer(answer=None, answer_type="text", text=f"There is no {_bare(error.query)} here.{told}",
                  source="none", evidence=Evidence(ids=ids))  # fmt: skip


def _bare(query: Query) -> str:
    return query.describe().removeprefix("the ").removeprefix("every ").removeprefix("any ")
