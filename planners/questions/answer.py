"""`Answer`: the reply to a question as JSON, with the evidence that it rests on."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from ..plan import Usage
from ..rooms.node import NodeId, Point

AnswerType = Literal["yesno", "number", "metres", "label", "list", "text"]
Source = Literal["geometry", "vlm", "none"]
Text = Annotated[str, Field(max_length=4000)]


class Line(BaseModel):
    """A measured distance, drawn as a line in evidence pictures.

    Attributes:
        start, end: its ends in the graph's frame (z up, metres, origin at the centre of the floor).
        label: what it measures, "1.24 m".
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    start: Point
    end: Point
    label: Annotated[str, Field(max_length=80)] = ""


class Evidence(BaseModel):
    """What an answer rests on.

    Attributes:
        ids: ids of the things that it is about, as in the scene graph; what the answer names comes first.
        views: names of the views that a vision model saw and relied on.
        lines: distances and routes that were measured.
        time: in a scene with time, when it is to be seen, seconds; None: at the time of the session.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    ids: tuple[NodeId, ...] = ()
    views: tuple[Annotated[str, Field(max_length=200)], ...] = ()
    lines: tuple[Line, ...] = ()
    time: Annotated[float, Field(allow_inf_nan=False)] | None = None


class Answer(BaseModel):
    """The reply to one question.

    Attributes:
        answer: "yes" or "no", a number, a length in metres, a label, several labels, a text, or None if the question
            has no answer here.
        answer_type: the type that the question asks for, also where `answer` is None.
        text: one or two sentences for a person.
        confidence: estimated probability that the answer is right, in [0, 1]; of a refusal, that it is rightly refused.
        source: "geometry": measured; "vlm": a vision-language model; "none": nobody could answer.
        evidence: what it rests on.
        frame: in whose frame of reference directions are told: "viewer", "object", or words such as "seated on the
            sofa, facing the window"; "" where none is needed.
        unit: "m", "m2", "deg", "%", "s", "m/s", "turns/s" and the like, or "".
        table: rows of a table, if one was asked for, each a mapping of column to value.
        usage: use of language models, None if none was asked.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    answer: float | Text | tuple[Text, ...] | None
    answer_type: AnswerType
    text: Text
    confidence: Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)] = 1.0
    source: Source = "geometry"
    evidence: Evidence = Evidence()
    frame: Annotated[str, Field(max_length=400)] = ""
    unit: Annotated[str, Field(max_length=8)] = ""
    table: tuple[dict[str, Any], ...] = ()
    usage: Usage | None = None

    @model_validator(mode="after")
    def _fits_its_type(self) -> Self:
        value, kind = self.answer, self.answer_type
        fits = (
            value is None
            or (kind == "yesno" and value in ("yes", "no"))
            or (kind in ("number", "metres") and isinstance(value, float))
            or (kind in ("label", "text") and isinstance(value, str))
            or (kind == "list" and isinstance(value, tuple))
        )
        if not fits:
            raise ValueError(f"an answer of type {kind} cannot be {value!r}")
        return self

    def to_json(self) -> dict[str, Any]:
        """As plain JSON data: counts without decimals, lengths with three; empty tables and usage are left out."""
        data = self.model_dump(mode="json")
        if isinstance(self.answer, float):
            whole = self.answer_type == "number" and self.answer == int(self.answer)
            data["answer"] = int(self.answer) if whole else round(self.answer, 3)
        for name in ("table", "usage"):
            if not data[name]:
                del data[name]
        for name in ("lines", "time"):
            if data["evidence"][name] in ([], None):
                del data["evidence"][name]
        return data
