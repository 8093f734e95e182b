"""The edit plan (operations, or the reason why there are none) and the protocol that planners implement.

A plan holds queries, not ids, so that it can be carried out on another scene.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple, Protocol, Self, get_args

from pydantic import BaseModel, ConfigDict, Field, model_validator

from ..gaussians.errors import BackendError
from ..tools.alternatives import either, given
from ..tools.registry import AnyOp

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..gaussians.language.query.query import Query
    from .rooms.graph import SceneGraph

MAX_OPS = 64

Verdict = Literal["ok", "not_an_edit", "not_understood", "impossible", "unsafe", "absent", "ambiguous"]
"""`not_an_edit`: a question or chat. `not_understood`: an edit in words that the planner does not know. `impossible`:
understood, but no operation does it. `unsafe`: not about the scene. `absent`, `ambiguous`: the scene has no such thing
or several; only planners that see the scene give these, and the resolution of a plan's queries."""


Count = Annotated[int, Field(ge=0, le=1_000_000_000)]


class PromptSize(BaseModel):
    """How much of a scene and of the examples a language model was shown.

    Attributes:
        tokens: of the prompt, as estimated.
        window: of prompt and answer together, tokens.
        things: of the scene, with size and place.
        named_only: further things of which the name was told alone.
        of_things: things of the scene; 0 if none was shown.
        examples, of_examples: of the prompt's examples, those that fitted, and all.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    tokens: Count
    window: Count
    things: Count
    named_only: Count = 0
    of_things: Count
    examples: Count
    of_examples: Count

    @property
    def whole(self) -> bool:
        """Whether nothing was left out."""
        return self.things == self.of_things and self.examples == self.of_examples

    def describe(self) -> str:
        """ "shown 24 of 40 things (16 more by name) and 8 of 23 examples in a window of 8,192 tokens"."""
        named = f" ({self.named_only} more by name)" if self.named_only else ""
        things = f"{self.things} of {self.of_things} things{named} and " if self.of_things else ""
        return f"shown {things}{self.examples} of {self.of_examples} examples in a window of {self.window:,} tokens"


class Usage(BaseModel):
    """The use of a language model, summed over all requests for one instruction.

    Attributes:
        model: back end and model, as in the planner's name.
        requests: number of requests; more than one if an answer had to be repaired.
        input_tokens, output_tokens: as counted by the back end, 0 if it did not count.
        dollars: cost by published prices; None if no price is known (local models, own servers).
        seconds: time spent waiting for answers.
        prompt: how much of the scene the model was shown, in the last instruction; None if the prompt is no plan's.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    model: Annotated[str, Field(max_length=200)]
    requests: Annotated[int, Field(ge=0, le=1000)] = 0
    input_tokens: Annotated[int, Field(ge=0, le=10**9)] = 0
    output_tokens: Annotated[int, Field(ge=0, le=10**9)] = 0
    dollars: Annotated[float, Field(ge=0, le=1e6, allow_inf_nan=False)] | None = None
    seconds: Annotated[float, Field(ge=0, le=86_400, allow_inf_nan=False)] = 0.0
    prompt: PromptSize | None = None

    def plus(self, other: Usage) -> Usage:
        """The sum of both; dollars are unknown only if both are."""
        known = [u.dollars for u in (self, other) if u.dollars is not None]
        return Usage(
            model=self.model,
            requests=self.requests + other.requests,
            input_tokens=self.input_tokens + other.input_tokens,
            output_tokens=self.output_tokens + other.output_tokens,
            dollars=sum(known) if known else None,
            seconds=self.seconds + other.seconds,
            prompt=other.prompt or self.prompt,
        )


class NoPlanError(BackendError):
    """A language model was asked and gave no plan; `usage` is what that cost, None if unknown."""

    def __init__(self, message: str, usage: Usage | None = None) -> None:
        super().__init__(message)
        self.usage = usage


class EditPlan(BaseModel):
    """A plan: either verdict "ok" and at least one operation, or another verdict, no operation and a reason.

    Attributes:
        instruction: the instruction as given.
        ops: the operations, in order. `Query.last` means the selection of the previous operation, and in the first
            operation that of the previous instruction.
        planner: name of the planner that made it.
        prompt_hash: hash of the prompt, "" for planners without one.
        verdict: see `Verdict`.
        reason: one sentence for a person; in a plan that is ok, the spelling corrections and what was done.
        unknown: the exact words that were not understood.
        seconds: how long planning took.
        usage: use of language models, None if none was asked.
    """

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        defer_build=True,
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
        """Whether the plan has operations."""
        return self.verdict == "ok"


class Movement(NamedTuple):
    """How something moves in a scene.

    Attributes:
        start, stop: its first start and its last stop, seconds.
        turns: whether it only turns round and round, so that its speed does not tell when it stops.
        end: that of the scene, seconds.
        degrees: its widest angle from the start.
        metres: the length of its way; of what slides how far out that takes it.
        edges: seconds at which it begins, ends or changes what it does, if these are few.
        spells: from when to when it moves, each time and each way, seconds.
    """

    start: float
    stop: float
    turns: bool
    end: float = math.inf
    degrees: float = 0.0
    metres: float = 0.0
    edges: tuple[float, ...] = ()
    spells: tuple[tuple[float, float], ...] = ()

    @property
    def rate(self) -> float:
        """Turns a second on the whole; 0 of what moves at no time."""
        seconds = self.stop - self.start
        return self.degrees / 360 / seconds if seconds > 0 else 0.0


class Observation(Protocol):
    """The scene as planners see it; each part is computed when it is first asked for."""

    def graph(self) -> SceneGraph:
        """The scene graph. Its ids are numbers: the groups that a query may name.

        Raises:
            ScenewrightError: there is no graph because the scene could not be embedded.
        """
        ...

    def picture(self) -> bytes | None:
        """The viewer's view as PNG, None if the scene has no pixels."""
        ...

    def moves(self, query: Query) -> bool | None:
        """Whether any of what a query names moves at some time; None if that cannot be told."""
        ...

    def movement(self, query: Query) -> Movement | None:
        """How what a query names moves; None if it does not, or if that cannot be told."""
        ...

    def after(self, ops: Sequence[AnyOp], query: Query) -> Movement | None:
        """How what a query names would move after operations that change when and how fast things do, without spells if
        it would not; None if they cannot be carried out, or if that cannot be told."""
        ...

    def has(self, query: Query) -> bool:
        """Whether a scene with motion surely has what a query names; no of others, where that is not asked."""
        ...

    def lacks(self, query: Query) -> bool:
        """Whether a scene with motion has nothing that a query names; no of others, where that is not asked."""
        ...


class Planner(Protocol):
    """Turns an instruction into a plan. Words it does not understand are no error: the verdict reports them."""

    @property
    def name(self) -> str:
        """Name of the planner in plans and receipts."""
        ...

    def plan(self, text: str, *, previous: str | None = None, observation: Observation | None = None) -> EditPlan:
        """The plan for an instruction.

        Args:
            text: the instruction.
            previous: the previous instruction, for "the red one" and "a bit more".
            observation: the scene, for planners that see it.

        Raises:
            UserError: the instruction is too long.
            BackendError: a language model cannot be reached, or gave no plan in any attempt; a `NoPlanError` if
                attempts may have cost something.
        """
        ...
