"""`When`: the time during which an edit holds, or that a movement takes, as data."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from ..gaussians.language.query.query import Query
from ..gaussians.world.relations import named, names
from .alternatives import NOT_GIVEN, either, given
from .lengths import Length

Part = Literal["while", "unless", "from", "until", "after", "until_end"]
# States that say nothing of another thing.
ALONE = ("moving", "still", "falling", "turning", "open", "opening", "closing", "fully_open", "halfway")
STATES = (*ALONE, "touches", "closest", *(n for n in names("query") if named(n).score is not None))
_STATED = {
    "moving": "moves",
    "still": "stands still",
    "falling": "falls",
    "turning": "turns",
    "open": "is open",
    "opening": "opens",
    "closing": "closes",
    "fully_open": "is open all the way",
    "halfway": "has gone half its way",
    "touches": "touches",
    "closest": "is closest to",
}
_PARTS: dict[Part, str] = {
    "while": "while {}", "unless": "while it is not so that {}", "from": "from when {}", "until": "until {}",
    "after": "after {}", "until_end": "as long as {}",
}  # fmt: skip

_NO_AMOUNT = {name: NOT_GIVEN for name in ("share", "degrees", "distance")}
Seconds = Annotated[float, Field(ge=-3600, le=3600, allow_inf_nan=False)]


class During(BaseModel):
    """A time told by what happens: "while it is on the rug". `state` is moving, still, falling, turning, open,
    opening, closing, fully_open, halfway, touches, closest, or a name of Relation.

    `part`: while or unless it is so, from when it first is on, until then, after it was, or until it no longer is.
    "open" is not being where it is at the start, "opening" and "closing" going away from there and back, "fully_open"
    as far from there as it comes, "halfway" the second half of a movement, or what is left of it when it has gone a
    `share` of it, turned by `degrees` or gone a `distance`;
    "closest" the moment of being nearest to the middle of another thing.
    """

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        defer_build=True,
        json_schema_extra=either(
            {"state": given(enum=["halfway"]), "anchors": {"maxItems": 0}},
            {"state": given(enum=[s for s in ALONE if s != "halfway"]), "anchors": {"maxItems": 0}, **_NO_AMOUNT},
            {"state": given(enum=[s for s in STATES if s not in ALONE]), "anchors": given(minItems=1), **_NO_AMOUNT},
        ),
    )

    state: Annotated[str, Field(max_length=24, json_schema_extra={"enum": list(STATES)})]
    anchors: Annotated[tuple[Query, ...], Field(max_length=2)] = ()
    of: Query | None = None  # whose state it is; None: that of the target
    part: Part = "while"
    share: Annotated[float, Field(gt=0, lt=1, allow_inf_nan=False)] | None = None
    degrees: Annotated[float, Field(gt=0, le=360, allow_inf_nan=False)] | None = None
    distance: Length | None = None

    @model_validator(mode="after")
    def _anchored(self) -> Self:
        if self.state not in STATES:
            raise ValueError(f"there is no state {self.state!r}; states are {', '.join(STATES)}")
        wanted = 0 if self.state in ALONE else 1
        if len(self.anchors) < wanted or (self.anchors and not wanted):
            raise ValueError(f'"{self.state}" takes {"what it is about" if wanted else "no anchor"}')
        amounts = sum(amount is not None for amount in (self.share, self.degrees, self.distance))
        if amounts > (self.state == "halfway"):
            raise ValueError("a share, degrees or a distance go with the state halfway, one of them at most")
        return self

    def describe(self) -> str:
        """ "while it is on the rug"."""
        who = "it" if self.of is None else self.of.describe()
        whom = " and ".join(q.describe() for q in self.anchors)
        if (gone := self._gone()) is not None:
            return _PARTS[self.part].format(f"{who} {gone}")
        said = _STATED[self.state] if self.state in _STATED else named(self.state).says(whom)
        return _PARTS[self.part].format(f"{who} {said} {whom if self.state in _STATED else ''}".strip())

    def _gone(self) -> str | None:
        """How far it has gone, in words; None if that is not told, or half its way."""
        if self.degrees is not None:
            return f"has turned by {self.degrees:g} degrees"
        if self.distance is not None:
            return f"has gone {self.distance.describe()}"
        return None if self.share is None else f"has gone {self.share:.0%} of its way"


class When(BaseModel):
    """`when` of any operation on a target: seconds of the scene in which a look holds, or that a movement takes.

    A missing end is open. Negative seconds count from the end of the scene. With `during`, `start` counts from when
    that begins. `until`: what ends each time, of part until or until_end. `every`: a look comes and goes, once in so
    many seconds, for the first half of each.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    start: Seconds | Literal["middle", "end"] | None = None
    stop: Seconds | Literal["middle", "end"] | None = None
    lasting: Annotated[float, Field(gt=0, le=3600, allow_inf_nan=False)] | None = None  # seconds, at most until `stop`
    during: During | None = None
    until: During | None = None
    every: Annotated[float, Field(ge=0.05, le=3600, allow_inf_nan=False)] | None = None
    gradual: bool = False  # a look that changes little by little from start to stop, and stays

    @model_validator(mode="after")
    def _ends(self) -> Self:
        if self.until is not None and self.until.part not in ("until", "until_end"):
            raise ValueError('"until" takes what ends the time: its part is until or until_end')
        return self

    def describe(self) -> str:
        """ "from 1 s to 3 s"."""
        said = [] if self.during is None else [self.during.describe()]
        if self.start is not None:
            said.append(f"from {_told(self.start)}" if self.during is None else f"{self.start:g} s later")
        if self.stop is not None:
            said.append(f"to {_told(self.stop)}")
        if self.until is not None:
            said.append(self.until.describe())
        if self.lasting is not None:
            said.append(f"for {self.lasting:g} s")
        if self.every is not None:
            said.append(f"once every {self.every:g} s")
        return " ".join([*said, *(["little by little"] if self.gradual else [])])


def _told(moment: float | str) -> str:
    if isinstance(moment, str):
        return f"the {moment}"
    return f"{moment:g} s" if moment >= 0 else f"{-moment:g} s before the end"
