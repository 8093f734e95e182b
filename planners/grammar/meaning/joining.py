"""What one clause's operations mean for another's: "take the cup and put it there", "keep the sofa, delete the rest".

Knows operations as fields, in the order in which they were said. Refuses to know words.
"""

from __future__ import annotations

from collections.abc import Sequence

from ....gaussians.language.query.query import Query
from ..nodes import Refusal
from .changes import Fields


def sparing(op: Fields, spared: Query) -> Fields:
    """An operation on several things without what was forbidden to touch."""
    target = op.get("target")
    if target is None or target.pick != "all" or len(target.exclude) >= 4:
        return op
    return {**op, "target": target.model_copy(update={"exclude": (*target.exclude, spared)})}


def release(ops: Sequence[Fields]) -> list[Fields]:
    """Settle clauses that are half a sentence: "keep the sofa (and delete the rest)", "take the cup (and put …)".

    Raises:
        Refusal: the other half is missing.
    """
    settled: list[Fields] = []
    taken: Query | None = None
    for i, op in enumerate(ops):
        held, fields = op.get("held"), {k: v for k, v in op.items() if k != "held"}
        after = ops[i + 1].get("target") if i + 1 < len(ops) else None
        if held == "kept" and (after is None or Query(last=True) not in after.exclude):
            raise Refusal("it says what to keep, and asks for no change", "keep", verdict="not_an_edit")
        if op["op"] == "isolate" and after is not None and after.pick == "all" and Query(last=True) in after.exclude:
            fields = {"op": "select", "target": op["target"]}  # "just keep the sofa and remove everything else"
        if held == "taken":
            if after != Query(last=True) or ops[i + 1]["op"] != "move":
                raise Refusal("say where to, or take it away", "take")
            taken = op["target"]
            continue
        if taken is not None:
            fields, taken = {**fields, "target": taken}, None
        settled.append(fields)
    return settled


def merge_copies(ops: Sequence[Fields]) -> list[Fields]:
    """ "copy the chair and put it next to the desk" is one copy that goes there."""
    merged: list[Fields] = []
    for op in ops:
        before = merged[-1] if merged else {}
        bare = before.get("op") == "duplicate" and not {"place", "direction"} & before.keys()
        if bare and op["op"] == "move" and op["target"].last and "toward" not in op:
            merged[-1] = {**before, **{k: v for k, v in op.items() if k not in ("op", "target")}}
        else:
            merged.append(op)
    return merged
