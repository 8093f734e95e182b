"""What a planner gives back: operations, or the reason why there are none.

Knows the type of a plan and the protocol of a planner. Refuses to know how words are understood and what a scene is:
a plan holds queries, not ids, so that it can be carried out on another scene.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, Protocol, Self, get_args

from pydantic import BaseModel, ConfigDict, Field, model_validator

from ..gaussians.errors import BackendError
from ..tools.alternatives import either, given
from ..tools.registry import AnyOp

if TYPE_CHECKING:
    from .rooms.graph import SceneGraph

MAX_OPS = 64

Verdict = Literal["ok", "not_an_edit", "not_understood", "impossible", "unsafe", "absent", "ambiguous"]
"""`not_an_edit`: a question or chat. `not_understood`: an edit, in words the planner does not know. `impossible`:
understood, but no operation does it. `unsafe`: not about the scene at all. `absent`, `ambiguous`: known only to
planners that saw the scene, and after resolving."""


class Usage(BaseModel):
    """What a language model was asked for, summed over all its answers to one instruction.

    Attributes:
        model: back end and model, as the planner is named.
        requests: how often it was asked; more than one where an answer had to be repaired.
        input_tokens, output_tokens: as the back end counted them, 0 where it did not.
        dollars: by published prices; None where none are known (local models, own servers).
        seconds: waiting for it.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    model: Annotated[str, Field(max_length=200)]
    requests: Annotated[int, Field(ge=0, le=1000)] = 0
    input_tokens: Annotated[int, Field(ge=0, le=10**9)] = 0
    output_tokens: Annotated[int, Field(ge=0, le=10**9)] = 0
    dollars: Annotated[float, Field(ge=0, le=1e6, allow_inf_nan=False)] | None = None
    seconds: Annotated[float, Field(ge=0, le=86_400, allow_inf_nan=False)] = 0.0

    def plus(self, other: Usage) -> Usage:
        """Both together; dollars are unknown only where both are."""
        known = [u.dollars for u in (self, other) if u.dollars is not None]
        return Usage(
            model=self.model,
            requests=self.requests + other.requests,
            input_tokens=self.input_tokens + other.input_tokens,
            output_tokens=self.output_tokens + other.output_tokens,
            dollars=sum(known) if known else None,
            seconds=self.seconds + other.seconds,
        )


class NoPlanError(BackendError):
    """A language model was asked and there is no plan; `usage` is what the asking cost, None if that is not known."""

    def __init__(self, message: str, usage: Usage | None = None) -> None:
        super().__init__(message)
        self.usage = usage


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
        usage: what language models were asked for; None if none was. Not compared either.
    """

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        json_schema_extra=either(
            {"verdict": {"enum": ["ok"]}, "ops": given(minItems=1)},
            {"verdict": given(enum=[v for v in get_args(Verdict) if v != "ok"]), "ops": {"maxItems": 0}},
        ),
    )

    instruction: Annotated[str, Field(max_length=4000)]
    ops: Annotated[tuple[AnyOp, ...], Field(max_length=MAX_OPS)] = ()
    planner: Annotated[str, Field(max_length=200)]
    prompt_hash: Annotated[str, Field(max_length=128)] = ""
    verdict: Verdict = "ok"
    reason: Annotated[str, Field(max_length=2000)] = ""
    unknown: Annotated[tuple[Annotated[str, Field(max_length=200)], ...], Field(max_length=64)] = ()
    seconds: Annotated[float, Field(ge=0, le=86_400, allow_inf_nan=False)] = 0.0
    usage: Usage | None = None

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


class Sight(Protocol):
    """The scene as far as planners may look at it, each part made only when somebody looks."""

    def graph(self) -> SceneGraph:
        """What stands where. Its ids are numbers, the groups that a query may name.

        Raises:
            ScenewrightError: the scene cannot be looked at (it could not be embedded).
        """
        ...

    def picture(self) -> bytes | None:
        """The viewer's view as PNG, None where there are no pixels."""
        ...


class Planner(Protocol):
    """Words to a plan. A planner never raises for words it does not understand; it says so in the verdict."""

    @property
    def name(self) -> str:
        """What receipts call it."""
        ...

    def plan(self, text: str, *, previous: str | None = None, sight: Sight | None = None) -> EditPlan:
        """The plan for an instruction.

        Args:
            text: the instruction.
            previous: the instruction before, for "the red one" and "a bit more".
            sight: the scene, for planners that look at it.

        Raises:
            UserError: the instruction is too long to be one.
            BackendError: a language model cannot be reached, or gave no plan after all attempts; a `NoPlanError` where
                attempts were paid for.
        """
        ...
