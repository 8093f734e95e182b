"""What a planner gives back: operations, or the reason why there are none.

Knows the type of a plan and the protocol of a planner. Refuses to know how words are understood and what a scene is:
a plan holds queries, not ids, so that it can be carried out on another scene.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, Protocol, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from ..tools.registry import AnyOp

if TYPE_CHECKING:
    from .graph import SceneGraph

MAX_OPS = 64

Verdict = Literal["ok", "not_an_edit", "not_understood", "impossible", "unsafe", "absent", "ambiguous"]
"""`not_an_edit`: a question or chat. `not_understood`: an edit, in words the planner does not know. `impossible`:
understood, but no operation does it. `unsafe`: not about the scene at all. `absent`, `ambiguous`: known only to
planners that saw the scene, and after resolving."""


class EditPlan(BaseModel):
    """A plan: either verdict "ok" and at least one operation, or another verdict, no operation and a reason.

    Attributes:
        instruction: the words as given.
        ops: what to do, in order. `Query.last` means the selection of the operation before, and in the first operation
            that of the instruction before.
        planner: who planned it.
        prompt_hash: hash of the prompt, "" for planners that use none.
        verdict: see `Verdict`.
        reason: one sentence for a person; of a plan that is ok, what was read otherwise than it was written.
        unknown: the exact words that were not understood.
        seconds: how long planning took; not compared (`same_as`).
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    instruction: Annotated[str, Field(max_length=4000)]
    ops: Annotated[tuple[AnyOp, ...], Field(max_length=MAX_OPS)] = ()
    planner: Annotated[str, Field(max_length=200)]
    prompt_hash: Annotated[str, Field(max_length=128)] = ""
    verdict: Verdict = "ok"
    reason: Annotated[str, Field(max_length=2000)] = ""
    unknown: Annotated[tuple[Annotated[str, Field(max_length=200)], ...], Field(max_length=64)] = ()
    seconds: Annotated[float, Field(ge=0, le=86_400, allow_inf_nan=False)] = 0.0

    @model_validator(mode="after")
    def _all_or_nothing(self) -> Self:
        if (self.verdict == "ok") != bool(self.ops):
            raise ValueError(f"a plan has operations exactly if its verdict is ok, got {self.verdict!r}")
        return self

    @property
    def ok(self) -> bool:
        """Whether there is something to do."""
        return self.verdict == "ok"

    def same_as(self, other: EditPlan) -> bool:
        """Whether both come to the same thing, whoever planned it and however long it took."""
        return (self.verdict, self.ops) == (other.verdict, other.ops)


class Planner(Protocol):
    """Words to a plan. A planner never raises for words it does not understand; it says so in the verdict."""

    @property
    def name(self) -> str:
        """What receipts call it."""
        ...

    def plan(self, text: str, *, previous: str | None = None, graph: SceneGraph | None = None) -> EditPlan:
        """The plan for an instruction.

        Args:
            text: the instruction.
            previous: the instruction before, for "the red one" and "a bit more".
            graph: the scene, for planners that look at it.

        Raises:
            UserError: the instruction is too long to be one.
        """
        ...
