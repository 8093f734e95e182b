"""The types every operation is made of: lengths, placements, the operation itself, its context and its outcome.

Knows what an operation may say and what it must give back. Refuses to know which operations exist (see registry),
how words become selections (see gaussians.language) and where an operation came from.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar, Literal, Protocol, Self

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, model_validator
from torch import Tensor

from ..gaussians.camera import Camera
from ..gaussians.language.query.query import Query
from ..gaussians.language.query.selection import Selection, mask_of
from ..gaussians.scene import Frame, Scene
from ..gaussians.world import relations
from ..gaussians.world.lengths import Unit, in_metres
from .alternatives import NOT_GIVEN, either, given
from .receipt import Check, Pixels, Receipt, SelectionSummary

__all__ = [
    "Affine", "Check", "ColorName", "Context", "Direction", "EditOp", "Encoder", "Length", "Outcome", "Pixels",
    "Placement", "Receipt", "SelectionSummary", "TargetedOp",
]  # fmt: skip

Direction = Literal["left", "right", "forward", "backward", "up", "down"]
ColorName = Annotated[str, Field(min_length=1, max_length=40)]
AssetName = Annotated[str, Field(min_length=1, max_length=60)]

Way = Annotated[float, Field(ge=-1000, le=1000, allow_inf_nan=False)]

_KINDS = [kind for kind in relations.KINDS if kind.used("placement")]
_RELATIVE = [k.name for k in _KINDS if not k.default and k.anchors == 1]
_PAIRED = [k.name for k in _KINDS if k.anchors == 2]
_ABSOLUTE = [k.name for k in _KINDS if k.default and k.name != "on"]
_OFFSET = ("on", "against")


class Length(BaseModel):
    """A length with its unit. "units" are the scene's own units; the others are converted by the scene's scale."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    value: Annotated[float, Field(gt=0, le=10_000, allow_inf_nan=False)]
    unit: Unit = "m"

    def in_units(self, frame: Frame) -> float:
        """This length in scene units; one unit counts as one metre where the scale is unknown (see `assumption`)."""
        if self.unit == "units":
            return self.value
        return in_metres(self.value, self.unit) / (frame.metres_per_unit or 1.0)

    def assumption(self, frame: Frame) -> tuple[str, ...]:
        """What had to be assumed to convert it, as notes for the receipt; empty if nothing."""
        if self.unit == "units" or frame.metres_per_unit is not None:
            return ()
        return (f"the scene's scale is unknown: {self.describe()} was read with one scene unit as one metre",)

    def describe(self) -> str:
        """ "40 cm"."""
        return f"{self.value:g} {self.unit}"


class Placement(BaseModel):
    """Where to put something: a relation to one or two things, or to the room if there are no anchors.

    "on" without an anchor or with an anchor called "floor" is on the floor. Left, right, in front and behind are as
    the viewer sees them. "opposite" is a few steps before the front of the anchor itself. "above" is for what hangs: on
    the wall behind the anchor, or from the ceiling over it. "between" takes two anchors, or one that means two things.
    "against" without an anchor is against a wall; "center" and "corner" without one are those of the room.
    """

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        json_schema_extra=either(
            {"relation": given(enum=_RELATIVE), "anchors": given(minItems=1, maxItems=1), "offset": NOT_GIVEN},
            {"relation": given(enum=_PAIRED), "anchors": given(minItems=1), "offset": NOT_GIVEN},
            {"relation": given(enum=_ABSOLUTE), "anchors": {"maxItems": 1}, "offset": NOT_GIVEN},
            {"relation": given(enum=["on"]), "anchors": {"maxItems": 1}},
            {"relation": given(enum=["against"]), "anchors": {"maxItems": 0}},
        ),
    )

    relation: relations.PlacementName
    anchors: Annotated[tuple[Query, ...], Field(max_length=2)] = ()
    offset: tuple[Way, Way] | None = None
    """With "on", or "against" a wall: near which point, metres along the scene graph's x and y from the middle of the
    anchor or of the floor."""

    @model_validator(mode="after")
    def _anchored(self) -> Self:
        kind = relations.named(self.relation)
        if not kind.default and not self.anchors:
            raise ValueError(f'place "{self.relation}" needs an anchor: say {kind.told("what")}')
        if self.offset is not None and (self.relation not in _OFFSET or (self.relation != "on" and self.anchors)):
            raise ValueError(f'an offset goes with "on", or "against" a wall, not with "{self.describe()}"')
        if len(self.anchors) > kind.anchors:
            raise ValueError(f'place "{self.relation}" takes one anchor, got {len(self.anchors)}')
        return self

    def describe(self) -> str:
        """ "next to the sofa"."""
        kind = relations.named(self.relation)
        return kind.told(*(a.describe() for a in self.anchors)) if self.anchors else kind.told(kind.default)


class Encoder(Protocol):
    """The part of a text encoder that operations use: new objects get a vector from their name."""

    @property
    def fingerprint(self) -> str: ...

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        """Unit rows `[T, D]`."""
        ...

    def knows(self, text: str) -> bool:
        """Whether `text` has words and all of them are known."""
        ...


Resolver = Callable[..., Selection]  # resolve(scene, query, viewer, encoder=None, last=None), as gaussians.language


@dataclass(frozen=True, eq=False)
class Context:
    """What an operation may look at besides the scene.

    Attributes:
        viewer: whose left, right, in front and behind are meant; pixel checks look through it.
        last: the selection of the instruction before ("it").
        encoder: for words and for naming new objects; None works with measured attributes only.
        seed: what varies between two inserted chairs; same seed, same bytes.
        pixel_checks: whether to render before and after from the viewer (slower; never needed for correctness).
        pixel_width: width of these pictures, pixels.
        resolver: how queries become selections; None means `scenewright.gaussians.language.query.resolve`.
        renderer: back end of pixel checks, as `gaussians.render.render` takes it.
    """

    viewer: Camera
    last: Selection | None = None
    encoder: Encoder | None = None
    seed: int = 0
    pixel_checks: bool = False
    pixel_width: int = 256
    resolver: Resolver | None = None
    renderer: str = "auto"

    def resolve(self, scene: Scene, query: Query) -> Selection:
        """What `query` means in `scene`; the verdict is not judged here (see `Selection.require`)."""
        from ..gaussians.language.query.resolve import resolve

        resolver: Resolver = self.resolver or resolve
        return resolver(scene, query, self.viewer, encoder=self.encoder, last=self.last)


@dataclass(frozen=True, eq=False)
class Affine:
    """What was asked of one body: `x -> matrix @ x + offset` on its centres.

    Attributes:
        rows: `[M]` int64 rows of the new cloud that were to move.
        matrix: `[3, 3]` float64.
        offset: `[3]` float64, scene units.
        source: `[M]` int64 rows of the old cloud they come from; none for what was not there before.
        support: height along up of the surface it was put on, scene units; None if it was not put anywhere.
    """

    rows: Tensor
    matrix: NDArray[np.float64]
    offset: NDArray[np.float64]
    source: Tensor
    support: float | None = None


_NONE = torch.zeros(0, dtype=torch.int64)


@dataclass(frozen=True, eq=False)
class Outcome:
    """What `EditOp.apply` gives back.

    Rows that stay keep their order; added rows stand at the end.

    Attributes:
        scene: the new scene; shares every column that did not change.
        touched: `[M]` int64 ids of Gaussians that stayed and changed.
        added, removed: `[M]` int64 ids.
        moved: what was asked of each body, for the checks.
        notes: for the receipt.
        focus: what "it" means next; None keeps the operation's own selection.
    """

    scene: Scene
    touched: Tensor = field(default_factory=lambda: _NONE)
    added: Tensor = field(default_factory=lambda: _NONE)
    removed: Tensor = field(default_factory=lambda: _NONE)
    moved: tuple[Affine, ...] = ()
    notes: tuple[str, ...] = ()
    focus: Selection | None = None


class EditOp(BaseModel):
    """One atomic operation: data that says what to do, and the code that does and checks it.

    A subclass in `tools/ops/` sets `op: Literal["name"] = "name"`, documents itself for a model in its docstring, gives
    an `example` (words and the JSON they mean) and implements `apply` and `check`.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    op: str
    example: ClassVar[tuple[str, dict[str, Any]]]

    def query(self) -> Query | None:
        """What the operation is about, or None if it needs no target."""
        return None

    def subject(self) -> str:
        """What it is about, in words: "the red chair"."""
        query = self.query()
        return query.describe() if query is not None else ""

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        """`[N]` bool: the Gaussians that may change or go; the others must come out bit for bit."""
        return mask_of(scene.cloud, selection.ids)

    @abstractmethod
    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        """The edited scene; never touches `scene` in place.

        Raises:
            InstructionError: it cannot be done as said.
        """

    @abstractmethod
    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        """The operation's own post-conditions, measured on the two scenes."""


class TargetedOp(EditOp):
    """An operation on something that is already in the scene."""

    target: Query
    """What to change."""

    def query(self) -> Query | None:
        return self.target
