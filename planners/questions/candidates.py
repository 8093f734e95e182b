"""What a phrase may mean where several things match, and one answer from the answers for each of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from ...gaussians.language.query.query import Query
from .answer import Answer, AnswerType, Evidence
from .survey import Found, NotResolved, Survey, Thing, listed

MOST = 6  # candidates that are told

Case = tuple[str, Answer]  # what was taken to be meant, and the answer then


def meant(query: Query, survey: Survey) -> tuple[Thing, ...]:
    """The one thing that a phrase describes, or everything that it may mean.

    Raises:
        NotResolved: it is absent.
    """
    found = survey.find(query)
    if found.verdict == "absent" or not found.things:
        raise NotResolved(query, Found("absent", (), found.near, found.reason))
    return tuple({t.row: t for t in found.things}.values())


def is_plural(query: Query) -> bool:
    """Whether a phrase means each of the things that match it."""
    return query.pick in ("all", "rest") or bool(query.also)


def agreed(cases: Sequence[Case]) -> Answer:
    """The answer that all cases share; otherwise none, with the answer in each case. Without cases there is none."""
    if not cases:
        return unknown("text", "The question compares a thing with itself, or names nothing that it can be asked of.")
    first = cases[0][1]
    if all(_same(first, a) for _, a in cases[1:]):
        worst = min((a for _, a in cases), key=lambda a: a.confidence)
        return first.model_copy(update={"evidence": joined(a for _, a in cases), "confidence": worst.confidence})
    said = "; ".join(f"{name}: {_value(a)}" for name, a in cases[:MOST])
    more = f"; and {len(cases) - MOST} more" if len(cases) > MOST else ""
    return Answer(
        answer=None, answer_type=first.answer_type, text=f"It depends on which is meant: {said}{more}.",
        evidence=joined(a for _, a in cases), frame=first.frame, unit=first.unit,
    )  # fmt: skip


def each(things: Sequence[Thing], survey: Survey, fn: Callable[[Thing], Answer]) -> Answer:
    """`agreed` over one answer a thing."""
    return agreed([(survey.named(t), fn(t)) for t in things])


def pairs(
    first: Sequence[Thing], second: Sequence[Thing], survey: Survey, fn: Callable[[Thing, Thing], Answer]
) -> Answer:
    """`agreed` over one answer a pair of different things."""
    cases: list[Case] = []
    for a in first:
        for b in second:
            if a.row == b.row and len(first) * len(second) > 1:
                continue
            both = [survey.named(a)] * (len(first) > 1) + [survey.named(b)] * (len(second) > 1)
            cases.append((" and ".join(both), fn(a, b)))
    return agreed(cases)


def whole(cases: Sequence[Case], quantifier: str) -> Answer:
    """A yes/no answer of a phrase that means each ("all") or any ("any") of several things."""
    yes = [c for c in cases if c[1].answer == "yes"]
    no = [c for c in cases if c[1].answer == "no"]
    if not yes or not no:
        return agreed(cases)
    if quantifier == "any":
        text = f"Yes: {listed([n for n, _ in yes[:MOST]])}{' and others' if len(yes) > MOST else ''}."
        best = max((a for _, a in yes), key=lambda a: a.confidence)
        return best.model_copy(update={"text": text, "evidence": joined(a for _, a in yes)})
    right = not no
    told = f"that holds of {listed([n for n, _ in yes])} and not of {listed([n for n, _ in no])}"
    best = (yes if right else no)[0][1]
    text = f"{'Yes' if right else 'No, not all'}: {told}."
    return best.model_copy(update={"text": text, "evidence": joined(a for _, a in cases)})


def joined(answers: Iterable[Answer]) -> Evidence:
    """The evidence of several answers, each id and line once."""
    every = [a.evidence for a in answers]
    return Evidence(
        ids=tuple(dict.fromkeys(i for e in every for i in e.ids)),
        lines=tuple(dict.fromkeys(line for e in every for line in e.lines)),
    )


def unknown(kind: AnswerType, text: str, things: Iterable[Thing] = (), frame: str = "") -> Answer:
    """No answer, with the reason."""
    ids = tuple(dict.fromkeys(t.id for t in things))
    return Answer(answer=None, answer_type=kind, text=text, source="none", evidence=Evidence(ids=ids), frame=frame)


def _same(a: Answer, b: Answer) -> bool:
    if isinstance(a.answer, float) and isinstance(b.answer, float):
        return abs(a.answer - b.answer) <= 0.02 * max(abs(a.answer), abs(b.answer))
    return a.answer == b.answer


def _value(answer: Answer) -> str:
    if isinstance(answer.answer, float):
        return f"{answer.answer:.2f} {answer.unit}".strip()
    if isinstance(answer.answer, tuple):
        return listed(list(answer.answer))
    return str(answer.answer) if answer.answer is not None else "cannot be told"
