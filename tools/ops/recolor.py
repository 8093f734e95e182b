"""The operation recolor: give the target a new colour and keep its shading and texture."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal, Self, get_args

import torch
from pydantic import ConfigDict, Field, model_validator
from torch import Tensor

from ...gaussians.color import rgb_to_lab, shade_of
from ...gaussians.language.field.measure import Sample, lightness_spread, lit_lab, mean_lab, sample
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from ..alternatives import NOT_GIVEN, either, given
from ..checks import count_matches
from ..cloud_diff import Draft, rows_of
from ..color_map import NEAR, ColorMap, distance, saturation, toward_color, warmth
from ..field_update import after_recolor
from ..operation import ColorName, Context, Outcome, TargetedOp
from ..placement.bodies import rows_by_thing
from ..receipt import Check, at_least, at_most, report

Adjust = Literal["darker", "lighter", "more_saturated", "less_saturated", "warmer", "cooler", "toward"]
SAME_COLOR = 20.0  # Lab distance, lightness weighted by half, below which things share one colour map


class Recolor(TargetedOp):
    """Change the target's colour, keeping its shading and texture.

    Give either `color` alone ("make it teal"), or `adjust` with `amount` ("a bit darker": amount 0.25, "much darker":
    0.8). `adjust` "toward" also needs `color` ("a bit more blue": toward, blue, 0.25).
    """

    model_config = ConfigDict(
        json_schema_extra=either(
            {"color": given(), "adjust": NOT_GIVEN},
            {"adjust": given(enum=[a for a in get_args(Adjust) if a != "toward"]), "color": NOT_GIVEN},
            {"adjust": given(enum=["toward"]), "color": given()},
        )
    )
    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "make the armchair teal",
        {"op": "recolor", "target": {"text": "armchair"}, "color": "teal"},
    )
    op: Literal["recolor"] = "recolor"
    color: ColorName | None = None
    """A CSS or everyday colour name ("teal", "dark green") or #rrggbb."""
    adjust: Adjust | None = None
    """A change relative to the colour it has."""
    amount: Annotated[float, Field(gt=0, le=1, allow_inf_nan=False)] = 0.5
    """How far to adjust, 0 to 1; has no effect with `color` alone."""

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if self.adjust is None and self.color is None:
            raise ValueError("recolor needs a color or an adjust")
        if self.adjust == "toward" and self.color is None:
            raise ValueError('adjust "toward" needs the color to go toward')
        if self.adjust not in (None, "toward") and self.color is not None:
            raise ValueError(f'give either a color or adjust "{self.adjust}", not both')
        return self

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        asked = self._asked()
        draft = Draft(scene.cloud)
        for rows in color_groups(scene, selection):
            change = self._map(sample(scene.cloud, rows), asked)
            draft.map("sh", rows, change.on_harmonics)
        after = scene.replace(cloud=draft.done())
        return Outcome(after.replace(language=after_recolor(after, selection.ids)), touched=selection.ids)

    def _asked(self) -> Tensor | None:
        """Lab of the named colour (see `gaussians.color.shade_of`)."""
        if self.color is None:
            return None
        return rgb_to_lab(torch.tensor(shade_of(self.color), dtype=torch.float64))

    def _map(self, colors: Sample, asked: Tensor | None) -> ColorMap:
        """The map for the things of one colour."""
        if self.adjust is None:
            assert asked is not None
            return toward_color(colors, asked)
        if self.adjust in ("more_saturated", "less_saturated"):
            return saturation(1 + 1.5 * self.amount if self.adjust == "more_saturated" else 1 - self.amount)
        if self.adjust in ("warmer", "cooler"):
            return warmth(self.amount if self.adjust == "warmer" else -self.amount)
        return toward_color(colors, self._shifted(lit_lab(colors), asked), keep_pattern=True)

    def _shifted(self, lit: Tensor, asked: Tensor | None) -> Tensor:
        """The new colour of the lit faces: darker or lighter at constant hue, or part of the way to a colour."""
        if asked is not None:
            return lit + self.amount * (asked - lit)
        lightness = float(lit[0])
        new = (
            lightness * (1 - 0.75 * self.amount)
            if self.adjust == "darker"
            else (lightness + 0.75 * self.amount * (100 - lightness))
        )
        # Chroma shrinks with lightness as it does in shadow, and a display has little chroma in very light colours.
        chroma = (
            min(1.0, new / max(lightness, 1.0))
            if self.adjust == "darker"
            else (min(1.0, 1.6 * (100 - new) / max(100 - lightness, 1.0)))
        )
        return torch.stack([torch.tensor(new, dtype=torch.float64), lit[1] * chroma, lit[2] * chroma])

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        was, now = (sample(s.cloud, rows_of(s.cloud, selection.ids)) for s in (before, outcome.scene))
        checks = [self._arrived(was, now), count_matches(before, outcome.scene, outcome)]
        if self.adjust is None:
            texture, kept = lightness_spread(was), lightness_spread(now)
            said = f"spread of lightness (shading, texture) went from {texture:.1f} to {kept:.1f}"
            if texture > 2:  # even a pure colour at the end of the display's range keeps a twentieth of it
                checks.append(at_least("texture kept", kept / texture, 0.05, "1", said))
            else:
                checks.append(report("texture kept", kept / max(texture, 1e-9), "1", said))
        return tuple(checks)

    def _arrived(self, was: Sample, now: Sample) -> Check:
        """The lit faces have the requested colour, or the colour changed in the requested direction."""
        if self.adjust is None:
            asked = self._asked()
            assert asked is not None
            off = float(distance(lit_lab(now), asked))
            return at_most("colour", off, NEAR, "ΔE94", f"its lit faces are {off:.1f} from {self.color}")
        step = self._progress(was, now)
        said = f"its colour moved by {step:.1f} in Lab"
        return at_least(f"{self.adjust.replace('_', ' ')}", step, 0.2, "ΔE", said)

    def _progress(self, was: Sample, now: Sample) -> float:
        """How far the colour moved in the requested direction, in Lab: of the lit faces, or for saturation and warmth
        of the mean.

        These two change chroma only, and the median chroma of a striped thing may be that of its white stripes.
        """
        old, new = mean_lab(was), mean_lab(now)
        if self.adjust in ("more_saturated", "less_saturated"):
            gain = math.hypot(float(new[1]), float(new[2])) - math.hypot(float(old[1]), float(old[2]))
            return gain if self.adjust == "more_saturated" else -gain
        if self.adjust in ("warmer", "cooler"):
            return float(new[2] - old[2]) * (1 if self.adjust == "warmer" else -1)
        old, new = lit_lab(was), lit_lab(now)
        if self.adjust in ("darker", "lighter"):
            return float(new[0] - old[0]) * (1 if self.adjust == "lighter" else -1)
        asked = self._asked()
        assert asked is not None
        return float(torch.linalg.vector_norm(old - asked) - torch.linalg.vector_norm(new - asked))


def color_groups(scene: Scene, selection: Selection) -> list[Tensor]:
    """Rows that share one colour map: one group for things of nearly the same colour, else one for each thing.

    So patches of one cloth keep their shading relative to each other, while a white and a black chair both turn red.
    """
    found: list[tuple[Tensor, list[Tensor]]] = []
    for _, rows in rows_by_thing(scene, selection):
        mean = mean_lab(sample(scene.cloud, rows, 2048))
        for other, alike in found:
            if float(torch.linalg.vector_norm((mean - other) * torch.tensor([0.5, 1, 1]))) < SAME_COLOR:
                alike.append(rows)
                break
        else:
            found.append((mean, [rows]))
    return [torch.cat(alike).sort().values for _, alike in found]
