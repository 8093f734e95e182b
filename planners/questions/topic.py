"""What "it" refers to after an answer."""

from __future__ import annotations

from ..rooms.node import NodeId
from .answer import Answer
from .survey import Survey


def topic(answer: Answer, survey: Survey) -> tuple[NodeId, ...]:
    """The ids of what an answer names, else of what its question is about; none if it is about no thing.

    Of a distance or a relation this is the first of the two things, and what has the same label.
    """
    known = {t.id: t for t in survey.things}
    ids = tuple(i for i in answer.evidence.ids if i in known)
    if answer.answer is None or not ids:
        return ()
    if answer.answer_type == "label":
        return ids[:1]
    if isinstance(answer.answer, tuple):
        return ids[: len(answer.answer)]
    return tuple(i for i in ids if known[i].label == known[ids[0]].label)
