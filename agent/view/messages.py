"""What a page may send: strict and bounded types. Anything else is refused before it reaches the session."""

from __future__ import annotations

import unicodedata
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError, field_validator, model_validator

from ...gaussians.camera import Camera

MAX_BYTES = 8 << 20  # of one message
MAX_RANGES = 200_000  # of slots in one message
MAX_SLOT = 2**31 - 1

Id = Annotated[int, Field(ge=0, le=2**53)]
Slot = Annotated[int, Field(ge=0, le=MAX_SLOT)]
Number = Annotated[float, Field(ge=-1e9, le=1e9, allow_inf_nan=False)]
Vector = Annotated[list[Number], Field(min_length=3, max_length=3)]
Side = Annotated[int, Field(ge=1, le=16_384)]
Text = Annotated[str, Field(min_length=1, max_length=4000)]
Mode = Literal["set", "add", "remove"]


class BadMessage(ValueError):
    """A message that is none of those a page sends; the text says why."""


class Message(BaseModel):
    """Base of the messages: exact types, and no unknown fields."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class View(Message):
    """The camera of a page, world frame; degrees and pixels."""

    position: Vector
    forward: Vector
    up: Vector
    fov_y: Annotated[float, Field(gt=0, lt=180, allow_inf_nan=False)]
    width: Side
    height: Side

    def camera(self) -> Camera:
        """The same camera. Raises UserError if it looks nowhere."""
        target = [p + f for p, f in zip(self.position, self.forward, strict=True)]
        return Camera.look_at(self.position, target, self.up, self.width, self.height, self.fov_y, "page")


class Resume(Message):
    """First message of a socket."""

    type: Literal["resume"]
    revision: Annotated[int, Field(ge=0, le=2**53)] | None = None


class Asked(Message):
    """Base of the messages that are answered."""

    id: Id


class Say(Asked):
    """A line that was typed."""

    type: Literal["say"]
    text: Text
    camera: View | None = None

    @field_validator("text")
    @classmethod
    def _plain(cls, text: str) -> str:
        if any(c not in "\n\t" and unicodedata.category(c) in ("Cc", "Cs") for c in text) or not text.strip():
            raise ValueError("a text holds control characters, or nothing")
        return text.strip()


class Answer(Asked):
    """A candidate of the open question, or yes or no."""

    type: Literal["answer"]
    choice: Annotated[int, Field(ge=1, le=100_000)] | Literal["yes", "no"]


class Select(Asked):
    """A thing, by its group or by one of its slots."""

    type: Literal["select"]
    mode: Literal["set", "add", "remove", "part", "clear"]
    group: Annotated[int, Field(ge=0, le=MAX_SLOT)] | None = None
    slot: Slot | None = None

    @model_validator(mode="after")
    def _named(self) -> Self:
        given = (self.group is not None) + (self.slot is not None)
        if given != (self.mode != "clear") or (self.mode == "part" and self.slot is None):
            raise ValueError("select takes a group or a slot; part takes a slot; clear takes neither")
        return self


class SelectSlots(Asked):
    """Slots from a box or a brush: ranges, first and count, ascending."""

    type: Literal["select_slots"]
    mode: Mode
    ranges: Annotated[list[Annotated[list[Slot], Field(min_length=2, max_length=2)]], Field(max_length=MAX_RANGES)]

    @model_validator(mode="after")
    def _ascending(self) -> Self:
        end = 0
        for first, count in self.ranges:
            if first < end or count < 1:
                raise ValueError("ranges ascend without overlap, each with a count")
            end = first + count
        return self


class Operate(Asked):
    """Operations on the selection, as one step."""

    type: Literal["operate"]
    ops: Annotated[list[dict[str, Any]], Field(min_length=1, max_length=8)]
    camera: View | None = None


class Step(Asked):
    """Undo or redo, or the columns of the state before the last edit."""

    type: Literal["undo", "redo", "before", "export"]


class Frame(Asked):
    """The scene at a time, seconds."""

    type: Literal["frame"]
    time: Number


class Save(Asked):
    """Write the scene beside its file."""

    type: Literal["save"]
    name: Annotated[str, Field(min_length=1, max_length=200)]
    force: bool = False


AnyMessage = Annotated[
    Resume | Say | Answer | Select | SelectSlots | Operate | Step | Frame | Save, Field(discriminator="type")
]
_ADAPTER: TypeAdapter[Any] = TypeAdapter(AnyMessage)


def parse(text: str) -> Message:
    """A message from its JSON text.

    Raises:
        BadMessage: it is too long, no JSON, or none that a page sends.
    """
    if len(text) > MAX_BYTES:
        raise BadMessage(f"a message has at most {MAX_BYTES:,} bytes")
    try:
        made: Message = _ADAPTER.validate_json(text)
    except (ValidationError, RecursionError, ValueError) as error:
        raise BadMessage("no message that a page sends") from error
    return made
