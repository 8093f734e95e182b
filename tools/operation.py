"""The types that operations are made of: lengths, placements, the operation's base class, its context and its outcome.

`registry` lists the operations; `gaussians.language` turns words into selections.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Protocol, Self

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, GetJsonSchemaHandler, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema
from torch import Tensor

from ..gaussians.camera import Camera
from ..gaussians.language.query.query import Query
from ..gaussians.language.query.selection import Selection, mask_of
from ..gaussians.scene import Scene
from ..gaussians.world import relations
from .alternatives import NOT_GIVEN, either, given
from .docstrings import described
from .lengths import Length
from .receipt import Check, Pixels, Receipt, SelectionSummary
from .when import When

if TYPE_CHECKING:
    from ..gaussians.assets.modeling.make import Asset
    from .finishing.photograph import Photograph
    from .lifting.behind import Photographs
    from .lifting.inpainters import Inpainter
    from .lifting.restylers import Restyler

__all__ = [
    "Affine", "Check", "ColorName", "Context", "Direction", "EditOp", "Encoder", "Length", "Outcome", "Pixels",
    "Placement", "Receipt", "SelectionSummary", "TargetedOp",
]  # fmt: skip

Direction = Literal["left", "right", "forward", "backward", "up", "down"]
ColorName = Annotated[str, Field(min_length=1, max_length=40)]
AssetName = Annotated[str, Field(min_length=1, max_length=60)]

Metres = Annotated[float, Field(ge=-1000, le=1000, allow_inf_nan=False)]

_KINDS = [kind for kind in relations.KINDS if kind.used("placement")]
_RELATIVE = [k.name for k in _KINDS if not k.default and k.anchors == 1]
_PAIRED = [k.name for k in _KINDS if k.anchors == 2]
_ABSOLUTE = [k.name for k in _KINDS if k.default and k.name != "on"]
_OFFSET = ("on", "against")


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
        defer_build=True,
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
    corner: Literal["front left", "front right", "back left", "back right"] | None = None
    """With "corner": which corner of the room, as the viewer sees it."""
    offset: tuple[Metres, Metres] | None = None
    """With "on", or "against" a wall: near which point, metres along the scene graph's x and y from the middle of the
    anchor or of the floor."""

    @model_validator(mode="after")
    def _anchored(self) -> Self:
        kind = relations.named(self.relation)
        if not kind.default and not self.anchors:
            raise ValueError(f'place "{self.relation}" needs an anchor: say {kind.told("what")}')
        if self.offset is not None and (self.relation not in _OFFSET or (self.relation != "on" and self.anchors)):
            raise ValueError(f'an offset goes with "on", or "against" a wall, not with "{self.describe()}"')
        if self.corner is not None and (self.relation != "corner" or self.anchors):
            raise ValueError(f'a corner of the room goes with relation "corner" alone, not with "{self.describe()}"')
        if len(self.anchors) > kind.anchors:
            raise ValueError(f'place "{self.relation}" takes one anchor, got {len(self.anchors)}')
        return self

    def describe(self) -> str:
        """ "next to the sofa"."""
        kind = relations.named(self.relation)
        if self.corner is not None:
            return f"in the {self.corner} corner of the room"
        return kind.told(*(a.describe() for a in self.anchors)) if self.anchors else kind.told(kind.default)


class Encoder(Protocol):
    """The part of a text encoder that operations use: it gives new objects a vector from their name."""

    @property
    def fingerprint(self) -> str: ...

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        """Unit rows `[T, D]`."""
        ...

    def knows(self, text: str) -> bool:
        """Whether `text` has words and all of them are known."""
        ...


class AssetSource(Protocol):
    """A user's own assets, by name."""

    def natural(self, name: str, color: str | None) -> tuple[Asset | None, tuple[str, ...]]:
        """The asset called `name` in its own proportions, metres, or None; and notes for the receipt.

        Raises:
            UserError: the colour is unknown.
        """
        ...


Resolver = Callable[..., Selection]  # resolve(scene, query, viewer, encoder=None, last=None), as gaussians.language


@dataclass(frozen=True, eq=False)
class Context:
    """What an operation may use besides the scene.

    Attributes:
        viewer: camera that defines left, right, in front and behind; pixel checks render from it.
        last: the selection of the previous instruction ("it").
        encoder: encodes words and the names of new objects; None works with measured attributes only.
        seed: selects the design of inserted assets; the same seed gives the same bytes.
        pixel_checks: whether to render before and after from the viewer (slower; not needed for correctness).
        pixel_width: width of these pictures, pixels.
        resolver: how queries become selections; None means `scenewright.gaussians.language.query.resolve`.
        renderer: back end of pixel checks, as `gaussians.render.render` takes it.
        assets: the user's own assets, which are taken before those of the library; None: there are none.
        infill: whether surfaces that an edit reveals are filled afterwards (see `completing`).
        inpainter: fills what an edit revealed in views of it, beside the fill from the scene itself; None: only that.
        restyler: paints views of what was restyled, which its colours then follow; None: the material as it is drawn.
        photographs: of the scene, against which what was filled is optimised where they see it; None: there are none.
        references: photographs of materials that the user gave, by the names of their files.
        harmony: whether what is put into a scene is fitted to its light and casts a shadow (see `harmony`).
        time: of a scene with motion, seconds, at which words are said and places are settled; None: its start.
    """

    viewer: Camera
    last: Selection | None = None
    encoder: Encoder | None = None
    seed: int = 0
    pixel_checks: bool = False
    pixel_width: int = 256
    resolver: Resolver | None = None
    renderer: str = "auto"
    assets: AssetSource | None = None
    infill: bool = True
    inpainter: Inpainter | None = None
    restyler: Restyler | None = None
    photographs: Photographs | None = None
    references: Mapping[str, Photograph] = field(default_factory=dict)
    harmony: bool = True
    time: float | None = None

    def resolve(self, scene: Scene, query: Query) -> Selection:
        """What `query` means in `scene`; whatever its verdict is (see `Selection.require`).

        What is too scattered or too large for one thing is unconfirmed (see `doubts`).
        """
        from ..gaussians.language.query.resolve import resolve
        from .doubts import with_doubt

        resolver: Resolver = self.resolver or resolve
        return with_doubt(scene, resolver(scene, query, self.viewer, encoder=self.encoder, last=self.last))


@dataclass(frozen=True, eq=False)
class Affine:
    """The map that was requested for one body: `x -> matrix @ x + offset` on its centres.

    Attributes:
        rows: `[M]` int64 rows of the new cloud that were to move.
        matrix: `[3, 3]` float64.
        offset: `[3]` float64, scene units.
        source: `[M]` int64 rows of the old cloud they come from; empty for new objects.
        support: height along up of the surface it was put on, scene units; None if it was not put anywhere.
        touches: whether it was put where other things reach into its place, which the notes tell.
    """

    rows: Tensor
    matrix: NDArray[np.float64]
    offset: NDArray[np.float64]
    source: Tensor
    support: float | None = None
    touches: bool = False


_NONE = torch.zeros(0, dtype=torch.int64)


@dataclass(frozen=True, eq=False)
class Outcome:
    """The result of `EditOp.apply`.

    Remaining rows keep their order; added rows come last.

    Attributes:
        scene: the new scene; shares every column that did not change.
        touched: `[M]` int64 ids of Gaussians that remained and changed.
        added, removed: `[M]` int64 ids.
        moved: the map requested for each body, for the checks.
        notes: for the receipt.
        focus: what "it" means in the next instruction; None keeps the operation's own selection.
    """

    scene: Scene
    touched: Tensor = field(default_factory=lambda: _NONE)
    added: Tensor = field(default_factory=lambda: _NONE)
    removed: Tensor = field(default_factory=lambda: _NONE)
    moved: tuple[Affine, ...] = ()
    notes: tuple[str, ...] = ()
    focus: Selection | None = None


def compounded(share: float, times: float) -> float:
    """The share (0 to 1) of the way that is gone if a step that goes `share` of what is left is made `times` times."""
    return 1 - (1 - share) ** times


class EditOp(BaseModel):
    """One atomic operation: data that say what to do, and the code that does and checks it.

    A subclass in `tools/ops/` sets `op: Literal["name"] = "name"`, has a docstring that describes it to a language
    model, gives an `example` (words and the JSON they mean) and implements `apply` and `check`.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    op: str
    example: ClassVar[tuple[str, dict[str, Any]]]
    reveals: ClassVar[bool] = False  # whether it takes things from their place, and what they hid may be filled
    puts: ClassVar[bool] = False  # whether it puts things where they were not, and they cast shadows there
    takes_enclosed: ClassVar[bool] = False  # whether what a thing of a capture encloses is edited with it
    of_what_moves: ClassVar[bool] = False  # whether it only changes how something moves already
    makes_motion: ClassVar[bool] = False  # whether it changes the motion of the scene itself, and reads its own `when`

    def query(self) -> Query | None:
        """The query of its target, or None if it has no target."""
        return None

    def time(self) -> When | None:
        """When it holds, or None at all times."""
        return None

    def subject(self) -> str:
        """Its target in words: "the red chair"."""
        query = self.query()
        return query.describe() if query is not None else ""

    def settled(self, scene: Scene, context: Context) -> Self:
        """The operation with what it takes from other things of the scene looked up; itself if it takes nothing.

        Raises:
            AbsentError, AmbiguousError: such a thing is not in the scene, or not unique.
        """
        return self

    def stronger(self, times: float) -> Self | None:
        """The operation done `times` as much, below 1 done less; None if it has no strength, or is done as much as it
        can be."""
        return None

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        """`[N]` bool: the Gaussians that may change or be removed; the others must stay the same bit for bit."""
        return mask_of(scene.cloud, selection.ids)

    @classmethod
    def __get_pydantic_json_schema__(cls, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        found = handler(core)
        described(cls, handler.resolve_ref_schema(found).get("properties", {}))
        return found

    @abstractmethod
    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        """The edited scene; `scene` itself is not changed.

        Raises:
            InstructionError: the operation cannot be done as said.
        """

    @abstractmethod
    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        """The operation's own post-conditions, measured on the two scenes."""


class TargetedOp(EditOp):
    """An operation on something that is already in the scene."""

    target: Query
    when: When | None = None

    def query(self) -> Query | None:
        return self.target

    def time(self) -> When | None:
        return self.when
