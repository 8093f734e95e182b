"""`Reply`, the result of a call: sentences, JSON data and pictures; and how results and refusals become one."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...gaussians.errors import ScenewrightError, UserError
from ...gaussians.language.query.selection import Candidate
from ...planners.model.prompt.labels import plain
from ..session.plan_report import candidate_json, planner_json
from ..session.refusal import NotUnderstoodError, verdict_of

if TYPE_CHECKING:
    from ...gaussians.camera import Camera
    from ..session.clarify import Question
    from ..session.result import Result

MAX_SIDE = 1280  # pixels of a picture, width and height; larger ones are scaled down by vision models
HOW_TO_ANSWER = "Nothing was changed. Call `answer` with a number, 'all', or words such as 'the left one'."
HOW_TO_CONFIRM = "Nothing was changed. Call `answer` with 'yes' to go on with it, or with 'no'."


@dataclass(frozen=True)
class Reply:
    """The result of a call.

    Attributes:
        text: one or more sentences for a person or a model.
        data: the result as JSON data; `verdict` is "ok", or says why nothing was done.
        pictures: PNG files.
        failed: whether nothing was done.
        asks: id of the question that was left open by what is ambiguous or not confirmed, "" if there is none.
        form: that question for a person who can answer it at once.
    """

    text: str
    data: dict[str, Any]
    pictures: tuple[bytes, ...] = ()
    failed: bool = False
    asks: str = ""
    form: str = ""

    def plus(self, **data: Any) -> Reply:
        """This reply with more data."""
        return replace(self, data={**self.data, **data})

    def without(self, labels: Collection[str]) -> Reply:
        """This reply with "thing" in place of labels, in its sentences and in the strings of its data."""
        if not labels:
            return self
        said = re.compile("|".join(map(re.escape, sorted(labels, key=lambda w: (-len(w), w)))), re.IGNORECASE)

        def cleaned(value: Any) -> Any:
            if isinstance(value, str):
                return said.sub("thing", value)
            if isinstance(value, dict):
                return {key: cleaned(item) for key, item in value.items()}
            return [cleaned(item) for item in value] if isinstance(value, list | tuple) else value

        return replace(self, text=cleaned(self.text), data=cleaned(self.data), form=cleaned(self.form))


def edited(result: Result, pictures: tuple[bytes, ...] = ()) -> Reply:
    """The reply to an instruction that was carried out, with a receipt for each operation."""
    sentences = list(result.sentences()) or [result.text]
    data = {
        "verdict": "ok",
        "said": sentences,
        "receipts": [r.model_dump(mode="json", exclude_none=True) for r in result.receipts],
        "groups": list(result.selection.groups) if result.selection is not None else [],
        "dry_run": result.dry_run,
        **planner_json(result.plan),
    }
    return Reply("\n".join(sentences), data, pictures)


def refused(error: ScenewrightError) -> Reply:
    """The reply to a call that was refused; the scene is as it was."""
    wrong = isinstance(error, UserError) and not isinstance(error, NotUnderstoodError)
    verdict = "invalid" if wrong else verdict_of(error)
    reason = str(error)
    if verdict == "not_an_edit":
        reason += " (questions are answered by `ask`)"
    return Reply(reason, {"verdict": verdict, "reason": reason}, failed=True)


def asked_back(reply: Reply, question: Question, viewer: Camera, id: str) -> Reply:
    """A refusal with the candidates of the question that it leaves open, and how to answer it."""
    numbered = numbered_candidates(question.candidates, viewer)
    form = "\n".join([reply.text, *(f"  {c['number']}. {c['said']}" for c in numbered)])
    verdict = question.selection.verdict
    how = HOW_TO_CONFIRM if verdict == "unconfirmed" else HOW_TO_ANSWER
    data = {**reply.data, "candidates": numbered, "question": id, "how_to_answer": how}
    asks = id if verdict in ("ambiguous", "unconfirmed") else ""
    return replace(reply, text=f"{form}\n{how}", data=data, asks=asks, form=form)


def numbered_candidates(candidates: Sequence[Candidate], viewer: Camera) -> list[dict[str, Any]]:
    """The candidates as JSON, each with its number and where the viewer sees it."""
    return [
        {"number": n, "said": _said(c, viewer), **candidate_json(c), "label": plain(c.label)}
        for n, c in enumerate(candidates, start=1)
    ]


def _said(candidate: Candidate, viewer: Camera) -> str:
    """A candidate in words: "red box (group 0), left in the view, 8.2 away"."""
    away = float(np.linalg.norm(np.asarray(candidate.center) - viewer.position))
    group = f" (group {candidate.group})" if candidate.group >= 0 else ""
    what = f"{candidate.color} {plain(candidate.label) or 'thing'}{group}"
    return f"{what}, {candidate.seen_from(viewer)}, {away:.1f} away from the viewer"
