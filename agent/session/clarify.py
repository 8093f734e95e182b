"""Clarification: finds the query of a plan that is ambiguous, absent or unconfirmed, and puts the user's answer into
the plan.

It never picks or confirms a candidate for the user.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...gaussians.errors import UserError
from ...gaussians.language.query.nested import Path, exchange, queries
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Candidate, Selection
from .answers import chosen_numbers, plain, says_all, says_yes

if TYPE_CHECKING:
    from ...planners.plan import EditPlan
    from ...tools.operation import EditOp

_SIDES = {"left": "leftmost", "right": "rightmost", "near": "nearest", "closest": "nearest", "close": "nearest",
          "far": "farthest", "big": "largest", "bigger": "largest", "biggest": "largest", "larger": "largest",
          "small": "smallest", "smaller": "smallest", "tall": "tallest", "taller": "tallest", "short": "shortest",
          "shorter": "shortest", "upper": "highest", "top": "highest", "higher": "highest", "lower": "lowest",
          "bottom": "lowest", "middle": "middle", "center": "middle", "centre": "middle", "front": "nearest",
          "back": "farthest"}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Question:
    """A query of a plan that did not resolve to one thing, or to one whose name is not confirmed.

    Attributes:
        plan: the plan that failed.
        step: index of the failed operation in the plan.
        path: where in the operation the query is.
        selection: its verdict ("ambiguous", "absent" or "unconfirmed"), reason and candidates.
        resolve: resolves another query in the same state of the scene.
        offered: the candidates are things that may be meant by a name that was not found, see `offers`.
        page: how often other things than those that were offered were asked for.
        kept: candidates of earlier pages that are meant, besides what is chosen now.
    """

    plan: EditPlan
    step: int
    path: Path
    selection: Selection
    resolve: Callable[[Query], Selection]
    offered: bool = False
    page: int = 0
    kept: tuple[Candidate, ...] = ()

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        return self.selection.candidates


def find_question(plan: EditPlan, step: int, verdict: str, resolve: Callable[[Query], Selection]) -> Question | None:
    """The innermost query of a step that resolves to `verdict`; None if there is none."""
    for path, query in queries(plan.ops[step]):
        # An excluded query may match several things: "all chairs but the green one".
        plural = "exclude" in path and query.pick == "one"
        found = resolve(query.model_copy(update={"pick": "all"}) if plural else query)
        if found.verdict == verdict:
            return Question(plan, step, path, found, resolve)
    return None


def plan_with_answer(question: Question, answer: str, parse: Callable[[str], Query | None]) -> EditPlan:
    """The plan with the user's answer in it: numbers of the list ("2", "1 and 3", "all but 2"), "all", or words ("the
    left one", "the red one"); "yes" to what is not confirmed. What was chosen counts as confirmed.

    Args:
        parse: reads a noun phrase as a query; returns None if it cannot.

    Raises:
        UserError: the answer does not choose a candidate; the message shows valid answers.
    """
    query, said = question.selection.query, plain(answer)
    if question.selection.verdict == "unconfirmed":
        if not says_yes(said):
            raise UserError(f"{answer!r} does not say whether that is meant; say 'yes' or 'no', or another instruction")
        return plan_with_query(question, query.model_copy(update={"confirmed": True}))
    chosen = _choice(question.candidates, query, said, parse)
    if chosen is None:
        raise UserError(
            f"{answer!r} does not say which; answer with a number from 1 to {len(question.candidates)}, several "
            "('1 and 2'), 'all', or a description such as 'the left one'"
        )
    _require_choice(question, chosen, answer)
    # What a person has chosen needs no other confirmation, nor an encoder that knows it.
    return plan_with_query(question, chosen.model_copy(update={"confirmed": True}))


def plan_with_query(question: Question, chosen: Query) -> EditPlan:
    """The plan of a question with another query in place of the one that failed."""
    ops: list[EditOp] = list(question.plan.ops)
    ops[question.step] = exchange(ops[question.step], question.path, chosen)
    return question.plan.model_copy(update={"ops": tuple(ops)})


def with_plural(plan: EditPlan, asked: Question) -> EditPlan:
    """The plan, with a remark if all things of a name were asked for and a person chose some of a list."""
    node = _node(asked, asked.path)
    if not isinstance(node, Query) or node.pick != "all" or not node.text:
        return plan
    said = f"{node.text}: only what was chosen; there may be more of that kind"
    return plan.model_copy(update={"reason": "; ".join(r for r in (plan.reason, said) if r)[:2000]})


def is_further(question: Question) -> bool:
    """Whether a question is about one of several things that are named together: "the neck and the head"."""
    return bool(question.selection.query.also) or (len(question.path) >= 2 and question.path[-2] == "also")


def without_further(question: Question) -> EditPlan:
    """The plan of a question about one of several things, without that thing."""
    query, (*around, last) = question.selection.query, question.path
    if query.also:
        return plan_with_query(question, query.also[0].model_copy(update={"also": query.also[1:]}))
    ops = list(question.plan.ops)
    left = tuple(one for i, one in enumerate(_node(question, tuple(around))) if i != last)
    ops[question.step] = exchange(ops[question.step], tuple(around), left)
    return question.plan.model_copy(update={"ops": tuple(ops)})


def asked_about(question: Question) -> str:
    """What a question is about, in words, where it is one of several things that are named together; else ""."""
    return question.selection.query.model_copy(update={"also": ()}).describe() if is_further(question) else ""


def _node(question: Question, path: Path) -> Any:
    """What stands at a path in the operation of a question."""
    node: Any = question.plan.ops[question.step]
    for key in path:
        node = node[key] if isinstance(key, int) else getattr(node, key)
    return node


def as_a_whole(plan: EditPlan, step: int) -> EditPlan:
    """The plan whose step takes all of its target: parts of other colours too, where an operation leaves them."""
    ops: list[EditOp] = list(plan.ops)
    if "whole" in type(ops[step]).model_fields:
        ops[step] = ops[step].model_copy(update={"whole": True})
    return plan.model_copy(update={"ops": tuple(ops)})


def _require_choice(question: Question, chosen: Query, answer: str) -> None:
    """Check that the answer selects only candidates of the question. Raises UserError if the query finds nothing, or
    something that is not a candidate."""
    if question.selection.verdict != "ambiguous":
        return
    found = question.resolve(chosen)
    if found.verdict == "absent" or not set(found.groups) <= {c.group for c in question.candidates}:
        raise UserError(
            f"{answer!r} is none of the {len(question.candidates)} that match; answer with a number from 1 to "
            f"{len(question.candidates)}, 'all', or words that describe one of them"
        )


def _choice(
    candidates: tuple[Candidate, ...], query: Query, answer: str, parse: Callable[[str], Query | None]
) -> Query | None:
    if (places := chosen_numbers(answer, len(candidates))) is not None:
        return _picked(query, [candidates[i] for i in places])
    if says_all(answer):
        both = re.search(r"\bboth\b", answer) and len(candidates) != 2
        return None if both else query.model_copy(update={"pick": "all"})
    words = re.fullmatch(rf"(?:the\s+)?(\w+)(?:\s+(?:one|{re.escape(query.text or 'one')}))?", answer)
    if words and words[1] in _SIDES:
        return query.model_copy(update={"pick": _SIDES[words[1]]})
    said = parse(answer)
    return merge(query, said) if said is not None else None


def _picked(query: Query, candidates: Sequence[Candidate]) -> Query:
    """A query for the candidates' groups; the words are kept for messages only. Raises UserError if a candidate is a
    place or a part without a row in the table of groups, so a number cannot pick it."""
    if any(c.group < 0 for c in candidates):
        raise UserError("that one cannot be picked by number; say where it is ('the left one'), or 'all'")
    return Query(text=query.text, colors=query.colors, size=query.size, groups=tuple(c.group for c in candidates))


def merge(query: Query, said: Query) -> Query:
    """The query narrowed by an answer: "the chair", then "the red one next to the sofa"."""
    generic = said.text in ("", "one", "ones", "thing")
    return query.model_copy(
        update={
            "text": query.text if generic else said.text,
            "colors": tuple(dict.fromkeys((*query.colors, *said.colors))),
            "not_colors": tuple(dict.fromkeys((*query.not_colors, *said.not_colors))),
            "size": said.size or query.size,
            "relations": (*query.relations, *said.relations),
            "pick": query.pick if said.pick == "one" else said.pick,
            "ordinal": said.ordinal or query.ordinal,
            "count": said.count or query.count,
        }
    )
